//! Registers of the peripherals: only this module makes addresses, so that every access is to one
//! of these.

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
