//! A lens given by a table, against ray-traced exposures of the same lens.

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposureRequest;
use fmc_simulation::scene::Scene;
use fmc_simulation::scene::field_table::{FieldNode, FieldTable};
use fmc_simulation::scene::lens::LensMapping;

use crate::scene::support::{HEIGHT_M, ground_below};

/// Largest distance of an exposure from the ray-traced one, mm: 0.0061 nm at the worst, where the
/// field is 0.84 mm beyond the table, 0.0016 nm elsewhere; the columns are rounded by 0.0005 nm.
const TOLERANCE_MM: f64 = 1e-8;
const POINTS: usize = 441;

fn rows() -> Vec<csv::StringRecord> {
    let text = include_str!("../../data/exposure_truth_dblgauss.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    table.records().map(Result::unwrap).collect()
}

fn number(row: &csv::StringRecord, column: usize) -> f64 {
    row[column].parse().unwrap()
}

/// Reads the lens from the motionless columns.
fn lens(rows: &[csv::StringRecord]) -> LensMapping {
    let nodes: Vec<FieldNode> = rows[..POINTS]
        .iter()
        .map(|row| FieldNode {
            ideal_mm: [number(row, 7), number(row, 8)],
            displacement_mm: [number(row, 11) / 1e3, number(row, 12) / 1e3],
        })
        .collect();
    LensMapping::FieldTable(FieldTable::new(&nodes).unwrap())
}

/// Returns an exposure of 1/100 s with the δ, Δδ, shutter and stage speed of a row.
fn scene(row: &csv::StringRecord, lens: &LensMapping) -> Scene {
    let exposure_s = 0.01;
    let focal_mm = number(row, 1);
    let (delta_mm, speed_ratio) = (number(row, 2), number(row, 5));
    let ramps = if &row[4] == "trap30_10" {
        "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n"
    } else {
        ""
    };
    let text = format!(
        "name = \"double Gauss\"\nprincipal_distance_mm = {focal_mm}\n[sensor]\nwidth_px = 6000\n\
         height_px = 6000\npixel_um = 10.0\n{ramps}"
    );
    let (camera, _) = CameraFile::parse("double-gauss.toml", &text).unwrap();
    let request = ExposureRequest {
        opening_offset_mm: Some(number(row, 3)),
        ..ExposureRequest::planned(delta_mm / speed_ratio / exposure_s / focal_mm, exposure_s)
    };
    let mut scene = Scene::still(&camera, &request, HEIGHT_M);
    scene.lens = lens.clone();
    scene.stage.speed_error_percent = 100.0 * (speed_ratio - 1.0);
    scene
}

#[test]
fn exposures_through_the_table_are_the_ray_traced_ones() {
    let rows = rows();
    let lens = lens(&rows);
    assert_eq!(rows.len(), 7 * POINTS);
    for exposure in rows.chunks(POINTS) {
        let scene = scene(&exposure[0], &lens);
        let frame = scene.expose(0.0);
        assert!((frame.centroid_offset_mm() - number(&exposure[0], 6)).abs() < 1e-9);
        let (mut most, mut motion) = (0.0_f64, 0.0_f64);
        for row in exposure {
            let ideal = [number(row, 7), number(row, 8)];
            let ground = ground_below(&scene, &frame, ideal);
            let found = frame.image_point(ground).unwrap().point_mm;
            for axis in 0..2 {
                let displacement = found[axis] - ideal[axis];
                most = most.max((displacement - number(row, 9 + axis) / 1e3).abs());
                let still = number(row, 11 + axis) / 1e3;
                motion = motion.max((displacement - still).abs());
            }
        }
        assert!(most <= TOLERANCE_MM, "δ {}: {most}", &exposure[0][2]);
        // The motion is large enough for the check to see it.
        assert!(motion > 1000.0 * most || number(&exposure[0], 6) < 1e-9);
    }
}
