//! Comparison of the kernel that is scheduled by hand with the portable one, on the core it is
//! scheduled for: Cortex-M4F and M7. On the Cortex-M55 the compared kernel is the portable one,
//! vectorised by a compiler.
//!
//! Ten million random points in each of the two forms, and all corner cases, must come out with the
//! same bits as single points; any NaN equals any other. The memory beside the points and the
//! caller's registers must not change. The program prints the number of points over semihosting and
//! fails at the first difference.
//!
//! A residual grid has at random points the bits of the PC, and so have the corrections and
//! inverses of an exposure with two; each are compared as one number.
//!
//! The way back, `distort`, has no assembly; a million random points are compared likewise.
//!
//! Helium's vectors take numbers below 2⁻¹²⁶ for zero. Where such numbers can occur, the program
//! calculates single points, and those left over from a slice, in that arithmetic, and checks near
//! the principal point how far it is from IEEE 754. Elsewhere a camera's coefficients and points do
//! not lead to such numbers, and the bits are those of IEEE 754.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod arithmetic;
#[cfg(target_os = "none")]
mod check;
#[cfg(target_os = "none")]
mod corners;
#[cfg(target_os = "none")]
mod distort;
#[cfg(target_os = "none")]
mod grid_bits;
#[cfg(target_os = "none")]
mod near;
#[cfg(target_os = "none")]
mod panic;
#[cfg(target_os = "none")]
mod random;
#[cfg(mps2)]
mod registers;

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn run() -> ! {
    use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
    use cortex_m_semihosting::hprintln;

    let outcome = check::sees_differences();
    // On other cores the compiler keeps the registers.
    #[cfg(mps2)]
    let outcome = outcome.and_then(|()| registers::are_kept());
    let outcome = outcome
        .and_then(|()| corners::compare())
        .and_then(|corners| {
            let near = near::compare()?;
            let random = random::compare()?;
            let distorted = distort::compare()?;
            hprintln!(
                "{} points of corner cases, {} at random, {} on the way back, in each form: the same bits; {} tiny coordinates flushed",
                corners,
                random,
                distorted,
                near
            );
            Ok(())
        });
    let grid = grid_bits::bits();
    let corrected = grid_bits::correction_bits();
    let is_grid_right =
        (grid, corrected) == (Some(grid_bits::BITS), Some(grid_bits::CORRECTION_BITS));
    hprintln!(
        "{} points of a residual grid, and as many corrected with two: {}",
        grid_bits::POINTS,
        if is_grid_right {
            "the bits of the PC"
        } else {
            "other bits than on the PC"
        }
    );
    exit(match outcome {
        Ok(()) if !is_grid_right => EXIT_FAILURE,
        Ok(()) => EXIT_SUCCESS,
        Err(difference) => {
            hprintln!("{}", difference);
            EXIT_FAILURE
        }
    });
    loop {
        cortex_m::asm::wfi();
    }
}
