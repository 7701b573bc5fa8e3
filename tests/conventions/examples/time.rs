//! Section 5: time, and its pairing with the principal point.

use super::{Example, Given, Results};
use crate::conventions::camera;
use fmc_camera::flight::camera::{Camera, Mechanism};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};

pub(super) const EXAMPLES: &[Example] = &[
    ("centroid of unequal ramps", unequal_ramps),
    (
        "centroid principal point with the time of opening",
        |given| ground_error(given, 0.0, |motion| (motion.centroid_mm, 0.0)),
    ),
    ("run-up not reported", run_up_not_reported),
    (
        "pair of opening, terrain above the compensated height",
        |given| {
            ground_error(given, given.number("relief", "m"), |motion| {
                (motion.opening_offset_mm, 0.0)
            })
        },
    ),
    (
        "pair of means, terrain above the compensated height",
        |given| {
            ground_error(given, given.number("relief", "m"), |motion| {
                (motion.centroid_mm, motion.centroid_time_s)
            })
        },
    ),
];

fn unequal_ramps(given: &Given) -> Results {
    let shutter = Shutter::new(ShutterProfile::Trapezoid {
        opening_fraction: given.number("r₁", ""),
        closing_fraction: given.number("r₂", ""),
    })
    .unwrap();
    let t: f32 = given.number("t", "s");
    vec![
        ("E[τ]", "s", (shutter.centroid() * t).into()),
        ("effective", "s", (shutter.effective_fraction() * t).into()),
    ]
}

/// Returns f in mm, V in m/s and the flying height in m.
fn flight(given: &Given) -> [f32; 3] {
    [("f", "mm"), ("V", "m/s"), ("height", "m")].map(|(symbol, unit)| given.number(symbol, unit))
}

/// Returns the ground error of a pair (offset, time) at a terrain `relief_m` above the height that
/// is compensated.
fn ground_error(
    given: &Given,
    relief_m: f64,
    pair: fn(&PrincipalPointMotion) -> (f32, f32),
) -> Results {
    let [f, v, height] = flight(given);
    let travel = UniformTravel {
        opening_offset_mm: 0.0,
        speed_mm_s: f * v / height,
        exposure_s: given.number("t", "s"),
    };
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let motion = PrincipalPointMotion::from_plan(travel, &shutter);
    let (offset_mm, time_s) = pair(&motion);
    // Mean image of a point below the aircraft at opening, and the point that follows from it with
    // the pair.
    let (ground_speed, scale) = (f64::from(v), (f64::from(height) - relief_m) / f64::from(f));
    let image =
        f64::from(motion.centroid_mm) - ground_speed * f64::from(motion.centroid_time_s) / scale;
    let ground = (image - f64::from(offset_mm)) * scale + ground_speed * f64::from(time_s);
    vec![("ground", "m", ground.abs())]
}

fn run_up_not_reported(given: &Given) -> Results {
    let [f, v, height] = flight(given);
    let mut record = camera::record();
    record.calibration.principal_distance_mm = f;
    record.mechanism = Mechanism::Stage {
        acceleration_mm_s2: given.number("a", "mm/s²"),
        settling_ms: 0.0,
        run_up: RunUp::FromRest,
        jerk_mm_s3: None,
        max_speed_mm_s: None,
    };
    let camera = Camera::new(record).unwrap();
    let plan = camera.plan(&Exposure::new(v / height, 0.01)).unwrap();
    vec![
        ("Δδ", "mm", plan.opening_mm.into()),
        ("ground", "m", (plan.opening_mm / f * height).into()),
    ]
}
