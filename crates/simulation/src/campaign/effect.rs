//! First effect of a fault: what the camera does differently than in the flight without it.

use std::collections::BTreeMap;
use std::fmt;

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome};

use crate::judge::quantity::Quantity;
use crate::judge::verdict::Verdict;
use crate::mission::flown::{Flown, FlownFrame};
use crate::mission::judgement::verdicts;
use crate::mission::scenario::MissionScenario;

/// Growth of a σ that counts as an effect.
const GROWTH: f64 = 1.5;

/// An effect of a fault.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// None.
    None,
    /// A fault is announced or stands in a record.
    Fault(&'static str),
    /// A trigger is refused.
    Refused(&'static str),
    /// A record has a flag.
    Flag(&'static str),
    /// A record no longer states a quantity.
    Withheld(Quantity),
    /// A record states a σ that is larger by half or more.
    SigmaGrows(Quantity),
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Fault(name) => write!(f, "fault {name}"),
            Self::Refused(name) => write!(f, "refused {name}"),
            Self::Flag(name) => write!(f, "flag {name}"),
            Self::Withheld(quantity) => write!(f, "no {}", quantity.name()),
            Self::SigmaGrows(quantity) => write!(f, "σ of {} grows", quantity.name()),
        }
    }
}

/// Records of the flight without faults, by the time of the trigger.
#[derive(Debug)]
pub struct Baseline {
    frames: BTreeMap<u64, (FlownFrame, Option<Verdict>)>,
}

impl Baseline {
    /// Collects the records of a flight without faults.
    #[must_use]
    pub fn of(scenario: &MissionScenario, flown: &Flown) -> Self {
        let verdicts = verdicts(scenario, flown);
        let frames = flown.frames.iter().cloned().zip(verdicts);
        Self {
            frames: frames
                .map(|(frame, verdict)| (frame.record.trigger.us(), (frame, verdict)))
                .collect(),
        }
    }

    /// Returns true if the trigger at a time, µs, has a record of an exposure without fault or flag
    /// that states every quantity.
    #[must_use]
    pub fn is_plain(&self, trigger_us: u64) -> bool {
        let frame = self.frames.get(&trigger_us);
        frame
            .and_then(|(_, verdict)| verdict.as_ref())
            .is_some_and(|verdict| {
                let states = |quantity: Quantity| verdict.of_quantity(quantity).is_some();
                !verdict.is_flagged && Quantity::ALL.into_iter().all(states)
            })
    }

    /// Returns the first effect after a time, µs, and its own time; of effects at one time, the
    /// one that says the most.
    #[must_use]
    pub fn first_effect(
        &self,
        flown: &Flown,
        verdicts: &[Option<Verdict>],
        since_us: u64,
    ) -> Option<(u64, Effect)> {
        let announced = flown
            .announced
            .iter()
            .filter(|(time_us, _)| *time_us >= since_us)
            .map(|(time_us, fault)| (*time_us, Effect::Fault(fault.name())));
        let recorded = flown
            .frames
            .iter()
            .zip(verdicts)
            .filter(|(frame, _)| frame.fetched_us >= since_us)
            .filter_map(|(frame, verdict)| {
                let effect = self.of_frame(frame, verdict.as_ref())?;
                Some((frame.fetched_us, effect))
            });
        announced.chain(recorded).min()
    }

    fn of_frame(&self, frame: &FlownFrame, verdict: Option<&Verdict>) -> Option<Effect> {
        let record = &frame.record;
        let usual = self.frames.get(&record.trigger.us());
        let had_fault =
            |fault: &Fault| usual.is_some_and(|(usual, _)| usual.record.faults.contains(*fault));
        if let Some(fault) = record.faults.iter().find(|fault| !had_fault(fault)) {
            return Some(Effect::Fault(fault.name()));
        }
        if let Outcome::Refused(reason) = record.outcome
            && usual.is_none_or(|(usual, _)| usual.record.outcome != record.outcome)
        {
            return Some(Effect::Refused(reason.name()));
        }
        let had_flag =
            |flag: &Flag| usual.is_some_and(|(usual, _)| usual.record.flags.contains(*flag));
        if let Some(flag) = record.flags.iter().find(|flag| !had_flag(flag)) {
            return Some(Effect::Flag(flag.name()));
        }
        let (usual, verdict) = (usual?.1.as_ref()?, verdict?);
        Quantity::ALL.into_iter().find_map(|quantity| {
            let before = usual.of_quantity(quantity)?;
            match verdict.of_quantity(quantity) {
                None => Some(Effect::Withheld(quantity)),
                Some(now) if now.sigma > GROWTH * before.sigma => {
                    Some(Effect::SigmaGrows(quantity))
                }
                Some(_) => None,
            }
        })
    }
}
