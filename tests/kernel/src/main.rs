//! Holds the kernel as a core runs it, scheduled by hand or with vectors, against the portable one a point at a time.
//!
//! Ten million random points in each of the two forms, and all corner cases, must come out with the same bits; any NaN
//! equals any other. What lies beside the points must stay as it is, and so must the registers that a function has to
//! keep. Prints what it has compared over semihosting; fails at the first difference.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod check;
#[cfg(target_os = "none")]
mod corners;
#[cfg(target_os = "none")]
mod random;
#[cfg(hand_scheduled)]
mod registers;
#[cfg(target_os = "none")]
mod subnormal;

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn run() -> ! {
    use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
    use cortex_m_semihosting::hprintln;

    let outcome = check::sees_differences()
        .and_then(|()| {
            #[cfg(hand_scheduled)]
            registers::are_kept()?;
            Ok(())
        })
        .and_then(|()| corners::compare())
        .and_then(|corners| {
            let random = random::compare()?;
            hprintln!(
                "{} points of corner cases, {} at random, in each form: the same bits",
                corners,
                random
            );
            Ok(())
        });
    exit(match outcome {
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

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    use cortex_m_semihosting::{debug, hprintln};

    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
