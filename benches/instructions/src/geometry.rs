//! Points and frames.

use core::hint::black_box;

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::Kernel;
use fmc_camera::geometry::mesh::displacement_rows::{DisplacementRows, RESTART_INTERVAL};
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::source_row::SourceRow;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::{Camera, Exposure, FrameCorrection};

use crate::counter::Counter;
use crate::specimen::{self, EXPOSURE, POINTS, full, points, short, strong};

/// Points to a call where it is not all of them.
const BATCH: usize = 256;
/// Repetitions of what is done once per frame.
const FRAMES: u32 = 100;
const PER_FRAME: (u32, &str) = (FRAMES, "frame");
#[expect(clippy::cast_possible_truncation, reason = "1024 points")]
const PER_POINT: (u32, &str) = (POINTS as u32, "point");
/// Every eighth pixel of 3.76 µm: 30.8 mm of the sensor.
const MESH_STEP_MM: f32 = 8.0 * 0.00376;
const ROW_START: SensorPoint = SensorPoint::new(-26.0, 15.0);

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let record = short();
    let camera = Camera::new(record).ok()?;
    let correction = camera.frame(&EXPOSURE).ok()?.correction;
    let full = Camera::new(full()).ok()?.frame(&EXPOSURE).ok()?.correction;
    if (correction.kernel(), full.kernel()) != (Kernel::Short, Kernel::Full) {
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
    mesh_rows(counter)?;
    source_rows(counter, &correction)?;
    let still = Exposure {
        model: CorrectionModel::Static,
        ..EXPOSURE
    };
    fold(counter, "frame_fold_static", &camera, still)?;
    for (kernel, record) in [
        ("calibration", record),
        ("calibration_strong", specimen::strong()),
    ] {
        counter.count(kernel, (1, "calibration"), || {
            Camera::new(black_box(record)).ok()
        })?;
    }
    Some(())
}

/// The hot path: points replaced in place, so many to a call.
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

/// The same with x and y apart.
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

/// One point after the other, with the distortion.
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

/// Points replaced in place by their measured ones.
fn distort_slice(counter: &mut Counter, kernel: &str, correction: &FrameCorrection) -> Option<()> {
    let mut points = points();
    counter.count(kernel, PER_POINT, || {
        let points = black_box(points.as_mut_slice());
        black_box(correction).distort_slice(points).ok()
    })?;
    black_box(points);
    Some(())
}

/// An exposure into coefficients.
fn fold(counter: &mut Counter, kernel: &str, camera: &Camera, exposure: Exposure) -> Option<()> {
    counter.count(kernel, PER_FRAME, || {
        for _ in 0..FRAMES {
            black_box(black_box(camera).frame(black_box(&exposure)).ok()?);
        }
        Some(())
    })
}

/// Displacements along rows of the measured image: without K3, with it, and all terms.
fn mesh_rows(counter: &mut Counter) -> Option<()> {
    let mut without_k3 = short();
    without_k3.calibration.distortion.k3 = 0.0;
    for (kernel, record) in [
        ("mesh_row", without_k3),
        ("mesh_row_k3", short()),
        ("mesh_row_k3_full", full()),
    ] {
        let correction = Camera::new(record).ok()?.frame(&EXPOSURE).ok()?.correction;
        let rows = DisplacementRows::new(&correction, MESH_STEP_MM);
        // The differences start anew as seldom as they ever do.
        (rows.restart_interval() == RESTART_INTERVAL.get()).then_some(())?;
        let mut row = [Displacement::default(); POINTS];
        counter.count(kernel, PER_POINT, || {
            black_box(&rows)
                .row(black_box(ROW_START))
                .write(black_box(&mut row));
            Some(())
        })?;
        black_box(row);
    }
    let correction = Camera::new(full()).ok()?.frame(&EXPOSURE).ok()?.correction;
    counter.count("mesh_row_setup", (FRAMES, "row"), || {
        let rows = DisplacementRows::new(&correction, MESH_STEP_MM);
        for _ in 0..FRAMES {
            black_box(black_box(&rows).row(black_box(ROW_START)));
        }
        Some(())
    })?;
    counter.count("mesh_rows_setup", PER_FRAME, || {
        for _ in 0..FRAMES {
            black_box(DisplacementRows::new(black_box(&correction), MESH_STEP_MM));
        }
        Some(())
    })
}

/// Sources along a row of the ideal image, and vertices as a warp engine stores them.
fn source_rows(counter: &mut Counter, correction: &FrameCorrection) -> Option<()> {
    counter.count("mesh_source_row", PER_POINT, || {
        let mut row = SourceRow::new(black_box(correction));
        let mut x_mm = ROW_START.x_mm;
        for _ in 0..POINTS {
            black_box(row.next(SensorPoint::new(x_mm, ROW_START.y_mm)).ok()?);
            x_mm += MESH_STEP_MM;
        }
        Some(())
    })?;
    for (kernel, format) in [
        ("mesh_words_s16q3", MeshFormat::S16Q3),
        ("mesh_words_single", MeshFormat::Single),
    ] {
        let row = VertexRow {
            first_col_px: 8,
            row_px: 800,
            spacing_px: 8,
            count: 1024,
            origin_px: [0, 0],
        };
        counter.count(kernel, PER_POINT, || {
            for word in black_box(&row).words(black_box(correction), format) {
                black_box(word.ok()?);
            }
            Some(())
        })?;
    }
    Some(())
}
