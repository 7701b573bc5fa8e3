//! Statistics of all missions.

use fmc_camera_file::InputError;
use rayon::prelude::*;
use serde::Serialize;

use super::draw::{DrawOptions, DrawnMission};
use super::mission::FlownMission;
use crate::judge::coverage::Coverage;
use crate::judge::quantity::Quantity;
use crate::mission::flown::Flown;

/// Number of worst cases of each kind.
const WORST: usize = 3;
/// Largest number of missions of a kind that repeat a finding.
const MOST_REPEATED: usize = 10;

/// Missions that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Request {
    /// Number of missions.
    pub missions: u32,
    /// Seed.
    pub seed: u64,
    /// Faults of each mission.
    pub faults: u32,
}

/// Statistics of random missions. The result depends on the request alone, not on the number of
/// threads.
#[derive(Debug, Clone)]
pub struct Statistics {
    /// The request.
    pub request: Request,
    /// Findings of every mission, in order.
    pub missions: Vec<FlownMission>,
    /// Number of draws of which no mission came.
    pub refused_draws: u32,
    /// Cases worth a look, with the files that repeat them.
    pub cases: Vec<Case>,
    /// The files.
    pub files: Vec<DrawnMission>,
}

/// A case worth a look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// Finding.
    pub what: String,
    /// Number of the mission.
    pub mission: u32,
    /// Number of the trigger; `None` for the whole mission.
    pub trigger: Option<u32>,
    /// Size: error/σ, or px above the predicted smear.
    pub size: Option<f64>,
    /// Name of the scenario that repeats it.
    pub scenario: String,
}

/// Reason why statistics cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum StatisticsError<E> {
    /// No mission came of a great many draws.
    #[error("mission {number}: {error}")]
    Draw {
        /// Number of the mission.
        number: u32,
        /// The last refusal.
        error: InputError,
    },
    /// A mission could not be flown.
    #[error("mission {number}: {error}")]
    Flight {
        /// Number of the mission.
        number: u32,
        /// The camera's error.
        error: E,
    },
}

impl Statistics {
    /// Draws and flies the missions on all cores. `done` is called after each.
    ///
    /// # Errors
    /// [`StatisticsError`] of the first mission that cannot be drawn or flown.
    pub fn run<E: Send>(
        request: Request,
        fly: impl Fn(&DrawnMission) -> Result<Flown, E> + Sync,
        done: impl Fn() + Sync,
    ) -> Result<Self, StatisticsError<E>> {
        let options = DrawOptions {
            seed: request.seed,
            faults: request.faults,
        };
        let draw = |number| {
            DrawnMission::draw(options, number)
                .map_err(|error| StatisticsError::Draw { number, error })
        };
        let found: Vec<(FlownMission, u32)> = (1..=request.missions)
            .into_par_iter()
            .map(|number| {
                let mission = draw(number)?;
                let flown =
                    fly(&mission).map_err(|error| StatisticsError::Flight { number, error })?;
                done();
                Ok((FlownMission::of(&mission, &flown), mission.refused))
            })
            .collect::<Result<_, StatisticsError<E>>>()?;
        let refused_draws = found.iter().map(|(_, refused)| refused).sum();
        let missions: Vec<FlownMission> = found.into_iter().map(|(found, _)| found).collect();
        let cases = cases(&missions);
        let mut numbers: Vec<u32> = cases.iter().map(|case| case.mission).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let files = numbers.into_iter().map(draw).collect::<Result<_, _>>()?;
        Ok(Self {
            request,
            missions,
            refused_draws,
            cases,
            files,
        })
    }

    /// Returns error/σ of a quantity in all frames.
    #[must_use]
    pub fn ratios(&self, quantity: Quantity) -> Vec<f64> {
        let missions = self.missions.iter();
        missions
            .flat_map(|mission| mission.ratios(quantity).map(|(_, ratio)| ratio))
            .collect()
    }

    /// Returns the distribution of a quantity's errors; `None` without errors.
    #[must_use]
    pub fn coverage(&self, quantity: Quantity) -> Option<Coverage> {
        Coverage::of_independent(&self.ratios(quantity))
    }

    /// Returns the predicted and the true smear of all exposed frames, px.
    #[must_use]
    pub fn smears(&self) -> Vec<(f64, f64)> {
        let verdicts = self.missions.iter().flat_map(|mission| &mission.verdicts);
        verdicts
            .map(|verdict| (verdict.predicted_px, verdict.smear_px))
            .collect()
    }

    /// Sums a count over all missions.
    pub fn sum(&self, count: impl Fn(&FlownMission) -> usize) -> usize {
        self.missions.iter().map(count).sum()
    }
}

/// Collects the worst frames of every quantity, and the missions in which something is wrong.
fn cases(missions: &[FlownMission]) -> Vec<Case> {
    let mut cases = Vec::new();
    for quantity in Quantity::ALL {
        let what = format!("{}, error/σ", quantity.name());
        worst(&mut cases, missions, &what, |mission| {
            mission.worst(quantity)
        });
    }
    worst(
        &mut cases,
        missions,
        "smear, px above the predicted one",
        FlownMission::worst_smear,
    );
    let whole = |what: String, mission: &FlownMission, trigger: Option<u32>| Case {
        what,
        mission: mission.number,
        trigger,
        size: None,
        scenario: DrawnMission::scenario_name(mission.number),
    };
    let spurious = missions
        .iter()
        .filter(|mission| !mission.spurious.is_empty());
    cases.extend(spurious.take(MOST_REPEATED).map(|mission| {
        let what = format!("spurious fault {}", mission.spurious.join(", "));
        whole(what, mission, None)
    }));
    let unanswered = missions.iter().filter(|mission| mission.unanswered > 0);
    cases.extend(unanswered.take(MOST_REPEATED).map(|mission| {
        let what = format!("{} triggers without a record", mission.unanswered);
        whole(what, mission, None)
    }));
    let silent = missions
        .iter()
        .filter_map(|mission| Some((mission, *mission.silent.first()?)));
    cases.extend(
        silent
            .take(MOST_REPEATED)
            .map(|(mission, trigger)| whole("silent frame".to_owned(), mission, Some(trigger))),
    );
    let vacuous = missions
        .iter()
        .filter_map(|mission| Some((mission, mission.vacuous.first()?)));
    cases.extend(
        vacuous
            .take(MOST_REPEATED)
            .map(|(mission, check)| whole(format!("nothing to judge: {check}"), mission, None)),
    );
    cases
}

/// Appends the missions with the largest sizes.
fn worst(
    cases: &mut Vec<Case>,
    missions: &[FlownMission],
    what: &str,
    of: impl Fn(&FlownMission) -> Option<(u32, f64)>,
) {
    let mut found: Vec<(u32, u32, f64)> = missions
        .iter()
        .filter_map(|mission| {
            let (trigger, size) = of(mission)?;
            Some((mission.number, trigger, size))
        })
        .collect();
    found.sort_by(|(.., one), (.., other)| other.abs().total_cmp(&one.abs()));
    cases.extend(
        found
            .into_iter()
            .take(WORST)
            .map(|(mission, trigger, size)| Case {
                what: what.to_owned(),
                mission,
                trigger: Some(trigger),
                size: Some(size),
                scenario: DrawnMission::scenario_name(mission),
            }),
    );
}
