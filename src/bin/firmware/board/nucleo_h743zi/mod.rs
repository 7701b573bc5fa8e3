//! ST NUCLEO-H743ZI2: STM32H743ZI, Cortex-M7 at 400 MHz.
//!
//! The link is USART3, which the board's ST-LINK shows to the PC as a serial port; logs leave
//! through the debugger (RTT). USART2 and UART7 receive from satellite receiver and autopilot. A
//! motor with an encoder moves the stage; the clock's own timer stamps edges of trigger, time pulse
//! and shutter. `docs/board.md` has pins, connectors and instructions.

mod captures;
mod clock;
mod control_loop;
mod fault;
mod flash;
mod flash_error;
mod flash_words;
mod force;
mod inputs;
mod latches;
mod line;
mod link;
mod log;
mod motor;
mod regions;
mod shutter;
mod step_pins;
mod watchdog;
mod wires;

use embassy_stm32::{
    gpio::{Level, Output, Speed},
    pac,
};

use self::{
    captures::{CapturePins, Captures},
    clock::Microseconds,
    flash::{Flash, RECORD_SECTORS},
    inputs::Inputs,
    latches::{LatchStreams, Latches},
    link::Link,
    motor::{Motor, MotorPins},
    shutter::Shutter,
    step_pins::StepPins,
    wires::Wires,
};
use fmc_camera::flight::{
    disciplined_clock::DisciplinedClock, flown_deck::FlownDeck, round_guard::LONGEST_ROUND_US,
};
use fmc_camera::io::instruments::Instruments;
use fmc_camera::io::link::{
    flight_memory::FlightMemory, message::ResetCause, wired_deck::WiredDeck,
};
use fmc_camera::io::store::{CalibrationStore, record_ring::RecordRing};

use super::{cause, flight_memory, memory_guard, trust};

pub(super) use self::{
    clock::now_us, fault::stop_after_fault, fault::stop_after_panic, log::carry_log,
};

/// The board with all parts that the firmware uses.
pub(crate) struct Board {
    link: Link,
    /// LD1, green: blinks while the main loop runs.
    alive: Output<'static>,
    /// LD3, red: lit if this start follows a fault or the watchdog.
    _restarted: Output<'static>,
    /// Longest time from the last round before the start until the clock counted again, ms.
    reset_at_most_ms: Option<u32>,
    time: DisciplinedClock,
    _clock: Microseconds,
    motor: Motor,
    captures: Captures,
    _latches: Latches,
    _shutter: Shutter,
    inputs: Inputs,
    wires: Wires,
    /// Reserved.
    _stepper: StepPins,
}

/// Longest time from the last round that is kept to a moment at which rounds are not overdue, ms.
const ROUNDS_WITHIN_MS: u32 = 2 * LONGEST_ROUND_US.div_ceil(1000);

/// Type of the link's camera: that on this board's pins.
pub(crate) type Deck = WiredDeck<motor::Drive>;

impl Board {
    /// Name of this board.
    pub(crate) const NAME: &'static str = "nucleo-h743zi";
    /// `true` if [`Board::power_off`] switches the power off.
    pub(crate) const CAN_POWER_OFF: bool = false;

    /// Starts clocks, link and watchdog, once; `None` if that fails.
    pub(crate) fn start() -> Option<(Self, ResetCause)> {
        watchdog::start();
        let (start, reset_at_most_ms) = reason_of_start();
        let mut core = cortex_m::Peripherals::take()?;
        memory_guard::start(&mut core.MPU, regions::REGIONS);
        core.SCB.enable_icache();
        core.SCB.enable_dcache(&mut core.CPUID);
        let p = embassy_stm32::init(clock::configuration());
        clock::watch();

        let restarted = Level::from(matches!(
            start,
            ResetCause::Watchdog | ResetCause::Fault | ResetCause::StackOverflow
        ));
        let board = Self {
            link: Link::start(p.USART3, p.PD8, p.PD9),
            alive: Output::new(p.PB0, Level::High, Speed::Low),
            _restarted: Output::new(p.PB14, restarted, Speed::Low),
            reset_at_most_ms,
            time: DisciplinedClock::new(),
            motor: Motor::start(
                (p.TIM1, p.TIM4),
                MotorPins {
                    pwm: p.PE9,
                    direction: p.PE10,
                    enable: p.PE12,
                    brake: p.PE15,
                    encoder_a: p.PD12,
                    encoder_b: p.PD13,
                    index: p.PD14,
                },
            ),
            // The clock starts before the timers that count with it.
            _clock: Microseconds::start(p.TIM2),
            captures: Captures::start(CapturePins {
                trigger: p.PA0,
                time_pulse: p.PB3,
                shutter_opened: p.PB10,
                shutter_closed: p.PB11,
            }),
            _latches: Latches::start(
                LatchStreams {
                    opened: p.DMA1_CH0,
                    closed: p.DMA1_CH1,
                    between: p.DMA1_CH2,
                },
                p.TIM6,
            ),
            _shutter: Shutter::start(p.TIM5, p.PA3),
            inputs: Inputs::start(p.PC8, p.PC9),
            wires: Wires::start((p.USART2, p.UART7), p.PD6, p.PE7),
            _stepper: StepPins {
                step: p.PC6,
                step_direction: p.PB15,
            },
        };
        control_loop::start(&mut core.SYST);
        Some((board, start))
    }

    /// Returns the store of the calibration: the first two sectors of the flash's second bank.
    #[expect(clippy::unused_self, reason = "the interface is that of every board")]
    pub(crate) fn store(&self) -> Option<CalibrationStore<Flash>> {
        trust::store_in(Flash::for_calibration()?)
    }

    /// Returns the ring of records: the other six.
    #[expect(clippy::unused_self, reason = "the interface is that of every board")]
    pub(crate) fn records(&self) -> Option<RecordRing<Flash>> {
        RecordRing::open(Flash::for_records()?, 0, RECORD_SECTORS).ok()
    }

    /// Returns the longest time from the last round before the start until the clock counted again,
    /// ms: by the watchdog's interval, which bounds every other reset of the chip, or from rounds
    /// that came until the handler of a fault. `None` without supply, and after a reset by the pin,
    /// which is held for any time.
    pub(crate) const fn reset_at_most_ms(&self, _: ResetCause) -> Option<u32> {
        self.reset_at_most_ms
    }

    /// Returns the memory that a reset leaves alone, once.
    pub(crate) fn flight_memory(start: ResetCause) -> &'static FlightMemory {
        flight_memory::find(start)
    }

    /// Returns the camera on this board's pins, not prepared.
    pub(crate) fn deck(start: ResetCause) -> Deck {
        let flown = FlownDeck::new(motor::drive(), start.unreferenced());
        WiredDeck::new(flown, Instruments::new())
    }

    /// Makes a round of the control loop, if one is due. Settings of the lines come first.
    pub(crate) fn fly(&mut self, deck: &mut Deck) {
        if let Some(inputs) = deck.flown_mut().take_inputs() {
            self.motor.set_inputs(&inputs);
            self.captures.set_inputs(&inputs);
            self.inputs.set_inputs(&inputs);
            self.wires.set_inputs(&inputs);
        }
        control_loop::turn(&mut self.time, &self.inputs, deck);
    }

    /// Takes the oldest byte received.
    pub(crate) fn receive(&mut self) -> Option<u8> {
        self.link.received.pop()
    }

    /// Returns `None`: the control loop comes round between two bytes.
    #[expect(clippy::unused_self, reason = "the interface is that of every board")]
    pub(crate) fn receive_more(&mut self) -> Option<u8> {
        None
    }

    /// Returns the number of bytes lost since the last call; a lower bound if the receiver itself
    /// overran.
    pub(crate) fn overruns(&mut self) -> u32 {
        self.link.received.take_lost()
    }

    /// Hands over as many bytes as the transmitter takes now, and returns how many; never waits.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> usize {
        self.link.send(bytes)
    }

    /// Keeps the watchdog from resetting the board for 0.5 s, if rounds come, and blinks.
    pub(crate) fn feed_watchdog(&mut self) {
        // The source of rounds also guards the motor: without it the force would stay on.
        if !control_loop::is_overdue() {
            watchdog::feed();
        }
        // The light blinks about once per second.
        let lit = clock::now_us() & (1 << 19) == 0;
        self.alive.set_level(lit.into());
    }

    /// Sleeps until the next interrupt: a byte, or 1 ms at the latest. A byte or a round that has
    /// come just before is not missed, since a pending interrupt also ends the sleep.
    pub(crate) fn idle(&mut self) {
        cortex_m::interrupt::free(|_| {
            if self.link.received.is_empty() && !control_loop::is_due() {
                cortex_m::asm::wfi();
            }
        });
    }

    /// Largest part of the stack used since the start, from the rest of the paint.
    pub(crate) fn stack_used_bytes() -> u32 {
        super::stack::used_bytes()
    }

    /// Restarts, once the last byte has left.
    pub(crate) fn reset(&mut self) -> ! {
        if !control_loop::is_overdue() {
            cause::note_punctual(ResetCause::Requested);
        }
        control_loop::stop();
        self.link.finish();
        cortex_m::peripheral::SCB::sys_reset()
    }

    /// Restarts, as this board cannot switch its power off.
    pub(crate) fn power_off(&mut self) -> ! {
        self.reset()
    }
}

/// Returns the cause of the processor's start, and [`Board::reset_at_most_ms`], from the flags of
/// the reset controller, which it clears.
fn reason_of_start() -> (ResetCause, Option<u32>) {
    let flags = pac::RCC.rsr().read();
    pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    // After a brown-out memory is no more reliable than after power on.
    if flags.porrstf() || flags.borrstf() {
        // They have no contents yet; reading them could fail the memory's error correction.
        cause::forget();
        flight_memory::forget();
        return (ResetCause::PowerOn, None);
    }
    let is_punctual = cause::is_punctual();
    let start = match cause::take() {
        noted @ (ResetCause::Fault | ResetCause::StackOverflow) => noted,
        _ if flags.iwdg1rstf() => ResetCause::Watchdog,
        _ => ResetCause::Requested,
    };
    // The last round that is kept may have begun late, and the one behind it may not have ended.
    let until_reset_ms = match (flags.iwdg1rstf(), flags.sftrstf()) {
        (true, _) => Some(watchdog::BITES_WITHIN_MS),
        (false, true) if is_punctual => Some(ROUNDS_WITHIN_MS + fault::RESETS_WITHIN_MS),
        (false, true) => Some(watchdog::BITES_WITHIN_MS),
        (false, false) => None,
    };
    (
        start,
        until_reset_ms.map(|until_ms| until_ms + clock::RUNS_WITHIN_MS),
    )
}
