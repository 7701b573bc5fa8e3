//! Counts of the encoder at the shutter's edges: every capture of an edge requests a transfer of the
//! encoder's count to memory, which the DMA makes some cycles later, whatever the processor does.

use core::sync::atomic::{AtomicU16, Ordering, fence};

use embassy_stm32::{
    Peri,
    pac::{
        self,
        dma::vals::{Dir, Pl, Size},
    },
    peripherals::{DMA1_CH0, DMA1_CH1, TIM2},
    timer::{Ch3, Ch4, Dma},
};
use fmc_camera::flight::event::ShutterEdge;

/// Number of counts of one kind of edge that are kept, a power of two: more edges than that in one
/// round could look like one.
const PLACES: u16 = 16;

/// Channels of the clock that capture the edges; each has the stream of its place.
const CHANNELS: [usize; 2] = [2, 3];

/// Counts, by kind of edge, in memory that the DMA reaches and no cache holds.
#[unsafe(link_section = ".shared.LATCHES")]
static COUNTS: [[AtomicU16; PLACES as usize]; 2] =
    [const { [const { AtomicU16::new(0) }; PLACES as usize] }; 2];

/// The transfers in operation.
pub(super) struct Latches {
    _streams: (Peri<'static, DMA1_CH0>, Peri<'static, DMA1_CH1>),
}

impl Latches {
    /// Begins to latch, once encoder and captures run.
    pub(super) fn start(opened: Peri<'static, DMA1_CH0>, closed: Peri<'static, DMA1_CH1>) -> Self {
        let requests = [
            Dma::<TIM2, Ch3>::request(&*opened),
            Dma::<TIM2, Ch4>::request(&*closed),
        ];
        for ((stream, request), counts) in (0..).zip(requests).zip(&COUNTS) {
            for count in counts {
                count.store(0, Ordering::Relaxed);
            }
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
        critical_section::with(|_| {
            pac::TIM2.dier().modify(|w| {
                for channel in CHANNELS {
                    w.set_ccde(channel, true);
                }
            });
        });
        Self {
            _streams: (opened, closed),
        }
    }
}

/// Address of a register or of memory, as the DMA takes it.
fn address<T>(of: *const T) -> u32 {
    u32::from_le_bytes(of.addr().to_le_bytes())
}

/// The edges of one kind whose counts have been taken.
#[derive(Default)]
pub(super) struct Latched {
    taken: [u16; 2],
}

impl Latched {
    /// Returns the count at the last edge of this kind, if it is the only one since the last call.
    pub(super) fn take(&mut self, edge: ShutterEdge) -> Option<u16> {
        let stream = match edge {
            ShutterEdge::Opened => 0,
            ShutterEdge::Closed => 1,
        };
        let left = pac::DMA1.st(stream).ndtr().read().ndt();
        // What the DMA has written before its counter changed is read after that.
        fence(Ordering::Acquire);
        let made = PLACES.wrapping_sub(left) % PLACES;
        let taken = core::mem::replace(self.taken.get_mut(stream)?, made);
        if made.wrapping_sub(taken) % PLACES != 1 {
            return None;
        }
        let count = COUNTS.get(stream)?.get(usize::from(taken))?;
        Some(count.load(Ordering::Relaxed))
    }
}
