//! Codes of the outcome, the faults and the flags of a record.

use fmc::flight::fault::Faults;
use fmc::flight::frame_record::{Flag, Flags, Reason};
use fmc::flight::vh::VhSource;

use crate::code::{self, codes, fmc_code, unknown};
use crate::refusal::Refusal;

/// The shutter opened.
pub const FMC_EXPOSED: fmc_code = 0;
/// The camera was not armed.
pub const FMC_REFUSED_NOT_ARMED: fmc_code = 1;
/// The previous frame was not finished.
pub const FMC_REFUSED_OVERLAP: fmc_code = 2;
/// V/H or exposure is outside the camera's limits.
pub const FMC_REFUSED_OUTSIDE_LIMITS: fmc_code = 3;
/// The travel does not fit the stroke.
pub const FMC_REFUSED_STROKE: fmc_code = 4;
/// The speed is beyond the mechanism's.
pub const FMC_REFUSED_SPEED: fmc_code = 5;
/// The stage did not reach its speed in time.
pub const FMC_REFUSED_NOT_AT_SPEED: fmc_code = 6;
/// The shutter did not open.
pub const FMC_REFUSED_SHUTTER_MISSING: fmc_code = 7;
/// A fault ended it before the shutter opened.
pub const FMC_REFUSED_FAULT: fmc_code = 8;
/// It was disarmed before the shutter opened.
pub const FMC_REFUSED_DISARMED: fmc_code = 9;
/// Too many records had not been acknowledged.
pub const FMC_REFUSED_RECORDS_FULL: fmc_code = 10;
/// The shutter opened, but no interior orientation can be given.
pub const FMC_REFUSED_UNUSABLE: fmc_code = 11;

/// V/H from a sensor of V/H.
pub const FMC_VH_DIRECT: fmc_code = 0;
/// V/H from speed and a height above ground.
pub const FMC_VH_ALTIMETER: fmc_code = 1;
/// V/H from speed, altitude and terrain.
pub const FMC_VH_TERRAIN: fmc_code = 2;

codes!(source, code_of_source, VhSource:
    FMC_VH_DIRECT = VhSource::Direct,
    FMC_VH_ALTIMETER = VhSource::Altimeter,
    FMC_VH_TERRAIN = VhSource::Terrain,
);

/// Returns the reason for a refusal; `None` for an exposure.
pub(crate) fn reason(outcome: fmc_code, by: fmc_code) -> Result<Option<Reason>, Refusal> {
    Ok(Some(match outcome {
        FMC_EXPOSED => return Ok(None),
        FMC_REFUSED_NOT_ARMED => Reason::NotArmed,
        FMC_REFUSED_OVERLAP => Reason::Overlap,
        FMC_REFUSED_OUTSIDE_LIMITS => Reason::OutsideLimits,
        FMC_REFUSED_STROKE => Reason::Stroke,
        FMC_REFUSED_SPEED => Reason::Speed,
        FMC_REFUSED_NOT_AT_SPEED => Reason::NotAtSpeed,
        FMC_REFUSED_SHUTTER_MISSING => Reason::ShutterMissing,
        FMC_REFUSED_FAULT => Reason::Fault(code::fault(by)?),
        FMC_REFUSED_DISARMED => Reason::Disarmed,
        FMC_REFUSED_RECORDS_FULL => Reason::RecordsFull,
        FMC_REFUSED_UNUSABLE => Reason::Unusable,
        _ => return Err(unknown(outcome)),
    }))
}

/// Returns outcome and fault of a refusal.
pub(crate) fn code_of_reason(reason: Reason) -> (fmc_code, fmc_code) {
    let outcome = match reason {
        Reason::NotArmed => FMC_REFUSED_NOT_ARMED,
        Reason::Overlap => FMC_REFUSED_OVERLAP,
        Reason::OutsideLimits => FMC_REFUSED_OUTSIDE_LIMITS,
        Reason::Stroke => FMC_REFUSED_STROKE,
        Reason::Speed => FMC_REFUSED_SPEED,
        Reason::NotAtSpeed => FMC_REFUSED_NOT_AT_SPEED,
        Reason::ShutterMissing => FMC_REFUSED_SHUTTER_MISSING,
        Reason::Fault(fault) => return (FMC_REFUSED_FAULT, i32::from(fault.code())),
        Reason::Disarmed => FMC_REFUSED_DISARMED,
        Reason::RecordsFull => FMC_REFUSED_RECORDS_FULL,
        Reason::Unusable => FMC_REFUSED_UNUSABLE,
    };
    (outcome, 0)
}

/// Returns the bits of faults, in the order of their codes.
pub(crate) fn fault_bits(faults: Faults) -> u32 {
    faults
        .iter()
        .fold(0, |bits, fault| bits | 1 << fault as u32)
}

/// Returns the faults of bits.
pub(crate) fn faults(bits: u32) -> Result<Faults, Refusal> {
    let mut faults = Faults::NONE;
    for fault in fmc::flight::fault::Fault::ALL {
        if bits & (1 << fault as u32) != 0 {
            faults.insert(fault);
        }
    }
    if fault_bits(faults) != bits {
        return Err(unknown(bits.cast_signed()));
    }
    Ok(faults)
}

/// Returns the bits of flags, in their order.
pub(crate) fn flag_bits(flags: Flags) -> u64 {
    flags.iter().fold(0, |bits, flag| bits | 1 << flag as u32)
}

/// Returns the flags of bits.
pub(crate) fn flags(bits: u64) -> Result<Flags, Refusal> {
    let mut flags = Flags::NONE;
    for flag in Flag::ALL {
        if bits & (1 << flag as u32) != 0 {
            flags.insert(flag);
        }
    }
    let others = bits & !flag_bits(flags);
    if others != 0 {
        // The lowest bit that is no flag, by its place.
        return Err(unknown(others.trailing_zeros().cast_signed()));
    }
    Ok(flags)
}
