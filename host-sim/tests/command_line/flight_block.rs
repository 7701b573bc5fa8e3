//! Simulated block of aerial images with the records of a camera whose detector moves: four strips
//! of ten frames to and fro, f = 50 mm, 700 m above ground, 60 and 30 % overlap, in files.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fmc_adjustment::bundle::tables::{NetworkTables, RowRole};
use fmc_simulation::block_experiment::flown_block::FlownBlock;
use fmc_simulation::block_experiment::scenario::Scenario;

use crate::command_line::support::Bench;

const CAMERA: &str = "name = \"Block\"\nprincipal_distance_mm = 50.0\n\
                      principal_point_mm = [0.02, -0.01]\n\
                      [sensor]\nwidth_px = 14204\nheight_px = 10652\npixel_um = 3.76\n\
                      [distortion]\nsign = \"distortion\"\nk1 = -2.0e-6\n\
                      [fmc]\nstroke_mm = 1.0\n";

const SCENARIO: &str = r#"name = "Block"
camera = "camera.toml"
[block]
strips = 4
frames = 10
points_per_frame = 40
[flight]
height_m = 700.0
speed_m_s = 75.0
wind_m_s = 15.0
exposure_s = [0.0033333333333, 0.0033333333333]
focus_spread_um = 1.0
[terrain]
relief_m = 28.0
wavelength_m = 900.0
[sigma]
image_um = 1.128
position_m = [0.03, 0.03, 0.04]
attitude_deg = [0.003, 0.003, 0.006]
record_um = 0.05
"#;

/// Strategy of the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RunUp {
    /// From rest at the calibrated position.
    FromRest,
    /// The centroid falls on the calibrated principal point.
    Centred,
}

/// A block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) run_up: RunUp,
    pub(crate) seed: u64,
    /// Error of the record of frame 18, mm.
    pub(crate) fault_mm: f64,
    /// `true` for positions stated at the triggers.
    pub(crate) at_trigger: bool,
    /// s: scale of the encoder.
    pub(crate) scale: f64,
}

impl Block {
    /// Writes `camera.toml`, `image_points.csv`, `points.csv`, `images.csv` and `records.csv`.
    pub(crate) fn bench(&self) -> Bench {
        let bench = Bench::with(CAMERA, b"");
        let block = FlownBlock::fly(&self.scenario(&bench.path(".")), self.seed, 1).unwrap();
        let [image_points, points] = point_tables(&block.tables);
        for (name, text) in [
            ("image_points.csv", image_points),
            ("points.csv", points),
            ("images.csv", self.images(&block)),
            ("records.csv", self.records(&block)),
        ] {
            fs::write(bench.path(name), text).unwrap();
        }
        bench
    }

    fn scenario(&self, folder: &Path) -> Scenario {
        let run_up = match self.run_up {
            RunUp::FromRest => "from-rest",
            RunUp::Centred => "centred",
        };
        let mut text = SCENARIO.replace("[terrain]", &format!("run_up = \"{run_up}\"\n[terrain]"));
        if self.fault_mm != 0.0 {
            let by_um = 1000.0 * self.fault_mm;
            writeln!(text, "[wrong_record]\nframe = 18\nby_um = {by_um:.3}").unwrap();
        }
        Scenario::parse("scenario.toml", &text, folder).unwrap()
    }

    fn records(&self, block: &FlownBlock) -> String {
        let mut text = "sequence,trigger_us,outcome,centroid_us,principal_point_x_mm,\
                        principal_point_y_mm,principal_point_sigma_mm,centroid_offset_mm,\
                        focus_shift_mm\n"
            .to_owned();
        let ([x0, y0], [ex, ey]) = (block.records.principal_point_mm, block.records.direction);
        for row in &block.records.table.rows {
            let trigger_us = 2_000_000 * row.sequence;
            let offset = row.offset_mm / (1.0 + self.scale);
            // The camera file gives no exit pupil: it is f away.
            let focus_shift = 50.0 * row.enlargement;
            writeln!(
                text,
                "{},{trigger_us},exposed,{},{:.9},{:.9},{},{offset:.9},{focus_shift:.9}",
                row.sequence,
                f64::from(trigger_us) + centroid_us(row.centroid_after_trigger_s),
                x0 + offset * ex,
                y0 + offset * ey,
                row.sigma_mm
            )
            .unwrap();
        }
        text
    }

    fn images(&self, block: &FlownBlock) -> String {
        let mut text =
            "image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg,sigma_x_m,sigma_y_m,sigma_z_m,\
                        sigma_pitch_deg,sigma_roll_deg,sigma_yaw_deg,vx_m_s,vy_m_s,vz_m_s,strip\n"
                .to_owned();
        let rows = &block.tables.images.as_ref().unwrap().rows;
        for (row, record) in rows.iter().zip(&block.records.table.rows) {
            let [x, y, z] = row.position_m;
            let [vx, vy, vz] = row.velocity_m_s.unwrap();
            let seconds = if self.at_trigger {
                1e-6 * centroid_us(record.centroid_after_trigger_s)
            } else {
                0.0
            };
            let [pitch, roll, yaw] = row.attitude_deg;
            let sigmas = row.sigmas.map(|sigma| sigma.unwrap().to_string()).join(",");
            writeln!(
                text,
                "{},{},{},{z},{pitch},{roll},{yaw},{sigmas},{vx},{vy},{vz},{}",
                row.image,
                x - seconds * vx,
                y - seconds * vy,
                row.strip.as_ref().unwrap()
            )
            .unwrap();
        }
        text
    }
}

/// Centroid after the trigger in whole microseconds, as a record states it.
fn centroid_us(after_trigger_s: Option<f64>) -> f64 {
    (1e6 * after_trigger_s.unwrap()).round()
}

/// Returns the text of `image_points.csv` and `points.csv`.
fn point_tables(tables: &NetworkTables) -> [String; 2] {
    let mut image_points = "image,point,x_mm,y_mm,sigma_um\n".to_owned();
    for row in &tables.image_points.rows {
        let ([x, y], sigma_um) = (row.measured_mm, 1000.0 * row.sigma_mm.unwrap());
        writeln!(
            image_points,
            "{},{},{x},{y},{sigma_um}",
            row.image, row.point
        )
        .unwrap();
    }
    let mut points = "point,x_m,y_m,z_m,role\n".to_owned();
    for row in &tables.object_points.rows {
        assert_eq!(row.role, RowRole::Check);
        let [x, y, z] = row.position_m;
        writeln!(points, "{},{x},{y},{z},check", row.point).unwrap();
    }
    [image_points, points]
}
