//! Records of a JSON file.

use std::borrow::Cow;
use std::fmt;
use std::io::BufRead;

use fmc_camera_file::InputError;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::stream::Stream;
use crate::FlightFrame;
use crate::row::Row;

pub(super) fn read<E: From<InputError>>(
    source: impl BufRead,
    stream: Stream<'_, impl FnMut(FlightFrame) -> Result<(), E>>,
) -> Result<(), E> {
    let file = stream.file;
    let mut records = Records {
        stream,
        stopped: None,
    };
    let mut json = serde_json::Deserializer::from_reader(source);
    let read = json
        .deserialize_map(Document(&mut records))
        .and_then(|()| json.end());
    // An error of a record, or of their user, goes before the one it causes here.
    if let Some(stopped) = records.stopped {
        return Err(stopped);
    }
    read.map_err(|error| {
        if error.is_io() {
            InputError::reading(file.as_ref(), &error.into())
        } else {
            InputError::invalid(format!("{file}: {error}"))
        }
    })?;
    records.stream.end()
}

/// The records of a file, and the error that ended their reading.
struct Records<'a, F, E> {
    stream: Stream<'a, F>,
    stopped: Option<E>,
}

/// The object around the records.
struct Document<'r, 'a, F, E>(&'r mut Records<'a, F, E>);

impl<'de, E, F> Visitor<'de> for Document<'_, '_, F, E>
where
    E: From<InputError>,
    F: FnMut(FlightFrame) -> Result<(), E>,
{
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with the key records")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut found = false;
        while let Some(key) = map.next_key::<Cow<'_, str>>()? {
            if key == "records" {
                if found {
                    return Err(A::Error::duplicate_field("records"));
                }
                found = true;
                map.next_value_seed(List(self.0))?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        if found {
            Ok(())
        } else {
            Err(A::Error::missing_field("records"))
        }
    }
}

/// The array of records.
struct List<'r, 'a, F, E>(&'r mut Records<'a, F, E>);

impl<'de, E, F> DeserializeSeed<'de> for List<'_, '_, F, E>
where
    E: From<InputError>,
    F: FnMut(FlightFrame) -> Result<(), E>,
{
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de, E, F> Visitor<'de> for List<'_, '_, F, E>
where
    E: From<InputError>,
    F: FnMut(FlightFrame) -> Result<(), E>,
{
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of records")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut records: A) -> Result<(), A::Error> {
        let Self(Records { stream, stopped }) = self;
        while let Some(row) = records.next_element::<Row<Vec<Cow<'static, str>>>>()? {
            let place = format!("{}, record {}", stream.file, stream.count + 1);
            if let Err(error) = stream.push(row, &place) {
                *stopped = Some(error);
                return Err(A::Error::custom("the records end here"));
            }
        }
        Ok(())
    }
}
