//! Files of other programs: what was written or read, and what it leaves.

mod export_summary;
mod exported_flight;
mod import_summary;

pub use export_summary::{ExportSummary, NotHeldSummary};
pub use exported_flight::{ExportedFlight, RefusedTrigger};
pub use import_summary::{Assumed, ImportSummary, ImportedGrid, comments};

/// Columns of the names on a terminal.
const NAMES: u16 = 16;

/// Writes a residual in µm and px with its place.
fn residual(largest_um: f64, rms_um: f64, pixel_um: f64, [x, y]: [f64; 2]) -> String {
    format!(
        "{} largest ({:.4} px), at ({x:.2}, {y:.2}) mm; {} RMS",
        crate::length::text(largest_um / 1000.0),
        largest_um / pixel_um,
        crate::length::text(rms_um / 1000.0)
    )
}
