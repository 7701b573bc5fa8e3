//! Image motion while the shutter is open, and the residual smear that the compensation leaves.

mod flight_state;
mod view;

use core::f32::consts::PI;
use core::fmt;

pub use self::flight_state::{Attitude, FlightState, GroundMotion};
pub use self::view::View;
use super::planar_flow::{GroundScale, Quadratic};
use super::range::{OutOfRange, Quantity};
use super::sensor::SensorPoint;

/// Smallest scale of the ground's image, as a fraction of its scale below the camera, at which a
/// corner of the sensor counts as seeing ground; 0 is the horizon.
pub const LEAST_GROUND_SCALE: f32 = 0.1;

/// Points along each side of the grid on which the largest smear is sought.
const GRID_POINTS: u8 = 9;

/// Ratio of squared lengths below which the first is certainly shorter: rounding can hide the order
/// of lengths that are closer.
const CLEARLY_SHORTER: f32 = 1.0 - 1e-5;

/// Velocity of an image point in the sensor frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ImageVelocity {
    /// To the right, mm/s.
    pub x_mm_s: f32,
    /// Upwards, mm/s.
    pub y_mm_s: f32,
}

/// Path of an image point over the detector while the shutter is open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Smear {
    /// To the right, µm.
    pub x_um: f32,
    /// Upwards, µm.
    pub y_um: f32,
}

impl Smear {
    /// Its length, µm.
    #[must_use]
    pub fn length_um(&self) -> f32 {
        libm::hypotf(self.x_um, self.y_um)
    }
}

/// The largest smear found on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestSmear {
    /// Place of the largest smear.
    pub point: SensorPoint,
    /// The smear there.
    pub smear: Smear,
    /// Bound that no point of the sensor exceeds, µm.
    pub bound_um: f32,
}

/// The image motion of some part of the sensor cannot be given.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ImageMotionError {
    /// A quantity is outside its range.
    OutOfRange(OutOfRange),
    /// A corner of the sensor sees the horizon or almost does: the scale of the ground's image
    /// there, as a fraction of its scale below the camera, is under [`LEAST_GROUND_SCALE`].
    Horizon(f32),
}

impl fmt::Display for ImageMotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Horizon(scale) => write!(
                f,
                "a corner of the sensor sees the horizon or nearly: scale of the ground {scale:.3} there, {LEAST_GROUND_SCALE} at least"
            ),
        }
    }
}

impl core::error::Error for ImageMotionError {}

impl From<OutOfRange> for ImageMotionError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

/// The velocity of every image point, in the lens frame and on the compensating detector.
///
/// # Model
/// Camera axes are right, forward (the FMC axis e) and up; the optical axis points down, the image
/// is the upright positive. A terrain point P moves by `Ṗ = -T - ω × P`, its image `x = -f·Px/Pz`,
/// `y = -f·Py/Pz` by
///
/// ```text
/// ẋ = -η'·s·(f·t₁ + x·t₃) + f·ω₂(1 + x²/f²) - ω₁·xy/f + ω₃·y
/// ẏ = -η'·s·(f·t₂ + y·t₃) - f·ω₁(1 + y²/f²) + ω₂·xy/f - ω₃·x
/// s = cosθ·cosφ + (x/f)·cosθ·sinφ - (y/f)·sinθ          η' = η/(1 - h/H)
/// t = (cosφ·sinχ + sinφ·cosχ·sinθ, cosχ·cosθ, sinφ·sinχ - cosφ·cosχ·sinθ)
/// ```
///
/// with x, y from the principal point. The detector moves by `f·η_c` against e; on it an image
/// point moves by `(ẋ, ẏ) + f·η_c·e`, the *residual*. The attitude is applied to a level camera in
/// the order heading, pitch, roll. Terrain is a horizontal plane at the relief's height, and the
/// lens counts as free of distortion: a lens whose distortion has the gradient J along e adds δ·J
/// to the smear, whatever the compensation.
///
/// # Units and frames
/// Points and velocities in the sensor frame, mm and mm/s; smear in µm.
///
/// # Accuracy
/// The rounding error of a residual velocity is at most [`ROUNDING_MM_S`] for f·η up to 20 mm/s
/// (`velocity_agrees_with_the_differentiated_path` in `host-sim/tests/scene`).
///
/// # Examples
/// ```
/// use fmc_camera::geometry::image_motion::{FlightState, GroundMotion, ImageMotion, View};
/// use fmc_camera::geometry::sensor::{FmcAxis, Sensor, SensorPoint};
/// let view = View {
///     sensor: Sensor::new(9216, 9216, 8.75)?,
///     principal_distance_mm: 100.0,
///     principal_point: SensorPoint::default(),
///     axis: FmcAxis::PlusY,
/// };
/// // V/H 0.10 1/s, compensated for 0.101: 1 % of f·V/H = 10 mm/s is left, 0.1 mm/s along +y.
/// let flight = FlightState {
///     motion: GroundMotion { vh_per_s: 0.1, ..GroundMotion::default() },
///     compensated_vh_per_s: 0.101,
///     ..FlightState::default()
/// };
/// let motion = ImageMotion::new(&view, &flight)?;
/// let centre = SensorPoint::default();
/// assert!((motion.velocity(centre).y_mm_s + 10.0).abs() < 1e-5);
/// assert!((motion.residual_velocity(centre).y_mm_s - 0.1).abs() < 1e-5);
/// assert!((motion.smear(centre, 1.0 / 300.0).y_um - 0.3333).abs() < 1e-4);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageMotion {
    view: View,
    right: Quadratic,
    forward: Quadratic,
    compensation_mm_s: f32,
}

/// Largest rounding error of a residual velocity, mm/s, for f·η up to 20 mm/s; over 1/100 s it
/// amounts to 0.1 nm.
pub const ROUNDING_MM_S: f32 = 1e-5;

impl ImageMotion {
    /// Returns the image motion of a camera in a flight state.
    ///
    /// # Errors
    /// [`ImageMotionError`] for a quantity outside [`Quantity::range`], and if a corner of the
    /// sensor does not see the ground.
    pub fn new(view: &View, flight: &FlightState) -> Result<Self, ImageMotionError> {
        let focal = Quantity::PrincipalDistanceMm.check(view.principal_distance_mm)?;
        Quantity::PrincipalPointX.check(view.principal_point.x_mm)?;
        Quantity::PrincipalPointY.check(view.principal_point.y_mm)?;
        let vh = Quantity::VhPerS.check(flight.motion.vh_per_s)?;
        let relief = Quantity::ReliefPercent.check(flight.motion.relief_percent)? / 100.0;
        let drift = radians(Quantity::DriftDeg.check(flight.motion.drift_deg)?);
        let attitude = &flight.attitude;
        let pitch = radians(Quantity::PitchDeg.check(attitude.pitch_deg)?);
        let roll = radians(Quantity::RollDeg.check(attitude.roll_deg)?);
        let about_right = radians(Quantity::PitchRateDegS.check(attitude.pitch_rate_deg_s)?);
        let about_forward = radians(Quantity::RollRateDegS.check(attitude.roll_rate_deg_s)?);
        let about_up = radians(Quantity::YawRateDegS.check(attitude.yaw_rate_deg_s)?);
        let compensated = Quantity::VhPerS.check(flight.compensated_vh_per_s)?;

        let (sin_pitch, cos_pitch) = libm::sincosf(pitch);
        let (sin_roll, cos_roll) = libm::sincosf(roll);
        let (sin_drift, cos_drift) = libm::sincosf(drift);
        let scale = GroundScale {
            centre: cos_pitch * cos_roll,
            along_right: cos_pitch * sin_roll / focal,
            along_forward: -sin_pitch / focal,
        };
        let least = scale.least_in(&view.extent());
        if least.is_nan() || least < LEAST_GROUND_SCALE {
            return Err(ImageMotionError::Horizon(least));
        }
        // Velocity over the ground along camera axes, in heights above the terrain per second.
        let vh = vh / (1.0 - relief);
        let to_right = vh * (cos_roll * sin_drift + sin_roll * cos_drift * sin_pitch);
        let to_front = vh * cos_drift * cos_pitch;
        let upwards = vh * (sin_roll * sin_drift - cos_roll * cos_drift * sin_pitch);

        let right = Quadratic {
            constant: focal * about_forward - focal * to_right * scale.centre,
            x: -(focal * to_right * scale.along_right + upwards * scale.centre),
            y: about_up - focal * to_right * scale.along_forward,
            xx: about_forward / focal - upwards * scale.along_right,
            xy: -about_right / focal - upwards * scale.along_forward,
            yy: 0.0,
        };
        let forward = Quadratic {
            constant: -focal * about_right - focal * to_front * scale.centre,
            x: -about_up - focal * to_front * scale.along_right,
            y: -(focal * to_front * scale.along_forward + upwards * scale.centre),
            xx: 0.0,
            xy: about_forward / focal - upwards * scale.along_right,
            yy: -about_right / focal - upwards * scale.along_forward,
        };
        Ok(Self {
            view: *view,
            right,
            forward,
            compensation_mm_s: focal * compensated,
        })
    }

    /// Returns the image's velocity in the lens frame, in which the principal point rests.
    ///
    /// # Units and frames
    /// The point is in mm of the sensor frame at the exposure's centroid and lies on the sensor;
    /// elsewhere the result is finite and has no meaning.
    #[must_use]
    pub fn velocity(&self, point: SensorPoint) -> ImageVelocity {
        self.velocity_beside(point, 0.0)
    }

    /// Returns the image's velocity on the detector, which the compensation leaves.
    ///
    /// # Units and frames
    /// As [`Self::velocity`].
    #[must_use]
    pub fn residual_velocity(&self, point: SensorPoint) -> ImageVelocity {
        self.velocity_beside(point, self.compensation_mm_s)
    }

    /// Returns the path of a point's image over the detector during an exposure.
    ///
    /// # Model
    /// Residual velocity at the centroid times `exposure_s`. The velocity's change over the
    /// exposure bends the path and, to second order, does not move its ends.
    ///
    /// # Units and frames
    /// As [`Self::velocity`]; `exposure_s` in s is the shutter's base, first light to last.
    #[must_use]
    pub fn smear(&self, point: SensorPoint, exposure_s: f32) -> Smear {
        let velocity = self.residual_velocity(point);
        let um = 1000.0 * exposure_s;
        Smear {
            x_um: velocity.x_mm_s * um,
            y_um: velocity.y_mm_s * um,
        }
    }

    /// Returns the largest smear on a grid of 9 x 9 points with corners and edges, and a bound that
    /// no point of the sensor exceeds.
    ///
    /// # Model
    /// Both components are quadratic in x and y. The bound is the longest of their nine Bernstein
    /// control points over the sensor, because the velocity is a mean of them with weights that are
    /// not negative. Where the largest smear lies in a corner and the field grows towards it, the
    /// bound is reached; with opposing terms it is larger.
    #[must_use]
    pub fn largest_smear(&self, exposure_s: f32) -> LargestSmear {
        let (point, smear) = self.largest_on_grid(exposure_s);
        LargestSmear {
            point,
            smear,
            bound_um: self.fastest_mm_s() * exposure_s * 1000.0,
        }
    }

    /// Returns the part of [`Self::largest_smear`] on the grid.
    pub(crate) fn largest_on_grid(&self, exposure_s: f32) -> (SensorPoint, Smear) {
        let sensor = &self.view.sensor;
        let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
        let place = |index: u8| 2.0 * f32::from(index) / f32::from(GRID_POINTS - 1) - 1.0;
        let square = |smear: Smear| smear.x_um * smear.x_um + smear.y_um * smear.y_um;
        let mut point = SensorPoint::default();
        let mut smear = self.smear(point, exposure_s);
        let mut length_um = smear.length_um();
        for row in 0..GRID_POINTS {
            for column in 0..GRID_POINTS {
                let at = SensorPoint::new(half_width * place(column), half_height * place(row));
                let found = self.smear(at, exposure_s);
                // This smear is shorter by more than the squares can err, so that its length, the
                // costly part, is not computed.
                if square(found) < CLEARLY_SHORTER * square(smear) {
                    continue;
                }
                let found_um = found.length_um();
                if found_um > length_um {
                    (point, smear, length_um) = (at, found, found_um);
                }
            }
        }
        (point, smear)
    }

    /// Returns the longest control point of the residual velocity over the sensor, mm/s.
    fn fastest_mm_s(&self) -> f32 {
        let extent = self.view.extent();
        let ends = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let mut fastest = 0.0_f32;
        for across in ends {
            for along in ends {
                let right = self.right.control_point(&extent, across, along);
                let forward = self.forward.control_point(&extent, across, along);
                let length = libm::hypotf(right, forward + self.compensation_mm_s);
                fastest = fastest.max(length);
            }
        }
        fastest
    }

    fn velocity_beside(&self, point: SensorPoint, detector_mm_s: f32) -> ImageVelocity {
        let at = self.view.flight_from_sensor(point);
        let right = self.right.at(at);
        let forward = self.forward.at(at) + detector_mm_s;
        let sign = self.view.axis.sign();
        if self.view.axis.is_x() {
            ImageVelocity {
                x_mm_s: sign * forward,
                y_mm_s: -sign * right,
            }
        } else {
            ImageVelocity {
                x_mm_s: sign * right,
                y_mm_s: sign * forward,
            }
        }
    }
}

fn radians(degrees: f32) -> f32 {
    degrees * (PI / 180.0)
}

#[cfg(test)]
mod tests;
