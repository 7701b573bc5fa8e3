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

/// Fits K0 to K3 and grids of the lens to the motionless columns.
fn calibrated(rows: &[Truth], grids: Vec<(GridCarrier, Lattice)>) -> GridFit {
    let observations: Vec<TableObservation> = rows[..POINTS]
        .iter()
        .map(|row| TableObservation {
            line: 2,
            measured_mm: row.still[0],
            distortion_mm: row.still[1],
            stage_offset_mm: 0.0,
        })
        .collect();
    fit(&GridRequest {
        file: "exposure_truth_dblgauss.csv".to_owned(),
        observations: &observations,
        principal_point_mm: [0.0, 0.0],
        axis: [0.0, 1.0],
        lens: NONE,
        is_estimated: [true, true, true, true, false, false, false, false],
        run_out: RunOut::default(),
        grids,
    })
    .unwrap()
}

/// Returns the largest residual of K0 to K3 alone, along an axis, nm.
fn left_by_polynomial_nm(rows: &[Truth]) -> f64 {
    let residuals = calibrated(rows, Vec::new()).residuals_mm;
    let sizes = residuals.iter().flatten().map(|mm| 1e6 * mm.abs());
    sizes.fold(0.0, f64::max)
}

/// Largest errors allowed with the principal point up to 0.05 mm, up to 0.23 mm and farther from
/// its calibrated place, nm.
type Allowed = [f64; 3];

/// Those of the lens of the table, whose polynomial leaves 6 nm.
const OF_TABLE: Allowed = [2.0, 4.0, 12.0];
/// Those of lenses whose polynomial leaves 30 to 75 nm.
const OF_OTHERS: Allowed = [2.0, 7.0, 25.0];

fn allowed_nm(centroid_mm: f64, [near, farther, far]: Allowed) -> f64 {
    match centroid_mm {
        ..=0.05 => near,
        ..=0.23 => farther,
        _ => far,
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

/// Judges polynomial and grid in all exposures of a lens.
fn judge(name: &str, rows: &[Truth], allowed: Allowed) {
    assert_eq!(rows.len() % POINTS, 0);
    let lattice = Lattice::covering([-26.0, -27.0], [26.0, 27.0], 2.0).unwrap();
    let found = calibrated(rows, vec![(GridCarrier::Lens, lattice)]);
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
        let allowed_nm = allowed_nm(first.centroid_mm, allowed);
        println!(
            "{name}, c = {} mm: {largest_nm:.2} nm of {allowed_nm}, polynomial {polynomial_nm:.1}",
            first.centroid_mm
        );
        assert!(
            largest_nm <= allowed_nm,
            "{name}, c = {} mm: {largest_nm} nm, allowed: {allowed_nm} nm",
            first.centroid_mm
        );
        assert!(polynomial_nm > 5.0, "{name}: the grid is not needed");
    }
}

#[test]
fn polynomial_and_grid_follow_the_ray_traced_exposures() {
    let rows = truth();
    assert_eq!(rows.len(), 7 * POINTS);
    judge("double Gauss", &rows, OF_TABLE);
}

/// Travel and opening offset of the exposures of the table, mm.
const EXPOSURES: [[f64; 2]; 6] = [
    [0.01, 0.0],
    [0.1, 0.0],
    [0.3, -0.15],
    [0.1, 0.05],
    [0.3, 0.08],
    [0.3, 0.52],
];

/// Displacement of a lens at an ideal point.
type Displacement<'a> = &'a dyn Fn([f64; 2]) -> [f64; 2];

/// Rows like those of the table for a lens given by its displacement at an ideal point from the
/// principal point, mm; the mean over the exposure is that of 2000 instants.
fn simulated(lens: Displacement<'_>) -> Vec<Truth> {
    const INSTANTS: u32 = 2000;
    let mut rows = Vec::new();
    for [delta_mm, offset_mm] in EXPOSURES {
        for index in 0..21 * 21_u16 {
            let [x, y] = [index % 21, index / 21].map(|place| 2.55 * (f64::from(place) - 10.0));
            let mut mean = [0.0; 2];
            for instant in 0..INSTANTS {
                let u = (f64::from(instant) + 0.5) / f64::from(INSTANTS);
                let [dx, dy] = lens([x, y - offset_mm - delta_mm * u]);
                mean = [
                    mean[0] + dx / f64::from(INSTANTS),
                    mean[1] + dy / f64::from(INSTANTS),
                ];
            }
            let displaced = |[dx, dy]: [f64; 2]| [[x + dx, y + dy], [dx, dy]];
            rows.push(Truth {
                delta_mm,
                offset_mm,
                ramps: false,
                centroid_mm: offset_mm + 0.5 * delta_mm,
                moving: displaced(mean),
                still: displaced(lens([x, y])),
            });
        }
    }
    rows
}

/// Returns the displacement of a lens whose image height is a function of that without distortion.
fn radial(height: impl Fn(f64) -> f64) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |[x, y]| {
        let r = x.hypot(y);
        let gain = if r > 0.0 { height(r) / r - 1.0 } else { 0.0 };
        [gain * x, gain * y]
    }
}

/// Lenses of other kinds than the double Gauss, with a distortion of 0.4 to 1 % at the corner.
#[test]
fn polynomial_and_grid_follow_lenses_whose_polynomial_leaves_thirty_to_seventy_five_nanometres() {
    // Even powers beyond K3, as of strong aspheres.
    let asphere = radial(|r: f64| {
        let q = (r / 36.06).powi(2);
        r * (1.0 - 8e-3 * q - 3e-3 * q.powi(2) + 1e-3 * q.powi(3) + 1e-4 * q.powi(4))
    });
    // A quotient, whose powers do not end.
    let quotient = radial(|r: f64| r * (1.0 - 1e-5 * r * r / (1.0 + 3e-4 * r * r)));
    // Radial waves, as of a moulded surface.
    let waves = radial(|r: f64| r - 4e-6 * r.powi(3) + 2e-4 * (r / 5.0).sin());
    let lenses: [(&str, Displacement<'_>); 3] = [
        ("asphere", &asphere),
        ("quotient", &quotient),
        ("waves", &waves),
    ];
    for (name, lens) in lenses {
        let rows = simulated(lens);
        let left_nm = left_by_polynomial_nm(&rows);
        assert!(
            (30.0..75.0).contains(&left_nm),
            "{name}: the polynomial leaves {left_nm} nm"
        );
        judge(name, &rows, OF_OTHERS);
    }
}
