//! Jams, each of which the camera names within 5 ms, in every phase of the motion.

use fmc_camera::flight::fault::Fault;
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::trace::Round;

use crate::mission::support::flown_with;
use crate::mission::sweep::with;

/// Phase of the required motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// The stage gains speed in the direction of flight.
    RunUp,
    /// The stage moves at constant speed.
    Cruise,
    /// The stage loses speed, or is in fly-back.
    Ramp,
}

fn phase(round: &Round) -> Option<Phase> {
    let setpoint = round.setpoint?;
    // A slower stage on a ramp of 1 m/s² comes to rest within the following tolerance, so that the
    // jam does not show.
    if setpoint.speed_mm_s.abs() < 5.0 {
        return None;
    }
    Some(if setpoint.acceleration_mm_s2.abs() < 1.0 {
        Phase::Cruise
    } else if setpoint.speed_mm_s > 0.0 && setpoint.acceleration_mm_s2 > 0.0 {
        Phase::RunUp
    } else {
        Phase::Ramp
    })
}

#[test]
fn jam_is_named_within_five_ms_in_run_up_cruise_and_ramp() {
    // The reference is a flight without the jam.
    let never = Injection::new(InjectedFault::Stall, 1e6);
    let trace = flown_with(&with(never), 3, Some(3)).trace.unwrap();
    let mut jams = [
        (Phase::RunUp, 0, 0),
        (Phase::Cruise, 0, 0),
        (Phase::Ramp, 0, 0),
    ];
    for round in &trace.rounds {
        let Some(phase) = phase(round) else {
            continue;
        };
        let onset_us = round.time_us;
        let onset_s = 1e-6 * f64::from(u32::try_from(onset_us).unwrap());
        let jam = Injection::new(InjectedFault::Stall, onset_s).lasting(0.05);
        let flown = flown_with(&with(jam), 3, None);
        let named_us = flown
            .announced
            .iter()
            .find(|(time_us, fault)| *time_us >= onset_us && *fault == Fault::Stall)
            .map(|(time_us, _)| *time_us);
        let after_us = named_us.map(|named_us| named_us - onset_us);
        let [run_up, cruise, ramp] = &mut jams;
        let (_, flights, latest_us) = match phase {
            Phase::RunUp => run_up,
            Phase::Cruise => cruise,
            Phase::Ramp => ramp,
        };
        *flights += 1;
        *latest_us = after_us.unwrap_or(u64::MAX).max(*latest_us);
    }
    for (phase, flights, latest_us) in jams {
        assert!(flights >= 5, "{phase:?}: {flights} jams");
        assert!(latest_us <= 5000, "{phase:?}: {latest_us} µs");
    }
}
