//! Faults of the attitude that the camera is told.

use fmc_camera::flight::event::AttitudeSample;
use fmc_camera_file::number::single;

use super::{InjectedFault, Injection, active};
use crate::mission::aircraft::Aircraft;

/// Returns attitude and rates as they are reported at a time, s, with the faults.
pub(in crate::mission) fn reported(
    injections: &[Injection],
    aircraft: &Aircraft,
    time_s: f64,
) -> AttitudeSample {
    let kept_s = active(injections, InjectedFault::AttitudeFrozen, time_s)
        .map_or(time_s, |frozen| (frozen.onset_s - frozen.size).max(0.0));
    let mut sample = aircraft.attitude_sample(kept_s);
    if let Some(factor) = active(injections, InjectedFault::AttitudeWrong, time_s) {
        let turn = |value: f32| value * single(factor.size);
        sample.pitch_deg = turn(sample.pitch_deg);
        sample.roll_deg = turn(sample.roll_deg);
        sample.drift_deg = turn(sample.drift_deg);
        sample.rates_deg_s = sample.rates_deg_s.map(turn);
    }
    sample
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::scenario::MissionScenario;

    fn rates(fault: InjectedFault, size: f64) -> [[f32; 3]; 3] {
        let scenario = MissionScenario::nominal(Some(3)).unwrap();
        let aircraft = Aircraft::of(&scenario, 1);
        let injection = [Injection::new(fault, 1.0).of_size(size).lasting(1.0)];
        [0.5, 1.5, 2.5].map(|time_s| reported(&injection, &aircraft, time_s).rates_deg_s)
    }

    #[test]
    fn attitude_stays_or_has_the_wrong_sign_while_the_fault_lasts() {
        let scenario = MissionScenario::nominal(Some(3)).unwrap();
        let aircraft = Aircraft::of(&scenario, 1);
        let [before, true_rates, after] =
            [0.5, 1.5, 2.5].map(|time_s| aircraft.attitude_sample(time_s).rates_deg_s);
        let kept = aircraft.attitude_sample(0.8).rates_deg_s;
        assert_eq!(
            rates(InjectedFault::AttitudeFrozen, 0.2),
            [before, kept, after]
        );
        let turned = true_rates.map(|rate| -rate);
        assert_eq!(
            rates(InjectedFault::AttitudeWrong, -1.0),
            [before, turned, after]
        );
        assert!((true_rates[0] - kept[0]).abs() > 0.0 && true_rates[0].abs() > 0.0);
    }
}
