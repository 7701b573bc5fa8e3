//! Section 8: image motion and residual smear.

use super::{Example, Given, Results};
use fmc_camera::geometry::image_motion::{
    Attitude, FlightState, GroundMotion, ImageMotion, LargestSmear, View,
};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};

pub(super) const EXAMPLES: &[Example] = &[
    ("image velocity", velocity),
    ("V/H error", |given| {
        let error: f32 = given.number("error", "%");
        largest(given, |flight| {
            flight.compensated_vh_per_s *= 1.0 + error / 100.0;
        })
    }),
    ("relief", |given| {
        let relief: f32 = given.number("h/H", "%");
        largest(given, |flight| flight.motion.relief_percent = relief)
    }),
    ("pitch", |given| {
        let pitch: f32 = given.number("θ", "°");
        largest(given, |flight| flight.attitude.pitch_deg = pitch)
    }),
    ("roll", |given| {
        let roll: f32 = given.number("φ", "°");
        largest(given, |flight| flight.attitude.roll_deg = roll)
    }),
    ("drift", |given| {
        let drift: f32 = given.number("χ", "°");
        largest(given, |flight| flight.motion.drift_deg = drift)
    }),
    ("pitch rate", |given| {
        let rate: f32 = given.number("ω₁", "°/s");
        largest(given, |flight| flight.attitude.pitch_rate_deg_s = rate)
    }),
    ("roll rate", |given| {
        let rate: f32 = given.number("ω₂", "°/s");
        largest(given, |flight| flight.attitude.roll_rate_deg_s = rate)
    }),
    ("yaw rate", |given| {
        let rate: f32 = given.number("ω₃", "°/s");
        largest(given, |flight| flight.attitude.yaw_rate_deg_s = rate)
    }),
];

fn view(given: &Given) -> View {
    View {
        sensor: given.sensor(),
        principal_distance_mm: given.number("f", "mm"),
        principal_point: SensorPoint::default(),
        axis: FmcAxis::PlusY,
    }
}

fn flight(given: &Given) -> FlightState {
    let vh_per_s = given.number("V/H", "1/s");
    FlightState {
        motion: GroundMotion {
            vh_per_s,
            ..GroundMotion::default()
        },
        attitude: Attitude::default(),
        compensated_vh_per_s: vh_per_s,
    }
}

fn velocity(given: &Given) -> Results {
    let mut flight = flight(given);
    flight.attitude.pitch_deg = given.number("θ", "°");
    let motion = ImageMotion::new(&view(given), &flight).unwrap();
    let point = given.point("x", "y");
    let (free, residual) = (motion.velocity(point), motion.residual_velocity(point));
    vec![
        ("ẋ", "mm/s", free.x_mm_s.into()),
        ("ẏ", "mm/s", free.y_mm_s.into()),
        ("residual ẏ", "mm/s", residual.y_mm_s.into()),
    ]
}

/// Returns the largest smear and its distance from the centre.
fn largest(given: &Given, change: impl Fn(&mut FlightState)) -> Results {
    let mut flight = flight(given);
    change(&mut flight);
    let motion = ImageMotion::new(&view(given), &flight).unwrap();
    let LargestSmear { smear, .. } = motion.largest_smear(given.number("t", "s"));
    vec![("smear", "µm", smear.length_um().into())]
}
