//! Tags of an output besides its pixels'.

use crate::container::Value;
use crate::metadata::{Dropped, Metadata};
use crate::tag::Tag;
use crate::tag_rule::TagRule;

/// What decides about tags.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TagOptions {
    /// Pixels do not move: coordinates of their places stay.
    pub keep_georeference: bool,
}

/// Tags of an output besides those of its pixels.
#[derive(Clone, Debug, Default)]
pub struct OutputTags {
    pub(crate) tags: Vec<(Tag, Value)>,
    pub(crate) exif: Vec<(Tag, Value)>,
    pub(crate) interop: Vec<(Tag, Value)>,
    pub(crate) gps: Vec<(Tag, Value)>,
    dropped: Vec<Dropped>,
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

    pub(crate) fn of(input: &Metadata, options: &TagOptions) -> Self {
        let mut output = Self {
            tags: Vec::new(),
            exif: input.exif.clone(),
            interop: input.interop.clone(),
            gps: input.gps.clone(),
            dropped: input.dropped.clone(),
        };
        for (tag, value) in &input.tags {
            if TagRule::of(*tag) == TagRule::Georeference && !options.keep_georeference {
                output.dropped.push(Dropped::tag(*tag, "the pixels moved"));
            } else {
                output.tags.push((*tag, value.clone()));
            }
        }
        output
    }
}
