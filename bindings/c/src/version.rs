//! Version of header and library, and the head of the structures that the caller fills.

use crate::refusal::{Failure, Refusal};
use crate::{FMC_ERROR_STRUCT_SIZE, FMC_ERROR_VERSION};

/// Version of this header, 0xMMmmpp: it changes with every structure.
pub const FMC_CAMERA_VERSION: u32 = 0x0000_0100;

/// Returns the version of the library: that of the header that belongs to it.
#[unsafe(no_mangle)]
pub extern "C" fn fmc_camera_version() -> u32 {
    FMC_CAMERA_VERSION
}

/// A structure that the caller fills. It begins with its size and the header's version, and all its
/// fields are valid with all bits.
pub(crate) trait Input: Copy {}

/// Checks that a size and a version are those of the library's structure.
pub(crate) fn checked(
    [size, version]: [u32; 2],
    size_of_library: usize,
    argument: u32,
) -> Result<(), Refusal> {
    let failure = |status| Failure::of_argument(status, argument);
    if version != FMC_CAMERA_VERSION {
        let failure = failure(FMC_ERROR_VERSION);
        return Err(failure.numbers(version, FMC_CAMERA_VERSION).into());
    }
    let expected = u32::try_from(size_of_library).unwrap_or(u32::MAX);
    if size != expected {
        let failure = failure(FMC_ERROR_STRUCT_SIZE);
        return Err(failure.numbers(size, expected).into());
    }
    Ok(())
}
