//! The link to the computer, cut.

use super::{InjectedFault, Injection, Share, active};

/// Which requests get through.
#[derive(Debug, Clone, Default)]
pub struct LinkFaults {
    injections: Vec<Injection>,
    lost: Share,
}

impl LinkFaults {
    /// Those among the injections.
    #[must_use]
    pub fn new(injections: &[Injection]) -> Self {
        Self {
            injections: injections.to_vec(),
            lost: Share::default(),
        }
    }

    /// Whether a request at a time is lost.
    pub fn loses(&mut self, time_s: f64) -> bool {
        let cut = active(&self.injections, InjectedFault::UartCut, time_s);
        cut.is_some_and(|cut| self.lost.hits(cut.size))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_lost_while_the_link_is_cut() {
        let cut = Injection::new(InjectedFault::UartCut, 1.0).lasting(1.0);
        let mut faults = LinkFaults::new(&[cut]);
        assert_eq!(
            [0.5, 1.5, 2.5].map(|time| faults.loses(time)),
            [false, true, false]
        );
    }
}
