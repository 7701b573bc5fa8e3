//! Section 4: motion of the principal point.

use super::{Example, Given, Results};
use crate::conventions::camera;
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::{Exposure, FlightDirection};
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
use fmc_camera::geometry::tdi::mean_transfers;

pub(super) const EXAMPLES: &[Example] = &[
    ("travel while open", travel),
    ("centred", |given| planned(given, RunUp::Centred)),
    ("from rest", |given| planned(given, RunUp::FromRest)),
    ("from rest, with limited jerk", |given| {
        planned(given, RunUp::FromRest)
    }),
    ("centred, against the axis", reverse),
    (
        "TDI, whole rows, first transfer after a row period",
        tdi_lag,
    ),
    (
        "TDI, whole rows, first transfer after half a period",
        tdi_lag,
    ),
    (
        "TDI, a row and a half, first transfer after a row period",
        tdi_lag,
    ),
    (
        "TDI, a row and a half, first transfer after half a period",
        tdi_lag,
    ),
];

fn travel(given: &Given) -> Results {
    let mut record = camera::record();
    record.calibration.principal_distance_mm = given.number("f", "mm");
    let exposure = given.exposure();
    let motion = Camera::new(record).unwrap().motion(&exposure).unwrap();
    let travel_mm = f64::from(motion.travel_mm);
    vec![
        ("v", "mm/s", travel_mm / f64::from(exposure.exposure_s)),
        ("δ", "mm", travel_mm),
    ]
}

fn planned(given: &Given, run_up: RunUp) -> Results {
    let camera = Camera::new(given.stage_camera(run_up)).unwrap();
    let motion = camera.motion(&given.exposure()).unwrap();
    vec![
        ("Δδ", "mm", motion.opening_offset_mm.into()),
        ("c̄", "mm", motion.centroid_mm.into()),
    ]
}

fn reverse(given: &Given) -> Results {
    let camera = Camera::new(given.stage_camera(RunUp::Centred)).unwrap();
    let exposure = Exposure {
        direction: FlightDirection::Reverse,
        ..given.exposure()
    };
    let motion = camera.motion(&exposure).unwrap();
    vec![
        ("δ", "mm", motion.travel_mm.into()),
        ("Δδ", "mm", motion.opening_offset_mm.into()),
    ]
}

fn tdi_lag(given: &Given) -> Results {
    let rows: f32 = given.number("rows", "");
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let mean = mean_transfers(rows, given.number("φ", ""), &shutter).unwrap();
    vec![("lag", "px", f64::from(rows / 2.0 - mean))]
}
