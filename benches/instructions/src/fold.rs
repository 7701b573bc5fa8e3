//! Most expensive conversion of an exposure into coefficients, searched for over cameras and over
//! all values of an exposure.

use core::hint::black_box;

use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::exposure::{CorrectionModel, FlightDirection, Limits};
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::five_coefficient::{FiveCoefficients, Regressor};
use fmc_camera::geometry::principal_distance::{Flatness, FocusSign};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::FmcAxis;
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::{Camera, CameraParameters, Exposure};

use crate::counter::Counter;
use crate::specimen::{flown, full, short, strong};

/// Repetitions of an exposure that may be the most expensive.
const FRAMES: u32 = 10;
const PER_FRAME: (u32, &str) = (FRAMES, "frame");
/// Largest deficit in the count of a single frame: the longest tick of the timer.
const TICK: u32 = 40;

/// Counts the most expensive frame of cameras with a stage, and that of cameras whose charge moves
/// in rows.
///
/// The cost of a frame depends on the ramp of the run-up (a root where the acceleration does not
/// reach its largest), the offset at opening, the model, the axis and the signs; with rows, mainly
/// on their number.
pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let stage = |run_up, jerk_mm_s3| Mechanism::Stage {
        acceleration_mm_s2: 1000.0,
        settling_ms: 5.0,
        run_up,
        jerk_mm_s3,
        max_speed_mm_s: None,
    };
    let stages = [
        stage(RunUp::Centred, None),
        stage(RunUp::Centred, Some(1e5)),
        stage(RunUp::FromRest, Some(1e5)),
    ];
    worst(counter, "frame_fold_worst", stages)?;
    // The earlier the first transfer, the more transfers there are.
    let rows = [Mechanism::Tdi {
        first_transfer: 0.0,
    }];
    worst(counter, "frame_fold_tdi_worst", rows)
}

/// Computes a number of frames of the same exposure; `None` if the camera refuses it.
#[inline(never)]
pub(crate) fn frames(camera: &Camera, exposure: &Exposure, repetitions: u32) -> Option<()> {
    for _ in 0..repetitions {
        black_box(black_box(camera).frame(black_box(exposure)).ok()?);
    }
    Some(())
}

fn worst<const N: usize>(
    counter: &mut Counter,
    kernel: &str,
    mechanisms: [Mechanism; N],
) -> Option<()> {
    let mut most = 0;
    for parameters in (0..).map_while(|number| camera(number, mechanisms)) {
        let camera = Camera::new(parameters).ok()?;
        for exposure in (0..).map_while(exposure) {
            let (once, taken) = counter.measure(|| frames(&camera, &exposure, 1))?;
            if taken.is_some() && (once + TICK) * FRAMES > most {
                let (counted, _) = counter.measure(|| frames(&camera, &exposure, FRAMES))?;
                most = most.max(counted);
            }
        }
    }
    Counter::print(kernel, PER_FRAME, most);
    Some(())
}

/// Digits of a number, each of which selects a value.
struct Choices(usize);

impl Choices {
    fn of<T: Copy, const N: usize>(&mut self, values: [T; N]) -> Option<T> {
        let value = values.get(self.0 % N).copied();
        self.0 /= N;
        value
    }

    /// Returns `chosen`, unless the number has more digits than there are choices.
    fn end<T>(self, chosen: T) -> Option<T> {
        (self.0 == 0).then_some(chosen)
    }
}

/// Returns one of the specimens, with a fitted model and the widest limits.
fn camera<const N: usize>(number: usize, mechanisms: [Mechanism; N]) -> Option<CameraParameters> {
    let mut choices = Choices(number);
    let mut parameters = choices.of([short(), full(), strong()])?;
    parameters.mechanism = choices.of(mechanisms)?;
    parameters.shutter = choices.of([ShutterProfile::Uniform, flown().shutter])?;
    parameters.limits = Limits {
        vh_per_s: Quantity::VhPerS.range().into(),
        exposure_s: Quantity::ExposureS.range().into(),
    };
    let lens = &mut parameters.calibration;
    let flat = [0.0; 5];
    let curved = [0.5, -1.0, 0.3, -0.2, 0.1];
    let (axis, coefficients_um, regressor) = choices.of([
        (FmcAxis::PlusX, flat, Regressor::Travel),
        (FmcAxis::MinusX, curved, Regressor::Centroid),
        (FmcAxis::PlusY, flat, Regressor::Centroid),
        (FmcAxis::MinusY, curved, Regressor::Travel),
    ])?;
    lens.axis = axis;
    lens.flatness = Flatness { coefficients_um };
    lens.fitted = Some(FiveCoefficients {
        km1: lens.distortion.k1,
        km2: lens.distortion.k2,
        kd1: 1e-7,
        pm1: -1e-7,
        regressor,
        ..FiveCoefficients::default()
    });
    choices.end(parameters)
}

/// Returns an exposure of any kind; no camera accepts some of them.
fn exposure(number: usize) -> Option<Exposure> {
    let mut choices = Choices(number);
    let focus = [(-400.0, FocusSign::Physical), (400.0, FocusSign::Printed)];
    let (focus_shift_um, focus_sign) = choices.of(focus)?;
    let exposure = Exposure {
        vh_per_s: choices.of([0.0, 1e-37, 0.05, 0.17, 1.0])?,
        // The longest exposure moves the charge by the largest number of rows, 1024, or the stage
        // by the stroke.
        exposure_s: choices.of([1e-6, 5e-3, 0.02, 0.4408])?,
        opening_offset_mm: choices.of([None, Some(-1.9), Some(1.9)])?,
        focus_shift_um,
        focus_sign,
        model: choices.of([
            CorrectionModel::Exact,
            CorrectionModel::Fitted,
            CorrectionModel::Static,
        ])?,
        direction: choices.of([FlightDirection::Forward, FlightDirection::Reverse])?,
    };
    choices.end(exposure)
}
