//! Errors of one record, each with its σ.

use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::vh::VhSource;

use super::quantity::Quantity;
use super::truth::PhysicalTruth;

/// An error, with the σ that the record states for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedError {
    /// Stated less true value.
    pub error: f64,
    /// σ, in the unit of the error.
    pub sigma: f64,
}

impl StatedError {
    /// Returns error/σ; infinity if either is not a number. A σ of 0 covers an error of 0 alone.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        if self.error == 0.0 {
            return 0.0;
        }
        let ratio = self.error / self.sigma;
        if ratio.is_nan() { f64::INFINITY } else { ratio }
    }
}

/// The errors of an exposed frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// Number of the record.
    pub sequence: u32,
    /// Error of the centroid principal point along the FMC axis, mm.
    pub principal_point_mm: StatedError,
    /// Error of the principal point across the FMC axis, mm.
    pub across_mm: f64,
    /// Error of V/H, 1/s; `None` if the record has no V/H.
    pub vh_per_s: Option<StatedError>,
    /// Error of the centroid in UTC, s; `None` if the record has no UTC.
    pub utc_s: Option<StatedError>,
    /// Error of the centroid on the camera's clock, µs.
    pub centroid_us: f64,
    /// True smear, px.
    pub smear_px: f64,
    /// Part of it that compensation leaves along the FMC axis, px, signed.
    pub compensation_px: f64,
    /// Predicted smear, px.
    pub predicted_px: f64,
    /// `true` if the record has a fault, or a flag other than that of the attitude.
    pub is_flagged: bool,
    /// `true` if the frame was exposed without compensation.
    pub is_standing: bool,
    /// Source of the V/H.
    pub vh_source: Option<VhSource>,
}

impl Verdict {
    /// Compares a record with the truth; `None` if it states no exposure.
    #[must_use]
    pub fn of(record: &FrameRecord, truth: &PhysicalTruth) -> Option<Self> {
        let Outcome::Exposed(exposed) = &record.outcome else {
            return None;
        };
        let point = exposed.interior.principal_point;
        let [x_mm, y_mm] = truth.principal_point_mm;
        let (dx_mm, dy_mm) = (f64::from(point.x_mm) - x_mm, f64::from(point.y_mm) - y_mm);
        let [ex, ey] = truth.axis;
        let is_usual = |flag: Flag| flag == Flag::WithAttitude;
        Some(Self {
            sequence: record.sequence,
            principal_point_mm: StatedError {
                error: beyond_rounding(dx_mm * ex + dy_mm * ey, x_mm.abs().max(y_mm.abs())),
                sigma: f64::from(exposed.principal_point_sigma.total_mm()),
            },
            across_mm: dy_mm * ex - dx_mm * ey,
            vh_per_s: exposed.vh.map(|vh| StatedError {
                error: f64::from(vh.vh_per_s) - truth.vh_per_s,
                sigma: f64::from(vh.sigma_per_s),
            }),
            utc_s: utc_s(exposed, truth),
            centroid_us: whole_us(exposed.centroid.us()) - truth.centroid_us,
            smear_px: truth.smear_px,
            compensation_px: truth.compensation_px,
            predicted_px: f64::from(exposed.smear_px),
            is_flagged: !record.faults.is_empty()
                || record.flags.iter().any(|flag| !is_usual(flag)),
            is_standing: record.flags.contains(Flag::NoCompensation),
            vh_source: exposed.vh.map(|vh| vh.source),
        })
    }

    /// Returns the error of a quantity; `None` if the record does not state it.
    #[must_use]
    pub fn of_quantity(&self, quantity: Quantity) -> Option<StatedError> {
        match quantity {
            Quantity::PrincipalPoint => Some(self.principal_point_mm),
            Quantity::Vh => self.vh_per_s,
            Quantity::Utc => self.utc_s,
        }
    }
}

/// Returns an error, or 0 where it is not more than the rounding of a number of f32.
fn beyond_rounding(error: f64, value: f64) -> f64 {
    if error.abs() <= f64::from(f32::EPSILON) * value {
        0.0
    } else {
        error
    }
}

fn utc_s(exposed: &ExposedFrame, truth: &PhysicalTruth) -> Option<StatedError> {
    let stated = exposed.centroid_utc?;
    let true_ns = truth.centroid_unix_ns?;
    let stated_ns = i64::try_from(stated.unix_us.checked_mul(1000)?).ok()?;
    Some(StatedError {
        error: 1e-9 * nanoseconds(stated_ns.checked_sub(true_ns)?),
        sigma: f64::from(stated.sigma_s),
    })
}

#[expect(
    clippy::cast_precision_loss,
    reason = "a difference of up to 100 days is exact"
)]
fn nanoseconds(ns: i64) -> f64 {
    ns as f64
}

#[expect(
    clippy::cast_precision_loss,
    reason = "a flight is shorter than 2^53 µs"
)]
fn whole_us(us: u64) -> f64 {
    us as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_of_the_record_is_no_error() {
        let error = f64::from(0.1478_f32) - 0.1478;
        assert!(error != 0.0 && beyond_rounding(error, 0.1478).abs() < f64::MIN_POSITIVE);
        assert!((beyond_rounding(1e-6, 0.1478) - 1e-6).abs() < 1e-18);
    }

    #[test]
    fn sigma_of_zero_covers_no_error_but_none() {
        let of = |error, sigma| StatedError { error, sigma }.ratio();
        assert!(of(0.0, 0.0).abs() < f64::MIN_POSITIVE);
        assert!(of(1e-9, 0.0).is_infinite());
        assert!((of(-3.0, 2.0) + 1.5).abs() < 1e-12);
        assert!(of(f64::NAN, 1.0).is_infinite() && of(1.0, f64::NAN).is_infinite());
    }
}
