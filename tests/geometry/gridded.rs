//! Corrections with residual grids, against the exposure mean of polynomial and splines in double
//! precision, and their inverses.

use crate::geometry::cameras;
use crate::geometry::jacobian::brown;
use crate::geometry::spline::{file, noise, strict, wave};
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
use proptest::prelude::*;

/// Largest error that grids add to that of the polynomial at up to 0.17 mm of travel, nm: V/H 0.17
/// 1/s for 1/100 s at f = 100 mm.
const ADDED_NM: f64 = 1.5;
/// Rounding of the evaluation of both grids, nm; that of the places of grids is part of it.
const ROUNDING_NM: f64 = 0.3;
/// Error of a round trip near an axis of the sensor, nm, where a unit in the last place is less
/// than the steps of two grids: twice the rounding of each in waves of ten nodes.
const LIMIT_NEAR_AXIS_NM: f32 = 0.3;
/// The same for grids without any order.
const LIMIT_OF_NOISE_NM: f32 = 1.2;

/// Returns a header of cells from (-30, -24) to (30, 24) mm.
fn header(carrier: GridCarrier) -> GridHeader {
    GridHeader {
        carrier,
        columns: 33,
        rows: 27,
        first_node: SensorPoint::new(-32.0, -26.0),
        pitch_mm: 2.0,
        scale_mm: 3e-3 / 32767.0,
    }
}

/// Returns the files of a grid of the lens and of one of the sensor.
fn files() -> [Vec<u8>; 2] {
    let turned = |column, row| {
        let [x, y] = wave(row, column);
        [y, x]
    };
    [
        file(&header(GridCarrier::Lens), wave),
        file(&header(GridCarrier::Sensor), turned),
    ]
}

/// Returns a camera of 53.4 mm by 40.1 mm with the distortion of a published one.
fn parameters(axis: FmcAxis) -> CalibrationParameters {
    let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    parameters.principal_point = SensorPoint::new(0.031, -0.047);
    parameters.axis = axis;
    parameters.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        p1: 2e-6,
        p2: -4.5e-6,
        ..Brown::NONE
    };
    parameters
}

/// Returns the motion of an exposure of 10 ms about a centroid.
fn motion(centroid_mm: f32, travel_mm: f32) -> PrincipalPointMotion {
    let travel = UniformTravel {
        opening_offset_mm: centroid_mm - 0.5 * travel_mm,
        speed_mm_s: travel_mm / 0.01,
        exposure_s: 0.01,
    };
    PrincipalPointMotion::from_plan(travel, &Shutter::new(ShutterProfile::Uniform).unwrap())
}

/// Returns the grids of a camera of one part, the other and both, each with those it has.
fn combinations<'a>(
    calibration: &Calibration,
    [lens, sensor]: &'a [Vec<u8>; 2],
) -> [CameraGrids<'a>; 3] {
    let [lens, sensor] = [lens, sensor].map(|bytes| ResidualGrid::parse(bytes).unwrap());
    [
        (Some(lens), None),
        (None, Some(sensor)),
        (Some(lens), Some(sensor)),
    ]
    .map(|(lens, sensor)| CameraGrids::new(calibration, lens, sensor).unwrap())
}

/// Returns the mean over a uniform exposure in double precision: of the polynomial alone, and with
/// the splines.
fn mean(
    parameters: &CalibrationParameters,
    grids: &CameraGrids<'_>,
    motion: &PrincipalPointMotion,
    kappa: f64,
    point: SensorPoint,
) -> [[f64; 2]; 2] {
    const INSTANTS: u16 = 12;
    let [x, y] = [point.x_mm, point.y_mm].map(f64::from);
    let pp = parameters.principal_point;
    let [x0, y0] = [pp.x_mm, pp.y_mm].map(f64::from);
    let unit = parameters
        .axis
        .sensor_from_offset(SensorPoint::default(), 1.0);
    let [ex, ey] = [unit.x_mm, unit.y_mm].map(f64::from);
    let mut sums = [[0.0; 2]; 2];
    for instant in 0..INSTANTS {
        let u = (f64::from(instant) + 0.5) / f64::from(INSTANTS);
        let c = f64::from(motion.opening_offset_mm) + u * f64::from(motion.travel_mm);
        let shrunk = |x: f64, y: f64| [(x - c * ex) / (1.0 + kappa), (y - c * ey) / (1.0 + kappa)];
        let [sx, sy] = shrunk(x - x0, y - y0);
        let [dx, dy] = brown(&parameters.distortion, sx, sy);
        let polynomial = [dx + kappa * sx, dy + kappa * sy];
        let zero = || [0.0; 2];
        let lens = grids
            .lens()
            .map_or_else(zero, |grid| strict(grid, shrunk(x, y)));
        let sensor = grids
            .sensor()
            .map_or_else(zero, |grid| strict(grid, [x, y]));
        for axis in 0..2 {
            sums[0][axis] += polynomial[axis];
            sums[1][axis] += polynomial[axis] + lens[axis] + sensor[axis];
        }
    }
    sums.map(|sum| sum.map(|sum| sum / f64::from(INSTANTS)))
}

fn error_nm(found: Displacement, expected: [f64; 2]) -> f64 {
    let [x, y] = expected;
    1e6 * (f64::from(found.dx_mm) - x)
        .abs()
        .max((f64::from(found.dy_mm) - y).abs())
}

/// Both carriers, all axes, the ends of the stroke, and focus shifts that shrink and enlarge the
/// image.
#[test]
fn grids_add_at_most_one_and_a_half_nanometres_to_the_error_of_an_exposure() {
    let files = files();
    let mut largest_nm = 0.0_f64;
    for axis in FmcAxis::ALL {
        let parameters = parameters(axis);
        let calibration = Calibration::new(parameters).unwrap();
        for (centroid_mm, travel_mm, shift_mm) in [
            (0.0, 0.0, 0.0),
            (0.0, 0.088, 0.01),
            (0.15, 0.17, -0.02),
            (-1.91, 0.17, 0.5),
            (1.91, -0.17, -0.5),
        ] {
            let motion = motion(centroid_mm, travel_mm);
            let focus = cameras::focus(&calibration, shift_mm);
            let kappa = focus.enlargement();
            let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
            for grids in combinations(&calibration, &files) {
                let correction = GriddedCorrection::exposed(polynomial, &grids, &motion, kappa);
                for point in cameras::grid(&calibration, 17) {
                    let [without, with] =
                        mean(&parameters, &grids, &motion, f64::from(kappa), point);
                    let answer = correction.correct(point);
                    let found = error_nm(answer.distortion, with);
                    let added = found - error_nm(polynomial.distortion(point), without);
                    assert!(added <= ADDED_NM, "{added} nm at {point:?}, {axis:?}");
                    largest_nm = largest_nm.max(added);
                    let coordinate = SensorPoint::new(
                        point.x_mm - answer.distortion.dx_mm,
                        point.y_mm - answer.distortion.dy_mm,
                    );
                    assert_eq!(answer.point, coordinate);
                }
            }
        }
    }
    println!("{largest_nm} nm");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn what_grids_leave_out_is_within_the_bound_that_they_state(
        axis in cameras::axes(),
        motion in cameras::motions(),
        shift_mm in -0.5_f32..0.5,
        x in -1.0_f32..=1.0,
        y in -1.0_f32..=1.0,
    ) {
        let uniform = self::motion(motion.centroid_mm, motion.travel_mm);
        let files = files();
        let parameters = parameters(axis);
        let calibration = Calibration::new(parameters).unwrap();
        let focus = cameras::focus(&calibration, shift_mm);
        let kappa = focus.enlargement();
        let polynomial = FrameCorrection::exact(&calibration, &uniform, &focus);
        let sensor = calibration.sensor();
        let point = SensorPoint::new(x * sensor.half_width_mm(), y * sensor.half_height_mm());
        for grids in combinations(&calibration, &files) {
            let correction = GriddedCorrection::exposed(polynomial, &grids, &uniform, kappa);
            let [_, expected] = mean(&parameters, &grids, &uniform, f64::from(kappa), point);
            let error = error_nm(correction.distortion(point), expected);
            prop_assert!(
                error <= f64::from(correction.left_out_nm()) + ROUNDING_NM,
                "{} nm of {}", error, correction.left_out_nm()
            );
        }
    }

    /// Lenses of some per cent, grids with structure and without any order, all places.
    #[test]
    fn gridded_corrections_come_back_within_two_units_in_the_last_place(
        lens in cameras::lenses(),
        axis in cameras::axes(),
        motion in cameras::motions(),
        shift_mm in -0.05_f32..0.05,
        disorder in any::<bool>(),
        places in prop::collection::vec((-1.0_f32..=1.0, -1.0_f32..=1.0), 8),
    ) {
        let (files, near_axis_nm) = if disorder {
            let carriers = [GridCarrier::Lens, GridCarrier::Sensor];
            (carriers.map(|carrier| file(&header(carrier), noise)), LIMIT_OF_NOISE_NM)
        } else {
            (files(), LIMIT_NEAR_AXIS_NM)
        };
        let mut record = parameters(axis);
        record.distortion = lens;
        let calibration = Calibration::new(record).unwrap();
        let focus = cameras::focus(&calibration, shift_mm);
        let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
        let half_width = calibration.sensor().half_width_mm();
        let half_height = calibration.sensor().half_height_mm();
        for grids in combinations(&calibration, &files) {
            let correction =
                GriddedCorrection::exposed(polynomial, &grids, &motion, focus.enlargement());
            for (x, y) in &places {
                let point = SensorPoint::new(x * half_width, y * half_height);
                prop_assert!(comes_back(&correction, point, near_axis_nm), "{point:?}");
            }
        }
    }

    #[test]
    fn any_ideal_point_gives_a_point_that_corrects_to_it_or_an_error(
        disorder in any::<bool>(),
        x in prop_oneof![-30.0_f32..30.0, -200.0_f32..200.0, any::<f32>()],
        y in prop_oneof![-23.0_f32..23.0, -200.0_f32..200.0, any::<f32>()],
    ) {
        let coefficients = if disorder { noise } else { wave };
        let bytes = file(&header(GridCarrier::Lens), coefficients);
        let calibration = Calibration::new(parameters(FmcAxis::PlusY)).unwrap();
        let grid = ResidualGrid::parse(&bytes).unwrap();
        let grids = CameraGrids::new(&calibration, Some(grid), None).unwrap();
        let still = FrameCorrection::without_motion(&calibration);
        let correction = GriddedCorrection::calibrated(still, &grids);
        match correction.distort(SensorPoint::new(x, y)) {
            Ok(measured) => {
                prop_assert!(still.contains(measured.point));
                let back = correction.correct(measured.point).point;
                prop_assert!((back.x_mm - x).abs() < 1e-5 && (back.y_mm - y).abs() < 1e-5);
            }
            Err(DistortError::OffSensor(point)) => prop_assert!(!still.contains(point)),
            // The iterates of a point that is three half widths from the centre and farther may run
            // to and fro between two edges. The nearest of two million was at 91 mm, 3.4 of them.
            Err(DistortError::NotConverged { .. }) => {
                let far_mm = 3.0 * calibration.sensor().half_width_mm();
                prop_assert!(x.abs().max(y.abs()) > far_mm || !(x + y).is_finite());
            }
        }
    }
}

/// Returns true if a point comes back.
fn comes_back(
    correction: &GriddedCorrection<'_>,
    measured: SensorPoint,
    near_axis_nm: f32,
) -> bool {
    let ideal = correction.correct(measured).point;
    let back = correction
        .distort(ideal)
        .unwrap_or_else(|error| panic!("{measured:?}: {error}"))
        .point;
    let within = |a: f32, ideal: f32, b: f32| {
        let largest = a.abs().max(ideal.abs());
        let ulp = largest.next_up() - largest;
        (a - b).abs() <= (2.0 * ulp).max(near_axis_nm * 1e-6)
    };
    within(measured.x_mm, ideal.x_mm, back.x_mm) && within(measured.y_mm, ideal.y_mm, back.y_mm)
}

#[test]
fn edges_of_the_sensor_come_back_too() {
    let files = files();
    let calibration = Calibration::new(parameters(FmcAxis::MinusX)).unwrap();
    let motion = motion(0.15, 0.1);
    let focus = cameras::focus(&calibration, 0.01);
    let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
    for grids in combinations(&calibration, &files) {
        let correction =
            GriddedCorrection::exposed(polynomial, &grids, &motion, focus.enlargement());
        for point in cameras::grid(&calibration, 101) {
            assert!(
                comes_back(&correction, point, LIMIT_NEAR_AXIS_NM),
                "{point:?}"
            );
        }
    }
}

#[test]
fn slices_have_the_bits_of_single_points() {
    let files = files();
    let calibration = Calibration::new(parameters(FmcAxis::PlusY)).unwrap();
    let motion = motion(0.15, 0.1);
    let focus = cameras::focus(&calibration, 0.0);
    let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
    let none = CameraGrids::new(&calibration, None, None).unwrap();
    let points = cameras::grid(&calibration, 23);
    for grids in combinations(&calibration, &files).into_iter().chain([none]) {
        let correction = GriddedCorrection::exposed(polynomial, &grids, &motion, 0.0);
        let single: Vec<SensorPoint> = points
            .iter()
            .map(|point| correction.correct(*point).point)
            .collect();
        let mut slice = points.clone();
        correction.correct_slice(&mut slice);
        assert_eq!(slice, single);
        let mut x_mm: Vec<f32> = points.iter().map(|point| point.x_mm).collect();
        let mut y_mm: Vec<f32> = points.iter().map(|point| point.y_mm).collect();
        correction.correct_slice_xy(&mut x_mm, &mut y_mm).unwrap();
        let zipped = x_mm
            .iter()
            .zip(&y_mm)
            .map(|(x, y)| SensorPoint::new(*x, *y));
        assert_eq!(zipped.collect::<Vec<_>>(), single);
        assert!(
            correction
                .correct_slice_xy(&mut x_mm[1..], &mut y_mm)
                .is_err()
        );
        let measured: Vec<SensorPoint> = single
            .iter()
            .map(|ideal| correction.distort(*ideal).unwrap().point)
            .collect();
        correction.distort_slice(&mut slice).unwrap();
        assert_eq!(slice, measured);
        slice[7] = SensorPoint::new(40.0, 0.0);
        let before = slice[8];
        let refused = correction.distort_slice(&mut slice).unwrap_err();
        assert_eq!((refused.index, slice[8]), (7, before));
    }
}

/// A camera without grids keeps its bits, also by way of the type that may have them.
#[test]
fn without_grids_the_bits_are_those_of_the_polynomial() {
    let calibration = Calibration::new(parameters(FmcAxis::PlusY)).unwrap();
    let none = CameraGrids::new(&calibration, None, None).unwrap();
    assert_eq!(
        none.least_scale().to_bits(),
        calibration.least_scale().to_bits()
    );
    let motion = motion(0.15, 0.1);
    let focus = cameras::focus(&calibration, 0.01);
    let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
    let correction = GriddedCorrection::exposed(polynomial, &none, &motion, 1e-4);
    assert_eq!(
        correction.left_out_nm().to_bits(),
        polynomial.left_out_nm().to_bits()
    );
    for point in cameras::grid(&calibration, 41) {
        assert_eq!(correction.correct(point), polynomial.correct(point));
        assert_eq!(correction.distort(point), polynomial.distort(point));
    }
    let row = row(8);
    let [mut with, mut without] = [[Displacement::default(); 400]; 2];
    let mesh = SourceMesh::new(&correction, row.spacing_px);
    assert!(mesh.block_length().is_some());
    row.sources(&mesh, &mut with).unwrap();
    row.sources(&SourceMesh::new(&polynomial, row.spacing_px), &mut without)
        .unwrap();
    assert_eq!(with, without);
}

/// Returns a row of 400 vertices, some of them up to a spacing beyond the right edge.
fn row(spacing_px: u16) -> VertexRow {
    VertexRow {
        first_col_px: 14204 - 399 * u32::from(spacing_px),
        row_px: 3001,
        spacing_px,
        count: 400,
        origin_px: [0, 0],
    }
}

#[test]
fn sources_of_a_mesh_are_what_distort_finds() {
    let files = files();
    let calibration = Calibration::new(parameters(FmcAxis::PlusY)).unwrap();
    let motion = motion(0.15, 0.1);
    let focus = cameras::focus(&calibration, 0.01);
    let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
    let sensor = calibration.sensor();
    for grids in combinations(&calibration, &files) {
        let correction =
            GriddedCorrection::exposed(polynomial, &grids, &motion, focus.enlargement());
        let row = row(16);
        let mesh = SourceMesh::new(&correction, row.spacing_px);
        assert_eq!((mesh.block_length(), mesh.bound_nm()), (None, None));
        let mut sources = [Displacement::default(); 400];
        let sources = row.sources(&mesh, &mut sources).unwrap();
        let mut compared = 0;
        for (index, found) in (0_u16..).zip(&*sources) {
            let col_px = row.first_col_px + u32::from(index) * u32::from(row.spacing_px);
            let ideal = sensor.sensor_from_pixel(fmc_camera::geometry::sensor::PixelPoint {
                col_px: f32::from(u16::try_from(col_px).unwrap()),
                row_px: 3001.0,
            });
            let Ok(measured) = correction.distort(ideal) else {
                continue;
            };
            let expected = [measured.distortion.dx_mm, measured.distortion.dy_mm];
            let difference_nm = error_nm(*found, expected.map(f64::from));
            // Both leave something, and the fold may drop terms.
            assert!(difference_nm <= 0.3, "{difference_nm} nm at {ideal:?}");
            compared += 1;
        }
        assert!(compared > 380, "{compared} vertices");
        let mut bytes = [0; 4 * 400];
        let words = row
            .write_words(&mesh, MeshFormat::S16Q3, &mut bytes)
            .unwrap();
        let singly: Vec<u8> = row
            .words(&correction, MeshFormat::S16Q3)
            .flat_map(|word| word.unwrap())
            .collect();
        assert_eq!(words.len(), singly.len());
    }
}

#[test]
fn point_that_is_no_number_stays_one_and_has_no_measured_point() {
    let files = files();
    let calibration = Calibration::new(parameters(FmcAxis::PlusY)).unwrap();
    let still = FrameCorrection::without_motion(&calibration);
    for grids in combinations(&calibration, &files) {
        let correction = GriddedCorrection::calibrated(still, &grids);
        for point in [(f32::NAN, 0.0), (0.0, f32::NAN), (f32::INFINITY, 0.0)] {
            let point = SensorPoint::new(point.0, point.1);
            let answer = correction.correct(point);
            assert!(!(answer.point.x_mm + answer.point.y_mm).is_finite());
            assert!(correction.distort(point).is_err());
        }
    }
}

#[test]
fn frame_of_the_static_model_has_the_grid_of_the_lens_where_it_was_calibrated() {
    let files = files();
    let parameters = parameters(FmcAxis::PlusY);
    let camera = Camera::new(CameraParameters::new(parameters)).unwrap();
    let motion = motion(0.5, 0.1);
    for grids in combinations(camera.calibration(), &files) {
        let frame = |model| {
            let exposure = Exposure {
                model,
                ..Exposure::new(0.1, 0.01)
            };
            let frame = camera.frame_of(&exposure, &motion).unwrap();
            (frame, GriddedFrame::new(&frame, &grids))
        };
        let (plain, still) = frame(CorrectionModel::Static);
        let calibrated = GriddedCorrection::calibrated(plain.correction, &grids);
        assert_eq!(still.correction, calibrated);
        let left_out_nm = still.interior.left_out_nm;
        assert!((left_out_nm - calibrated.left_out_nm()).abs() <= 0.0);
        let (_, moved) = frame(CorrectionModel::Exact);
        let point = SensorPoint::new(3.1, -7.7);
        let is_moved = still.correction.residual(point) != moved.correction.residual(point);
        assert_eq!(is_moved, grids.lens().is_some());
    }
}
