//! Contenders that are timed: the kernel in all its forms, a copy of the same bytes, and another
//! crate.

use std::hint::black_box;

use cam_geom::{IntrinsicParameters as _, coordinate_system::CameraFrame};
use fmc_camera_kernel::inverse::LastStep;
use fmc_camera_kernel::portable;
use fmc_camera_kernel::{
    Terms,
    host::{Batch, Level},
};
use nalgebra::{Dyn, OMatrix, U2, U3};
use opencv_ros_camera::{Distortion, RosOpenCvIntrinsics, UndistortedPixels};

use crate::form::FORM;
use crate::points::Points;
use crate::timing::Contender;

/// Names of the copies of separate x and y, and of pairs.
const COPY_XY: &str = "memcpy x, y";
const COPY_PAIRS: &str = "memcpy pairs";

/// Returns all contenders, on the same points.
pub(crate) fn all(points: &Points) -> Vec<Contender<'_>> {
    let mut all = vec![
        Contender::new(COPY_XY, COPY_XY, || {
            let mut answers = points.answers.borrow_mut();
            answers.x.copy_from_slice(black_box(&points.x));
            answers.y.copy_from_slice(black_box(&points.y));
            black_box(&mut *answers);
        }),
        Contender::new(COPY_PAIRS, COPY_PAIRS, || {
            let mut answers = points.answers.borrow_mut();
            answers.pairs.copy_from_slice(black_box(&points.pairs));
            black_box(&mut *answers);
        }),
    ];
    for level in Level::all() {
        for (terms, name) in [(Terms::Short, "short"), (Terms::Full, "full")] {
            let batch = Batch::new(FORM, terms).at(level).in_one_thread();
            all.extend(of_batch(points, batch, &format!("{level} {name}")));
        }
        let short = Batch::new(FORM, Terms::Short).at(level);
        all.push(distorted(points, short, &format!("{level} distort x, y")));
    }
    let widest = Level::widest();
    let short = Batch::new(FORM, Terms::Short);
    let stored = short.in_one_thread().streamed_from(usize::MAX);
    all.push(xy_into(
        points,
        stored,
        &format!("{widest} short x, y, stored"),
    ));
    let streamed = short.in_one_thread().streamed_from(0);
    all.push(xy_into(
        points,
        streamed,
        &format!("{widest} short x, y, streamed"),
    ));
    let threads = short.threaded_from(0);
    all.push(xy_into(
        points,
        threads,
        &format!("{widest} short x, y, threads"),
    ));
    all.push(Contender::new(
        "portable short pairs in place",
        COPY_PAIRS,
        || {
            let mut answers = points.answers.borrow_mut();
            portable::short_pairs(black_box(&FORM), &mut answers.pairs);
            black_box(&mut *answers);
        },
    ));
    all.extend(other_crate(points));
    all.extend(cold(points));
    all
}

/// Returns a batch in its four layouts.
fn of_batch<'a>(points: &'a Points, batch: Batch, name: &str) -> [Contender<'a>; 4] {
    [
        xy_into(points, batch, &format!("{name} x, y")),
        Contender::new(format!("{name} x, y in place"), COPY_XY, move || {
            let mut answers = points.answers.borrow_mut();
            let answers = &mut *answers;
            batch.xy(&mut answers.x, &mut answers.y);
            black_box(answers);
        }),
        Contender::new(format!("{name} pairs"), COPY_PAIRS, move || {
            let mut answers = points.answers.borrow_mut();
            batch.pairs_into(black_box(&points.pairs), &mut answers.pairs);
            black_box(&mut *answers);
        }),
        Contender::new(format!("{name} pairs in place"), COPY_PAIRS, move || {
            let mut answers = points.answers.borrow_mut();
            batch.pairs(&mut answers.pairs);
            black_box(&mut *answers);
        }),
    ]
}

/// Returns the way back of a batch, with distortions: all points end with the first step.
fn distorted<'a>(points: &'a Points, batch: Batch, name: &str) -> Contender<'a> {
    let last_step = LastStep {
        longest2_mm2: 1e-6,
        farthest_mm: [200.0, 200.0],
    };
    Contender::new(name, COPY_XY, move || {
        let mut answers = points.answers.borrow_mut();
        let answers = &mut *answers;
        let all_end = batch.xy_distorted(
            black_box(&last_step),
            [black_box(&points.x), black_box(&points.y)],
            [&mut answers.x, &mut answers.y],
            [&mut answers.dx, &mut answers.dy],
        );
        assert!(all_end, "the bench has no point off the sensor");
        black_box(answers);
    })
}

fn xy_into<'a>(points: &'a Points, batch: Batch, name: &str) -> Contender<'a> {
    Contender::new(name, COPY_XY, move || {
        let mut answers = points.answers.borrow_mut();
        let answers = &mut *answers;
        batch.xy_into(
            [black_box(&points.x), black_box(&points.y)],
            [&mut answers.x, &mut answers.y],
        );
        black_box(answers);
    })
}

/// Returns both directions, and a copy, of points that no cache holds.
fn cold(points: &Points) -> [Contender<'_>; 3] {
    let short = Batch::new(FORM, Terms::Short).in_one_thread();
    let widest = Level::widest();
    let copy = Contender::new(COPY_XY, "", || {
        let mut answers = points.answers.borrow_mut();
        answers.x.copy_from_slice(black_box(&points.x));
        answers.y.copy_from_slice(black_box(&points.y));
        black_box(&mut *answers);
    });
    [
        copy,
        xy_into(points, short, &format!("{widest} short x, y")),
        distorted(points, short, &format!("{widest} distort x, y")),
    ]
    .map(Contender::cold)
}

/// Returns the crate `opencv-ros-camera`, in double precision: the correction of pixels by five
/// iterations, its polynomial the other way, and directions through it to pixels.
fn other_crate(points: &Points) -> [Contender<'_>; 3] {
    let distortion =
        Distortion::from_opencv_vec(nalgebra::Vector5::new(-0.1, 0.05, 1e-4, 1e-4, 0.01));
    let (focal_px, centre_px) = (18_857.0, 4_607.5);
    let camera = RosOpenCvIntrinsics::from_params_with_distortion(
        focal_px, 0.0, focal_px, centre_px, centre_px, distortion,
    );
    let count = points.pairs.len();
    let mm = |row: usize, column: usize| {
        let mm = points.pairs.get(row).and_then(|point| point.get(column));
        f64::from(mm.copied().unwrap_or_default())
    };
    let places = OMatrix::<f64, Dyn, U2>::from_fn(count, |row, column| {
        centre_px + mm(row, column) / 0.00875
    });
    let rays = OMatrix::<f64, Dyn, U3>::from_fn(count, |row, column| match column {
        0 | 1 => mm(row, column) / 0.00875 / focal_px,
        _ => 1.0,
    });
    let rays = cam_geom::Points::<CameraFrame, f64, _, _>::new(rays);
    let measured = cam_geom::Pixels::new(places.clone());
    let ideal = UndistortedPixels { data: places };
    let cameras = [camera.clone(), camera.clone(), camera];
    let [undistorting, distorting, projecting] = cameras;
    [
        Contender::new("opencv-ros-camera undistort", "", move || {
            black_box(undistorting.undistort(black_box(&measured)));
        }),
        Contender::new("opencv-ros-camera distort", "", move || {
            black_box(distorting.distort(black_box(&ideal)));
        }),
        Contender::new("opencv-ros-camera project", "", move || {
            black_box(projecting.camera_to_pixel(black_box(&rays)));
        }),
    ]
}
