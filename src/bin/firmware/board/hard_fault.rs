//! Handler of hard faults, on a stack of its own: the other one may be full.
//!
//! A fault whose frame finds no room on the stack still leads to the handler (ARM DDI 0403E,
//! derived exceptions on exception entry). The memory protection is off there, so the guard below
//! the stack is memory for the handler: it overwrites neither the stack nor the statics.

use core::arch::naked_asm;

use cortex_m::peripheral::SCB;
use fmc_camera::io::link::message::ResetCause;

use super::{stack, stop_after_fault};

/// The register with the address of a fault of the memory protection is valid (`MMARVALID`).
const ADDRESS_VALID: u32 = 1 << 7;

/// Place of the program counter in the frame of an exception, words.
const PROGRAM_COUNTER: usize = 6;

/// A hard fault.
pub(super) struct HardFault {
    /// Cause that the next start tells.
    pub(super) cause: ResetCause,
    /// Address of the fault, by its frame; 0 if a full stack had no room for one.
    program_counter: u32,
    /// Registers HFSR and CFSR.
    hard: u32,
    configurable: u32,
}

impl HardFault {
    /// Reads the fault from the processor's registers and from the frame on the stack.
    fn read(stack_pointer: usize) -> Self {
        // SAFETY: reading these registers has no effect.
        let (hard, configurable, address) = unsafe {
            let registers = &*SCB::PTR;
            (
                registers.hfsr.read(),
                registers.cfsr.read(),
                registers.mmfar.read(),
            )
        };
        let guard = stack::guard();
        let is_in_guard = configurable & ADDRESS_VALID != 0
            && usize::try_from(address).is_ok_and(|address| guard.contains(&address));
        // The stack pointer is below the frame, also where the frame was not written.
        let is_full = stack_pointer < guard.end || is_in_guard;
        Self {
            cause: if is_full {
                ResetCause::StackOverflow
            } else {
                ResetCause::Fault
            },
            program_counter: stack::word(stack_pointer, PROGRAM_COUNTER).unwrap_or(0),
            hard,
            configurable,
        }
    }

    /// Logs it.
    pub(super) fn log(&self) {
        let name = if self.cause == ResetCause::StackOverflow {
            "stack overflow"
        } else {
            "hard fault"
        };
        defmt::error!(
            "{=str} at {=u32:#010x}, HFSR {=u32:#x}, CFSR {=u32:#x}",
            name,
            self.program_counter,
            self.hard,
            self.configurable
        );
    }
}

/// The handler's first instructions, which use no stack: its own begins where the guard ends.
///
/// Registers of the floating-point unit that the entry has left to be stored later (`LSPACT` in
/// FPCCR) are not stored: their place is in the guard, or nowhere.
#[unsafe(naked)]
#[unsafe(export_name = "HardFault")]
#[unsafe(link_section = ".HardFault.user")]
unsafe extern "C" fn enter() -> ! {
    naked_asm!(
        "movw r2, #0xef34",
        "movt r2, #0xe000",
        "ldr r3, [r2]",
        "bic r3, r3, #1",
        "str r3, [r2]",
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_end",
        "movt r1, #:upper16:_stack_end",
        "msr msp, r1",
        "b {handle}",
        handle = sym handle,
    )
}

extern "C" fn handle(stack_pointer: usize) -> ! {
    stop_after_fault(&HardFault::read(stack_pointer))
}
