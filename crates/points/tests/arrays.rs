//! Arrays of points against the correction of a single one.

#![expect(
    clippy::float_cmp,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    reason = "a test may panic, and compares bits"
)]

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_frames::table::{self, GivenExposure};
use fmc_frames::{FrameCamera, FrameTable};
use fmc_points::{
    Answer, Answers, ColumnPoints, Coordinate, CorrectionKernel, Direction, Flag, Flight,
    FlightCamera, FlightPoints, FrameCorrections, FramePoints, OffSensor, PointError, Points,
    PointsMut, Unit, left_out,
};

const CAMERA: &str = include_str!("../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");
const EXPOSURES: &str = "sequence,vh,exposure\n3,0.17,1/200\n5,0.05,1/500\n8,0.1,1/100\n";

/// A flight of three frames.
struct Flown {
    file: CameraFile,
    camera: FrameCamera,
    table: FrameTable,
    corrections: FrameCorrections,
}

impl Flown {
    fn new() -> Self {
        let (file, _) = CameraFile::parse("camera.toml", CAMERA).unwrap();
        let camera = FrameCamera::new("camera.toml", &file).unwrap();
        let given = GivenExposure::default();
        let table = FrameTable::collect(|each| {
            table::read_from("exposures.csv", EXPOSURES.as_bytes(), &camera, &given, each)
        });
        Self {
            file,
            camera,
            table: table.unwrap(),
            corrections: FrameCorrections::default(),
        }
    }

    /// Hands the flight to `use_it`.
    fn with<R>(&self, use_it: impl FnOnce(Flight<'_>) -> R) -> R {
        let grids = self.camera.grids().unwrap();
        use_it(Flight {
            camera: FlightCamera {
                calibration: self.camera.calibration(),
                grids: &grids,
                principal_point_mm: self.file.principal_point_mm,
            },
            table: &self.table,
            corrections: &self.corrections,
        })
    }

    /// Hands what is asked of the points of one frame to `use_it`.
    fn with_frame<R>(
        &self,
        place: usize,
        direction: Direction,
        unit: Unit,
        use_it: impl FnOnce(FramePoints<'_>) -> R,
    ) -> R {
        let grids = self.camera.grids().unwrap();
        let calibration = self.camera.calibration();
        let row = &self.table.rows()[place];
        let correction = row.correction(calibration).unwrap();
        let terms = left_out(calibration, &correction, row.model().unwrap(), &row.motion);
        let gridded = row.gridded(calibration, &grids).unwrap();
        use_it(FramePoints {
            kernel: CorrectionKernel::new(gridded, terms),
            direction,
            off_sensor: OffSensor::Extrapolate,
            unit,
            file: &self.file,
        })
    }

    /// Returns the answer of the library to one point.
    fn answer(&self, place: usize, direction: Direction, [x, y]: [f32; 2]) -> [f32; 2] {
        let correction = self.table.rows()[place]
            .correction(self.camera.calibration())
            .unwrap();
        let given = SensorPoint::new(x, y);
        let point = match direction {
            Direction::Correct => correction.correct(given).point,
            Direction::Distort => correction.distort(given).unwrap().point,
        };
        [point.x_mm, point.y_mm]
    }
}

/// Points over the sensor, by a sequence that fills it evenly.
fn points(count: u16) -> Vec<[f32; 2]> {
    let place = |i: u16, ratio: f32| 36.0 * ((f32::from(i) * ratio).fract() - 0.5);
    let points = (0..count).map(|i| [place(i, 0.754_877_7), place(i, 0.569_840_3)]);
    points.collect()
}

fn doubles(points: &[[f32; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|point| point.map(f64::from)).collect()
}

fn written<T: Coordinate>(of: &[[T; 2]], write: impl FnOnce(Answers<'_>)) -> Vec<[T; 2]> {
    let mut to = vec![[T::NAN; 2]; of.len()];
    write(T::answers(of, &mut to));
    to
}

#[test]
fn answers_in_single_precision_have_the_bits_of_the_camera() {
    let flown = Flown::new();
    for direction in [Direction::Correct, Direction::Distort] {
        // Few points are computed one by one, many in blocks with a rest.
        for count in [3, 1500] {
            let points = points(count);
            let expected: Vec<_> = points
                .iter()
                .map(|point| flown.answer(0, direction, *point))
                .collect();
            flown.with_frame(0, direction, Unit::Millimetres, |frame| {
                assert_eq!(written(&points, |answers| frame.write(answers)), expected);
                let mut replaced = points.clone();
                frame.replace(PointsMut::Single(&mut replaced));
                assert_eq!(replaced, expected);
            });
        }
    }
}

#[test]
fn coordinates_in_double_precision_keep_their_digits() {
    const STEP_MM: f64 = 1e-8;
    let flown = Flown::new();
    flown.with_frame(0, Direction::Correct, Unit::Millimetres, |frame| {
        // The step is a hundredth of the last digit in single precision, or less.
        let points: Vec<_> = points(600)
            .into_iter()
            .filter(|[x, _]| x.abs() > 4.0)
            .collect();
        let points = doubles(&points);
        assert!(points.len() > 400);
        let beside: Vec<_> = points.iter().map(|[x, y]| [x + STEP_MM, *y]).collect();
        let answers = written(&points, |answers| frame.write(answers));
        let answers_beside = written(&beside, |answers| frame.write(answers));
        // Both have the distortion of one point in single precision; 1e-13 is rounding.
        for ([x, y], [x_beside, y_beside]) in answers.iter().zip(answers_beside) {
            assert!((x_beside - x - STEP_MM).abs() < 1e-13);
            assert!((y_beside - y).abs() < 1e-13);
        }
    });
}

#[test]
fn pixels_are_answered_as_the_millimetres_that_they_are() {
    let flown = Flown::new();
    let points = doubles(&points(700));
    let pixels: Vec<_> = points
        .iter()
        .map(|point| flown.file.pixel_from_sensor(*point))
        .collect();
    let [in_mm, in_px] =
        [(&points, Unit::Millimetres), (&pixels, Unit::Pixels)].map(|(points, unit)| {
            flown.with_frame(1, Direction::Correct, unit, |frame| {
                written(points, |answers| frame.write(answers))
            })
        });
    for (mm, px) in in_mm.iter().zip(in_px) {
        let [x, y] = flown.file.sensor_from_pixel(px);
        // 0.1 pm: what the conversion of pixels rounds.
        assert!((x - mm[0]).abs() < 1e-10 && (y - mm[1]).abs() < 1e-10);
    }
}

#[test]
fn points_of_many_frames_are_answered_as_those_of_each() {
    let flown = Flown::new();
    let points = points(900);
    // Runs of every length, and single points.
    let index: Vec<i64> = (0..900_i64).map(|i| (i * i / 700) % 3).collect();
    for direction in [Direction::Correct, Direction::Distort] {
        let expected: Vec<_> = points
            .iter()
            .zip(&index)
            .map(|(point, place)| flown.answer(usize::try_from(*place).unwrap(), direction, *point))
            .collect();
        flown.with(|flight| {
            let work = FlightPoints {
                flight,
                index: &index,
                direction,
                answer: Answer::Ideal,
                off_sensor: OffSensor::Extrapolate,
                each: 1,
            };
            work.check(Points::Single(&points)).unwrap();
            assert_eq!(written(&points, |answers| work.write(0, answers)), expected);
            // The second part of an array has its own part of the index.
            let mut rest = points[400..].to_vec();
            work.replace(400, PointsMut::Single(&mut rest));
            assert_eq!(rest, expected[400..]);
        });
    }
}

#[test]
fn columns_tell_why_a_point_has_no_answer() {
    let flown = Flown::new();
    flown.with(|flight| {
        let columns = ColumnPoints {
            flight,
            direction: Direction::Correct,
            answer: Answer::Ideal,
        };
        let (x, y) = ([1.0_f32, 500.0, 1.0, f32::NAN], [2.0_f32; 4]);
        let answers = columns.singles([&x, &y], &[2, 2, 7, 0]).unwrap();
        let flags = [
            Flag::Answered,
            Flag::OffSensor,
            Flag::NoFrame,
            Flag::Answered,
        ];
        assert_eq!(answers.flags, flags.map(|flag| flag as u8));
        assert_eq!(
            [answers.x[0], answers.y[0]],
            flown.answer(2, Direction::Correct, [1.0, 2.0])
        );
        assert!(
            answers.x[1..]
                .iter()
                .chain(&answers.y[1..])
                .all(|number| number.is_nan())
        );
    });
}

#[test]
fn index_beyond_the_frames_and_point_off_the_sensor_are_named() {
    let flown = Flown::new();
    let points = [[1.0_f64, 2.0], [500.0, 2.0]];
    flown.with(|flight| {
        let mut work = FlightPoints {
            flight,
            index: &[0, 3],
            direction: Direction::Correct,
            answer: Answer::Ideal,
            off_sensor: OffSensor::Error,
            each: 1,
        };
        let error = work.check(Points::Double(&points)).unwrap_err();
        let sentence = "index[1] = 3: must be a place among 3 frames, from 0";
        assert_eq!(error.to_string(), sentence);
        work.index = &[0, 2];
        let error = work.check(Points::Double(&points)).unwrap_err();
        let expected = PointError::OffSensor {
            index: 1,
            point_mm: [500.0, 2.0],
        };
        assert_eq!(error, expected);
        assert_eq!(error.to_string(), "points[1] = (500, 2) mm: off the sensor");
    });
}
