//! Text and attachments of a PDF, as another program reads them.

use std::collections::BTreeMap;

use lopdf::{Dictionary, Document, Object};

/// Largest size of a stream that is unpacked, bytes.
const LARGEST: usize = 16 << 20;

/// A PDF that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadPdf {
    /// Text of each page.
    pub pages: Vec<String>,
    /// Attached files by name.
    pub attachments: BTreeMap<String, Vec<u8>>,
}

impl ReadPdf {
    /// Reads a PDF.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let document = Document::load_mem(bytes).map_err(|error| error.to_string())?;
        let pages = document
            .get_pages()
            .into_keys()
            .map(|page| document.extract_text_with_limit(&[page], LARGEST))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| error.to_string())?;
        Ok(Self {
            pages,
            attachments: attachments(&document),
        })
    }

    /// Returns the words of all pages, in order: text between blanks.
    #[must_use]
    pub fn words(&self) -> Vec<&str> {
        self.pages
            .iter()
            .flat_map(|page| page.split_whitespace())
            .collect()
    }
}

/// Returns the attached files: those of the file specifications with an embedded file.
fn attachments(document: &Document) -> BTreeMap<String, Vec<u8>> {
    let specifications = document.objects.values().filter_map(|object| {
        let object = object.as_dict().ok()?;
        attachment(document, object)
    });
    specifications.collect()
}

fn attachment(document: &Document, specification: &Dictionary) -> Option<(String, Vec<u8>)> {
    let resolve = |object: &Object| {
        let (_, object) = document.dereference(object).ok()?;
        Some(object.clone())
    };
    let files = resolve(specification.get(b"EF").ok()?)?;
    let stream = resolve(files.as_dict().ok()?.get(b"F").ok()?)?;
    let content = stream
        .as_stream()
        .ok()?
        .decompressed_content_with_limit(LARGEST)
        .ok()?;
    let name = specification.get(b"F").ok()?.as_str().ok()?;
    Some((String::from_utf8_lossy(name).into_owned(), content))
}
