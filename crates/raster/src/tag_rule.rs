//! Tags of an input: which are kept, written anew or dropped.

use crate::tag::Tag;

/// Treatment of a tag.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum TagRule {
    /// It describes the pixels of the file, and is written anew.
    Pixels,
    /// It is kept bit for bit.
    Kept,
    /// It is kept as long as no pixel moves.
    Georeference,
    /// It is the offset of a directory that is kept.
    Directory,
    /// It is dropped, for a reason.
    Dropped(&'static str),
}

impl TagRule {
    /// Returns the treatment of a tag of the frame's page.
    pub(crate) fn of(tag: Tag) -> Self {
        match tag.0 {
            254..=259 | 262 | 266 | 273 | 274 | 277..=279 | 284 | 317 | 322..=325 | 338 | 339 => {
                Self::Pixels
            }
            34_665 | 34_853 => Self::Directory,
            33_550 | 33_922 | 34_264 | 34_735..=34_737 | 50_844 => Self::Georeference,
            280 | 281 | 340 | 341 => Self::Dropped("extremes of the pixels as recorded"),
            288 | 289 | 400 | 40_965 => Self::Dropped("places in the old file"),
            292 | 293 | 347 | 512 | 515..=521 => {
                Self::Dropped("settings of a codec that is not used")
            }
            320 | 529..=532 => Self::Dropped("colours that the pixels do not have"),
            330 => Self::Dropped("reduced images and other sub-images"),
            513 | 514 => Self::Dropped("thumbnail"),
            37_724 => Self::Dropped("layers of the pixels as recorded"),
            51_008 | 51_009 | 51_022 => Self::Dropped("asks to correct the lens again"),
            _ => Self::Kept,
        }
    }
}
