//! One exposure, as C asks for it.

use fmc::flight::exposure::Exposure;

use crate::code::{self, fmc_code};
use crate::error::{fmc_error, fmc_status};
use crate::memory;
use crate::refusal::Refusal;
use crate::version::{Input, checked};
use crate::{FMC_CAMERA_VERSION, FMC_FOCUS_PHYSICAL, FMC_FORWARD, FMC_MODEL_EXACT, FMC_NO};

/// An exposure, as `fmc_exposure_defaults` begins it.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_exposure {
    /// Size of this structure, bytes.
    pub size: u32,
    /// `FMC_CAMERA_VERSION` of the header.
    pub version: u32,
    /// V/H, 1/s, positive in either direction.
    pub vh_per_s: f32,
    /// Exposure time, s.
    pub exposure_s: f32,
    /// `FMC_YES`: the principal point is at `opening_offset_mm` when the shutter opens; `FMC_NO`: where
    /// the mechanism's strategy has it.
    pub has_opening_offset: fmc_code,
    /// Offset along the FMC axis when the shutter opens, mm.
    pub opening_offset_mm: f32,
    /// Shift of the detector away from the lens, beyond the stage's run-out, µm.
    pub focus_shift_um: f32,
    /// `FMC_FOCUS_...`
    pub focus_sign: fmc_code,
    /// `FMC_MODEL_...`
    pub model: fmc_code,
    /// `FMC_FORWARD` or `FMC_REVERSE`.
    pub direction: fmc_code,
}

impl Input for fmc_exposure {}

impl fmc_exposure {
    #[expect(clippy::cast_possible_truncation, reason = "tens of bytes")]
    const DEFAULT: Self = Self {
        size: size_of::<Self>() as u32,
        version: FMC_CAMERA_VERSION,
        vh_per_s: 0.0,
        exposure_s: 0.0,
        has_opening_offset: FMC_NO,
        opening_offset_mm: 0.0,
        focus_shift_um: 0.0,
        focus_sign: FMC_FOCUS_PHYSICAL,
        model: FMC_MODEL_EXACT,
        direction: FMC_FORWARD,
    };

    /// Returns the exposure, not yet validated.
    ///
    /// # Errors
    /// The refusal of a code.
    pub fn exposure(&self) -> Result<Exposure, Refusal> {
        Ok(Exposure {
            vh_per_s: self.vh_per_s,
            exposure_s: self.exposure_s,
            opening_offset_mm: code::bool_of(self.has_opening_offset)?
                .then_some(self.opening_offset_mm),
            focus_shift_um: self.focus_shift_um,
            focus_sign: code::focus_sign(self.focus_sign)?,
            model: code::model(self.model)?,
            direction: code::direction(self.direction)?,
        })
    }
}

/// Fills an exposure with defaults: planned opening, no focus shift, exact model, forward. `size`
/// is that of the structure, `version` is `FMC_CAMERA_VERSION`. V/H and exposure time remain to be
/// filled.
///
/// # Safety
/// Unless it is NULL or misaligned, `exposure` is to `size` bytes of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_exposure_defaults(
    exposure: *mut fmc_exposure,
    size: u32,
    version: u32,
    error: *mut fmc_error,
) -> fmc_status {
    let filled = || {
        checked([size, version], size_of::<fmc_exposure>(), 2)?;
        let place = memory::output(exposure, 1)?;
        // SAFETY: the caller's promise.
        unsafe { place.write(fmc_exposure::DEFAULT) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(filled(), error) }
}
