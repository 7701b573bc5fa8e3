//! The frame of an exposure: interior orientation, and correction of its points.

use fmc::flight::camera::{Camera, Frame};
use fmc::flight::interior_orientation::InteriorOrientation;

use crate::FMC_ERROR_CAMERA_CHANGED;
use crate::camera::fmc_camera;
use crate::code::{self, fmc_code};
use crate::error::{fmc_error, fmc_status};
use crate::exposure::fmc_exposure;
use crate::memory::{self, Extent, Kept, Storage};
use crate::refusal::{Failure, Refusal};

/// Words of a frame.
pub const FMC_FRAME_WORDS: usize = 24;

/// A frame, in storage of the caller; it may be copied.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_frame {
    /// Words of the library alone.
    pub opaque: [u64; FMC_FRAME_WORDS],
}

impl Storage for fmc_frame {
    type Object = Frame;
    const LETTERS: [u8; 4] = *b"fram";
}

/// Checks that an object is of the calibration that the camera has.
#[inline]
pub(crate) fn unchanged<T>(
    kept: &Kept<T>,
    camera: &Kept<Camera>,
    argument: u32,
) -> Result<(), Refusal> {
    if kept.stamp != camera.stamp {
        return Err(changed(kept.stamp, camera.stamp, argument));
    }
    Ok(())
}

#[cold]
#[inline(never)]
fn changed(found: u32, expected: u32, argument: u32) -> Refusal {
    Failure::of_argument(FMC_ERROR_CAMERA_CHANGED, argument)
        .numbers(found, expected)
        .into()
}

/// Interior orientation of a frame. Offsets are along the FMC axis, from the calibrated position.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct fmc_interior {
    /// V/H used, 1/s.
    pub vh_per_s: f32,
    /// Exposure time, s.
    pub exposure_s: f32,
    /// Offset of the principal point when the shutter opens, mm.
    pub opening_offset_mm: f32,
    /// Travel of the principal point while the shutter is open, mm.
    pub travel_mm: f32,
    /// Time of the centroid after opening, s.
    pub centroid_time_s: f32,
    /// Offset of the principal point at the centroid, mm.
    pub centroid_mm: f32,
    /// Second central moment of the offset, mm².
    pub second_moment_mm2: f32,
    /// Third central moment of the offset, mm³.
    pub third_moment_mm3: f32,
    /// Fourth central moment of the offset, mm^4.
    pub fourth_moment_mm4: f32,
    /// Principal point at the centroid, sensor frame, mm.
    pub principal_point_x_mm: f32,
    /// Principal point at the centroid, sensor frame, mm.
    pub principal_point_y_mm: f32,
    /// Principal distance that goes with corrected coordinates, mm.
    pub principal_distance_mm: f32,
    /// Run-out and focus shift, mm.
    pub focus_shift_mm: f32,
    /// Relative enlargement of the image by the focus shift.
    pub enlargement: f32,
    /// `FMC_MODEL_...`
    pub model: fmc_code,
    /// `FMC_YES` if all terms are evaluated, `FMC_NO` if those below 0.5 nm in all are left out.
    pub has_all_terms: fmc_code,
    /// Bound of what model and evaluation leave out, nm per axis.
    pub left_out_nm: f32,
}

impl From<&InteriorOrientation> for fmc_interior {
    fn from(interior: &InteriorOrientation) -> Self {
        let motion = &interior.motion;
        Self {
            vh_per_s: interior.vh_per_s,
            exposure_s: interior.exposure_s,
            opening_offset_mm: motion.opening_offset_mm,
            travel_mm: motion.travel_mm,
            centroid_time_s: motion.centroid_time_s,
            centroid_mm: motion.centroid_mm,
            second_moment_mm2: motion.moments.second,
            third_moment_mm3: motion.moments.third,
            fourth_moment_mm4: motion.moments.fourth,
            principal_point_x_mm: interior.principal_point.x_mm,
            principal_point_y_mm: interior.principal_point.y_mm,
            principal_distance_mm: interior.principal_distance_mm,
            focus_shift_mm: interior.focus_shift_mm,
            enlargement: interior.enlargement,
            model: code::code_of_model(interior.model),
            has_all_terms: code_of_terms(interior.terms),
            left_out_nm: interior.left_out_nm,
        }
    }
}

/// Predicts the frame of an exposure and puts it into storage, where it remains the camera's as
/// long as the camera has this calibration. After a refusal the storage is as before.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_frame_init(
    frame: *mut fmc_frame,
    camera: *const fmc_camera,
    exposure: *const fmc_exposure,
    error: *mut fmc_error,
) -> fmc_status {
    let initialised = || {
        memory::room(frame, 1)?;
        Extent::of(frame, 1, 1).apart_from(Extent::of(camera, 1, 2))?;
        // SAFETY: the caller's promise.
        let camera = unsafe { memory::kept(camera, 2) }?;
        // SAFETY: the caller's promise.
        let exposure = unsafe { memory::input(exposure, 3) }?.exposure()?;
        match camera.object.frame(&exposure) {
            Ok(made) => {
                // SAFETY: the caller's promise.
                unsafe { memory::put(frame, camera.stamp, made) };
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(initialised(), error) }
}

/// Returns the interior orientation of a frame.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_frame_interior(
    frame: *const fmc_frame,
    interior: *mut fmc_interior,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let frame = unsafe { memory::object(frame, 1) }?;
        let place = memory::output(interior, 2)?;
        // SAFETY: the caller's promise.
        unsafe { place.write((&frame.interior).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

code::codes!(terms, code_of_terms, fmc::geometry::frame_correction::Terms:
    FMC_NO = fmc::geometry::frame_correction::Terms::Short,
    FMC_YES = fmc::geometry::frame_correction::Terms::Full,
);
