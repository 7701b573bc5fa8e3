//! Structures of the lens and of the sensor, told apart by stage positions, and tables that are
//! refused.

use fmc_adjustment::grid::fit::{GridFit, fit};
use fmc_adjustment::grid::lattice::Lattice;
use fmc_adjustment::grid::request::GridRequest;
use fmc_adjustment::grid::run_out::RunOut;
use fmc_adjustment::grid::table::TableObservation;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

const NONE: Lens = Lens {
    k: [0.0; 4],
    p: [0.0; 2],
    b: [0.0; 2],
};
const LENS: Lens = Lens {
    k: [1e-4, -3e-6, 2e-9, -4e-13],
    p: [2e-6, -1e-6],
    b: [1e-5, -2e-5],
};
const PRINCIPAL_POINT_MM: [f64; 2] = [0.2, -0.1];
const HALF_MM: f64 = 20.0;
const ALL: [bool; 8] = [true; 8];
const BOTH: [GridCarrier; 2] = [GridCarrier::Lens, GridCarrier::Sensor];

fn wave([x, y]: [f64; 2], phase: f64) -> [f64; 2] {
    let turn = std::f64::consts::TAU / 20.0;
    [
        3e-3 * (turn * (0.3 * x + 0.95 * y) + phase).sin(),
        3e-3 * (turn * (0.6 * x - 0.8 * y) + 2.0 * phase).cos(),
    ]
}

/// Distortion with structures of lens and sensor of the given amplitudes.
fn distortion([x, y]: [f64; 2], offset_mm: f64, [of_lens, of_sensor]: [f64; 2]) -> [f64; 2] {
    let moved = [x, y - offset_mm];
    let [x0, y0] = PRINCIPAL_POINT_MM;
    let polynomial = LENS.displacement([moved[0] - x0, moved[1] - y0]);
    let (lens, sensor) = (wave(moved, 0.4), wave([x, y], 1.7));
    [0, 1].map(|i| polynomial[i] + of_lens * lens[i] + of_sensor * sensor[i])
}

fn table(offsets_mm: &[f64], amplitudes: [f64; 2]) -> Vec<TableObservation> {
    let side = || (0..=40_u8).map(|i| f64::from(i) - HALF_MM);
    let mut rows = Vec::new();
    for offset in offsets_mm {
        for (x, y) in side().flat_map(|y| side().map(move |x| (x, y))) {
            rows.push(TableObservation {
                line: 2,
                measured_mm: [x, y],
                distortion_mm: distortion([x, y], *offset, amplitudes),
                stage_offset_mm: *offset,
            });
        }
    }
    rows
}

fn fitted(rows: &[TableObservation], carriers: &[GridCarrier]) -> Result<GridFit, InputError> {
    let lattice = |carrier: &GridCarrier| {
        let reach = match carrier {
            GridCarrier::Lens => HALF_MM + 1.0,
            GridCarrier::Sensor => HALF_MM,
        };
        let to = [HALF_MM, reach];
        let lattice = Lattice::covering(to.map(|side| -side), to, 2.0);
        (*carrier, lattice.unwrap())
    };
    fit(&GridRequest {
        file: "table.csv".to_owned(),
        observations: rows,
        principal_point_mm: PRINCIPAL_POINT_MM,
        axis: [0.0, 1.0],
        lens: NONE,
        is_estimated: ALL,
        run_out: RunOut::default(),
        grids: carriers.iter().map(lattice).collect(),
    })
}

/// Returns the largest error at a stage offset, nm.
fn error_nm(found: &GridFit, offset_mm: f64, amplitudes: [f64; 2]) -> f64 {
    let splines: Vec<_> = found
        .grids
        .iter()
        .map(|grid| (grid.carrier, grid.spline()))
        .collect();
    let [x0, y0] = PRINCIPAL_POINT_MM;
    let side = || (0..=57_u8).map(|i| f64::from(i) / 1.5 - 19.0);
    let mut largest = 0.0_f64;
    for point in side().flat_map(|y| side().map(move |x| [x, y])) {
        let moved = [point[0], point[1] - offset_mm];
        let mut sum = found.lens.displacement([moved[0] - x0, moved[1] - y0]);
        for (carrier, spline) in &splines {
            let value = match carrier {
                GridCarrier::Lens => spline.displacement(moved),
                GridCarrier::Sensor => spline.displacement(point),
            };
            sum = [sum[0] + value[0], sum[1] + value[1]];
        }
        let truth = distortion(point, offset_mm, amplitudes);
        for axis in 0..2 {
            largest = largest.max(1e6 * (sum[axis] - truth[axis]).abs());
        }
    }
    largest
}

#[test]
fn three_stage_positions_tell_the_structure_of_the_lens_from_that_of_the_sensor() {
    let rows = table(&[-1.0, 0.0, 1.0], [1.0, 0.7]);
    let found = fitted(&rows, &BOTH).unwrap();
    for offset_mm in [0.0, 0.15, -0.6] {
        let error = error_nm(&found, offset_mm, [1.0, 0.7]);
        assert!(error < 13.0, "{offset_mm} mm: {error} nm");
    }
    let residuals = found.residuals_mm.iter().flatten();
    let worst = residuals.fold(0.0_f64, |worst, value| worst.max(value.abs()));
    assert!(worst < 13e-6, "{worst} mm");
}

/// CALIBRATIONS section 9: 60 to 135 nm at 0.15 mm.
#[test]
fn wrong_carrier_costs_a_tenth_of_a_micrometre() {
    for (truth, wrong) in [
        ([1.0, 0.0], GridCarrier::Sensor),
        ([0.0, 1.0], GridCarrier::Lens),
    ] {
        let rows = table(&[0.0], truth);
        let found = fitted(&rows, &[wrong]).unwrap();
        assert!(error_nm(&found, 0.0, truth) < 13.0);
        let error = error_nm(&found, 0.15, truth);
        assert!((60.0..145.0).contains(&error), "{error} nm");
    }
}

#[test]
fn polynomial_alone_leaves_no_grid() {
    let rows = table(&[0.0], [0.0, 0.0]);
    let found = fitted(&rows, &[GridCarrier::Lens]).unwrap();
    let coefficients = found.grids[0].coefficients_mm.iter().flatten();
    let largest = coefficients.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(largest < 1e-8, "{largest} mm");
    assert!((found.lens.k[1] - LENS.k[1]).abs() < 1e-10);
}

/// Coefficients that are not estimated are those of the request.
#[test]
fn polynomial_that_is_held_is_kept_and_the_grid_takes_the_rest() {
    let rows = table(&[0.0], [1.0, 0.0]);
    let lattice = Lattice::covering([-HALF_MM; 2], [HALF_MM; 2], 2.0).unwrap();
    let held = GridRequest {
        file: "table.csv".to_owned(),
        observations: &rows,
        principal_point_mm: PRINCIPAL_POINT_MM,
        axis: [0.0, 1.0],
        lens: LENS,
        is_estimated: [false; 8],
        run_out: RunOut::default(),
        grids: vec![(GridCarrier::Lens, lattice)],
    };
    let found = fit(&held).unwrap();
    assert_eq!(found.lens, LENS);
    assert!(error_nm(&found, 0.0, [1.0, 0.0]) < 13.0);
    let only_k1 = [false, true, false, false, false, false, false, false];
    let found = fit(&GridRequest {
        is_estimated: only_k1,
        run_out: RunOut::default(),
        ..held
    })
    .unwrap();
    assert_eq!([found.lens.p, found.lens.b], [LENS.p, LENS.b]);
    assert!((found.lens.k[2] - LENS.k[2]).abs() < 1e-30);
    assert!(error_nm(&found, 0.0, [1.0, 0.0]) < 13.0);
}

#[test]
fn one_stage_position_does_not_tell_the_two_apart() {
    let refused = |rows: &[TableObservation]| fitted(rows, &BOTH).unwrap_err().to_string();
    let text = refused(&table(&[0.3], [1.0, 1.0]));
    assert!(
        text.contains("table.csv") && text.contains("0.3 mm"),
        "{text}"
    );
    assert!(text.contains("one stage position"), "{text}");
    assert!(fitted(&[], &[GridCarrier::Lens]).is_err());
}

#[test]
fn points_outside_the_grid_and_pitches_without_a_grid_are_refused() {
    let rows = table(&[0.0, 4.5], [1.0, 0.0]);
    let text = fitted(&rows, &[GridCarrier::Lens]).unwrap_err().to_string();
    assert!(
        text.contains("outside the grid") && text.contains("4.5 mm"),
        "{text}"
    );
    for pitch_mm in [0.0, -1.0, f64::NAN, f64::INFINITY, 0.1] {
        let refused = Lattice::covering([-20.0, -20.0], [20.0, 20.0], pitch_mm);
        assert!(refused.is_err(), "{pitch_mm}");
    }
}
