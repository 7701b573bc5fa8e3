//! The pages of a certificate before they are set: sections of text, tables and figures.

pub mod block;
mod sections;
mod wording;

use crate::content::Certificate;
use block::Section;
use wording::NOT_STATED;

/// The pages, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Title.
    pub title: String,
    /// Lines under the title.
    pub subtitle: String,
    /// Line at the foot of every page.
    pub foot: String,
    /// Sections.
    pub sections: Vec<Section>,
}

impl Document {
    /// Sets out a certificate.
    #[must_use]
    pub fn of(certificate: &Certificate) -> Self {
        let identity = &certificate.identity;
        let number = identity.number.as_deref().unwrap_or(NOT_STATED);
        let file = &identity.camera_file;
        let short = file.sha256.get(..16).unwrap_or(&file.sha256);
        Self {
            title: "Calibration certificate".to_owned(),
            subtitle: format!("{}, certificate number {number}", identity.name),
            foot: format!(
                "camera file SHA-256 {short}…, CRC-32 {}; certificate {number}",
                file.crc32
            ),
            sections: sections::all(certificate),
        }
    }
}
