//! Tags of an output besides its pixels'.

use crate::container::{Entries, Value};
use crate::metadata::{Dropped, Metadata};
use crate::tag::Tag;
use crate::tag_rule::TagRule;
use crate::xmp::{Packet, RectifiedCamera};

/// Facts of the output that decide about tags.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TagOptions {
    /// Pixels do not move: coordinates of their places stay.
    pub keep_georeference: bool,
    /// The camera that the XMP packet names; none keeps the packet as it is.
    pub camera: Option<RectifiedCamera>,
}

/// Tags of an output besides those of its pixels.
#[derive(Clone, Debug, Default)]
pub struct OutputTags {
    pub(crate) tags: Entries,
    pub(crate) exif: Entries,
    pub(crate) interop: Entries,
    pub(crate) gps: Entries,
    dropped: Vec<Dropped>,
}

impl Metadata {
    /// Returns the tags of an output, and what it drops.
    #[must_use]
    pub fn output(&self, options: &TagOptions) -> OutputTags {
        OutputTags::of(self, options)
    }
}

impl OutputTags {
    /// Returns all that the output drops of its input.
    #[must_use]
    pub fn dropped(&self) -> &[Dropped] {
        &self.dropped
    }

    /// Returns a bound of the bytes of all values and entries, for
    /// [`FramePlan::with_bytes_beside`](crate::FramePlan::with_bytes_beside).
    #[must_use]
    pub fn bound_bytes(&self) -> u64 {
        let entry = 24;
        let lists = [&self.tags, &self.exif, &self.interop, &self.gps];
        let values = lists.into_iter().flatten();
        let bytes = values.map(|(_, value)| value.bytes.len() as u64 + entry);
        bytes.sum::<u64>() + 1024
    }

    /// Sets the camera in the packet; one that is no XMP is replaced.
    fn set_camera(&mut self, camera: &RectifiedCamera) {
        let (mut value_type, mut packet) = (1, None);
        if let Some(value) = self.tags.remove(&Tag::XMP) {
            let text = std::str::from_utf8(&value.bytes).ok();
            packet = text.and_then(|text| Packet::edited(text, camera));
            if packet.is_none() {
                let why = "it is no well-formed XMP; a packet of the camera replaces it";
                self.dropped.push(Dropped::tag(Tag::XMP, why));
            } else if value.value_type == 7 {
                value_type = 7;
            }
        }
        let Some(packet) = packet.or_else(|| Packet::of(camera)) else {
            return;
        };
        let dropped = packet.dropped.into_iter().map(|name| Dropped {
            tag: Some(Tag::XMP),
            name,
            why: "asks to correct the lens again",
        });
        self.dropped.extend(dropped);
        let bytes = packet.text.into_bytes();
        self.tags.insert(Tag::XMP, Value { value_type, bytes });
    }

    fn of(input: &Metadata, options: &TagOptions) -> Self {
        let mut output = Self {
            tags: Entries::new(),
            exif: input.exif.clone(),
            interop: input.interop.clone(),
            gps: input.gps.clone(),
            dropped: input.dropped.clone(),
        };
        for (tag, value) in &input.tags {
            if TagRule::of(*tag) == TagRule::Georeference && !options.keep_georeference {
                output.dropped.push(Dropped::tag(*tag, "the pixels moved"));
            } else {
                output.tags.insert(*tag, value.clone());
            }
        }
        if let Some(camera) = &options.camera {
            output.set_camera(camera);
        }
        output
    }
}
