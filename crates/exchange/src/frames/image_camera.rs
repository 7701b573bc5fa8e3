//! Camera of one image: an exposure of a flight, with the numbers that other programs have a place
//! for.

use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera_file::number::single;
use fmc_frames::Exposed;

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::pinhole::Pinhole;

/// Interior orientation and time of one exposure, as its record has them.
///
/// Lengths are in mm in the sensor frame. The numbers are those of the record, in single precision:
/// a flight of 1e6 exposures is held in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageCamera {
    /// Sequence number of the trigger.
    pub sequence: u32,
    /// Principal point at the centroid of the exposure, mm.
    pub principal_point_mm: [f32; 2],
    /// Standard deviation of the principal point along the FMC axis.
    pub sigma: PrincipalPointSigma,
    /// c̄: principal point - calibrated principal point, along the FMC axis, mm.
    pub centroid_offset_mm: f32,
    /// μ₂: variance of the offset during the exposure, mm².
    pub variance_mm2: f32,
    /// κ: relative enlargement of the image by the focus shift.
    pub enlargement: f32,
    /// Centroid of the exposure by the camera's clock, µs.
    pub centroid_us: u64,
    /// The same instant in UTC, if the camera knew it.
    pub centroid_utc: Option<UtcTime>,
}

impl ImageCamera {
    /// Returns the frame of an exposure; `exit_pupil_mm` is L of its camera.
    ///
    /// # Model
    /// κ is Δz/L whatever the model of the record is: the others leave it out of the correction,
    /// but the image is enlarged all the same.
    #[must_use]
    pub fn of(sequence: u32, exposed: &Exposed, exit_pupil_mm: f64) -> Self {
        let interior = &exposed.interior;
        Self {
            sequence,
            principal_point_mm: [interior.principal_point.x_mm, interior.principal_point.y_mm],
            sigma: exposed.sigma.unwrap_or_default(),
            centroid_offset_mm: interior.motion.centroid_mm,
            variance_mm2: interior.motion.moments.second,
            enlargement: single(f64::from(interior.focus_shift_mm) / exit_pupil_mm),
            centroid_us: exposed.centroid.map_or(0, Time::us),
            centroid_utc: exposed.centroid_utc,
        }
    }

    /// Returns the principal point in double precision, mm.
    #[must_use]
    pub fn principal_point(&self) -> [f64; 2] {
        self.principal_point_mm.map(f64::from)
    }

    /// Returns 1 + κ.
    #[must_use]
    pub fn scale(&self) -> f64 {
        1.0 + f64::from(self.enlargement)
    }

    /// Returns a camera that distorts rays, as it was during this exposure.
    ///
    /// # Model
    /// The lens and its distortion move together: the principal point is that of the frame, F is
    /// F(1 + κ), and coefficients of rays stay as they are. The terms of μ₂ are left out
    /// ([`left_out_mm`](Self::left_out_mm)).
    #[must_use]
    pub fn pinhole(&self, camera: &Calibrated, at_rest: &Pinhole) -> Pinhole {
        let scale = self.scale();
        Pinhole {
            focal_px: at_rest.focal_px.map(|focal| focal * scale),
            skew_px: at_rest.skew_px * scale,
            centre_px: camera.pixel_from_sensor(self.principal_point()),
            ..*at_rest
        }
    }

    /// Returns a camera that corrects measured points, as it was during this exposure.
    ///
    /// # Model
    /// As [`pinhole`](Self::pinhole). Coefficients of mm go with the enlarged image: those of r²ⁱ
    /// are divided by (1 + κ)²ⁱ, P1 and P2 by 1 + κ.
    #[must_use]
    pub fn correction(&self, at_rest: &Correction) -> Correction {
        let scale = self.scale();
        let [s2, s4, s6] = [2, 4, 6].map(|power| scale.powi(power));
        let [k0, k1, k2, k3] = at_rest.lens.k;
        let mut moved = Correction {
            principal_distance_mm: at_rest.principal_distance_mm * scale,
            principal_point_mm: self.principal_point(),
            ..*at_rest
        };
        moved.lens.k = [k0, k1 / s2, k2 / s4, k3 / s6];
        moved.lens.p = at_rest.lens.p.map(|p| p / scale);
        moved
    }

    /// Returns the largest effect of the terms of μ₂, which a camera per image has no place for,
    /// mm: `largest_bend` is the largest second derivative of the distortion along the FMC axis,
    /// 1/mm.
    #[must_use]
    pub fn left_out_mm(&self, largest_bend: f64) -> f64 {
        f64::from(self.variance_mm2) / 2.0 * largest_bend
    }
}
