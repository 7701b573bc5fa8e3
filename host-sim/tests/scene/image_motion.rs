//! The camera's image velocity, in single precision, against the differentiated path of the scene.

use fmc_camera::geometry::image_motion::{
    Attitude, FlightState, GroundMotion, ImageMotion, ROUNDING_MM_S, View,
};
use fmc_camera::geometry::sensor::{FmcAxis, Sensor, SensorPoint};
use fmc_camera_file::number::single;
use fmc_reference::exposure::ExposureRequest;
use fmc_simulation::scene::Scene;
use fmc_simulation::scene::terrain::Terrain;

use crate::scene::support::{HEIGHT_M, points, square};

/// Returns the same flight state in both models; at its centroid the scene has the attitude.
pub(crate) fn pair(axis: &str, flight: &FlightState, exposure_s: f64) -> (ImageMotion, Scene) {
    let camera = square(&format!(
        "[fmc]\naxis = \"{axis}\"\n[limits]\nvh_per_s = [0.0, 1.0]\n"
    ));
    let view = View {
        sensor: Sensor::new(9216, 9216, 8.75).unwrap(),
        principal_distance_mm: 100.0,
        principal_point: SensorPoint::default(),
        axis: FmcAxis::from(camera.fmc.axis),
    };
    let FlightState {
        motion,
        attitude,
        compensated_vh_per_s,
    } = *flight;
    let compensated = f64::from(compensated_vh_per_s);
    let mut scene = Scene::still(
        &camera,
        &ExposureRequest::planned(compensated, exposure_s),
        HEIGHT_M,
    );
    let (sin, cos) = f64::from(motion.drift_deg).to_radians().sin_cos();
    let speed = f64::from(motion.vh_per_s) * HEIGHT_M;
    scene.trajectory.velocity_m_s = [speed * sin, speed * cos, 0.0];
    scene.terrain = Terrain::Plane {
        height_m: f64::from(motion.relief_percent) / 100.0 * HEIGHT_M,
    };
    scene.attitude.pitch_deg = attitude.pitch_deg.into();
    scene.attitude.roll_deg = attitude.roll_deg.into();
    scene.attitude.rates_deg_s = [
        attitude.pitch_rate_deg_s,
        attitude.roll_rate_deg_s,
        attitude.yaw_rate_deg_s,
    ]
    .map(f64::from);
    scene.attitude.reference_s = scene.expose(0.0).centroid_s();
    (ImageMotion::new(&view, flight).unwrap(), scene)
}

pub(crate) fn compensated(vh_per_s: f32) -> FlightState {
    FlightState {
        motion: GroundMotion {
            vh_per_s,
            ..GroundMotion::default()
        },
        attitude: Attitude::default(),
        compensated_vh_per_s: vh_per_s,
    }
}

#[test]
fn velocity_agrees_with_the_differentiated_path() {
    let still = compensated(0.17);
    let change = |change: fn(&mut FlightState)| {
        let mut flight = still;
        change(&mut flight);
        flight
    };
    let states = [
        still,
        change(|f| f.attitude.pitch_deg = 10.0),
        change(|f| f.attitude.roll_deg = -10.0),
        change(|f| f.motion.drift_deg = 12.0),
        change(|f| f.attitude.pitch_rate_deg_s = 5.0),
        change(|f| f.attitude.roll_rate_deg_s = -5.0),
        change(|f| f.attitude.yaw_rate_deg_s = 5.0),
        change(|f| f.motion.relief_percent = 15.0),
        change(|f| f.compensated_vh_per_s = 0.0),
        change(|f| {
            f.motion.relief_percent = -20.0;
            f.motion.drift_deg = -7.0;
            f.attitude = Attitude {
                pitch_deg: -6.0,
                roll_deg: 8.0,
                pitch_rate_deg_s: 1.5,
                roll_rate_deg_s: 2.5,
                yaw_rate_deg_s: -3.5,
            };
            f.compensated_vh_per_s = 0.18;
        }),
    ];
    let mut most = 0.0_f64;
    for (index, flight) in states.iter().enumerate() {
        for axis in ["+y", "-y", "+x", "-x"] {
            let (motion, scene) = pair(axis, flight, 0.01);
            let frame = scene.expose(0.0);
            let middle_s = frame.centroid_s();
            for [x, y] in points(&square(""), 5, 0.99) {
                let ground = frame.ground_point([x, y]).unwrap();
                let step_s = 1e-5;
                let place = |time_s| frame.place_at(ground, time_s).unwrap();
                let (before, after) = (place(middle_s - step_s), place(middle_s + step_s));
                let centre = place(middle_s);
                assert!((centre[0] - x).hypot(centre[1] - y) < 1e-9);
                let velocity = motion.residual_velocity(SensorPoint::new(single(x), single(y)));
                for (component, found) in [velocity.x_mm_s, velocity.y_mm_s].iter().enumerate() {
                    let expected = (after[component] - before[component]) / (2.0 * step_s);
                    let difference = (expected - f64::from(*found)).abs();
                    assert!(
                        difference < f64::from(ROUNDING_MM_S),
                        "state {index}, axis {axis}, ({x}, {y}): {expected} {found}"
                    );
                    most = most.max(difference);
                }
            }
        }
    }
}
