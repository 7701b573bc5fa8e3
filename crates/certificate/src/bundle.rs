//! The files of a certificate: pages, content, camera file, their hashes and the signature.

use fmc_camera_file::GridFiles;
use fmc_report::figure::FigureError;
use fmc_report::hash;
use fmc_report::page::PageError;

use crate::content::{Certificate, residual};
use crate::document::Document;
use crate::html;
use crate::pdf::{Attachment, PdfError, pdf};
use crate::signature::PrivateKey;

/// Name of the PDF.
pub const PDF: &str = "certificate.pdf";
/// Name of the HTML page.
pub const HTML: &str = "certificate.html";
/// Name of the content.
pub const JSON: &str = "certificate.json";
/// Name of the list of hashes, as `sha256sum` writes it.
pub const SUMS: &str = "SHA256SUMS";
/// Name of the detached signature of the list.
pub const SIGNATURE: &str = "SHA256SUMS.sig";
/// Name of the public key of the signature.
pub const PUBLIC_KEY: &str = "public-key.pem";

/// All names but that of the camera file.
pub const NAMES: [&str; 6] = [PDF, HTML, JSON, SUMS, SIGNATURE, PUBLIC_KEY];

/// A reason why the files cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum BundleError {
    /// The PDF failed.
    #[error(transparent)]
    Pdf(#[from] PdfError),
    /// The HTML page failed.
    #[error(transparent)]
    Page(#[from] PageError),
    /// The content cannot be written as JSON.
    #[error("{JSON}: {0}")]
    Json(#[from] serde_json::Error),
    /// The public key cannot be written.
    #[error("{PUBLIC_KEY} cannot be written")]
    PublicKey,
    /// The camera file or a grid has the name of another file of the certificate.
    #[error(
        "a file of the certificate is called {0}, too: rename the camera file, or the grid of it"
    )]
    Name(String),
}

impl BundleError {
    /// Returns true if other details or another camera file would succeed.
    #[must_use]
    pub const fn is_of_the_input(&self) -> bool {
        matches!(
            self,
            Self::Name(_)
                | Self::Pdf(PdfError::NoGlyph(_) | PdfError::TooLong(_) | PdfError::TooWide(_))
                | Self::Page(PageError::Figure(FigureError::NothingToDraw))
        )
    }
}

/// Makes the files of a certificate, each with its name; the last are the list of hashes and what
/// signs it.
///
/// # Errors
/// [`BundleError`] if the pages cannot be set.
pub fn files(
    certificate: &Certificate,
    camera_file: &[u8],
    grids: &GridFiles,
    key: Option<&PrivateKey>,
) -> Result<Vec<(String, Vec<u8>)>, BundleError> {
    let identity = &certificate.identity;
    let name = &identity.camera_file.name;
    let grids = residual::files(&certificate.residual_grids, grids);
    let mut names: Vec<&str> = NAMES.to_vec();
    for name in [name].into_iter().chain(grids.iter().map(|(name, _)| name)) {
        if names.contains(&name.as_str()) {
            return Err(BundleError::Name(name.clone()));
        }
        names.push(name);
    }
    let mut json = serde_json::to_vec_pretty(certificate)?;
    json.push(b'\n');
    let document = Document::of(certificate);
    let mut attachments = vec![
        Attachment {
            name,
            bytes: camera_file,
            media_type: "application/toml",
            description: "camera file",
        },
        Attachment {
            name: JSON,
            bytes: &json,
            media_type: "application/json",
            description: "content of this certificate",
        },
    ];
    attachments.extend(grids.iter().map(|(name, bytes)| Attachment {
        name,
        bytes,
        media_type: "application/octet-stream",
        description: "residual grid of the camera",
    }));
    let pdf = pdf(
        &document,
        identity.issued_on,
        &identity.software,
        &attachments,
    )?;
    let html = html::page(&document)?;
    let mut files = vec![
        (PDF.to_owned(), pdf),
        (HTML.to_owned(), html.into_bytes()),
        (JSON.to_owned(), json),
        (name.clone(), camera_file.to_vec()),
    ];
    files.extend(grids.iter().cloned());
    let sums = sums(&files).into_bytes();
    if let Some(key) = key {
        let public = key.public().pem().ok_or(BundleError::PublicKey)?;
        files.push((SIGNATURE.to_owned(), key.sign(&sums).to_vec()));
        files.push((PUBLIC_KEY.to_owned(), public.into_bytes()));
    }
    files.push((SUMS.to_owned(), sums));
    Ok(files)
}

/// Writes the list of hashes.
fn sums(files: &[(String, Vec<u8>)]) -> String {
    let line = |(name, bytes): &(String, Vec<u8>)| format!("{}  {name}\n", hash::sha256(bytes));
    files.iter().map(line).collect::<Vec<_>>().concat()
}
