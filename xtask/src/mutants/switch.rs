//! Number of the mutant that the program is, from its environment, or of none.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Number that stands for the program as it is, with a record of the mutants that it reaches.
const RECORD: u32 = u32::MAX;

static ACTIVE: AtomicU32 = AtomicU32::new(u32::MAX - 1);
static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

/// Returns true if the program is this mutant.
#[inline]
pub const fn is(number: u32) -> bool {
    core::intrinsics::const_eval_select((number,), never, is_active)
}

const fn never(_: u32) -> bool {
    false
}

#[inline]
fn is_active(number: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    if active == RECORD {
        REACHED[number as usize].store(true, Relaxed);
    }
    active == number
}

extern "C" fn begin() {
    if let Ok(number) = std::env::var("FMC_MUTANT") {
        ACTIVE.store(number.parse().unwrap_or(RECORD), Relaxed);
    }
}

extern "C" fn end() {
    if let Ok(path) = std::env::var("FMC_MUTANTS_REACHED") {
        let reached: std::vec::Vec<u8> = REACHED.iter().map(|at| at.load(Relaxed).into()).collect();
        let _ = std::fs::write(path, reached);
    }
}

#[used]
#[unsafe(link_section = ".init_array")]
static BEGIN: extern "C" fn() = begin;

#[used]
#[unsafe(link_section = ".fini_array")]
static END: extern "C" fn() = end;
