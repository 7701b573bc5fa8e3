//! ST NUCLEO-H743ZI2: STM32H743ZI, Cortex-M7 at 400 MHz.
//!
//! The link is USART3, which the board's ST-LINK shows to the PC as a serial port; logs leave through the debugger (RTT).
//! `docs/board.md` has pins, connectors and instructions.

mod clock;
mod drive_pins;
mod fault;
mod link;
mod log;

use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use embassy_stm32::{
    gpio::{Level, Output, Speed},
    pac::{self, iwdg::vals::Key},
};

use self::{clock::Microseconds, drive_pins::DrivePins, link::Link};
use fmc_camera::io::link::message::Start;

use super::cause;

pub(super) use self::{clock::now_us, fault::stop_after_panic, log::carry_log};

/// Interval of the interrupts that end [`Board::idle`] where nothing is received.
const TICK_US: u32 = 1000;

/// The board with everything that the firmware uses of it.
pub(crate) struct Board {
    link: Link,
    /// LD1, green: blinks while the main loop runs.
    alive: Output<'static>,
    /// LD3, red: lit where this start follows a fault or the watchdog.
    _restarted: Output<'static>,
    _clock: Microseconds,
    /// Reserved for mechanism, shutter, trigger and time pulse.
    _drive: DrivePins,
}

impl Board {
    /// Name of this board.
    pub(crate) const NAME: &'static str = "nucleo-h743zi";
    /// Whether [`Board::power_off`] switches the power off.
    pub(crate) const CAN_POWER_OFF: bool = false;

    /// Starts clocks, link and watchdog, once; `None` where that fails.
    pub(crate) fn start() -> Option<(Self, Start)> {
        start_watchdog();
        let start = reason_of_start();
        let mut core = cortex_m::Peripherals::take()?;
        core.SCB.enable_icache();
        core.SCB.enable_dcache(&mut core.CPUID);
        let p = embassy_stm32::init(clock::configuration());

        start_tick(&mut core.SYST);

        let restarted = Level::from(matches!(start, Start::Watchdog | Start::Fault));
        let board = Self {
            link: Link::start(p.USART3, p.PD8, p.PD9),
            alive: Output::new(p.PB0, Level::High, Speed::Low),
            _restarted: Output::new(p.PB14, restarted, Speed::Low),
            _clock: Microseconds::start(p.TIM2),
            _drive: DrivePins {
                encoder_a: p.PD12,
                encoder_b: p.PD13,
                motor_pwm: p.PE9,
                motor_direction: p.PE10,
                motor_enable: p.PE12,
                step: p.PC6,
                step_direction: p.PB15,
                limit_low: p.PC8,
                limit_high: p.PC9,
                shutter_command: p.PC10,
                trigger: p.PA0,
                time_pulse: p.PB3,
                shutter_opened: p.PB10,
                shutter_closed: p.PB11,
            },
        };
        Some((board, start))
    }

    /// Oldest byte received, in order.
    pub(crate) fn receive(&mut self) -> Option<u8> {
        self.link.received.pop()
    }

    /// Bytes lost since this was asked last; at least, where the receiver itself overran.
    pub(crate) fn overruns(&mut self) -> u32 {
        self.link.received.take_lost()
    }

    /// Hands over as many bytes as the transmitter takes now, and returns how many; never waits.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> usize {
        self.link.send(bytes)
    }

    /// Keeps the watchdog from resetting the board for 0.5 s, and blinks.
    pub(crate) fn feed_watchdog(&mut self) {
        pac::IWDG1.kr().write(|w| w.set_key(Key::RESET));
        // About once per second.
        let lit = clock::now_us() & (1 << 19) == 0;
        self.alive.set_level(lit.into());
    }

    /// Sleeps until the next interrupt: a byte, or 1 ms at the latest. A byte that has come just before is not missed,
    /// since an interrupt that waits to be served also ends the sleep.
    pub(crate) fn idle(&mut self) {
        cortex_m::interrupt::free(|_| {
            if self.link.received.is_empty() {
                cortex_m::asm::wfi();
            }
        });
    }

    /// Most of the stack that has been used since the start, by what is left of the paint.
    pub(crate) fn stack_used_bytes() -> u32 {
        super::stack::used_bytes()
    }

    /// Restarts, once the last byte has left.
    pub(crate) fn reset(&mut self) -> ! {
        self.link.finish();
        cortex_m::peripheral::SCB::sys_reset()
    }

    /// Restarts, as this board cannot switch its power off.
    pub(crate) fn power_off(&mut self) -> ! {
        self.reset()
    }
}

/// Ends [`Board::idle`].
#[exception]
fn SysTick() {}

fn start_tick(timer: &mut SYST) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(clock::CORE_MHZ * TICK_US - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
}

/// Starts the watchdog before anything that could wait for ever, with the interval that it has after a reset: 0.5 s.
/// It stands still while a debugger holds the processor.
fn start_watchdog() {
    pac::DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
    pac::IWDG1.kr().write(|w| w.set_key(Key::START));
}

/// Why the processor started, from the flags of the reset controller, which it clears.
fn reason_of_start() -> Start {
    let flags = pac::RCC.rsr().read();
    pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    // A brown-out leaves memory no more reliable than power coming on.
    if flags.porrstf() || flags.borrstf() {
        // Nor has the mark any content yet; reading it could fail the memory's error correction.
        cause::forget();
        Start::PowerOn
    } else if cause::take() == Start::Fault {
        Start::Fault
    } else if flags.iwdg1rstf() {
        Start::Watchdog
    } else {
        Start::Requested
    }
}
