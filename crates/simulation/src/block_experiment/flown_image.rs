//! Physical exposure of a frame of the block, and the camera's record of it.

use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::records::RecordRow;
use fmc_camera::flight::camera::FrameError;
use fmc_reference::exposure::ExposureRequest;
use nalgebra::{Matrix3, Rotation3, Vector3};

use super::flight_plan::Station;
use super::planned_exposure::planned;
use super::scenario::Scenario;
use crate::noise::Noise;
use crate::scene::Scene;
use crate::scene::attitude::Attitude;

/// A frame as flown.
#[derive(Debug, Clone)]
pub struct FlownImage {
    /// Aircraft, ground, lens and stage of the exposure.
    pub scene: Scene,
    /// The camera's record, whose line is that of its file.
    pub record: RecordRow,
}

impl FlownImage {
    /// Exposes a frame at its station, with the run's light, attitude, focus and error of the
    /// stage.
    ///
    /// # Errors
    /// [`FrameError`] for an exposure that the camera refuses.
    pub(super) fn new(
        scenario: &Scenario,
        station: &Station,
        noise: &mut Noise,
    ) -> Result<Self, FrameError> {
        let flight = &scenario.written.flight;
        let [x, y, z] = station.position_m;
        let ground_m = if flight.follows_terrain {
            scenario.terrain().height_at([x, y])
        } else {
            scenario.written.terrain.height_m
        };
        let vh_per_s = station.speed_m_s() / (z - ground_m);
        let [shortest, longest] = flight.exposure_s;
        let exposure_s = noise.between(shortest.ln(), longest.ln()).exp();
        let [pitch_deg, roll_deg, yaw_deg] = noise.next(flight.attitude_spread_deg);
        let [focus_shift_um, stage_um] =
            noise.next([flight.focus_spread_um, scenario.written.sigma.record_um]);
        let planned = planned(&scenario.planner, vh_per_s, exposure_s, focus_shift_um)?;
        let request = ExposureRequest {
            focus_shift_mm: focus_shift_um / 1000.0,
            ..ExposureRequest::planned(vh_per_s, exposure_s)
        };
        let mut scene = Scene::still(&scenario.camera, &request, z);
        scene.trajectory.position_m = station.position_m;
        scene.trajectory.velocity_m_s = station.velocity_m_s;
        scene.attitude = Attitude {
            yaw_deg: station.yaw_deg() + yaw_deg,
            pitch_deg,
            roll_deg,
            ..Attitude::level()
        };
        scene.stage.opening_offset_mm += stage_um / 1000.0;
        let wrong = scenario.written.wrong_record.as_ref();
        let wrong_um = wrong
            .filter(|wrong| wrong.frame == i64::from(station.frame))
            .map_or(0.0, |wrong| wrong.by_um);
        Ok(Self {
            scene,
            record: RecordRow {
                line: u64::from(station.frame) + 1,
                sequence: station.frame,
                is_exposed: true,
                offset_mm: planned.offset_mm + wrong_um / 1000.0,
                sigma_mm: scenario.written.sigma.record_um / 1000.0,
                enlargement: planned.enlargement,
                centroid_after_trigger_s: Some(planned.centroid_after_trigger_s),
            },
        })
    }
}

/// Returns position and attitude of the sensor frame at the centroid of an exposure.
pub(super) fn sensor_pose(
    scene: &Scene,
    projection_centre_m: [f64; 3],
    ground_from_camera: Rotation3<f64>,
) -> Pose {
    let column = |sensor| {
        let [right, forward] = scene.interior.camera_from_sensor(sensor);
        Vector3::new(right, forward, 0.0)
    };
    let camera_from_sensor =
        Matrix3::from_columns(&[column([1.0, 0.0]), column([0.0, 1.0]), Vector3::z()]);
    Pose {
        position_m: projection_centre_m.into(),
        rotation: ground_from_camera * Rotation3::from_matrix_unchecked(camera_from_sensor),
    }
}
