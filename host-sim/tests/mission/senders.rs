//! Bytes of receiver and autopilot, as they leave for the camera.

use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::mavlink::{MavlinkReading, MavlinkReceiver};
use fmc_camera::io::nmea::{NmeaReading, NmeaReceiver};
use fmc_simulation::mission::aircraft::Aircraft;
use fmc_simulation::mission::fault::line::{Carried, SerialLine};
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::file::{VhSourceName, VhTable};
use fmc_simulation::mission::scenario::MissionScenario;
use fmc_simulation::mission::sensors::Sensors;

/// Sentences and messages that arrive within so many seconds.
fn sent(
    scenario: &MissionScenario,
    line: &SerialLine,
    injections: &[Injection],
    seconds: u64,
) -> (Vec<NmeaReading>, Vec<MavlinkReading>) {
    let mut sensors = Sensors::of(scenario, line, injections, 1);
    let aircraft = Aircraft::of(scenario, 1);
    let (mut nmea, mut mavlink) = (NmeaReceiver::new(), MavlinkReceiver::new());
    let (mut sentences, mut messages) = (Vec::new(), Vec::new());
    for round in 1..=1000 * seconds {
        sensors.arrivals(&aircraft, 1000 * round);
        let traffic = sensors.traffic().unwrap();
        let read = traffic
            .receiver
            .iter()
            .filter_map(|byte| nmea.receive(*byte));
        sentences.extend(read.map(Result::unwrap));
        let read = traffic
            .autopilot
            .iter()
            .filter_map(|byte| mavlink.receive(*byte));
        messages.extend(read.map(Result::unwrap));
    }
    (sentences, messages)
}

fn whole_line() -> SerialLine {
    SerialLine::new(Carried::everything(), &[])
}

/// Errors of the autopilot's speed, relative to the true one when it was measured.
fn speed_errors(scenario: &MissionScenario, injections: &[Injection]) -> Vec<f64> {
    let aircraft = Aircraft::of(scenario, 1);
    let (_, messages) = sent(scenario, &whole_line(), injections, 20);
    let speed = |reading: &MavlinkReading| match reading.samples.first() {
        Some(VhSample::GroundSpeed(speed_m_s)) => Some(f64::from(*speed_m_s)),
        _ => None,
    };
    let latency_s = scenario.written.vh[0].latency_ms / 1000.0;
    let speeds = messages.iter().filter_map(speed);
    speeds
        .zip(0_u16..)
        .map(|(speed_m_s, index)| {
            let time_s = 0.0007 + 0.02 * f64::from(index) - latency_s;
            let truth = aircraft.speed_and_height(time_s.max(0.0));
            speed_m_s / truth.ground_speed_m_s - 1.0
        })
        .collect()
}

#[test]
fn speed_of_the_autopilot_is_as_noisy_and_late_as_the_receivers_and_without_its_faults() {
    let scenario = MissionScenario::nominal(Some(20)).unwrap();
    let errors = speed_errors(&scenario, &[]);
    assert!(errors.len() > 990, "{}", errors.len());
    let count = f64::from(u32::try_from(errors.len()).unwrap());
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
    // Speed and height share 0.2 % of V/H; the standard error of 1000 deviates is 2 %.
    let expected = 0.002 / 2.0_f64.sqrt();
    assert!((rms / expected - 1.0).abs() < 0.08, "{rms} {expected}");
    let jump = Injection::new(InjectedFault::VhJump, 1.0);
    assert_eq!(speed_errors(&scenario, &[jump]), errors);
}

#[test]
fn time_of_a_silent_source_has_no_speed_and_that_of_another_its_own() {
    let scenario = MissionScenario::nominal(Some(20)).unwrap();
    let speeds_of_times = |injections: &[Injection]| {
        let (sentences, _) = sent(&scenario, &whole_line(), injections, 6);
        let times = sentences
            .into_iter()
            .filter(|sentence| sentence.unix_us.is_some());
        times.map(|time| time.sample).collect::<Vec<_>>()
    };
    let silent = Injection::new(InjectedFault::VhDropOut, 2.5);
    let found = speeds_of_times(&[silent]);
    let with_speed: Vec<bool> = found.iter().map(Option::is_some).collect();
    // The times of 0.42 s, 1.42 s and so on.
    assert_eq!(with_speed, [true, true, true, false, false, false]);
    let jump = Injection::new(InjectedFault::VhJump, 2.5).of_size(50.0);
    let [whole, jumped] = [&[][..], &[jump]].map(speeds_of_times);
    let speed = |sample: &Option<VhSample>| match sample {
        Some(VhSample::GroundSpeed(speed_m_s)) => *speed_m_s,
        other => panic!("{other:?}"),
    };
    for (index, (whole, jumped)) in whole.iter().zip(&jumped).enumerate() {
        let ratio = speed(jumped) / speed(whole);
        let expected = if index < 3 { 1.0 } else { 1.5 };
        assert!((ratio - expected).abs() < 1e-4, "{index}: {ratio}");
    }
}

#[test]
fn cut_line_of_a_source_loses_the_wires_that_it_sends_on() {
    let mut scenario = MissionScenario::nominal(Some(20)).unwrap();
    // The receiver belongs to the first source; the altimeter sends its height with the autopilot.
    let altimeter = scenario.written.vh[0].clone();
    scenario.written.vh = vec![
        VhTable {
            source: VhSourceName::Terrain,
            ..altimeter.clone()
        },
        altimeter,
    ];
    let cut = Injection::new(InjectedFault::UartCut, 0.0).of_size(100.0);
    for (carried, receiver_is_whole, autopilot_is_whole) in [
        ("altimeter", true, false),
        ("terrain", false, true),
        ("direct", true, true),
    ] {
        let line = SerialLine::new(Carried::of_names([carried].into_iter()), &[cut]);
        let (sentences, messages) = sent(&scenario, &line, &[cut], 2);
        let whole = (!sentences.is_empty(), !messages.is_empty());
        assert_eq!(whole, (receiver_is_whole, autopilot_is_whole), "{carried}");
    }
}
