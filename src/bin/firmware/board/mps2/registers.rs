//! Registers of the peripherals: only this module makes addresses, so that every access is to one
//! of these.

use cortex_m::peripheral::CPUID;

/// A 32-bit register of a peripheral.
#[derive(Clone, Copy)]
pub(super) struct Register(usize);

impl Register {
    /// Reads it, with its side effects in the peripheral.
    pub(super) fn read(self) -> u32 {
        // SAFETY: the address is one of those below: an aligned register of this machine, which
        // Rust does not use as memory.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    /// Writes it, with its side effects in the peripheral.
    pub(super) fn write(self, value: u32) {
        // SAFETY: as for `read`; no peripheral of this machine writes to memory.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }
}

/// The machine's PSRAM, 16 MB: no linker script places anything there. A PC may share it.
#[derive(Clone, Copy)]
pub(super) struct SharedMemory(usize);

impl SharedMemory {
    /// Its bytes up to the end of those that are used: blocks, then the parts of the flash.
    const BYTES: usize = 0x2d_8000;
    /// Part number of a Cortex-M7, which the machine with the memory at the other address has.
    const CORTEX_M7: u32 = 0xc27;

    /// The memory of the machine with this processor.
    pub(super) fn of(processor: &CPUID) -> Self {
        let part_number = processor.base.read() >> 4 & 0xfff;
        Self(if part_number == Self::CORTEX_M7 {
            0x6000_0000
        } else {
            0x2100_0000
        })
    }

    /// Reads a byte; zero outside the part in use.
    pub(super) fn read_byte(self, at: usize) -> u8 {
        if at >= Self::BYTES {
            return 0;
        }
        // SAFETY: the address lies in memory of this machine that Rust does not use otherwise; the
        // access is volatile, since a PC writes there.
        unsafe { ((self.0 + at) as *const u8).read_volatile() }
    }

    /// Writes a byte, unless outside the part in use.
    pub(super) fn write_byte(self, at: usize, byte: u8) {
        if at < Self::BYTES {
            // SAFETY: as for `read_byte`.
            unsafe { ((self.0 + at) as *mut u8).write_volatile(byte) }
        }
    }

    /// Reads an aligned word, the lowest byte first, at once; zero outside the part in use.
    pub(super) fn read_word(self, at: usize) -> u32 {
        if !Self::holds_word(at) {
            return 0;
        }
        // SAFETY: as for `read_byte`; the address is aligned.
        u32::from_le(unsafe { ((self.0 + at) as *const u32).read_volatile() })
    }

    /// Writes an aligned word, the lowest byte first, at once, unless outside the part in use.
    pub(super) fn write_word(self, at: usize, word: u32) {
        if Self::holds_word(at) {
            // SAFETY: as for `read_word`.
            unsafe { ((self.0 + at) as *mut u32).write_volatile(word.to_le()) }
        }
    }

    /// Returns `true` for the place of an aligned word in the part in use.
    const fn holds_word(at: usize) -> bool {
        at < Self::BYTES && at.is_multiple_of(size_of::<u32>())
    }
}

/// A CMSDK APB UART.
#[derive(Clone, Copy)]
pub(super) struct UartRegisters {
    pub(super) data: Register,
    pub(super) state: Register,
    pub(super) control: Register,
    /// Status when read; writing ones clears its bits.
    pub(super) interrupts: Register,
    pub(super) baud_divisor: Register,
}

impl UartRegisters {
    const fn at(base: usize) -> Self {
        Self {
            data: Register(base),
            state: Register(base + 0x4),
            control: Register(base + 0x8),
            interrupts: Register(base + 0xc),
            baud_divisor: Register(base + 0x10),
        }
    }
}

/// UART 0.
pub(super) const LINK_UART: UartRegisters = UartRegisters::at(0x4000_4000);
/// UART 1.
pub(super) const LOG_UART: UartRegisters = UartRegisters::at(0x4000_5000);

/// UART 2.
pub(super) const RECEIVER_UART: UartRegisters = UartRegisters::at(0x4000_6000);
/// UART 3.
pub(super) const AUTOPILOT_UART: UartRegisters = UartRegisters::at(0x4000_7000);

/// Watchdog: the value it counts down from.
pub(super) const WATCHDOG_LOAD: Register = Register(0x4000_8000);
/// Watchdog: bit 0 interrupt (NMI) at the first expiry, bit 1 reset at the second.
pub(super) const WATCHDOG_CONTROL: Register = Register(0x4000_8008);
/// Watchdog: any value starts the count again.
pub(super) const WATCHDOG_CLEAR: Register = Register(0x4000_800c);
/// Watchdog: the others can be written only after the key.
pub(super) const WATCHDOG_LOCK: Register = Register(0x4000_8c00);

/// FPGA system registers: counts up once per prescaler period.
pub(super) const COUNTER: Register = Register(0x4002_8018);
/// FPGA system registers: the prescaler's period in cycles, less one.
pub(super) const PRESCALER: Register = Register(0x4002_801c);
