//! Silent frames: wrong beyond what the record admits, and without a flag.

use super::quantity::Quantity;
use super::verdict::Verdict;

/// Error in units of its σ beyond which a frame without a flag is silent.
pub const SILENT_SIGMAS: f64 = 5.0;

/// Smear above the predicted one beyond which a frame without a flag is silent, px.
pub const SILENT_SMEAR_PX: f64 = 0.3;

/// Returns true if a frame without fault and flag has its principal point or its time off by more
/// than [`SILENT_SIGMAS`], or smear [`SILENT_SMEAR_PX`] above the predicted one, in which an error
/// of V/H shows.
#[must_use]
pub fn is_silent(frame: &Verdict) -> bool {
    let is_wrong = [Quantity::PrincipalPoint, Quantity::Utc]
        .into_iter()
        .any(|quantity| {
            frame
                .of_quantity(quantity)
                .is_some_and(|stated| stated.ratio().abs() > SILENT_SIGMAS)
        });
    !frame.is_flagged && (is_wrong || frame.smear_px - frame.predicted_px > SILENT_SMEAR_PX)
}
