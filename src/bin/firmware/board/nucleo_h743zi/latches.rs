//! Counts of the encoder that the DMA takes, whatever the processor does: at the shutter's edges,
//! each of whose captures requests a transfer, and four times a millisecond while a frame is in
//! flight.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering, fence};

use embassy_stm32::{
    Peri,
    pac::{
        self,
        dma::vals::{Dir, Pl, Size},
        timer::regs::ArrCore,
    },
    peripherals::{DMA1_CH0, DMA1_CH1, DMA1_CH2, TIM2, TIM6},
    rcc,
    timer::{Ch3, Ch4, Dma, UpDma},
};
use fmc_camera::flight::{drive::MAX_LATCHES, event::ShutterEdge};
use heapless::Vec;

use super::clock;

/// Number of counts of each stream that are kept, a power of two: more edges of one kind than that
/// in a round could look like one.
const PLACES: u16 = 16;

/// Streams of the DMA.
const OPENED: usize = 0;
const CLOSED: usize = 1;
const BETWEEN: usize = 2;
const STREAMS: usize = 3;

/// Channels of the clock that capture the edges.
const CHANNELS: [usize; 2] = [2, 3];

/// Time from one count to the next in a frame, µs.
const INTERVAL_US: u16 = 250;

/// The last counts by their number from the last on, with their ages beyond its own, µs; the oldest
/// first.
const AGES_US: [(u16, u16); MAX_LATCHES] = [
    (4, 3 * INTERVAL_US),
    (3, 2 * INTERVAL_US),
    (2, INTERVAL_US),
    (1, 0),
];

/// Time within which the DMA has taken a count, µs.
const TAKEN_US: u16 = 2;

/// Number of tries to read time and number of the last count together.
const TRIES: usize = 4;

/// Counts, by stream, in memory that the DMA reaches and no cache holds.
#[unsafe(link_section = ".shared.LATCHES")]
static COUNTS: [[AtomicU16; PLACES as usize]; STREAMS] =
    [const { [const { AtomicU16::new(0) }; PLACES as usize] }; STREAMS];

/// Time from which counts are taken in the frame.
static STARTED_US: AtomicU32 = AtomicU32::new(0);

/// Number of the count that was the next then.
static STARTED_AT: AtomicU16 = AtomicU16::new(0);

/// The streams of the DMA.
pub(super) struct LatchStreams {
    pub(super) opened: Peri<'static, DMA1_CH0>,
    pub(super) closed: Peri<'static, DMA1_CH1>,
    pub(super) between: Peri<'static, DMA1_CH2>,
}

/// The transfers in operation.
pub(super) struct Latches {
    _streams: LatchStreams,
}

impl Latches {
    /// Begins to latch at edges, once encoder and captures run.
    pub(super) fn start(streams: LatchStreams, _timer: Peri<'static, TIM6>) -> Self {
        let requests = [
            Dma::<TIM2, Ch3>::request(&*streams.opened),
            Dma::<TIM2, Ch4>::request(&*streams.closed),
            UpDma::<TIM6>::request(&*streams.between),
        ];
        for ((stream, request), counts) in (0..).zip(requests).zip(&COUNTS) {
            for count in counts {
                count.store(0, Ordering::Relaxed);
            }
            start_stream(stream, request, counts);
        }
        critical_section::with(|_| {
            pac::TIM2.dier().modify(|w| {
                for channel in CHANNELS {
                    w.set_ccde(channel, true);
                }
            });
        });
        rcc::enable_and_reset::<TIM6>();
        let timer = pac::TIM6;
        timer.psc().write_value(clock::TIMER_MHZ - 1);
        timer.arr().write_value(ArrCore(u32::from(INTERVAL_US) - 1));
        timer.egr().write(|w| w.set_ug(true));
        timer.dier().write(|w| w.set_ude(true));
        Self { _streams: streams }
    }
}

fn start_stream(stream: usize, request: u8, counts: &[AtomicU16]) {
    pac::DMAMUX1.ccr(stream).write(|w| w.set_dmareq_id(request));
    let channel = pac::DMA1.st(stream);
    channel.par().write_value(address(pac::TIM4.cnt().as_ptr()));
    channel.m0ar().write_value(address(counts.as_ptr()));
    channel.ndtr().write(|w| w.set_ndt(PLACES));
    channel.cr().write(|w| {
        w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
        w.set_psize(Size::BITS16);
        w.set_msize(Size::BITS16);
        w.set_minc(true);
        w.set_circ(true);
        w.set_pl(Pl::VERY_HIGH);
        w.set_en(true);
    });
}

/// Address of a register or of memory, as the DMA takes it.
fn address<T>(of: *const T) -> u32 {
    u32::from_le_bytes(of.addr().to_le_bytes())
}

/// Begins to take counts between the rounds, or ends it.
pub(super) fn take_between(is_wanted: bool) {
    let timer = pac::TIM6;
    if is_wanted {
        timer.cnt().write(|w| w.set_cnt(0));
        STARTED_US.store(clock::now_us(), Ordering::Relaxed);
        STARTED_AT.store(made(BETWEEN), Ordering::Relaxed);
    }
    timer.cr1().write(|w| w.set_cen(is_wanted));
}

/// Number of counts that a stream has taken, modulo its places.
fn made(stream: usize) -> u16 {
    PLACES.wrapping_sub(pac::DMA1.st(stream).ndtr().read().ndt()) % PLACES
}

/// Returns the count that a stream has taken at a number.
fn count(stream: usize, number: u16) -> Option<u16> {
    let counts = COUNTS.get(stream)?;
    let count = counts.get(usize::from(number % PLACES))?;
    // A count is written before the DMA's counter changes: it is read after that.
    fence(Ordering::Acquire);
    Some(count.load(Ordering::Relaxed))
}

/// The counts that have been looked at.
#[derive(Default)]
pub(super) struct Latched {
    taken: [u16; 2],
    /// Number of the last count in a frame, and its age at the last look, µs.
    between: Option<(u16, u16)>,
    /// Time for which counts had been taken then, µs: older ones are of an earlier frame.
    running_us: u16,
}

impl Latched {
    /// Returns the count at the last edge of this kind, if it is the only one since the last call.
    pub(super) fn take(&mut self, edge: ShutterEdge) -> Option<u16> {
        let stream = match edge {
            ShutterEdge::Opened => OPENED,
            ShutterEdge::Closed => CLOSED,
        };
        let made = made(stream);
        let taken = core::mem::replace(self.taken.get_mut(stream)?, made);
        (made.wrapping_sub(taken) % PLACES == 1)
            .then(|| count(stream, taken))
            .flatten()
    }

    /// Notes which count is the last, and how old it is now. Counts that are not as many as there
    /// were intervals are not used.
    pub(super) fn look(&mut self) {
        self.between = None;
        if !pac::TIM6.cr1().read().cen() {
            return;
        }
        for _ in 0..TRIES {
            let made = made(BETWEEN);
            let age_us = pac::TIM6.cnt().read().cnt();
            let running_us = clock::now_us().wrapping_sub(STARTED_US.load(Ordering::Relaxed));
            if age_us < TAKEN_US || self::made(BETWEEN) != made {
                continue;
            }
            let interval_us = u32::from(INTERVAL_US);
            let until_last_us = running_us.saturating_sub(u32::from(age_us));
            let rounded_us = until_last_us.saturating_add(interval_us / 2);
            let [intervals, ..] = (rounded_us / interval_us).to_le_bytes();
            let counted = made.wrapping_sub(STARTED_AT.load(Ordering::Relaxed));
            if counted % PLACES == u16::from(intervals) % PLACES {
                self.between = Some((made, age_us));
                self.running_us = u16::try_from(running_us).unwrap_or(u16::MAX);
            }
            return;
        }
    }

    /// Returns the last counts with their ages at the last look, s; the oldest first.
    pub(super) fn between(&self) -> Vec<(f32, u16), MAX_LATCHES> {
        let mut counts = Vec::new();
        let Some((made, age_us)) = self.between else {
            return counts;
        };
        for (back, older_us) in AGES_US {
            let age_us = age_us.saturating_add(older_us);
            if age_us < self.running_us
                && let Some(count) = count(BETWEEN, made.wrapping_sub(back))
            {
                let _ = counts.push((1e-6 * f32::from(age_us), count));
            }
        }
        counts
    }
}
