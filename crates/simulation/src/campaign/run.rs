//! One run: a copy of the flight, with one or two faults.

use fmc_camera::flight::frame_record::{Flag, Outcome as Recorded};

use super::case::Case;
use super::effect::Effect;
use super::outcome::Outcome;
use super::world::{INTERVAL_MS, OriginalFlight, next_us};
use crate::judge::answers::Answers;
use crate::judge::silence::largest_used;
use crate::mission::clock::{microseconds, seconds};
use crate::mission::device::FlyingDevice;
use crate::mission::fault::Injection;
use crate::mission::flown::Flown;
use crate::mission::judgement::verdicts;

/// Time from a round to the onset of a fault, µs: before the next round but one, after the
/// mechanics have come to the next.
const ONSET_US: u64 = 50;
/// Least and greatest time for which a run goes on after its last trigger, µs.
const AFTER_US: [u64; 2] = [150_000, 1_500_000];
/// Time from a trigger within which its light passes, µs.
const FRAME_US: u64 = INTERVAL_MS as u64 * 1000;

/// A case, and the number of rounds after the tick at which it begins.
pub type Delayed = (Case, u32);

/// Returns the faults of a run.
#[must_use]
pub fn injections(tick: u32, faults: &[Delayed]) -> Vec<Injection> {
    faults
        .iter()
        .map(|(case, after)| case.at(seconds(next_us(tick + after) + ONSET_US)))
        .collect()
}

/// Returns the time of the last trigger that is awaited, µs.
#[must_use]
pub fn last_trigger_us(injections: &[Injection], faults: &[Delayed]) -> u64 {
    injections
        .iter()
        .zip(faults)
        .map(|(injection, (case, _))| microseconds(injection.onset_s + case.watched_s()))
        .max()
        .unwrap_or(0)
}

/// Flies a run from a tick of the cycle on; `None` for a tick that the cycle does not have.
///
/// `allowed` is the part of what its record allows by which a frame may be off.
///
/// # Errors
/// An error if the camera fails.
pub fn fly<D: FlyingDevice + Clone>(
    start: &OriginalFlight<D>,
    tick: u32,
    faults: &[Delayed],
    allowed: f64,
) -> Result<Option<Outcome>, D::Error> {
    let Some(mut flight) = start.flight(tick) else {
        return Ok(None);
    };
    let injections = injections(tick, faults);
    for injection in &injections {
        flight.inject(*injection);
    }
    // The triggers after it are left out, which is no effect of a fault.
    let last_us = last_trigger_us(&injections, faults);
    flight.end_triggers(last_us);
    let mut arrived_us = None;
    let flown = flight.to_end(AFTER_US, |now_us, told| {
        if arrived_us.is_none() && now_us <= last_us && !start.was_told(now_us, told) {
            arrived_us = Some(now_us);
        }
    })?;
    let onset_us = injections
        .iter()
        .map(|injection| microseconds(injection.onset_s))
        .min()
        .unwrap_or(0);
    Ok(Some(judged(start, &flown, onset_us, arrived_us, allowed)))
}

fn judged<D>(
    start: &OriginalFlight<D>,
    flown: &Flown,
    onset_us: u64,
    arrived_us: Option<u64>,
    allowed: f64,
) -> Outcome {
    let verdicts = verdicts(&start.scenario, flown);
    let effect = start.baseline.first_effect(flown, &verdicts, onset_us);
    let after_ms =
        |time_us: u64| u32::try_from(time_us.saturating_sub(onset_us) / 1000).unwrap_or(u32::MAX);
    // A cut line that carries requests changes nothing of what the camera is told.
    let arrived_us = arrived_us.or((flown.lost_requests > 0).then_some(onset_us));
    let records = flown.frames.iter().map(|frame| &frame.record);
    let answers = Answers::of(&flown.triggers_us, records);
    // Frames before the fault are those of the flight without it.
    let judged = || {
        flown
            .frames
            .iter()
            .zip(&verdicts)
            .filter(move |(frame, _)| frame.record.trigger.us() + FRAME_US >= onset_us)
    };
    let silent: Vec<u32> = judged()
        .filter(|(frame, verdict)| {
            if let Some(verdict) = verdict {
                largest_used(verdict).is_some_and(|(_, used)| used > allowed)
            } else {
                let is_plain = frame.record.faults.is_empty()
                    && frame
                        .record
                        .flags
                        .iter()
                        .all(|flag| flag == Flag::WithAttitude);
                matches!(frame.record.outcome, Recorded::Exposed(_)) && is_plain
            }
        })
        .map(|(frame, _)| frame.record.sequence)
        .collect();
    let worst = judged()
        .filter_map(|(_, verdict)| largest_used(verdict.as_ref()?))
        .max_by(|(_, one), (_, other)| one.total_cmp(other));
    Outcome {
        arrived_ms: arrived_us.map(after_ms),
        effect: effect
            .as_ref()
            .map_or(Effect::None, |(_, effect)| effect.clone())
            .to_string(),
        effect_ms: effect.map(|(time_us, _)| after_ms(time_us)),
        worst_of: worst.map_or("", |(name, _)| name).to_owned(),
        worst: worst.map(|(_, used)| used),
        silent: u32::try_from(silent.len()).unwrap_or(u32::MAX),
        first_silent: silent.first().copied(),
        unrecorded: unrecorded(flown),
        unanswered: u32::try_from(answers.missing() + answers.extra).unwrap_or(u32::MAX),
        exposed: u32::try_from(judged().filter(|(_, verdict)| verdict.is_some()).count())
            .unwrap_or(u32::MAX),
    }
}

/// Returns the number of exposures of which no record says anything: neither an exposure nor a
/// fault of the frame at that time.
fn unrecorded(flown: &Flown) -> u32 {
    let silent = flown.unrecorded.iter().filter(|light| {
        let opened_us = microseconds(light.opened_s);
        !flown.frames.iter().any(|frame| {
            let trigger_us = frame.record.trigger.us();
            let is_its_frame = (trigger_us..=trigger_us + FRAME_US).contains(&opened_us);
            let is_told = !frame.record.faults.is_empty()
                || matches!(frame.record.outcome, Recorded::Refused(_));
            is_its_frame && is_told
        })
    });
    u32::try_from(silent.count()).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::plan::Run;
    use crate::campaign::repeat;
    use crate::campaign::world::{CAMERA_TEXT, World};
    use crate::mechanics::Mechanics;
    use crate::mission::fault::InjectedFault;
    use crate::mission::flight_loop::{Flight, FlightOptions};
    use crate::mission::rig_camera::RigCamera;
    use crate::mission::scenario::MissionScenario;
    use fmc_camera_file::CameraFile;

    /// A seed that the scenario of the campaign does not have itself.
    const SEED: u64 = 2;

    /// Flies the scenario that repeats a run, from its start.
    fn repeated(run: &Run) -> Flown {
        let text = repeat::scenario_text(run, SEED, "camera.toml");
        let scenario = MissionScenario::parse_of_texts("finding.toml", &text, |_| {
            CameraFile::parse("camera.toml", CAMERA_TEXT)
        })
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
        let mut camera = RigCamera::default();
        camera
            .prepare(&scenario.camera.parameters(), &scenario.flight_settings())
            .unwrap();
        let seed = scenario.seed();
        let mechanics = Mechanics::seeded(scenario.written.mechanics, seed).unwrap();
        let options = FlightOptions {
            seed,
            frame: Some(0),
        };
        let flight = Flight::new(&scenario, options, mechanics, camera);
        flight.to_end(AFTER_US, |_, _| {}).unwrap()
    }

    #[test]
    fn copy_in_flight_flies_as_the_scenario_that_repeats_it_does_from_the_start() {
        let starts =
            World::ALL.map(|world| OriginalFlight::fly(world, SEED, RigCamera::default()).unwrap());
        let cases = Case::all();
        for (fault, tick) in InjectedFault::ALL.into_iter().zip((0..).step_by(10)) {
            let mut mine = cases.iter().filter(|case| case.fault == fault);
            let case = *mine.nth(5).unwrap();
            let other = cases[cases.len() / 3];
            let run = Run {
                number: 0,
                world: World::TwoSources,
                tick,
                faults: vec![(case, 0), (other, 40)],
            };
            let [_, start, _] = &starts;
            let mut flight = start.flight(tick).unwrap();
            let injections = injections(tick, &run.faults);
            for injection in &injections {
                flight.inject(*injection);
            }
            flight.end_triggers(last_trigger_us(&injections, &run.faults));
            let copied = flight.to_end(AFTER_US, |_, _| {}).unwrap();
            let whole = repeated(&run);
            assert_eq!(copied.frames, whole.frames, "{}", run.description());
            assert_eq!(copied.announced, whole.announced, "{}", run.description());
            assert_eq!(copied.states, whole.states, "{}", run.description());
            assert_eq!(copied.unrecorded, whole.unrecorded, "{}", run.description());
            assert!(copied.frames.len() > 30);
        }
    }

    #[test]
    fn run_without_a_fault_changes_nothing_and_a_jam_is_named() {
        let start = OriginalFlight::fly(World::OneSource, 1, RigCamera::default()).unwrap();
        let nothing = Case {
            duration_s: 1e-6,
            ..*Case::all().first().unwrap()
        };
        let outcome = fly(&start, 7, &[(nothing, 0)], 1.0).unwrap().unwrap();
        assert_eq!(outcome.arrived_ms, None);
        assert_eq!(outcome.effect, Outcome::NO_EFFECT);
        assert!(outcome.exposed >= 3 && outcome.silent_bad() == 0);
        let jam = Case::all()
            .into_iter()
            .find(|case| case.fault == InjectedFault::Stall && case.size > 50.0)
            .unwrap();
        let outcome = fly(&start, 7, &[(jam, 0)], 1.0).unwrap().unwrap();
        assert_eq!(outcome.effect, "fault stall");
        assert!(outcome.arrived_ms.is_some());
        assert_eq!(fly(&start, 360, &[(jam, 0)], 1.0).unwrap(), None);
    }
}
