//! Tags of a frame besides its pixels'.

use crate::container::{Container, Directory, Entries, TAGS_LIMIT_BYTES};
use crate::read_error::ReadError;
use crate::tag::Tag;
use crate::tag_rule::TagRule;

/// Tags of a frame besides those of its pixels, and what is dropped whatever the options.
#[derive(Clone, Debug, Default)]
pub struct Metadata {
    pub(crate) tags: Entries,
    pub(crate) exif: Entries,
    pub(crate) interop: Entries,
    pub(crate) gps: Entries,
    pub(crate) dropped: Vec<Dropped>,
}

/// Something of the input that is not in the output.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct Dropped {
    /// The tag, or nothing for a page.
    pub tag: Option<Tag>,
    /// Its name, as `GeoKeyDirectory (34735)`, `page 2` or `drone-dji:DewarpData`.
    pub name: String,
    /// The reason.
    pub why: &'static str,
}

impl Dropped {
    pub(crate) fn tag(tag: Tag, why: &'static str) -> Self {
        Self {
            tag: Some(tag),
            name: tag.to_string(),
            why,
        }
    }
}

impl Metadata {
    /// Returns what of the input does not come into an output, whatever the options.
    #[must_use]
    pub fn dropped(&self) -> &[Dropped] {
        &self.dropped
    }

    /// Takes the first page of full resolution, and reads its tags.
    pub(crate) fn read(
        container: &Container,
        pages: Vec<Directory>,
    ) -> Result<(Directory, Self), ReadError> {
        let count = pages.len();
        let mut metadata = Self::default();
        let mut frame = None;
        for (number, page) in (1..).zip(pages) {
            let why = match reason_to_drop(container, &page)? {
                Some(why) => why,
                None if frame.is_none() => {
                    frame = Some(page);
                    continue;
                }
                None => "only the first page of full resolution is taken",
            };
            metadata.dropped.push(Dropped {
                tag: None,
                name: format!("page {number}"),
                why,
            });
        }
        let page = frame.ok_or(ReadError::NoFullPage { pages: count })?;
        let mut reading = Reading {
            container,
            left_bytes: TAGS_LIMIT_BYTES,
            dropped: Vec::new(),
        };
        let mut directories: Vec<Tag> = Vec::new();
        for entry in &page.entries {
            match TagRule::of(entry.tag) {
                TagRule::Pixels => {}
                TagRule::Dropped(why) => reading.dropped.push(Dropped::tag(entry.tag, why)),
                TagRule::Kept | TagRule::Georeference => {
                    reading.entry(entry, &mut metadata.tags)?;
                }
                TagRule::Directory if directories.contains(&entry.tag) => {
                    reading
                        .dropped
                        .push(Dropped::tag(entry.tag, "it comes a second time"));
                }
                TagRule::Directory if reading.offset(&page, entry.tag)? == 0 => {
                    reading
                        .dropped
                        .push(Dropped::tag(entry.tag, "its directory has no place"));
                }
                TagRule::Directory => {
                    directories.push(entry.tag);
                    let directory = reading.directory(&page, entry.tag)?;
                    if entry.tag == Tag::GPS {
                        reading.entries(&directory, &mut metadata.gps)?;
                    } else {
                        reading.entries(&directory, &mut metadata.exif)?;
                        if directory.find(Tag::INTEROP).is_some() {
                            let interop = reading.directory(&directory, Tag::INTEROP)?;
                            reading.entries(&interop, &mut metadata.interop)?;
                        }
                    }
                }
            }
        }
        metadata.dropped.append(&mut reading.dropped);
        Ok((page, metadata))
    }
}

/// Types of offsets of directories: IFD and IFD8.
const DIRECTORY_TYPES: [u16; 2] = [13, 18];

/// Bytes that an entry counts besides its value.
const ENTRY_BYTES: u64 = 24;

/// Values that are being read.
struct Reading<'a> {
    container: &'a Container,
    left_bytes: u64,
    dropped: Vec<Dropped>,
}

impl Reading<'_> {
    fn entries(&mut self, directory: &Directory, values: &mut Entries) -> Result<(), ReadError> {
        let entries = directory.entries.iter();
        for entry in entries.filter(|entry| entry.tag != Tag::INTEROP) {
            match TagRule::of(entry.tag) {
                TagRule::Pixels | TagRule::Directory => {
                    let why = "it belongs into the directory of a page";
                    self.dropped.push(Dropped::tag(entry.tag, why));
                }
                _ => self.entry(entry, values)?,
            }
        }
        Ok(())
    }

    fn entry(
        &mut self,
        entry: &crate::container::Entry,
        values: &mut Entries,
    ) -> Result<(), ReadError> {
        let tag = entry.tag;
        if DIRECTORY_TYPES.contains(&entry.value_type) {
            self.dropped
                .push(Dropped::tag(tag, "it is a place in the old file"));
            return Ok(());
        }
        let Some((_, bytes)) = self.container.place(entry)? else {
            self.dropped
                .push(Dropped::tag(tag, "its type is none of TIFF or BigTIFF"));
            return Ok(());
        };
        let limit = TAGS_LIMIT_BYTES;
        let left = self
            .left_bytes
            .checked_sub(bytes.saturating_add(ENTRY_BYTES));
        self.left_bytes = left.ok_or(ReadError::TagsTooLong { tag, bytes, limit })?;
        if values.contains_key(&tag) {
            self.dropped
                .push(Dropped::tag(tag, "it comes a second time"));
            return Ok(());
        }
        if let Some(value) = self.container.value(entry)? {
            values.insert(tag, value);
        }
        Ok(())
    }

    /// Reads the directory that a tag points to.
    fn directory(&mut self, parent: &Directory, tag: Tag) -> Result<Directory, ReadError> {
        let offset = self.offset(parent, tag)?;
        self.container.directory(offset, tag.to_string())
    }

    /// Returns the offset of the directory that a tag points to.
    fn offset(&self, parent: &Directory, tag: Tag) -> Result<u64, ReadError> {
        let tags = crate::header::Tags {
            container: self.container,
            page: parent,
        };
        tags.number(tag)?.ok_or(ReadError::Missing { tag })
    }
}

/// Returns why a page is not the frame.
fn reason_to_drop(
    container: &Container,
    page: &Directory,
) -> Result<Option<&'static str>, ReadError> {
    let tags = crate::header::Tags { container, page };
    let kind = tags.number(Tag::SUBFILE_TYPE)?.unwrap_or(0);
    let old_kind = tags.number(Tag::OLD_SUBFILE_TYPE)?.unwrap_or(1);
    Ok(if kind & 1 != 0 || old_kind == 2 {
        Some("reduced image")
    } else if kind & 4 != 0 {
        Some("mask")
    } else {
        None
    })
}
