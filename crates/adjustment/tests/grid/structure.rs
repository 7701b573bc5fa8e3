//! Grids fitted to 3 µm of structure, as the camera evaluates them (CALIBRATIONS section 9).

use fmc_adjustment::grid::fit::fit;
use fmc_adjustment::grid::grid_file;
use fmc_adjustment::grid::lattice::Lattice;
use fmc_adjustment::grid::request::GridRequest;
use fmc_adjustment::grid::run_out::RunOut;
use fmc_adjustment::grid::table::TableObservation;
use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{GridCarrier, PlacedGrid, ResidualGrid};
use fmc_reference::lens::Lens;
use fmc_reference::residual_spline::ResidualSpline;

const NONE: Lens = Lens {
    k: [0.0; 4],
    p: [0.0; 2],
    b: [0.0; 2],
};
/// Half sides of the sensor with half of a stroke of 4 mm, mm.
const HALF_MM: [f64; 2] = [26.7, 22.0];
/// Distance of neighbouring points of the table, mm.
const TABLE_MM: f64 = 0.5;

/// Waves in four directions, of unequal lengths with amplitudes in proportion to them; their sum is
/// within ±3 µm and comes near to it.
fn structure(shortest_mm: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let wave = |angle: f64, length: f64, phase: f64| {
        let along = x * angle.cos() + y * angle.sin();
        length * (std::f64::consts::TAU * along / (length * shortest_mm) + phase).sin()
    };
    let sum = |phase: f64| {
        let sum = wave(0.3, 1.0, phase)
            + wave(1.4, 1.3, 1.7 * phase + 1.0)
            + wave(2.2, 1.7, 0.6 * phase + 2.0)
            + wave(2.9, 2.2, 2.3 * phase + 3.0);
        3.3e-3 / (1.0 + 1.3 + 1.7 + 2.2) * sum
    };
    [sum(0.4), sum(1.9)]
}

fn lattice_points(step_mm: f64) -> Vec<[f64; 2]> {
    let [half_x, half_y] = HALF_MM;
    let along = |half: f64| {
        let mut place = -half;
        let mut found = Vec::new();
        while place < half {
            found.push(place);
            place += step_mm;
        }
        found.push(half);
        found
    };
    let columns = along(half_x);
    along(half_y)
        .into_iter()
        .flat_map(|y| columns.iter().map(move |x| [*x, y]).collect::<Vec<_>>())
        .collect()
}

/// Errors of the camera's grid, nm: largest and rms against the structure, largest against the same
/// coefficients in double precision.
struct Errors {
    largest: f64,
    rms: f64,
    rounding: f64,
    /// Bound of the rounding: 2⁻¹³ of the largest difference of neighbouring nodes.
    largest_rounding: f64,
    bytes: usize,
}

fn errors(shortest_mm: f64, pitch_mm: f64) -> Errors {
    let observations: Vec<TableObservation> = lattice_points(TABLE_MM)
        .into_iter()
        .map(|measured_mm| TableObservation {
            line: 2,
            measured_mm,
            distortion_mm: structure(shortest_mm, measured_mm),
            stage_offset_mm: 0.0,
        })
        .collect();
    let [half_x, half_y] = HALF_MM;
    let lattice = Lattice::covering([-half_x, -half_y], HALF_MM, pitch_mm).unwrap();
    let found = fit(&GridRequest {
        file: "table.csv".to_owned(),
        observations: &observations,
        principal_point_mm: [0.0, 0.0],
        axis: [0.0, 1.0],
        lens: NONE,
        is_estimated: [false; 8],
        run_out: RunOut::default(),
        grids: vec![(GridCarrier::Lens, lattice)],
    })
    .unwrap();
    let file = grid_file::bytes(&found.grids[0]).unwrap();
    let grid = ResidualGrid::parse(&file).unwrap();
    let placed = PlacedGrid::calibrated(&grid);
    let spline = ResidualSpline::of(&grid);
    let points = lattice_points(0.37);
    let (mut largest, mut squares, mut rounding) = (0.0_f64, 0.0, 0.0_f64);
    for point in &points {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "the point a camera receives"
        )]
        let [x, y] = point.map(|value| value as f32);
        let received = [x, y].map(f64::from);
        let d = placed.displacement(SensorPoint::new(x, y));
        let found = [d.dx_mm, d.dy_mm].map(f64::from);
        let truth = structure(shortest_mm, received);
        let strict = spline.displacement(received);
        for axis in 0..2 {
            let error = 1e6 * (found[axis] - truth[axis]);
            largest = largest.max(error.abs());
            squares += error * error;
            rounding = rounding.max(1e6 * (found[axis] - strict[axis]).abs());
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "some thousand points")]
    let rms = (squares / (2.0 * points.len() as f64)).sqrt();
    Errors {
        largest,
        rms,
        rounding,
        largest_rounding: 1e6 * f64::from(grid.bounds().slope()) * pitch_mm / 8192.0,
        bytes: file.len(),
    }
}

/// Largest rounding that is allowed, and that of waves of ten nodes or more, nm.
const MOST_ROUNDING_NM: f64 = 1.5;
const TEN_NODES_ROUNDING_NM: f64 = 0.07;

/// The table of CALIBRATIONS section 9: shortest wave, pitch, largest error and rms, nm.
const TABLE: [(f64, f64, f64, f64); 9] = [
    (10.0, 1.0, 5.2, 0.3),
    (10.0, 2.0, 40.0, 2.6),
    (10.0, 4.0, 299.0, 54.0),
    (20.0, 1.0, 1.2, 0.1),
    (20.0, 2.0, 12.0, 0.5),
    (20.0, 4.0, 49.0, 4.4),
    (40.0, 1.0, 0.3, 0.02),
    (40.0, 2.0, 2.1, 0.1),
    (40.0, 4.0, 11.0, 0.9),
];

#[test]
fn structure_of_3_um_is_held_within_the_errors_of_section_9() {
    let largest_um = lattice_points(1.0)
        .into_iter()
        .flat_map(|point| structure(20.0, point))
        .fold(0.0_f64, |largest, value| largest.max(1e3 * value.abs()));
    assert!((2.7..=3.0).contains(&largest_um), "{largest_um} µm");
    for (shortest_mm, pitch_mm, largest_nm, rms_nm) in TABLE {
        let found = errors(shortest_mm, pitch_mm);
        let Errors { largest, rms, .. } = found;
        assert!(
            largest <= largest_nm && rms <= rms_nm,
            "waves of {shortest_mm} mm, pitch {pitch_mm} mm: {largest} ({rms}) nm"
        );
        let rounding = found.rounding;
        assert!(
            rounding <= found.largest_rounding && rounding <= MOST_ROUNDING_NM,
            "waves of {shortest_mm} mm, pitch {pitch_mm} mm: {rounding} nm of rounding"
        );
        if shortest_mm >= 10.0 * pitch_mm {
            assert!(rounding <= TEN_NODES_ROUNDING_NM, "{rounding} nm");
        }
    }
}

#[test]
fn files_are_as_large_as_section_9_says() {
    for (pitch_mm, kilobytes) in [(1.0, 10.3), (2.0, 2.8), (4.0, 0.9)] {
        let found = errors(40.0, pitch_mm);
        let bytes = f64::from(u16::try_from(found.bytes).unwrap());
        // The format and the stroke are not said to the millimetre.
        assert!((bytes / 1e3 / kilobytes - 1.0).abs() < 0.25, "{bytes}");
    }
}

/// The error of a cubic spline falls with the fourth power of the pitch.
#[test]
fn half_the_pitch_leaves_a_sixteenth_of_the_error() {
    for (shortest_mm, pitch_mm) in [(20.0, 4.0), (10.0, 2.0)] {
        let [whole, half] = [pitch_mm, 0.5 * pitch_mm].map(|pitch| errors(shortest_mm, pitch).rms);
        let ratio = whole / half;
        assert!((13.0..30.0).contains(&ratio), "{shortest_mm} mm: {ratio}");
    }
}
