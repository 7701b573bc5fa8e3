//! QEMU's `mps2-an386` (Cortex-M4F) and `mps2-an500` (Cortex-M7): one image runs on both.
//!
//! The first UART is the link, the second the log, the third the satellite receiver's wire and the
//! fourth the autopilot's. Arm's application notes AN386 and AN500 describe
//! the peripherals and their addresses; QEMU's `hw/arm/mps2.c` shows which of them it has.

mod blocks;
mod clock;
#[cfg(drills)]
mod drills;
mod fault;
mod flash;
mod link;
mod log;
mod registers;
mod uart;
mod watchdog;
mod wires;

use core::sync::atomic::Ordering;

use cortex_m::peripheral::{Peripherals, SCB};
use cortex_m_semihosting::debug;

use fmc_camera::io::link::{deck::RigDeck, flight_memory::FlightMemory, message::ResetCause};
use fmc_camera::io::store::{CalibrationStore, record_ring::RecordRing};

use super::{cause, flight_memory, memory_guard, trust};
use blocks::Blocks;
use flash::{Flash, RECORD_SECTORS};
use registers::SharedMemory;

pub(super) use self::{
    clock::now_us, fault::stop_after_fault, fault::stop_after_panic, log::carry_log,
};

/// The camera of the link.
pub(crate) type Deck = RigDeck;

/// The board, started.
pub(crate) struct Board {
    /// The tick at which the watchdog was last fed.
    fed: u32,
    blocks: Blocks,
    memory: SharedMemory,
}

#[allow(
    dead_code,
    clippy::unused_self,
    reason = "the interface is that of every board"
)]
impl Board {
    pub(crate) const NAME: &'static str = "mps2";
    pub(crate) const CAN_POWER_OFF: bool = true;

    /// Starts clocks, watchdog, link and log, once.
    pub(crate) fn start() -> Option<(Self, ResetCause)> {
        let mut core = Peripherals::take()?;
        let start = cause::take();
        memory_guard::start(&mut core.MPU, []);
        clock::start(&mut core.SYST);
        log::start();
        link::start(&mut core.NVIC);
        wires::start(&mut core.NVIC);
        watchdog::start();
        #[cfg(negative_control)]
        super::panic::can_panic();
        let memory = SharedMemory::of(&core.CPUID);
        Some((
            Self {
                fed: clock::ticks(),
                blocks: Blocks::offered(memory),
                memory,
            },
            start,
        ))
    }

    /// Returns the store of the calibration: two sectors, an erasure of which takes less time than
    /// the watchdog has.
    pub(crate) fn store(&self) -> Option<CalibrationStore<Flash>> {
        trust::store_in(Flash::of_calibration(self.memory))
    }

    /// Returns the ring of records.
    pub(crate) fn records(&self) -> Option<RecordRing<Flash>> {
        let sectors = u32::try_from(RECORD_SECTORS).ok()?;
        RecordRing::open(Flash::of_records(self.memory), 0, sectors).ok()
    }

    /// Returns the longest time from the last look for a round until the clock counted again, ms:
    /// rounds come when the rig sends them. `None` without supply.
    pub(crate) fn reset_at_most_ms(&self, start: ResetCause) -> Option<u32> {
        (start != ResetCause::PowerOn).then_some(watchdog::BITES_WITHIN_MS + clock::RUNS_WITHIN_MS)
    }

    /// Returns the memory that a reset leaves alone, once.
    pub(crate) fn flight_memory(start: ResetCause) -> &'static FlightMemory {
        flight_memory::find(start)
    }

    /// Returns a test rig.
    pub(crate) const fn deck(start: ResetCause) -> Deck {
        RigDeck::after(start)
    }

    /// Hands over the bytes of receiver and autopilot; rounds come over the link.
    #[inline]
    pub(crate) fn fly(&mut self, deck: &mut Deck) {
        wires::hand_over(deck);
        self.blocks.hand_over(deck);
    }

    pub(crate) fn receive(&mut self) -> Option<u8> {
        let next = self.blocks.next();
        next.or_else(|| self.blocks.after(link::receive()?))
    }

    /// Takes the next byte of a block of which at least one was taken.
    #[inline]
    pub(crate) fn receive_more(&mut self) -> Option<u8> {
        self.blocks.next()
    }

    pub(crate) fn overruns(&mut self) -> u32 {
        link::overruns()
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) -> usize {
        self.blocks.send(bytes)
    }

    /// Feeds the watchdog once per tick: the loop runs once per byte, and the emulator takes long
    /// over a peripheral's register.
    pub(crate) fn feed_watchdog(&mut self) {
        let now = clock::ticks();
        if now != self.fed {
            self.fed = now;
            watchdog::feed();
            fault::FORGIVEN.store(false, Ordering::Relaxed);
            #[cfg(drills)]
            drills::run();
        }
    }

    pub(crate) fn idle(&mut self) {
        if !self.blocks.hold_request() {
            link::wait();
        }
    }

    pub(crate) fn stack_used_bytes() -> u32 {
        super::stack::used_bytes()
    }

    pub(crate) fn reset(&mut self) -> ! {
        link::finish();
        cause::note(ResetCause::Requested);
        SCB::sys_reset()
    }

    pub(crate) fn power_off(&mut self) -> ! {
        link::finish();
        loop {
            debug::exit(debug::EXIT_SUCCESS);
        }
    }
}
