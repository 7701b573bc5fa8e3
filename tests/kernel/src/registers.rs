//! The registers that a function must leave as it found them.

use core::arch::asm;

use fmc_camera_kernel::Coefficients;

use crate::check::Difference;
use crate::corners::CAMERA;

/// Number of points: two blocks of three.
const POINTS: usize = 6;
/// Numbers put into s16 to s31.
const NUMBERS: [f32; 16] = [
    1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0,
];

unsafe extern "C" {
    fn fmc_camera_kernel_short_pairs(_: *mut f32, blocks: usize, _: *const Coefficients);
    fn fmc_camera_kernel_full_pairs(_: *mut f32, blocks: usize, _: *const Coefficients);
    fn fmc_camera_kernel_short_xy(_: *mut f32, _: *mut f32, blocks: usize, _: *const Coefficients);
    fn fmc_camera_kernel_full_xy(_: *mut f32, _: *mut f32, blocks: usize, _: *const Coefficients);
}

/// Calls a kernel with numbers in s16 to s31 and compares them afterwards.
macro_rules! kept {
    ($kernel:path, $first:expr, $second:expr, $third:expr, $fourth:expr) => {{
        let before = NUMBERS.map(f32::to_bits);
        let mut after = [0_u32; 16];
        // SAFETY: the arguments are those of the kernel, for two blocks; every register that is
        // loaded here or that a function may change is named.
        unsafe {
            asm!(
                "vldmia r5, {{s16-s31}}",
                "bl {kernel}",
                "vstmia r4, {{s16-s31}}",
                kernel = sym $kernel,
                inout("r0") $first => _,
                inout("r1") $second => _,
                inout("r2") $third => _,
                inout("r3") $fourth => _,
                in("r4") after.as_mut_ptr(),
                in("r5") before.as_ptr(),
                out("r12") _, out("lr") _,
                out("d0") _, out("d1") _, out("d2") _, out("d3") _,
                out("d4") _, out("d5") _, out("d6") _, out("d7") _,
                out("d8") _, out("d9") _, out("d10") _, out("d11") _,
                out("d12") _, out("d13") _, out("d14") _, out("d15") _,
            );
        }
        same(stringify!($kernel), before, after)
    }};
}

/// Checks that every kernel keeps the registers, for one block and for two.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn are_kept() -> Result<(), Difference> {
    let mut x = [1.0_f32; 2 * POINTS];
    let mut y = [2.0_f32; POINTS];
    let (x, y) = (x.as_mut_ptr(), y.as_mut_ptr());
    let form = &CAMERA;
    let form: *const Coefficients = form;
    for blocks in [1_usize, 2] {
        kept!(fmc_camera_kernel_short_pairs, x, blocks, form, 0)?;
        kept!(fmc_camera_kernel_full_pairs, x, blocks, form, 0)?;
        kept!(fmc_camera_kernel_short_xy, x, y, blocks, form)?;
        kept!(fmc_camera_kernel_full_xy, x, y, blocks, form)?;
    }
    Ok(())
}

fn same(what: &'static str, before: [u32; 16], after: [u32; 16]) -> Result<(), Difference> {
    let mut pairs = before.into_iter().zip(after).enumerate();
    pairs.find(|(_, (before, after))| before != after).map_or(
        Ok(()),
        |(index, (expected, found))| {
            Err(Difference {
                what,
                points: 0,
                index: 16 + index,
                found,
                expected,
            })
        },
    )
}
