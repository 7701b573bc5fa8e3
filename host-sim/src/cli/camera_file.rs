//! Arguments of the check of a camera file.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::examples;

/// Arguments of `camera-file`.
#[derive(Debug, Args)]
pub struct CameraFileArgs {
    /// Action on the file.
    #[command(subcommand)]
    pub action: CameraFileAction,
}

/// Actions on a camera file.
#[derive(Debug, Subcommand)]
pub enum CameraFileAction {
    /// Check a camera file, and show what the program reads from it.
    ///
    /// Shows format, distortion at the corner, limits, and the V/H up to which the mechanism flies
    /// the shortest and the longest exposure of the limits. A file that the other commands refuse
    /// is refused here with the same message (exit 2); a warning that they give is given here, too.
    #[command(after_help = examples::CAMERA_FILE_CHECK)]
    Check {
        /// Camera file (TOML); docs/camera-file.md has every key.
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
}
