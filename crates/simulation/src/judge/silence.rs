//! Silent frames: wrong beyond what the record admits, and without a flag.

use super::quantity::Quantity;
use super::verdict::Verdict;

/// Error in units of its σ beyond which a frame without a flag is silent.
pub const SILENT_SIGMAS: f64 = 5.0;

/// Smear above the predicted one beyond which a frame without a flag may be silent, px.
pub const SILENT_SMEAR_PX: f64 = 0.3;

/// Multiple of the predicted smear that corresponds to [`SILENT_SIGMAS`]. A prediction is what 95 %
/// of the frames do not exceed, √(2·ln 20) σ of an error in two dimensions; 5 σ of an error in one
/// dimension is exceeded with a probability of 5.7e-7, as is √(2·ln(1/5.7e-7)) σ in two.
pub const SILENT_SMEAR_TIMES: f64 = 2.19;

/// Returns true if a frame without fault and flag has its principal point or its time off by more
/// than [`SILENT_SIGMAS`], or smear that no chance explains ([`smear_used`]).
#[must_use]
pub fn is_silent(frame: &Verdict) -> bool {
    largest_used(frame).is_some_and(|(_, used)| used > 1.0)
}

/// Returns the largest part of what its record allows that an error of a frame without fault or
/// flag takes, and the name of the quantity; `None` for other frames, which nobody is to trust.
#[must_use]
pub fn largest_used(frame: &Verdict) -> Option<(&'static str, f64)> {
    let sigmas = |quantity: Quantity| {
        let stated = frame.of_quantity(quantity)?;
        Some((quantity.name(), stated.ratio().abs() / SILENT_SIGMAS))
    };
    let smear = Some(("smear", smear_used(frame)));
    [
        sigmas(Quantity::PrincipalPoint),
        sigmas(Quantity::Utc),
        smear,
    ]
    .into_iter()
    .flatten()
    .max_by(|(_, one), (_, other)| one.total_cmp(other))
    .filter(|_| !frame.is_flagged)
}

/// Returns the smear above the predicted one in parts of that beyond which a frame without a flag
/// is silent; 0 for one below it.
///
/// That is [`SILENT_SMEAR_PX`] for what the compensation leaves, and for all smear the larger of
/// that and [`SILENT_SMEAR_TIMES`] the predicted smear, less the predicted one.
///
/// # Model
/// A prediction is wrong in one of 20 frames by its own definition, and in a gust in several one
/// after the other: to be above it by a distance in pixels is no sign of a fault, except where the
/// camera itself is at fault. What V/H, stage, rows of a TDI sensor and shutter do wrong shows in
/// the motion along the FMC axis that compensation leaves, which neither attitude nor wind across
/// the track enters. That part has no allowance for chance. The rest, which the camera cannot
/// compensate, is judged as principal point and time are, by what the record states.
#[must_use]
pub fn smear_used(frame: &Verdict) -> f64 {
    let used = |px: f64, allowed_px: f64| (px - frame.predicted_px) / allowed_px;
    let by_chance_px = (SILENT_SMEAR_TIMES - 1.0) * frame.predicted_px;
    let of_smear = used(frame.smear_px, SILENT_SMEAR_PX.max(by_chance_px));
    let not_compensated_px = frame.smear_px.min(frame.compensation_px.abs());
    let of_compensation = used(not_compensated_px, SILENT_SMEAR_PX);
    of_smear.max(of_compensation).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::verdict::StatedError;
    use super::*;

    /// A frame with a smear that may be the air's in part, px.
    fn smeared(predicted_px: f64, smear_px: f64, compensation_px: f64) -> Verdict {
        Verdict {
            sequence: 1,
            principal_point_mm: StatedError {
                error: 0.0,
                sigma: 1e-5,
            },
            across_mm: 0.0,
            vh_per_s: None,
            utc_s: None,
            centroid_us: 0.0,
            smear_px,
            compensation_px,
            predicted_px,
            is_flagged: false,
            is_standing: false,
            vh_source: None,
        }
    }

    #[test]
    fn smear_of_the_air_is_silent_where_no_chance_explains_it() {
        assert!(!is_silent(&smeared(0.3, 0.59, 0.1)));
        assert!(!is_silent(&smeared(0.3, 0.65, 0.1)));
        assert!(is_silent(&smeared(0.3, 0.67, 0.1)));
        // A prediction near 0 has its allowance in pixels.
        assert!(!is_silent(&smeared(0.05, 0.34, 0.1)) && is_silent(&smeared(0.05, 0.36, 0.1)));
    }

    #[test]
    fn smear_that_compensation_leaves_has_no_allowance_for_chance() {
        assert!(is_silent(&smeared(0.3, 0.65, 0.61)) && is_silent(&smeared(0.3, 0.65, -0.61)));
        assert!(!is_silent(&smeared(0.3, 0.65, 0.59)));
        let flagged = Verdict {
            is_flagged: true,
            ..smeared(0.3, 0.65, 0.61)
        };
        assert!(!is_silent(&flagged));
    }

    #[test]
    fn multiple_is_as_far_out_in_two_dimensions_as_5_sigma_in_one() {
        let beyond_5_sigma: f64 = 5.733e-7;
        let times = (beyond_5_sigma.ln() / 0.05_f64.ln()).sqrt();
        assert!((times - SILENT_SMEAR_TIMES).abs() < 0.005, "{times}");
    }
}
