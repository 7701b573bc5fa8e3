//! Capture inputs of trigger, time pulse and shutter sensor: TIM2, the clock itself, stamps their
//! edges, and its interrupt keeps them.

use embassy_stm32::{
    Peri, bind_interrupts,
    gpio::{AfType, Flex, Pull},
    interrupt::typelevel::{self, Interrupt as _},
    pac::{
        self,
        timer::{
            regs::SrGp16,
            vals::{CcmrInputCcs, FilterValue},
        },
    },
    peripherals::{PA0, PB3, PB10, PB11, TIM2},
    timer::{Ch1, Ch2, Ch3, Ch4},
};
use fmc_camera::flight::{
    disciplined_clock::DisciplinedClock,
    drive::flown_drive::FlownDrive,
    event::{Event, ShutterEdge},
    flown_deck::FlownDeck,
    input_settings::{Edge, InputSettings},
    ring::Ring,
};

use super::{inputs::filter_of, line::Line};

/// Lines of the channels, where their pulls are set.
const LINES: [Line; 4] = [
    Line::new(pac::GPIOA, 0),
    Line::new(pac::GPIOB, 3),
    Line::new(pac::GPIOB, 10),
    Line::new(pac::GPIOB, 11),
];

/// Number of edges of one line that are kept from one round to the next.
const PLACES: usize = 8;

/// Events of the edges, by channel.
const EVENTS: [Event; 4] = [
    Event::Trigger,
    Event::TimePulse,
    Event::Shutter(ShutterEdge::Opened),
    Event::Shutter(ShutterEdge::Closed),
];

static EDGES: [Ring<u32, PLACES>; 4] = [const { Ring::new() }; 4];

bind_interrupts!(struct Interrupts {
    TIM2 => Capture;
});

/// The pins of the capture inputs.
pub(super) struct CapturePins {
    pub(super) trigger: Peri<'static, PA0>,
    pub(super) time_pulse: Peri<'static, PB3>,
    pub(super) shutter_opened: Peri<'static, PB10>,
    pub(super) shutter_closed: Peri<'static, PB11>,
}

/// The inputs in operation.
pub(super) struct Captures {
    _pins: [Flex<'static>; 4],
}

impl Captures {
    /// Begins to stamp rising edges, once the clock runs. 8 samples at 200 MHz reject pulses
    /// shorter than 40 ns.
    pub(super) fn start(pins: CapturePins) -> Self {
        let input = AfType::input(Pull::Down);
        let pins = [
            attach_channel::<_, Ch1>(pins.trigger, input),
            attach_channel::<_, Ch2>(pins.time_pulse, input),
            attach_channel::<_, Ch3>(pins.shutter_opened, input),
            attach_channel::<_, Ch4>(pins.shutter_closed, input),
        ];
        let timer = pac::TIM2;
        for pair in 0..2 {
            timer.ccmr_input(pair).modify(|w| {
                for channel in 0..2 {
                    w.set_ccs(channel, CcmrInputCcs::TI4);
                    w.set_icf(channel, FilterValue::FCK_INT_N8);
                }
            });
        }
        timer.ccer().modify(|w| {
            for channel in 0..4 {
                w.set_cce(channel, true);
            }
        });
        // Stamps of the set-up itself are dropped.
        timer.sr().write_value(SrGp16(0));
        listen();
        // SAFETY: the handler shares with other code only atomics, and registers of which main loop
        // and handler use the same one with interrupts masked alone.
        unsafe { typelevel::TIM2::enable() };
        Self { _pins: pins }
    }

    /// Takes the settings of the lines over. What they lead to by themselves is dropped.
    #[expect(clippy::unused_self, reason = "the inputs must be in operation")]
    pub(super) fn set_inputs(&mut self, inputs: &InputSettings) {
        let edges = [
            inputs.trigger,
            inputs.time_pulse,
            inputs.shutter_opened,
            inputs.shutter_closed,
        ];
        let filter = filter_of(inputs.shortest_pulse_ns);
        let timer = pac::TIM2;
        timer.ccer().modify(|w| {
            for channel in 0..4 {
                w.set_cce(channel, false);
            }
        });
        for (line, edge) in LINES.iter().zip(edges) {
            line.pull(edge == Edge::Falling);
        }
        for pair in 0..2 {
            timer.ccmr_input(pair).modify(|w| {
                for channel in 0..2 {
                    w.set_icf(channel, filter);
                }
            });
        }
        timer.ccer().modify(|w| {
            for (channel, edge) in edges.into_iter().enumerate() {
                w.set_ccp(channel, edge == Edge::Falling);
            }
        });
        timer.sr().write_value(SrGp16(0));
        timer.ccer().modify(|w| {
            for channel in 0..4 {
                w.set_cce(channel, true);
            }
        });
    }
}

fn attach_channel<Pin, Channel>(pin: Peri<'static, Pin>, input: AfType) -> Flex<'static>
where
    Pin: embassy_stm32::timer::TimerPin<TIM2, Channel>,
    Channel: embassy_stm32::timer::TimerChannel,
{
    super::line::attach::<Pin, TIM2, Channel>(pin, input)
}

/// Lets every channel interrupt.
fn listen() {
    critical_section::with(|_| {
        pac::TIM2.dier().modify(|w| {
            for channel in 0..4 {
                w.set_ccie(channel, true);
            }
        });
    });
}

/// Hands over the stamped edges; time pulses give the clock its rate.
pub(super) fn hand_over<Drive: FlownDrive>(
    clock: &mut DisciplinedClock,
    deck: &mut FlownDeck<Drive>,
) {
    for (edges, event) in EDGES.iter().zip(EVENTS) {
        // No more are taken than were there at first, however fast they come.
        for stamp in (0..PLACES).map_while(|_| edges.pop()) {
            deck.capture(clock.extend(stamp), event);
            if event == Event::TimePulse {
                clock.pulse(stamp);
                deck.note_clock(clock.drift());
            }
        }
        let lost = edges.take_lost();
        if lost > 0 {
            deck.count_lost(lost);
        }
    }
    // A line that had filled its ring was disabled until now.
    listen();
}

/// Interrupt of every edge.
struct Capture;

impl typelevel::Handler<typelevel::TIM2> for Capture {
    unsafe fn on_interrupt() {
        let timer = pac::TIM2;
        let status = timer.sr().read();
        let mut overrun = SrGp16(u32::MAX);
        for (channel, edges) in EDGES.iter().enumerate() {
            let was_overwritten = status.ccof(channel);
            if was_overwritten {
                overrun.set_ccof(channel, false);
            }
            // Reading the register clears the interrupt.
            let stamp = status.ccif(channel).then(|| timer.ccr(channel).read());
            if !edges.capture(stamp, was_overwritten) {
                // The line stays disabled until the next round.
                timer.dier().modify(|w| w.set_ccie(channel, false));
            }
        }
        // Zeros clear bits, ones leave them.
        timer.sr().write_value(overrun);
    }
}
