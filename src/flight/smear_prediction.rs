//! Residual smear of a frame, predicted from the camera's own data.

use super::event::AttitudeSample;
use super::exposure::FlightDirection;
use super::vh::VhEstimate;
use crate::geometry::calibration::Calibration;
use crate::geometry::image_motion::{Attitude, FlightState, GroundMotion, ImageMotion, View};
use crate::geometry::sensor::{FmcAxis, SensorPoint};

/// Number of standard deviations by which the uncertain part of the image motion enters the
/// prediction: 95 % of a normal error in two dimensions lie within √(2·ln 20) = 2.45 σ.
pub const COVERAGE: f32 = 2.45;

/// Points along each side of the grid on which the largest gradient of the lens distortion is
/// sought.
const GRID_POINTS: u8 = 9;

/// The properties of a calibrated camera on which smear depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmearPrediction {
    view: View,
    direction: FlightDirection,
    /// max |∂D/∂e| over the sensor.
    lens_gradient: f32,
    /// Squared distance of the projection centre from a corner of the sensor, as a multiple of the
    /// square of the principal distance: `1 + R²/f²`.
    corner: f32,
}

/// Compensation of one exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation {
    /// t: exposure, s.
    pub exposure_s: f32,
    /// δ: travel in the direction of flight, mm; 0: the stage stood still.
    pub travel_mm: f32,
    /// Departure of the stage from a straight line in time meanwhile, to both sides together, mm.
    /// The charge of a TDI sensor moves in whole rows: one row, or the travel if it is shorter than
    /// the first transfer takes.
    pub wander_mm: f32,
    /// σ of δ, mm.
    pub travel_sigma_mm: f32,
    /// Principal point at the centroid, mm.
    pub principal_point: SensorPoint,
}

/// Motion of the aircraft, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AircraftMotion {
    /// Attitude and rates; `None` if they are not reported.
    pub attitude: Option<AttitudeSample>,
    /// σ of pitch, roll and drift, °.
    pub attitude_sigma_deg: f32,
    /// σ of all three attitude rates together, °/s.
    pub rate_sigma_deg_s: f32,
    /// Squared standard deviation of V/H over the track, as a part of the square of V/H
    /// ([`VhMonitor::relative_variance`](super::vh::VhMonitor::relative_variance)).
    pub vh_relative_variance: f32,
}

/// Predicted smear of an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictedSmear {
    /// Largest smear on the sensor, µm.
    pub largest_um: f32,
    /// `true` if the attitude is in it.
    pub is_with_attitude: bool,
}

impl SmearPrediction {
    /// Returns the prediction for a camera that flies along its FMC axis, or against it.
    #[must_use]
    pub fn new(calibration: &Calibration, direction: FlightDirection) -> Self {
        let calibrated = View::calibrated(calibration);
        let view = View {
            axis: match (direction, calibrated.axis) {
                (FlightDirection::Forward, axis) => axis,
                (FlightDirection::Reverse, FmcAxis::PlusX) => FmcAxis::MinusX,
                (FlightDirection::Reverse, FmcAxis::MinusX) => FmcAxis::PlusX,
                (FlightDirection::Reverse, FmcAxis::PlusY) => FmcAxis::MinusY,
                (FlightDirection::Reverse, FmcAxis::MinusY) => FmcAxis::PlusY,
            },
            ..calibrated
        };
        let parameters = calibration.parameters();
        let (focal_mm, sensor) = (view.principal_distance_mm, &view.sensor);
        let radius = libm::hypotf(sensor.half_width_mm(), sensor.half_height_mm()) / focal_mm;
        let origin = parameters.principal_point;
        let (half_width, half_height) = (view.sensor.half_width_mm(), view.sensor.half_height_mm());
        let place = |index: u8| 2.0 * f32::from(index) / f32::from(GRID_POINTS - 1) - 1.0;
        let mut lens_gradient: f32 = 0.0;
        for row in 0..GRID_POINTS {
            for column in 0..GRID_POINTS {
                let jacobian = parameters.distortion.jacobian(
                    half_width * place(column) - origin.x_mm,
                    half_height * place(row) - origin.y_mm,
                );
                let gradient = if parameters.axis.is_x() {
                    libm::hypotf(jacobian.dx_by_x, jacobian.dy_by_x)
                } else {
                    libm::hypotf(jacobian.dx_by_y, jacobian.dy_by_y)
                };
                lens_gradient = lens_gradient.max(gradient);
            }
        }
        Self {
            view,
            direction,
            lens_gradient,
            corner: 1.0 + radius * radius,
        }
    }

    /// Returns the residual smear on the sensor that 95 % of the frames do not exceed.
    ///
    /// # Model
    /// The largest length of the residual image motion over a grid of the sensor
    /// ([`ImageMotion::largest_smear`]), with attitude, rates and drift if they are given; to that
    /// are added the departure of the stage or of the rows from its straight line,
    /// `|δ|·max|∂D/∂e|`, by which the lens distortion changes along the travel, and [`COVERAGE`]
    /// times
    ///
    /// ```text
    /// σ² = (f·t)²·(σ_η² + c·η²·(s² + α²) + c²·ω²) + σ_δ²      c = 1 + R²/f²
    /// ```
    ///
    /// with the spread s of V/H over the track for the relief elsewhere in the picture and the wind
    /// across the track, the uncertain angles α, the uncertain rates ω and the sensor's
    /// half-diagonal R. The terrain is taken as level at the height that V/H refers to.
    ///
    /// Attitudes for which no image motion can be given (see [`ImageMotion::new`]) count as not
    /// given.
    ///
    /// # Units and frames
    /// `travel_mm` is positive in the direction of flight; the attitude is about the camera's axes,
    /// the drift from the direction of flight.
    #[must_use]
    pub fn of(
        &self,
        vh: &VhEstimate,
        aircraft: &AircraftMotion,
        compensation: &Compensation,
    ) -> PredictedSmear {
        let focal_mm = self.view.principal_distance_mm;
        let Compensation {
            exposure_s,
            travel_mm,
            wander_mm,
            travel_sigma_mm,
            principal_point,
        } = *compensation;
        // Flown backwards, the camera's right and front are the flight's left and rear.
        let sign = self.direction.sign();
        let view = View {
            principal_point,
            ..self.view
        };
        let compensated = travel_mm / (focal_mm * exposure_s);
        let level = FlightState {
            motion: GroundMotion {
                vh_per_s: vh.vh_per_s,
                ..GroundMotion::default()
            },
            attitude: Attitude::default(),
            compensated_vh_per_s: compensated.max(0.0),
        };
        // A stage that has moved against the flight adds to the smear.
        let against_um = 1000.0 * (-travel_mm).max(0.0);
        let with_attitude = aircraft.attitude.map(|sample| {
            let [pitch_rate_deg_s, roll_rate_deg_s, yaw_rate_deg_s] = sample.rates_deg_s;
            FlightState {
                motion: GroundMotion {
                    drift_deg: sample.drift_deg,
                    ..level.motion
                },
                attitude: Attitude {
                    pitch_deg: sign * sample.pitch_deg,
                    roll_deg: sign * sample.roll_deg,
                    pitch_rate_deg_s: sign * pitch_rate_deg_s,
                    roll_rate_deg_s: sign * roll_rate_deg_s,
                    yaw_rate_deg_s,
                },
                ..level
            }
        });
        let with_attitude = with_attitude.and_then(|flight| ImageMotion::new(&view, &flight).ok());
        let is_with_attitude = with_attitude.is_some();
        let motion = with_attitude.or_else(|| ImageMotion::new(&view, &level).ok());
        let motion_um = match motion {
            Some(motion) => motion.largest_on_grid(exposure_s).1.length_um(),
            // If even a level camera has no image motion, V/H is out of its range: all of the
            // motion is left.
            None => 1000.0 * focal_mm * exposure_s * libm::fabsf(vh.vh_per_s - compensated),
        };
        let angle = aircraft.attitude_sigma_deg.to_radians();
        let rate_per_s = self.corner * aircraft.rate_sigma_deg_s.to_radians();
        let elsewhere = aircraft.vh_relative_variance + angle * angle;
        let variance_per_s2 = vh.sigma_per_s * vh.sigma_per_s
            + self.corner * elsewhere * vh.vh_per_s * vh.vh_per_s
            + rate_per_s * rate_per_s;
        let track_mm = focal_mm * exposure_s;
        let variance_mm2 =
            track_mm * track_mm * variance_per_s2 + travel_sigma_mm * travel_sigma_mm;
        let largest_um = motion_um
            + against_um
            + 1000.0 * COVERAGE * fmc_camera_kernel::sqrt(variance_mm2)
            + 1000.0 * wander_mm
            + 1000.0 * libm::fabsf(travel_mm) * self.lens_gradient;
        PredictedSmear {
            largest_um,
            is_with_attitude,
        }
    }

    /// Converts micrometres to pixels.
    #[must_use]
    pub fn pixels(&self, smear_um: f32) -> f32 {
        smear_um / (1000.0 * self.view.sensor.pixel_mm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::vh::VhSource;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::CalibrationParameters;

    const VH: VhEstimate = VhEstimate {
        vh_per_s: 0.1,
        sigma_per_s: 0.0,
        age_s: 0.0,
        source: VhSource::Direct,
        extrapolated: false,
    };

    fn prediction(k0: f32) -> SmearPrediction {
        let mut parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
        parameters.distortion = Brown {
            k0,
            ..Brown::default()
        };
        SmearPrediction::new(
            &Calibration::new(parameters).unwrap(),
            FlightDirection::Forward,
        )
    }

    const KNOWN: AircraftMotion = AircraftMotion {
        attitude: None,
        attitude_sigma_deg: 0.0,
        rate_sigma_deg_s: 0.0,
        vh_relative_variance: 0.0,
    };

    fn compensation(travel_mm: f32) -> Compensation {
        Compensation {
            exposure_s: 1.0 / 300.0,
            travel_mm,
            wander_mm: 0.0,
            travel_sigma_mm: 0.0,
            principal_point: SensorPoint::default(),
        }
    }

    /// δ = f·η·t (`docs/conventions.md`, section 4) for 100 mm, 0.10 1/s and 1/300 s: 33.3 µm.
    const DELTA_MM: f32 = 0.1 / 3.0;

    #[test]
    fn compensation_leaves_its_error_and_nothing_leaves_everything() {
        let level = prediction(0.0);
        let left = |travel_mm| level.of(&VH, &KNOWN, &compensation(travel_mm)).largest_um;
        assert!(left(DELTA_MM) < 1e-3);
        assert!((left(1.01 * DELTA_MM) - 0.3333).abs() < 1e-3);
        assert!((left(0.0) - 33.333).abs() < 1e-2);
        assert!((left(-DELTA_MM) - 66.667).abs() < 1e-2);
        assert!((level.pixels(8.75) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn sigma_lens_and_attitude_rate_add_what_the_model_says() {
        let uncertain = VhEstimate {
            sigma_per_s: 0.001,
            ..VH
        };
        let found = prediction(0.0)
            .of(&uncertain, &KNOWN, &compensation(DELTA_MM))
            .largest_um;
        let expected = 0.3333 * COVERAGE;
        assert!((found - expected).abs() < 1e-3, "1 % of 33.3 µm: {found}");
        // A scale error of 1e-3 over 33.3 µm.
        let lens = prediction(1e-3)
            .of(&VH, &KNOWN, &compensation(DELTA_MM))
            .largest_um;
        assert!((lens - 0.0333).abs() < 1e-3, "{lens}");
        let rate = AttitudeSample {
            pitch_deg: 0.0,
            roll_deg: 0.0,
            drift_deg: 0.0,
            rates_deg_s: [1.0, 0.0, 0.0],
        };
        let with = |sample| AircraftMotion {
            attitude: Some(sample),
            ..KNOWN
        };
        let found = prediction(0.0)
            .of(&VH, &with(rate), &compensation(DELTA_MM))
            .largest_um;
        assert!((found - 6.8).abs() < 0.1, "pitch rate 1 °/s: {found}");
        let absurd = AttitudeSample {
            pitch_deg: f32::NAN,
            ..rate
        };
        assert!(
            prediction(0.0)
                .of(&VH, &with(absurd), &compensation(DELTA_MM))
                .largest_um
                < 1e-3
        );
    }

    #[test]
    fn spread_angles_rates_and_travel_add_what_the_model_says() {
        let level = prediction(0.0);
        let found = |aircraft: AircraftMotion, travel_sigma_mm| {
            let compensation = Compensation {
                travel_sigma_mm,
                ..compensation(DELTA_MM)
            };
            level.of(&VH, &aircraft, &compensation).largest_um / COVERAGE
        };
        // R = 57.02 mm: c = 1 + R²/f² = 1.3251.
        let corner: f32 = 1.3251;
        let spread = found(
            AircraftMotion {
                vh_relative_variance: 1e-4,
                ..KNOWN
            },
            0.0,
        );
        assert!(
            (spread - 0.3333 * libm::sqrtf(corner)).abs() < 1e-3,
            "{spread}"
        );
        let angle = found(
            AircraftMotion {
                attitude_sigma_deg: 1.0,
                ..KNOWN
            },
            0.0,
        );
        assert!(
            (angle - 0.5818 * libm::sqrtf(corner)).abs() < 1e-3,
            "{angle}"
        );
        // 100 mm over 1/300 s at 0.1 °/s: 0.5818 µm.
        let rate = found(
            AircraftMotion {
                rate_sigma_deg_s: 0.1,
                ..KNOWN
            },
            0.0,
        );
        assert!((rate - 0.5818 * corner).abs() < 1e-3, "{rate}");
        let travel = found(KNOWN, 0.0005);
        assert!((travel - 0.5).abs() < 1e-3, "{travel}");
    }

    #[test]
    fn distortion_counts_along_the_axis_and_a_flight_against_it_is_that_of_the_opposite_axis() {
        let prediction = |axis, direction| {
            let mut parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
            // More along x than along y.
            parameters.distortion = Brown {
                k0: 1e-3,
                p1: 1e-5,
                ..Brown::default()
            };
            parameters.axis = axis;
            SmearPrediction::new(&Calibration::new(parameters).unwrap(), direction)
        };
        for (axis, opposite) in [
            (FmcAxis::PlusX, FmcAxis::MinusX),
            (FmcAxis::MinusX, FmcAxis::PlusX),
            (FmcAxis::PlusY, FmcAxis::MinusY),
            (FmcAxis::MinusY, FmcAxis::PlusY),
        ] {
            let reverse = prediction(axis, FlightDirection::Reverse);
            let forward = prediction(opposite, FlightDirection::Forward);
            assert_eq!(reverse.view.axis, opposite);
            assert_eq!(prediction(axis, FlightDirection::Forward).view.axis, axis);
            let travel = compensation(DELTA_MM);
            let of = |it: &SmearPrediction| it.of(&VH, &KNOWN, &travel).largest_um;
            assert_eq!(of(&reverse).to_bits(), of(&forward).to_bits());
        }
        // 2·p1·y across and 6·p1·x along, at the corner of 40.32 mm.
        let gradient = |axis| prediction(axis, FlightDirection::Forward).lens_gradient;
        let (along, across) = (gradient(FmcAxis::PlusX), gradient(FmcAxis::PlusY));
        assert!(along > across + 1e-4, "{along}, {across}");
    }

    #[test]
    fn without_image_motion_all_of_the_motion_is_left() {
        let beyond = VhEstimate {
            vh_per_s: 1e6,
            ..VH
        };
        let found = prediction(0.0).of(&beyond, &KNOWN, &compensation(DELTA_MM));
        // 100 mm over 1/300 s at 10⁶ 1/s, less 33 µm.
        assert!((found.largest_um / 3.333_333e8 - 1.0).abs() < 1e-5);
        assert!(!found.is_with_attitude);
    }
}
