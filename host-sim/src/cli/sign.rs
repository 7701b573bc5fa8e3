//! Arguments of the signature of a calibration.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{ADVANCED, examples};

/// Arguments of `sign`.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct SignArgs {
    /// Key, in place of a signature.
    #[command(subcommand)]
    pub action: Option<SignAction>,
    /// Calibration and key.
    #[command(flatten)]
    pub calibration: Option<SignCalibrationArgs>,
}

/// Actions beside a signature.
#[derive(Debug, Subcommand)]
pub enum SignAction {
    /// Make a key pair: private-key.pem and public-key.pem.
    ///
    /// The private key signs; whoever has it decides what cameras store, and it is never on a
    /// camera. The public key is built into the firmware (docs/store.md). Files that exist are not
    /// replaced.
    #[command(after_help = examples::SIGN_KEY)]
    Key(SignKeyArgs),
}

/// Arguments of `sign key`.
#[derive(Debug, Args)]
pub struct SignKeyArgs {
    /// Folder for both files; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Arguments of `sign` without an action.
#[derive(Debug, Args)]
pub struct SignCalibrationArgs {
    /// Camera file (TOML), with serial and version.
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Private key of Ed25519 (PEM), of `host-sim sign key` or `openssl genpkey -algorithm
    /// ed25519`.
    #[arg(long, value_name = "KEY.pem")]
    pub key: PathBuf,
    /// File for the signature.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Details of the certificate (TOML), of which a camera stores lens, laboratory and day of the
    /// calibration; without them they are not named.
    #[arg(long, value_name = "DETAILS.toml", help_heading = ADVANCED)]
    pub details: Option<PathBuf>,
    /// Output of `host-sim camera stored --json`: permits the camera to store this version, even if
    /// a higher one was stored, in the place of that calibration, once.
    #[arg(long, value_name = "STORED.json", help_heading = ADVANCED)]
    pub over: Option<PathBuf>,
}
