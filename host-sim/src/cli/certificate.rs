//! Arguments of the certificate.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{ADVANCED, examples};

/// Arguments of `certificate`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct CertificateArgs {
    /// Check of a certificate, in place of making one.
    #[command(subcommand)]
    pub action: Option<CertificateAction>,
    /// Camera and files.
    #[command(flatten)]
    pub make: Option<MakeCertificateArgs>,
}

/// Actions on a certificate that exists.
#[derive(Debug, Subcommand)]
pub enum CertificateAction {
    /// Check signature and hashes of a certificate, and that camera file and PDF say the same.
    ///
    /// Fails (exit 1) when the camera file has been changed since, when a file has another hash
    /// than listed, when PDF, HTML or certificate.json say anything else than the camera file, when
    /// the signature is not that of the key, and when --records has a record of another
    /// calibration.
    #[command(after_help = examples::CERTIFICATE_CHECK)]
    Check(CertificateFolderArgs),
}

/// Arguments of `certificate` without an action.
#[derive(Debug, Args)]
pub struct MakeCertificateArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Folder for certificate.pdf, certificate.html, certificate.json, the camera file and
    /// SHA256SUMS; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Details that no camera file has (TOML): number, laboratory, persons, dates, lens, stage,
    /// encoder. What is missing is printed as "not stated".
    #[arg(long, value_name = "DETAILS.toml")]
    pub details: Option<PathBuf>,
    /// summary.json of a calibration by which parameters were found: σ, correlations, redundancy,
    /// residuals. May be repeated.
    #[arg(long, value_name = "summary.json", help_heading = ADVANCED)]
    pub calibration: Vec<PathBuf>,
    /// Form of the laboratory (TOML): keys of certificate.json that must be stated. Where one is
    /// not, all that are missing are listed, nothing is written, exit code 1.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub require: Option<PathBuf>,
    /// Private key of Ed25519 (PEM, as `openssl genpkey -algorithm ed25519` writes it), which signs
    /// SHA256SUMS: SHA256SUMS.sig and public-key.pem.
    #[arg(long, value_name = "KEY.pem", help_heading = ADVANCED)]
    pub sign: Option<PathBuf>,
}

/// Arguments of `certificate check`.
#[derive(Debug, Args)]
pub struct CertificateFolderArgs {
    /// Folder of the certificate.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Public key of the laboratory (PEM), which must have signed. Without it the key in the folder
    /// is used, which shows that the files belong together, and not who has signed them.
    #[arg(long, value_name = "PUBLIC.pem")]
    pub key: Option<PathBuf>,
    /// records.csv or records.json of a flight: every record must carry the CRC-32 of this
    /// calibration.
    #[arg(long, value_name = "FILE")]
    pub records: Option<PathBuf>,
}
