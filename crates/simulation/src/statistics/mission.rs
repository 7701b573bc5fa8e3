//! Findings in one random mission.

use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::frame_record::Outcome;
use fmc_camera_file::MechanismName;

use super::draw::DrawnMission;
use crate::judge::answers::Answers;
use crate::judge::quantity::Quantity;
use crate::judge::silence::is_silent;
use crate::judge::verdict::Verdict;
use crate::mechanics::EncoderSide;
use crate::mission::flown::Flown;
use crate::mission::judgement::Judgement;
use crate::mission::spurious_faults;

/// Hardware on which the error of the principal point depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Step of the encoder, µm.
    pub encoder_step_um: f64,
    /// Play between screw and stage, µm.
    pub play_um: f64,
    /// Part that the encoder sits on.
    pub encoder_side: EncoderSide,
    /// `true` if the camera flies against its FMC axis.
    pub is_reversed: bool,
    /// `true` if charge moves in place of a stage.
    pub is_tdi: bool,
}

/// A mission that was flown, and what was found wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub struct FlownMission {
    /// Number of the mission.
    pub number: u32,
    /// Its hardware.
    pub setup: Setup,
    /// Number of triggers.
    pub triggers: usize,
    /// Errors of the exposed frames.
    pub verdicts: Vec<Verdict>,
    /// Faults that came before any that was injected.
    pub spurious: Vec<String>,
    /// Number of triggers without their record.
    pub unanswered: usize,
    /// Numbers of the frames that were wrong without a flag.
    pub silent: Vec<u32>,
    /// Checks that had nothing to judge.
    pub vacuous: Vec<String>,
    /// `true` if the mission passed although no record states a principal point, or none V/H.
    pub is_vacuous_pass: bool,
    /// Number of triggers that were refused.
    pub refused: usize,
}

impl FlownMission {
    /// Judges a flight.
    #[must_use]
    pub fn of(mission: &DrawnMission, flown: &Flown) -> Self {
        let scenario = &mission.scenario;
        let judgement = Judgement::of(scenario, flown);
        let verdicts: Vec<Verdict> = judgement.verdicts.iter().flatten().copied().collect();
        let records = flown.frames.iter().map(|frame| &frame.record);
        let vacuous = judgement.checks.iter().filter(|check| check.is_vacuous);
        // By the records alone, whatever the checks say of themselves.
        let is_judged = |quantity| {
            verdicts
                .iter()
                .any(|one| one.of_quantity(quantity).is_some())
        };
        let is_vacuous_pass =
            judgement.passed() && !(is_judged(Quantity::PrincipalPoint) && is_judged(Quantity::Vh));
        let mechanics = &scenario.written.mechanics;
        Self {
            number: mission.number,
            setup: Setup {
                encoder_step_um: mechanics.encoder_step_um,
                play_um: mechanics.backlash_um,
                encoder_side: mechanics.encoder_side,
                is_reversed: scenario.flight_settings().direction == FlightDirection::Reverse,
                is_tdi: scenario.camera.fmc.mechanism == MechanismName::Tdi,
            },
            triggers: flown.triggers_us.len(),
            spurious: spurious_faults::of(scenario, flown),
            unanswered: Answers::of(&flown.triggers_us, records).missing(),
            silent: verdicts
                .iter()
                .filter(|verdict| is_silent(verdict))
                .map(|verdict| verdict.sequence)
                .collect(),
            vacuous: vacuous.map(|check| check.what.clone()).collect(),
            is_vacuous_pass,
            refused: flown
                .frames
                .iter()
                .filter(|frame| matches!(frame.record.outcome, Outcome::Refused(_)))
                .count(),
            verdicts,
        }
    }

    /// Returns the errors of a quantity in units of their σ.
    pub fn ratios(&self, quantity: Quantity) -> impl Iterator<Item = (u32, f64)> {
        self.verdicts.iter().filter_map(move |verdict| {
            let ratio = verdict.of_quantity(quantity)?.ratio();
            Some((verdict.sequence, ratio))
        })
    }

    /// Returns the frame whose quantity is farthest off in units of its σ.
    #[must_use]
    pub fn worst(&self, quantity: Quantity) -> Option<(u32, f64)> {
        self.ratios(quantity)
            .max_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))
    }

    /// Returns the frame whose smear is farthest above the predicted one, px; `None` if that of
    /// none is.
    #[must_use]
    pub fn worst_smear(&self) -> Option<(u32, f64)> {
        self.verdicts
            .iter()
            .map(|verdict| (verdict.sequence, verdict.smear_px - verdict.predicted_px))
            .filter(|(_, excess_px)| *excess_px > 0.0)
            .max_by(|(_, one), (_, other)| one.total_cmp(other))
    }
}
