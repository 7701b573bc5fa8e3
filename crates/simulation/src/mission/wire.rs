//! Wires of satellite receiver and autopilot: bytes at their baud rate, and the faults of each
//! wire.

use std::collections::VecDeque;

use super::clock::{microseconds, seconds};
use super::fault::{InjectedFault, Injection, active};

/// Bits of a byte on a wire: start, eight, stop.
pub(super) const BITS: u64 = 10;

/// Text that a device in a flood repeats: a whole sentence that the camera ignores.
const FLOOD: &[u8] = b"$GPTXT,01,01,02,FLOOD*03\r\n";

/// Bytes that arrive on the camera's wires from one round to the next.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WireTraffic {
    /// From the satellite receiver.
    pub receiver: Vec<u8>,
    /// From the autopilot.
    pub autopilot: Vec<u8>,
}

/// Faults of one wire.
#[derive(Debug, Clone, Copy)]
pub(super) struct WireFaults {
    /// The wire is cut.
    pub(super) cut: InjectedFault,
    /// The device sends without a pause.
    pub(super) flood: InjectedFault,
    /// The device sends at another baud rate than the camera expects.
    pub(super) baud: InjectedFault,
}

impl WireFaults {
    pub(super) const RECEIVER: Self = Self {
        cut: InjectedFault::ReceiverCut,
        flood: InjectedFault::ReceiverFlood,
        baud: InjectedFault::ReceiverBaud,
    };

    pub(super) const AUTOPILOT: Self = Self {
        cut: InjectedFault::AutopilotCut,
        flood: InjectedFault::AutopilotFlood,
        baud: InjectedFault::AutopilotBaud,
    };

    fn has(self, fault: InjectedFault) -> bool {
        [self.cut, self.flood, self.baud].contains(&fault)
    }
}

/// A wire with the bytes that are on it.
#[derive(Debug, Clone)]
pub(super) struct WireSimulator {
    baud: u64,
    /// Bytes with their times of arrival, µs.
    bytes: VecDeque<(u64, u8)>,
    free_at_us: u64,
    faults: WireFaults,
    injections: Vec<Injection>,
    /// Bytes of the flood so far.
    flooded: usize,
    lost_bytes: u32,
}

impl WireSimulator {
    /// Creates an idle wire with its faults among the injections.
    pub(super) fn new(baud: u64, faults: WireFaults, injections: &[Injection]) -> Self {
        let mut wire = Self {
            baud: baud.max(1),
            bytes: VecDeque::new(),
            free_at_us: 0,
            faults,
            injections: Vec::new(),
            flooded: 0,
            lost_bytes: 0,
        };
        for injection in injections {
            wire.inject(*injection);
        }
        wire
    }

    /// Adds a fault, if it is one of this wire.
    pub(super) fn inject(&mut self, injection: Injection) {
        if self.faults.has(injection.fault) {
            self.injections.push(injection);
        }
    }

    /// Sends bytes at a time, µs, after those that were sent before.
    pub(super) fn send(&mut self, at_us: u64, bytes: &[u8]) {
        let mut at_us = at_us.max(self.free_at_us);
        for byte in bytes {
            at_us += 1_000_000 * BITS / self.baud;
            self.bytes.push_back((at_us, *byte));
        }
        self.free_at_us = at_us;
    }

    /// Removes and returns the bytes that arrive by a time, µs; `is_lost` tells at what times the
    /// line that carries the wire loses them.
    pub(super) fn arrived(&mut self, to_us: u64, is_lost: impl Fn(u64) -> bool) -> Vec<u8> {
        let mut arrived = Vec::new();
        while let Some((at_us, byte)) = self.bytes.pop_front_if(|(at_us, _)| *at_us <= to_us) {
            self.hear(at_us, byte, &is_lost, &mut arrived);
        }
        if let Some(flood) = active(&self.injections, self.faults.flood, seconds(to_us)) {
            // The size is a whole number of bytes per round.
            for _ in 0..microseconds(flood.size * 1e-6) {
                let next = FLOOD.iter().cycle().nth(self.flooded % FLOOD.len());
                self.flooded += 1;
                if let Some(byte) = next {
                    self.hear(to_us, *byte, &is_lost, &mut arrived);
                }
            }
        }
        arrived
    }

    /// Adds what the camera hears of a byte that comes at a time, µs.
    fn hear(&mut self, at_us: u64, byte: u8, is_lost: impl Fn(u64) -> bool, arrived: &mut Vec<u8>) {
        if is_lost(at_us) || active(&self.injections, self.faults.cut, seconds(at_us)).is_some() {
            self.lost_bytes += 1;
            return;
        }
        match active(&self.injections, self.faults.baud, seconds(at_us)) {
            Some(wrong) => arrived.extend(misread(byte, wrong.size)),
            None => arrived.push(byte),
        }
    }

    /// Returns the time at which the next byte arrives, µs.
    pub(super) fn due_us(&self) -> u64 {
        let next_us = self.bytes.front().map_or(u64::MAX, |(at_us, _)| *at_us);
        let floods = self
            .injections
            .iter()
            .filter(|one| one.fault == self.faults.flood);
        let flood_us = floods.map(|flood| microseconds(flood.onset_s)).min();
        // A flood is looked at in every round from its onset on.
        next_us.min(flood_us.unwrap_or(u64::MAX))
    }

    /// Number of bytes that were lost on the way.
    pub(super) const fn lost_bytes(&self) -> u32 {
        self.lost_bytes
    }
}

/// Returns the bytes that a receiver hears if the sender's baud rate is so many times its own: it
/// samples the middle of each of its own bits, from a falling edge on, and the line is high behind
/// the sender's stop bit.
fn misread(byte: u8, rate: f64) -> Vec<u8> {
    // In bits of the sender: 0 is the start bit, 9 the stop bit.
    let level = |at: f64| match at {
        at if at < 1.0 => false,
        at if at < 9.0 => (0..8).any(|bit| {
            at >= f64::from(bit) + 1.0 && at < f64::from(bit) + 2.0 && byte >> bit & 1 == 1
        }),
        _ => true,
    };
    let mut heard = Vec::new();
    let mut from = 0.0;
    // The sender's edges lie between its bits.
    while let Some(edge) = (0..10)
        .map(f64::from)
        .find(|at| *at >= from && !level(*at + 0.5) && (*at < 0.5 || level(*at - 0.5)))
    {
        let bits = (0..8).filter(|bit| level(edge + rate * (f64::from(*bit) + 1.5)));
        heard.push(bits.fold(0, |heard, bit| heard | 1 << bit));
        from = edge + 9.5 * rate;
    }
    heard
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::clock::ROUND_US;

    fn wire(injection: Option<Injection>) -> WireSimulator {
        WireSimulator::new(
            9600,
            WireFaults::RECEIVER,
            &injection.into_iter().collect::<Vec<_>>(),
        )
    }

    #[test]
    fn bytes_arrive_one_after_the_other_at_their_baud_rate() {
        let mut wire = wire(None);
        wire.send(1000, b"abc");
        wire.send(1000, b"d");
        assert_eq!(wire.due_us(), 1000 + 1041);
        assert_eq!(wire.arrived(2041, |_| false), b"a");
        assert_eq!(wire.arrived(5000, |at_us| at_us == 3082), b"c");
        assert_eq!(wire.arrived(6000, |_| false), b"d");
        assert_eq!((wire.lost_bytes(), wire.due_us()), (1, u64::MAX));
    }

    #[test]
    fn cut_wire_loses_its_bytes_and_another_wires_cut_does_not() {
        let cut = Injection::new(InjectedFault::ReceiverCut, 0.002).of_size(0.0015);
        let mut cut_wire = wire(Some(cut));
        cut_wire.send(0, b"abcd");
        assert_eq!(cut_wire.arrived(10_000, |_| false), b"ad");
        let other = Injection {
            fault: InjectedFault::AutopilotCut,
            ..cut
        };
        let mut whole = wire(Some(other));
        whole.send(0, b"abcd");
        assert_eq!(whole.arrived(10_000, |_| false), b"abcd");
    }

    #[test]
    fn byte_at_the_right_rate_is_heard_as_it_is_and_at_another_as_others() {
        for byte in 0..=u8::MAX {
            assert_eq!(misread(byte, 1.0), [byte], "{byte}");
            assert!(!misread(byte, 0.5).is_empty());
        }
        // At half the receiver's rate every bit of the sender takes two of it.
        assert_eq!(misread(0b0101_0101, 0.5).first(), Some(&0b0110_0110));
        let text = b"$GPVTG,0.0,T,,M,186.609,N,345.600,K,A*2E";
        for rate in [0.25, 0.5, 2.0, 4.0] {
            let heard: Vec<u8> = text.iter().flat_map(|byte| misread(*byte, rate)).collect();
            assert!(!heard.contains(&b'$'), "{rate}: {heard:?}");
        }
    }

    #[test]
    fn flood_comes_in_every_round_while_it_lasts() {
        let flood = Injection::new(InjectedFault::ReceiverFlood, 0.01)
            .of_size(100.0)
            .lasting(0.002);
        let mut wire = wire(Some(flood));
        let sizes =
            [9000, 10_000, 11_000, 12_000].map(|to_us| wire.arrived(to_us, |_| false).len());
        assert_eq!(sizes, [0, 100, 100, 0]);
    }

    #[test]
    fn flood_is_lost_on_a_cut_wire_and_misread_at_another_baud_rate() {
        let of_100_bytes = |other: Injection| {
            let flood = Injection::new(InjectedFault::ReceiverFlood, 0.0).of_size(100.0);
            let mut wire = WireSimulator::new(9600, WireFaults::RECEIVER, &[flood, other]);
            let whole = wire.arrived(1000, |_| false);
            assert_eq!(whole.len(), 100);
            let lost = wire.arrived(2000, |_| true);
            (lost, wire.arrived(3000, |_| false), wire.lost_bytes())
        };
        let cut = Injection::new(InjectedFault::ReceiverCut, 0.0025).of_size(1.0);
        assert_eq!(of_100_bytes(cut), (vec![], vec![], 200));
        let baud = Injection::new(InjectedFault::ReceiverBaud, 0.0025).of_size(0.5);
        let (lost, misread, lost_bytes) = of_100_bytes(baud);
        assert_eq!((lost, lost_bytes), (vec![], 100));
        assert!(
            !misread.is_empty() && !misread.contains(&b'$'),
            "{misread:?}"
        );
    }

    #[test]
    fn every_baud_rate_of_a_scenario_leaves_room_in_a_round() {
        let bytes_per_round = fmc_camera::io::instruments::BYTES_PER_ROUND as u64;
        assert!((115_200 * ROUND_US).div_ceil(1_000_000 * BITS) <= bytes_per_round);
    }
}
