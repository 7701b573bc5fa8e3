//! Error budget of a camera: the largest effect of every source of error over the exposures that
//! the camera's limits allow, as `host-sim budget` has it, computed in the camera's precision.

use fmc::flight::camera::{Camera, CameraParameters, Frame};
use fmc::flight::exposure::Exposure;
use fmc::geometry::image_motion::ImageMotionError;
use fmc::geometry::principal_distance::Flatness;
use fmc_camera_c::{
    FMC_ERROR_NULL, FMC_ERROR_OUT_OF_RANGE, FMC_MECHANISM_TDI, FMC_OK, Refusal, fmc_camera_record,
    fmc_error, fmc_status,
};

use crate::distortion::missed;
use crate::exposures::over_the_limits;
use crate::smear::Smears;

/// Number of sources of error, in the order of `Source::ALL` of the crate `fmc-simulation`.
pub const SOURCES: usize = 15;

/// Part of a focus shift that is left when it is corrected as a pure enlargement, relative to the
/// shift (`FOCUS_REMAINDER` of the crate `fmc-simulation`).
const FOCUS_REMAINDER: f32 = 0.173 / 10.0;

/// Uncertainties that a camera file does not state.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assumptions {
    /// Focus shift that was not measured, µm.
    pub focus_um: f32,
    /// Error of V/H, per cent.
    pub vh_error_percent: f32,
    /// Height of the terrain above the plane that V/H holds for, per cent of the flying height.
    pub relief_percent: f32,
    /// Drift that the camera's mount does not turn out, degrees.
    pub drift_deg: f32,
    /// Rate of roll, of pitch and of yaw, degrees/s.
    pub rate_deg_s: f32,
    /// Step of the stage's encoder, µm.
    pub encoder_um: f32,
    /// Error of the time stamp, ms.
    pub timing_ms: f32,
}

/// Effects of all sources.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Budget {
    /// Largest effect of each source on the sensor, µm; negative for a source that a camera with
    /// this mechanism does not have.
    pub effects_um: [f32; SOURCES],
    /// Exposures that the camera accepts.
    pub accepted: u32,
    /// Exposures that it refuses.
    pub refused: u32,
}

/// Computes the budget of a camera.
///
/// # Units and frames
/// Lengths on the sensor, µm; the exposures are 10 V/H x 6 times, evenly spaced over the limits of
/// the record.
///
/// # Accuracy
/// Within 2 nm and 1e-4 of the effect of `host-sim budget`, which computes in double precision; the
/// effects of the distortion also within what the frames state as left out
/// (`budget_is_that_of_host_sim`).
///
/// # Errors
/// As `fmc_camera_init` for the record, as `fmc_frame_init` if the camera accepts none of the
/// exposures, and `FMC_ERROR_OUT_OF_RANGE` for an assumption.
#[unsafe(no_mangle)]
pub extern "C" fn fmc_web_budget(
    record: Option<&fmc_camera_record>,
    assumptions: Option<&Assumptions>,
    budget: Option<&mut Budget>,
    error: Option<&mut fmc_error>,
) -> fmc_status {
    let (Some(record), Some(assumptions), Some(budget)) = (record, assumptions, budget) else {
        return FMC_ERROR_NULL;
    };
    match computed(record, assumptions) {
        Ok(computed) => {
            *budget = computed;
            FMC_OK
        }
        Err(refusal) => {
            if let Some(error) = error {
                *error = refusal;
            }
            refusal.status
        }
    }
}

fn computed(record: &fmc_camera_record, assumed: &Assumptions) -> Result<Budget, fmc_error> {
    let parameters = record.parameters()?;
    let camera = Camera::new(parameters).map_err(Refusal::from)?;
    // Its distortion is that of the motion alone.
    let flat = Camera::new(without_run_out(&parameters)).map_err(Refusal::from)?;
    let mut largest = Effects::default();
    let mut budget = Budget::default();
    let mut refusal = None;
    let limits = parameters.limits;
    for (vh_per_s, exposure_s) in over_the_limits(limits.vh_per_s, limits.exposure_s) {
        let exposure = Exposure::new(vh_per_s, exposure_s);
        match camera.frame(&exposure).and_then(|frame| {
            let flat = flat.frame(&exposure)?;
            Ok((frame, flat))
        }) {
            Ok((frame, of_flat)) => {
                budget.accepted += 1;
                let smears = Smears::of(&camera, (vh_per_s, exposure_s), assumed);
                let smears = smears.map_err(refused)?;
                largest.grow(Effects::of(&camera, &frame, assumed));
                let missed = missed(&flat, &of_flat.correction);
                largest.grow(Effects {
                    static_distortion: missed.by_static,
                    second_order: missed.by_moved,
                    vh_error: smears.vh_error,
                    relief: smears.relief,
                    drift: smears.drift,
                    tilt_rate: smears.tilt_rate,
                    yaw_rate: smears.yaw_rate,
                    ..Effects::default()
                });
            }
            Err(error) => {
                budget.refused += 1;
                refusal = Some(error);
            }
        }
    }
    match refusal {
        Some(error) if budget.accepted == 0 => Err(Refusal::from(error).into()),
        _ => {
            budget.effects_um = largest.of_mechanism(record.mechanism == FMC_MECHANISM_TDI);
            Ok(budget)
        }
    }
}

fn without_run_out(parameters: &CameraParameters) -> CameraParameters {
    let mut flat = *parameters;
    flat.calibration.flatness = Flatness {
        coefficients_um: Default::default(),
    };
    flat
}

fn refused(error: ImageMotionError) -> fmc_error {
    match error {
        ImageMotionError::OutOfRange(error) => Refusal::from(error).into(),
        // The camera looks straight down, so that it does not see the horizon.
        ImageMotionError::Horizon(scale) => fmc_error {
            value: scale,
            ..fmc_error::of_status(FMC_ERROR_OUT_OF_RANGE)
        },
    }
}

/// Effects of an exposure, or the largest of several, mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Effects {
    opening_time: f32,
    calibrated_point: f32,
    static_distortion: f32,
    second_order: f32,
    run_out: f32,
    focus_shift: f32,
    focus_remainder: f32,
    encoder: f32,
    timing: f32,
    vh_error: f32,
    relief: f32,
    drift: f32,
    tilt_rate: f32,
    yaw_rate: f32,
    row_transfer: f32,
}

impl Effects {
    /// Returns the effects that frame and assumptions alone determine.
    fn of(camera: &Camera, frame: &Frame, assumed: &Assumptions) -> Self {
        let parameters = camera.calibration().parameters();
        let sensor = camera.calibration().sensor();
        let interior = &frame.interior;
        let motion = &interior.motion;
        let radius_mm = libm::hypotf(
            sensor.half_width_mm() + parameters.principal_point.x_mm.abs(),
            sensor.half_height_mm() + parameters.principal_point.y_mm.abs(),
        );
        let focus_mm = assumed.focus_um / 1000.0;
        let run_out_mm = interior.focus_shift_mm.abs();
        let speed_mm_s = parameters.principal_distance_mm * interior.vh_per_s;
        Self {
            // Of the smooth path, which the rows of a TDI sensor follow.
            opening_time: (motion.travel_mm * motion.centroid_time_s / interior.exposure_s).abs(),
            calibrated_point: motion.centroid_mm.abs(),
            run_out: run_out_mm / parameters.exit_pupil_mm * radius_mm,
            focus_shift: focus_mm / parameters.exit_pupil_mm * radius_mm,
            focus_remainder: (run_out_mm + focus_mm) * FOCUS_REMAINDER,
            encoder: assumed.encoder_um / 2000.0,
            timing: speed_mm_s * assumed.timing_ms / 1000.0,
            row_transfer: parameters.pixel_um / 1000.0,
            ..Self::default()
        }
    }

    /// Returns all of them in the order of the budget.
    const fn all(&mut self) -> [&mut f32; SOURCES] {
        [
            &mut self.opening_time,
            &mut self.calibrated_point,
            &mut self.static_distortion,
            &mut self.second_order,
            &mut self.run_out,
            &mut self.focus_shift,
            &mut self.focus_remainder,
            &mut self.encoder,
            &mut self.timing,
            &mut self.vh_error,
            &mut self.relief,
            &mut self.drift,
            &mut self.tilt_rate,
            &mut self.yaw_rate,
            &mut self.row_transfer,
        ]
    }

    /// Replaces each effect by that of another exposure, if it is larger there.
    fn grow(&mut self, mut other: Self) {
        for (largest, effect) in self.all().into_iter().zip(other.all()) {
            *largest = largest.max(*effect);
        }
    }

    /// Returns the effects, µm, of the sources that a camera with this mechanism has.
    fn of_mechanism(mut self, is_tdi: bool) -> [f32; SOURCES] {
        if is_tdi {
            (self.run_out, self.encoder) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
        } else {
            self.row_transfer = f32::NEG_INFINITY;
        }
        self.all().map(|effect_mm| *effect_mm * 1000.0)
    }
}
