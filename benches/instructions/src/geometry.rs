//! Geometry: points and frames.

use core::hint::black_box;

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::geometry::frame_correction::Terms;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::{Camera, Exposure, FrameCorrection};

use crate::counter::Counter;
use crate::fold::frames;
use crate::specimen::{self, EXPOSURE, POINTS, full, points, short, strong};

/// Points per call, unless all points are in one call.
const BATCH: usize = 256;
/// Repetitions of work that is done once per frame.
const FRAMES: u32 = 100;
const PER_FRAME: (u32, &str) = (FRAMES, "frame");
#[expect(clippy::cast_possible_truncation, reason = "1024 points")]
const PER_POINT: (u32, &str) = (POINTS as u32, "point");
pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let parameters = short();
    let camera = Camera::new(parameters).ok()?;
    let correction = camera.frame(&EXPOSURE).ok()?.correction;
    let full = Camera::new(full()).ok()?.frame(&EXPOSURE).ok()?.correction;
    if (correction.terms(), full.terms()) != (Terms::Short, Terms::Full) {
        return None;
    }
    slice::<POINTS>(counter, "correct_slice", &correction)?;
    slice::<POINTS>(counter, "correct_slice_full", &full)?;
    slice::<BATCH>(counter, "correct_slice_256", &correction)?;
    slice::<BATCH>(counter, "correct_slice_full_256", &full)?;
    slice_xy(counter, "correct_slice_xy", &correction)?;
    slice_xy(counter, "correct_slice_xy_full", &full)?;
    single(counter, "correct", &correction)?;
    single(counter, "correct_full", &full)?;
    distort(counter, "distort", &correction)?;
    distort(counter, "distort_full", &full)?;
    let strong = Camera::new(strong()).ok()?.frame(&EXPOSURE).ok()?;
    distort(counter, "distort_strong", &strong.correction)?;
    distort_slice(counter, "distort_slice", &correction)?;
    distort_slice(counter, "distort_slice_full", &full)?;
    fold(counter, "frame_fold", &camera, EXPOSURE)?;
    let still = Exposure {
        model: CorrectionModel::Static,
        ..EXPOSURE
    };
    fold(counter, "frame_fold_static", &camera, still)?;
    for (kernel, parameters) in [
        ("calibration", parameters),
        ("calibration_strong", specimen::strong()),
    ] {
        counter.count(kernel, (1, "calibration"), || {
            Camera::new(black_box(parameters)).ok()
        })?;
    }
    Some(())
}

/// Counts the hot path: points replaced in place, `LENGTH` per call.
fn slice<const LENGTH: usize>(
    counter: &mut Counter,
    kernel: &str,
    correction: &FrameCorrection,
) -> Option<()> {
    let mut points = points();
    counter.count(kernel, PER_POINT, || {
        for slice in points.chunks_mut(LENGTH) {
            black_box(correction).correct_slice(black_box(slice));
        }
        Some(())
    })?;
    black_box(points);
    Some(())
}

/// Counts the hot path with separate x and y.
fn slice_xy(counter: &mut Counter, kernel: &str, correction: &FrameCorrection) -> Option<()> {
    let mut x = points().map(|point| point.x_mm);
    let mut y = points().map(|point| point.y_mm);
    counter.count(kernel, PER_POINT, || {
        let (x, y) = black_box((&mut x, &mut y));
        black_box(correction).correct_slice_xy(x, y).ok()
    })?;
    black_box((x, y));
    Some(())
}

/// Counts one point after the other, with the distortion.
fn single(counter: &mut Counter, kernel: &str, correction: &FrameCorrection) -> Option<()> {
    let points = points();
    counter.count(kernel, PER_POINT, || {
        for point in black_box(&points) {
            black_box(black_box(correction).correct(*point));
        }
        Some(())
    })
}

fn distort(counter: &mut Counter, kernel: &str, correction: &FrameCorrection) -> Option<()> {
    let points: [SensorPoint; POINTS] = points();
    counter.count(kernel, PER_POINT, || {
        for point in black_box(&points) {
            black_box(black_box(correction).distort(*point).ok()?);
        }
        Some(())
    })
}

/// Counts points replaced in place by their measured ones.
fn distort_slice(counter: &mut Counter, kernel: &str, correction: &FrameCorrection) -> Option<()> {
    let mut points = points();
    counter.count(kernel, PER_POINT, || {
        let points = black_box(points.as_mut_slice());
        black_box(correction).distort_slice(points).ok()
    })?;
    black_box(points);
    Some(())
}

/// Counts the conversion of an exposure into coefficients.
fn fold(counter: &mut Counter, kernel: &str, camera: &Camera, exposure: Exposure) -> Option<()> {
    counter.count(kernel, PER_FRAME, || frames(camera, &exposure, FRAMES))
}
