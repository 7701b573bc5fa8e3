use super::*;
use crate::geometry::sensor::{FmcAxis, Sensor};
use proptest::prelude::*;

/// Returns the view of a camera of f = 100 mm, 80.64 mm square.
fn view(axis: FmcAxis) -> View {
    View {
        sensor: Sensor::new(9216, 9216, 8.75).unwrap(),
        principal_distance_mm: 100.0,
        principal_point: SensorPoint::default(),
        axis,
    }
}

/// Returns a flight at V/H 0.1, compensated for 0.1.
fn compensated() -> FlightState {
    FlightState {
        motion: GroundMotion {
            vh_per_s: 0.1,
            ..GroundMotion::default()
        },
        attitude: Attitude::default(),
        compensated_vh_per_s: 0.1,
    }
}

fn with(change: impl Fn(&mut FlightState)) -> ImageMotion {
    let mut flight = compensated();
    change(&mut flight);
    ImageMotion::new(&view(FmcAxis::PlusY), &flight).unwrap()
}

const EXPOSURE_S: f32 = 1.0 / 300.0;

/// Compares each residual alone, the largest length over the sensor, with the formulas worked by
/// hand: all lie in corners, (±40.32, ±40.32) mm, δ = 33.33 µm.
#[test]
fn residuals_of_a_square_camera_are_those_worked_by_hand() {
    let cases: [(&str, f32, ImageMotion); 8] = [
        // 1 % of δ.
        (
            "V/H error 1 %",
            0.3333,
            with(|f| f.compensated_vh_per_s = 0.101),
        ),
        // δ(1/0.9 - 1).
        (
            "relief 10 %",
            3.7037,
            with(|f| f.motion.relief_percent = 10.0),
        ),
        // y = +40.32: (δ(1 - 0.99281²), x·η·t·sinθ·0.99281) = (0.4776, 0.2329) µm.
        ("pitch 1°", 0.5313, with(|f| f.attitude.pitch_deg = 1.0)),
        // x = -40.32: δ(1 - 0.99281).
        ("roll 1°", 0.2396, with(|f| f.attitude.roll_deg = 1.0)),
        // 2δ·sin 2.5°.
        ("drift 5°", 2.9080, with(|f| f.motion.drift_deg = 5.0)),
        // 5.8178 µm·(1.16257, 0.16257).
        (
            "pitch rate 1°/s",
            6.8294,
            with(|f| f.attitude.pitch_rate_deg_s = 1.0),
        ),
        (
            "roll rate 1°/s",
            6.8294,
            with(|f| f.attitude.roll_rate_deg_s = 1.0),
        ),
        // 57.02 mm·0.017453/300.
        (
            "yaw rate 1°/s",
            3.3174,
            with(|f| f.attitude.yaw_rate_deg_s = 1.0),
        ),
    ];
    for (name, expected_um, motion) in cases {
        let largest = motion.largest_smear(EXPOSURE_S);
        let found_um = largest.smear.length_um();
        assert!((found_um - expected_um).abs() < 2e-4, "{name}: {found_um}");
        assert!(largest.bound_um >= found_um - 1e-4, "{name}");
    }
}

#[test]
fn largest_on_the_grid_is_that_of_all_lengths() {
    for (pitch_deg, roll_rate_deg_s, vh_per_s) in [
        (0.0, 0.0, 0.1),
        (0.0, 0.0, 0.101),
        (1.0, 0.0, 0.1),
        (-2.0, 1.5, 0.12),
        (0.3, -4.0, 0.05),
    ] {
        let motion = with(|f| {
            f.attitude.pitch_deg = pitch_deg;
            f.attitude.roll_rate_deg_s = roll_rate_deg_s;
            f.compensated_vh_per_s = vh_per_s;
        });
        let half_mm = motion.view.sensor.half_width_mm();
        let place = |index: u8| half_mm * (2.0 * f32::from(index) / 8.0 - 1.0);
        let middle = motion.smear(SensorPoint::default(), EXPOSURE_S).length_um();
        let longest = (0..81_u8)
            .map(|index| SensorPoint::new(place(index % 9), place(index / 9)))
            .map(|point| motion.smear(point, EXPOSURE_S).length_um())
            .fold(middle, f32::max);
        let found = motion.largest_smear(EXPOSURE_S).smear.length_um();
        assert_eq!(found.to_bits(), longest.to_bits(), "{found} {longest}");
    }
}

#[test]
fn signs_of_attitude_are_those_of_the_documents() {
    let at = |x_mm, y_mm| SensorPoint::new(x_mm, y_mm);
    // Tilted forward, the ground ahead is farther away and its image slower.
    let pitch = with(|f| f.attitude.pitch_deg = 2.0);
    assert!(pitch.velocity(at(0.0, 40.0)).y_mm_s > -10.0);
    assert!(pitch.velocity(at(0.0, -40.0)).y_mm_s < -10.0);
    // Rolled towards -x, the ground there is farther away and its image slower.
    let roll = with(|f| f.attitude.roll_deg = 2.0);
    assert!(roll.velocity(at(-40.0, 0.0)).y_mm_s > -10.0);
    assert!(roll.velocity(at(40.0, 0.0)).y_mm_s < -10.0);
    // The track leads to the right: the image moves to the left.
    let drift = with(|f| f.motion.drift_deg = 2.0);
    assert!(drift.velocity(at(0.0, 0.0)).x_mm_s < 0.0);
    // Nose up: the ground moves backwards. Right side down: to the right. Nose to the left:
    // the image turns clockwise.
    let pitching = with(|f| f.attitude.pitch_rate_deg_s = 1.0);
    assert!(pitching.residual_velocity(at(0.0, 0.0)).y_mm_s < 0.0);
    let rolling = with(|f| f.attitude.roll_rate_deg_s = 1.0);
    assert!(rolling.residual_velocity(at(0.0, 0.0)).x_mm_s > 0.0);
    let yawing = with(|f| f.attitude.yaw_rate_deg_s = 1.0);
    assert!(yawing.residual_velocity(at(0.0, 40.0)).x_mm_s > 0.0);
}

#[test]
fn image_moves_against_every_axis() {
    for axis in FmcAxis::ALL {
        let motion = ImageMotion::new(&view(axis), &compensated()).unwrap();
        let velocity = motion.velocity(SensorPoint::new(11.0, -7.0));
        let e = axis.sensor_from_offset(SensorPoint::default(), 1.0);
        assert!((velocity.x_mm_s + 10.0 * e.x_mm).abs() < 1e-5);
        assert!((velocity.y_mm_s + 10.0 * e.y_mm).abs() < 1e-5);
    }
}

#[test]
fn what_is_not_believable_is_refused() {
    let refused = |change: fn(&mut FlightState)| {
        let mut flight = compensated();
        change(&mut flight);
        match ImageMotion::new(&view(FmcAxis::PlusY), &flight) {
            Err(ImageMotionError::OutOfRange(error)) => error.quantity,
            other => panic!("not refused: {other:?}"),
        }
    };
    assert_eq!(refused(|f| f.motion.vh_per_s = -0.1), Quantity::VhPerS);
    assert_eq!(
        refused(|f| f.motion.relief_percent = 100.0),
        Quantity::ReliefPercent
    );
    assert_eq!(refused(|f| f.motion.drift_deg = 46.0), Quantity::DriftDeg);
    assert_eq!(
        refused(|f| f.attitude.pitch_deg = f32::NAN),
        Quantity::PitchDeg
    );
    assert_eq!(refused(|f| f.attitude.roll_deg = -46.0), Quantity::RollDeg);
    assert_eq!(
        refused(|f| f.attitude.pitch_rate_deg_s = 61.0),
        Quantity::PitchRateDegS
    );
    assert_eq!(
        refused(|f| f.attitude.roll_rate_deg_s = 61.0),
        Quantity::RollRateDegS
    );
    assert_eq!(
        refused(|f| f.attitude.yaw_rate_deg_s = -61.0),
        Quantity::YawRateDegS
    );
    assert_eq!(
        refused(|f| f.compensated_vh_per_s = f32::INFINITY),
        Quantity::VhPerS
    );
}

#[test]
fn horizon_on_the_sensor_is_refused() {
    // Half the field is 22°; a corner is 30° off the axis.
    let wide = View {
        principal_distance_mm: 40.0,
        ..view(FmcAxis::PlusY)
    };
    let mut flight = compensated();
    flight.attitude.pitch_deg = 44.0;
    assert!(matches!(
        ImageMotion::new(&wide, &flight),
        Err(ImageMotionError::Horizon(scale)) if scale < LEAST_GROUND_SCALE
    ));
    flight.attitude.pitch_deg = 30.0;
    assert!(ImageMotion::new(&wide, &flight).is_ok());
}

proptest! {
    /// Checks on a fine grid of points that no smear exceeds the bound, and that the largest one
    /// found on the coarse grid is at most the bound.
    #[test]
    fn bound_holds_over_the_whole_sensor(
        angles in prop::array::uniform3(-5.0_f32..5.0),
        rates in prop::array::uniform3(-5.0_f32..5.0),
        relief_percent in -20.0_f32..20.0,
        compensated_vh_per_s in 0.05_f32..0.15,
        axis in prop::sample::select(&FmcAxis::ALL[..]),
    ) {
        let mut flight = compensated();
        flight.motion.relief_percent = relief_percent;
        flight.compensated_vh_per_s = compensated_vh_per_s;
        [flight.attitude.pitch_deg, flight.attitude.roll_deg, flight.motion.drift_deg] = angles;
        let attitude = &mut flight.attitude;
        [attitude.pitch_rate_deg_s, attitude.roll_rate_deg_s, attitude.yaw_rate_deg_s] = rates;
        let motion = ImageMotion::new(&view(axis), &flight).unwrap();
        let largest = motion.largest_smear(EXPOSURE_S);
        for row in 0..33_u8 {
            for column in 0..33_u8 {
                let place = |index: u8| (f32::from(index) / 16.0 - 1.0) * 40.32;
                let smear = motion.smear(SensorPoint::new(place(column), place(row)), EXPOSURE_S);
                prop_assert!(smear.length_um() <= largest.bound_um + 1e-4);
            }
        }
        prop_assert!(largest.smear.length_um() <= largest.bound_um + 1e-4);
        // The middle control points leave out the curvature: at 5 °/s (40.32 mm)²·ω·t/f = 4.7 µm
        // of each component, and less than 0.2 µm of tilt.
        prop_assert!(largest.bound_um <= largest.smear.length_um() + 7.0);
    }
}
