//! Polynomial and grid against ray-traced exposures of a lens that no polynomial describes.
//!
//! Both are fitted to the motionless columns; the camera gets only them, δ, Δδ and the shutter.

use fmc_adjustment::grid::fit::{GridFit, fit};
use fmc_adjustment::grid::grid_file;
use fmc_adjustment::grid::lattice::Lattice;
use fmc_adjustment::grid::request::GridRequest;
use fmc_adjustment::grid::run_out::RunOut;
use fmc_adjustment::grid::table::TableObservation;
use fmc_camera::geometry::grid::{GridCarrier, PlacedGrid, ResidualGrid};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::{Camera, Exposure};
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_reference::lens::Lens;

const NONE: Lens = Lens {
    k: [0.0; 4],
    p: [0.0; 2],
    b: [0.0; 2],
};
const PRINCIPAL_DISTANCE_MM: f64 = 149.999_958_957;
/// Points of the lens in an exposure.
const POINTS: usize = 441;

/// A row of `exposure_truth_dblgauss.csv`.
struct Truth {
    delta_mm: f64,
    offset_mm: f64,
    ramps: bool,
    centroid_mm: f64,
    /// Measured point and distortion during the exposure and without motion, mm.
    moving: [[f64; 2]; 2],
    still: [[f64; 2]; 2],
}

fn truth() -> Vec<Truth> {
    let text = include_str!("../../../../host-sim/data/exposure_truth_dblgauss.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let row = |row: csv::StringRecord| {
        let number = |index: usize| row[index].parse::<f64>().unwrap();
        let ideal = [number(7), number(8)];
        let displaced = |first: usize| {
            let d = [number(first) / 1e3, number(first + 1) / 1e3];
            [[ideal[0] + d[0], ideal[1] + d[1]], d]
        };
        Truth {
            delta_mm: number(2),
            offset_mm: number(3),
            ramps: &row[4] == "trap30_10",
            centroid_mm: number(6),
            moving: displaced(9),
            still: displaced(11),
        }
    };
    table.records().map(|record| row(record.unwrap())).collect()
}

/// Fits K0 to K3 and a grid of the lens to the motionless columns.
fn calibrated(rows: &[Truth]) -> GridFit {
    let observations: Vec<TableObservation> = rows[..POINTS]
        .iter()
        .map(|row| TableObservation {
            line: 2,
            measured_mm: row.still[0],
            distortion_mm: row.still[1],
            stage_offset_mm: 0.0,
        })
        .collect();
    let lattice = Lattice::covering([-26.0, -27.0], [26.0, 27.0], 2.0).unwrap();
    fit(&GridRequest {
        file: "exposure_truth_dblgauss.csv".to_owned(),
        observations: &observations,
        principal_point_mm: [0.0, 0.0],
        axis: [0.0, 1.0],
        lens: NONE,
        is_estimated: [true, true, true, true, false, false, false, false],
        run_out: RunOut::default(),
        grids: vec![(GridCarrier::Lens, lattice)],
    })
    .unwrap()
}

/// Largest error allowed with the principal point so far from its calibrated place, nm.
fn allowed_nm(centroid_mm: f64) -> f64 {
    match centroid_mm {
        ..=0.05 => 2.0,
        ..=0.23 => 4.0,
        _ => 12.0,
    }
}

fn camera(lens: &Lens, ramps: bool) -> Camera {
    let [k0, k1, k2, k3] = lens.k;
    let shutter = if ramps {
        "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n"
    } else {
        ""
    };
    let text = format!(
        "name = \"double Gauss\"\nprincipal_distance_mm = {PRINCIPAL_DISTANCE_MM}\n\
         [sensor]\nwidth_px = 5200\nheight_px = 5200\npixel_um = 10.0\n\
         [distortion]\nk0 = {k0:e}\nk1 = {k1:e}\nk2 = {k2:e}\nk3 = {k3:e}\n\
         [limits]\nvh_per_s = [0.001, 0.17]\n{shutter}"
    );
    CameraFile::parse("double-gauss.toml", &text).unwrap().1
}

#[test]
fn polynomial_and_grid_follow_the_ray_traced_exposures() {
    let rows = truth();
    assert_eq!(rows.len(), 7 * POINTS);
    let found = calibrated(&rows);
    let file = grid_file::bytes(&found.grids[0]).unwrap();
    let grid = ResidualGrid::parse(&file).unwrap();
    let cameras = [false, true].map(|ramps| camera(&found.lens, ramps));
    for exposure_rows in rows.chunks(POINTS) {
        let mut largest_nm = 0.0_f64;
        let mut polynomial_nm = 0.0_f64;
        let first = &exposure_rows[0];
        for row in exposure_rows {
            let [x, y] = row.moving[0].map(single);
            let exposure = Exposure {
                opening_offset_mm: Some(single(row.offset_mm)),
                ..Exposure::new(single(row.delta_mm / PRINCIPAL_DISTANCE_MM / 0.02), 0.02)
            };
            let frame = cameras[usize::from(row.ramps)].frame(&exposure).unwrap();
            let motion = frame.interior.motion;
            let placed = PlacedGrid::new(&grid, FmcAxis::PlusY, motion.centroid_mm, 0.0);
            let point = SensorPoint::new(x, y);
            let (d, left) = (
                frame.correction.distortion(point),
                placed.displacement(point),
            );
            let [dx, dy] = row.moving[1];
            for (polynomial, grid, truth) in [(d.dx_mm, left.dx_mm, dx), (d.dy_mm, left.dy_mm, dy)]
            {
                let [polynomial, grid] = [polynomial, grid].map(f64::from);
                largest_nm = largest_nm.max(1e6 * (polynomial + grid - truth).abs());
                polynomial_nm = polynomial_nm.max(1e6 * (polynomial - truth).abs());
            }
        }
        let allowed_nm = allowed_nm(first.centroid_mm);
        assert!(
            largest_nm <= allowed_nm,
            "c = {} mm: {largest_nm} nm, allowed: {allowed_nm} nm",
            first.centroid_mm
        );
        assert!(polynomial_nm > 5.0, "the grid is not needed");
    }
}
