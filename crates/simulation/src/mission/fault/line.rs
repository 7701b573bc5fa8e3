//! Serial line to the camera: its traffic and its cuts.

use super::{InjectedFault, Injection};
use crate::mission::clock::microseconds;
use crate::mission::file::VhSourceName;

/// Traffic that a line can carry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traffic {
    /// Speed and height, or V/H, from a source.
    Vh(VhSourceName),
    /// Attitude and rates.
    Attitude,
    /// Messages that name the receiver's time pulses; the pulses themselves have a separate wire.
    Time,
    /// The computer's requests for records, and the answers.
    Records,
}

/// Traffic of one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Carried(Vec<Traffic>);

impl Carried {
    /// Names of traffic in a scenario, without those of single sources.
    pub const NAMES: [&'static str; 4] = ["vh", "attitude", "time", "records"];

    /// Returns the traffic that such a name, or the name of a source, stands for.
    #[must_use]
    pub fn named(name: &str) -> Option<Vec<Traffic>> {
        let sources = VhSourceName::ALL.map(Traffic::Vh);
        match name {
            "vh" => Some(sources.to_vec()),
            "attitude" => Some(vec![Traffic::Attitude]),
            "time" => Some(vec![Traffic::Time]),
            "records" => Some(vec![Traffic::Records]),
            _ => VhSourceName::named(name).map(|source| vec![Traffic::Vh(source)]),
        }
    }

    /// Collects the traffic of several names; unknown names add nothing.
    pub fn of_names<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        Self(names.filter_map(Self::named).flatten().collect())
    }

    /// Returns every kind of traffic.
    #[must_use]
    pub fn everything() -> Self {
        Self::of_names(Self::NAMES.into_iter())
    }

    /// Returns true if the line carries this traffic.
    #[must_use]
    pub fn has(&self, traffic: Traffic) -> bool {
        self.0.contains(&traffic)
    }

    /// Returns true if the line carries any source of V/H.
    #[must_use]
    pub fn has_vh(&self) -> bool {
        self.0
            .iter()
            .any(|traffic| matches!(traffic, Traffic::Vh(_)))
    }
}

/// A serial line with its cuts.
#[derive(Debug, Clone)]
pub struct SerialLine {
    carried: Carried,
    /// Begin and end of each cut, µs.
    cuts_us: Vec<[u64; 2]>,
}

impl SerialLine {
    /// Creates a line that carries this traffic, with the cuts among the injections.
    #[must_use]
    pub fn new(carried: Carried, injections: &[Injection]) -> Self {
        let mut line = Self {
            carried,
            cuts_us: Vec::new(),
        };
        for injection in injections {
            line.inject(injection);
        }
        line
    }

    /// Adds a cut; other faults are not those of the line.
    pub fn inject(&mut self, injection: &Injection) {
        if injection.fault == InjectedFault::UartCut {
            let ends_s = [injection.onset_s, injection.end_s()];
            self.cuts_us.push(ends_s.map(microseconds));
        }
    }

    /// Returns true if the line loses this traffic at a time, µs.
    #[must_use]
    pub fn loses(&self, traffic: Traffic, at_us: u64) -> bool {
        self.carried.has(traffic)
            && self
                .cuts_us
                .iter()
                .any(|[from_us, to_us]| (*from_us..*to_us).contains(&at_us))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_hangs_on_the_line_is_lost_while_it_is_cut_and_nothing_else() {
        let cut = Injection::new(InjectedFault::UartCut, 1.0).of_size(1.5);
        let carried = Carried::of_names(["altimeter", "records"].into_iter());
        let line = SerialLine::new(carried, &[cut]);
        let at = [999_999, 1_000_000, 2_499_999, 2_500_000];
        let lost = at.map(|at_us| line.loses(Traffic::Vh(VhSourceName::Altimeter), at_us));
        assert_eq!(lost, [false, true, true, false]);
        assert!(line.loses(Traffic::Records, 1_500_000));
        for traffic in [
            Traffic::Vh(VhSourceName::Direct),
            Traffic::Attitude,
            Traffic::Time,
        ] {
            assert!(!line.loses(traffic, 1_500_000));
        }
    }

    #[test]
    fn everything_is_more_than_its_parts_and_unknown_names_mean_nothing() {
        let all = Carried::everything();
        assert!(all.has_vh() && all.has(Traffic::Attitude) && all.has(Traffic::Time));
        assert!(VhSourceName::ALL.map(Traffic::Vh).map(|one| all.has(one)) == [true; 4]);
        assert!(!Carried::of_names(["attitude"].into_iter()).has_vh());
        assert_eq!(Carried::named("gyro"), None);
    }
}
