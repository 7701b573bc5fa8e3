//! Correction and distortion of points, as pairs and with x and y apart.

use core::slice;

use fmc::geometry::frame_correction::FrameCorrection;
use fmc::geometry::sensor::SensorPoint;

use crate::FMC_OK;
use crate::camera::fmc_camera;
use crate::error::{fmc_error, fmc_status};
use crate::frame::{fmc_frame, unchanged};
use crate::memory::{self, Extent};
use crate::refusal::{Refusal, of_point};

/// A point of the sensor: x right, y up from the centre of the pixel array, mm.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fmc_point {
    /// x, mm.
    pub x_mm: f32,
    /// y, mm.
    pub y_mm: f32,
}

const _: () = assert!(size_of::<fmc_point>() == size_of::<SensorPoint>());
const _: () = assert!(align_of::<fmc_point>() == align_of::<SensorPoint>());

/// Replaces measured points by their ideal points, every one for itself. Points beyond the sensor
/// are extrapolated, and a NaN stays a NaN. `count` may be 0; then `points` may be anything.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
/// `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_correct(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    points: *mut fmc_point,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let extent = Extent::of(points, count, 3);
    // SAFETY: the caller's promise.
    if let Some((of_camera, of_frame)) = unsafe { memory::holding_both(camera, frame) }
        && of_camera.stamp == of_frame.stamp
        && memory::is_placed(points, count, extent)
        && extent.is_apart_from(Extent::of(camera, 1, 1))
        && extent.is_apart_from(Extent::of(frame, 1, 2))
    {
        // SAFETY: the pointer has been checked, and the caller owns the points, which are two
        // numbers in both types.
        let points = unsafe { slice::from_raw_parts_mut(points.cast::<SensorPoint>(), count) };
        of_frame.object.correction.correct_slice(points);
        return FMC_OK;
    }
    // SAFETY: the caller's promise.
    unsafe { not_corrected(camera, frame, points, count, error) }
}

/// Finds out why `fmc_correct` has not corrected points.
///
/// # Safety
/// As of `fmc_correct`.
#[cold]
#[inline(never)]
unsafe fn not_corrected(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    points: *mut fmc_point,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let found = || {
        // SAFETY: the caller's promise.
        let (correction, points) = unsafe { pairs(camera, frame, points, count) }?;
        // There are none, or they are refused.
        correction.correct_slice(points);
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(found(), error) }
}

/// Does the same as `fmc_correct` for separate coordinates.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
/// to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_correct_xy(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    x_mm: *mut f32,
    y_mm: *mut f32,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let corrected = || {
        // SAFETY: the caller's promise.
        let correction = unsafe { correction(camera, frame) }?;
        // SAFETY: the caller's promise.
        let [x, y] = unsafe { coordinates(camera, frame, [x_mm, y_mm], count) }?;
        // They are as long as each other.
        let _ = correction.correct_slice_xy(x, y);
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(corrected(), error) }
}

/// Replaces ideal points by their measured points, which must be on the sensor. If one has none,
/// the error holds its index: those before it have been replaced, it and those behind have not.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
/// `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_distort(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    points: *mut fmc_point,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let distorted = || {
        // SAFETY: the caller's promise.
        let (correction, points) = unsafe { pairs(camera, frame, points, count) }?;
        let refused = |refused: fmc::geometry::inverse::DistortSliceError| {
            of_point(refused.error, refused.index)
        };
        correction.distort_slice(points).map_err(refused)
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(distorted(), error) }
}

/// Does the same as `fmc_distort` for separate coordinates.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
/// to `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_distort_xy(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    x_mm: *mut f32,
    y_mm: *mut f32,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let distorted = || {
        // SAFETY: the caller's promise.
        let correction = unsafe { correction(camera, frame) }?;
        // SAFETY: the caller's promise.
        let [x, y] = unsafe { coordinates(camera, frame, [x_mm, y_mm], count) }?;
        for (index, (x_mm, y_mm)) in x.iter_mut().zip(y).enumerate() {
            let measured = correction.distort(SensorPoint::new(*x_mm, *y_mm));
            let measured = measured.map_err(|error| of_point(error, index))?;
            (*x_mm, *y_mm) = (measured.point.x_mm, measured.point.y_mm);
        }
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(distorted(), error) }
}

/// Returns the correction of a frame of a camera, arguments 1 and 2.
///
/// # Safety
/// As of the functions above.
#[inline]
unsafe fn correction<'a>(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
) -> Result<&'a FrameCorrection, Refusal> {
    // SAFETY: the caller's promise.
    let (camera, frame) = unsafe { (memory::kept(camera, 1)?, memory::kept(frame, 2)?) };
    unchanged(frame, camera, 2)?;
    Ok(&frame.object.correction)
}

/// Returns the correction of a frame of a camera, and points, argument 3.
///
/// # Safety
/// As of the functions above.
#[inline(never)]
unsafe fn pairs<'a>(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    points: *mut fmc_point,
    count: usize,
) -> Result<(&'a FrameCorrection, &'a mut [SensorPoint]), Refusal> {
    // SAFETY: the caller's promise.
    let correction = unsafe { correction(camera, frame) }?;
    let points = points.cast::<SensorPoint>();
    apart(camera, frame, Extent::of(points, count, 3))?;
    // SAFETY: the caller's promise; both types are two numbers.
    let points = unsafe { memory::elements_mut(points, count, 3) }?;
    Ok((correction, points))
}

/// Checks that points share no memory with camera and frame.
#[inline]
fn apart(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    points: Extent,
) -> Result<(), Refusal> {
    points.apart_from(Extent::of(camera, 1, 1))?;
    points.apart_from(Extent::of(frame, 1, 2))
}

/// Returns separate coordinates, arguments 3 and 4.
///
/// # Safety
/// As of the functions above.
unsafe fn coordinates<'a>(
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    [x_mm, y_mm]: [*mut f32; 2],
    count: usize,
) -> Result<[&'a mut [f32]; 2], Refusal> {
    let [x, y] = [(x_mm, 3), (y_mm, 4)].map(|(mm, argument)| Extent::of(mm, count, argument));
    apart(camera, frame, x)?;
    apart(camera, frame, y)?;
    y.apart_from(x)?;
    // SAFETY: the caller's promise, and they are apart.
    let x = unsafe { memory::elements_mut(x_mm, count, 3) }?;
    // SAFETY: the caller's promise, and they are apart.
    let y = unsafe { memory::elements_mut(y_mm, count, 4) }?;
    Ok([x, y])
}
