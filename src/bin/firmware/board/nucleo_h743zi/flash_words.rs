//! Words of the flash's second bank at their addresses: loads whose faults of the bus are masked,
//! and stores.

use core::arch::asm;

use cortex_m::{
    asm::{dsb, isb},
    peripheral::{MPU, SCB},
};

use super::regions::{BANK_2, BANK_2_BYTES};

/// Bytes of a word, which one ECC protects.
pub(super) const WORD: usize = 32;

/// A word in the processor's own.
type Pieces = [u32; WORD / size_of::<u32>()];

/// `BFHFNMIGN` of the register CCR: an access whose bus fails is ignored where no fault can be
/// taken (ARMv7-M, DDI 0403E, section B3.2.8).
const IGNORE_BUS_FAULTS: u32 = 1 << 8;

/// `HFNMIENA` of the register `MPU_CTRL`: the memory protection holds where faults are masked,
/// too, and with it the kind of memory by which a load goes past the cache (section B3.5.3).
const PROTECT_MASKED: u32 = 1 << 1;

/// All bits of the fault of the bus in the register CFSR (BFSR); ones clear them.
const BUS_FAULTS: u32 = 0xff << 8;

/// Returns the address of the word with an offset in the bank, if it lies there.
fn address_of(offset: u32) -> Option<usize> {
    let is_word = offset < BANK_2_BYTES && offset.is_multiple_of(32);
    is_word.then_some(BANK_2.wrapping_add(offset) as usize)
}

/// Reads the word with an offset in the bank; `None` if the bus fails, as it does for a word that
/// its ECC cannot correct.
///
/// Such a load raises a fault, which would restart the firmware, again and again if a start reads
/// the word. With all faults but the non-maskable interrupt masked and `BFHFNMIGN` set, it returns
/// any bits, and the fault's register tells of it. `HFNMIENA` is set as long: without, the default
/// map would hold, and the cache would answer, which no write to the bank reaches.
pub(super) fn read(offset: u32) -> Option<[u8; WORD]> {
    let address = address_of(offset)?;
    let mut pieces = Pieces::default();
    // SAFETY: the registers are used by nobody else while interrupts and faults are masked, which
    // they were not before, and are left as they were. The addresses are those of one aligned word
    // of the flash's second bank, in which Rust has nothing: any bits are valid.
    let has_failed = unsafe {
        let (registers, protection) = (&*SCB::PTR, &*MPU::PTR);
        asm!("cpsid f");
        protection.ctrl.modify(|bits| bits | PROTECT_MASKED);
        registers.ccr.modify(|bits| bits | IGNORE_BUS_FAULTS);
        dsb();
        isb();
        for (place, piece) in pieces.iter_mut().enumerate() {
            *piece = (address as *const u32).wrapping_add(place).read_volatile();
        }
        dsb();
        let has_failed = registers.cfsr.read() & BUS_FAULTS != 0;
        registers.cfsr.write(BUS_FAULTS);
        registers.ccr.modify(|bits| bits & !IGNORE_BUS_FAULTS);
        protection.ctrl.modify(|bits| bits & !PROTECT_MASKED);
        dsb();
        isb();
        asm!("cpsie f");
        has_failed
    };
    (!has_failed).then(|| {
        let mut word = [0; WORD];
        for (bytes, piece) in word.chunks_mut(size_of::<u32>()).zip(pieces) {
            for (byte, value) in bytes.iter_mut().zip(piece.to_le_bytes()) {
                *byte = value;
            }
        }
        word
    })
}

/// Hands a word for an offset to the bank, which must be open for it. The bank writes it once all
/// its bytes have come.
pub(super) fn write(offset: u32, word: &[u8]) {
    let Some(address) = address_of(offset) else {
        return;
    };
    // The bank's registers are reached before its memory.
    dsb();
    for (place, bytes) in word.chunks(size_of::<u32>()).take(WORD / 4).enumerate() {
        if let Ok(bytes) = bytes.try_into() {
            let piece = u32::from_le_bytes(bytes);
            // SAFETY: as above; no more pieces are written than the word has.
            unsafe {
                (address as *mut u32)
                    .wrapping_add(place)
                    .write_volatile(piece);
            }
        }
    }
    dsb();
}
