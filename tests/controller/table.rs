//! Every event in every state.

use std::fmt::Write;

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::{AttitudeSample, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Outcome;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;

use crate::controller::bench::Bench;

/// Table of each event in each state: the next state and the records made, at once; for a tick,
/// within the next 10 ms without other events.
const TABLE: &str = include_str!("table.csv");

/// Returns cameras in every state.
fn states() -> Vec<Bench> {
    let flying = |state| {
        let mut bench = Bench::armed();
        bench.send(Event::Trigger);
        bench.run_until(100, |it| it == state);
        bench
    };
    let standby = {
        let mut bench = Bench::new(FlightSettings::default());
        bench.run(2);
        bench
    };
    let degraded = {
        let mut bench = flying(State::RunUp);
        bench.send(Event::Drive(Fault::Drive));
        bench.run_until(100, |it| it == State::Degraded(Fault::Drive));
        bench
    };
    let without_vh = {
        let mut bench = Bench::armed();
        bench.vh_per_s = None;
        bench.run_until(20_000, |it| it == State::Degraded(Fault::VhLost));
        bench
    };
    let failed = {
        let mut bench = flying(State::RunUp);
        bench.send(Event::Drive(Fault::Drive));
        bench
    };
    let without_supply = {
        let mut bench = Bench::armed();
        bench.send(Event::Supply(Supply::Low));
        bench
    };
    vec![
        standby,
        Bench::armed(),
        degraded,
        without_vh,
        flying(State::RunUp),
        flying(State::Tracking),
        flying(State::Exposing),
        flying(State::FlyBack),
        failed,
        without_supply,
    ]
}

fn events(bench: &Bench) -> Vec<(&'static str, Event)> {
    let at = |offset_mm| {
        Event::Stage(StageReading {
            time: bench.now,
            offset_mm,
        })
    };
    vec![
        ("arm", Event::Command(Command::Arm)),
        ("disarm", Event::Command(Command::Disarm)),
        ("clear fault", Event::Command(Command::ClearFault)),
        ("exposure", Event::Command(Command::Exposure(0.005))),
        ("focus shift", Event::Command(Command::FocusShift(10.0))),
        ("temperature", Event::Command(Command::Temperature(20.0))),
        ("V/H", Event::Vh(VhSample::Direct(0.1))),
        ("V/H not a number", Event::Vh(VhSample::Direct(f32::NAN))),
        (
            "attitude",
            Event::Attitude(AttitudeSample {
                pitch_deg: 1.0,
                roll_deg: 1.0,
                drift_deg: 1.0,
                rates_deg_s: [0.1; 3],
            }),
        ),
        ("time pulse", Event::TimePulse),
        ("GNSS time", Event::GnssTime(1_800_000_000)),
        ("trigger", Event::Trigger),
        ("shutter opened", Event::Shutter(ShutterEdge::Opened)),
        ("shutter closed", Event::Shutter(ShutterEdge::Closed)),
        ("stage where it should be", at(bench.place_mm())),
        ("stage not a number", at(f32::NAN)),
        ("limit switch", Event::LimitSwitch),
        ("drive", Event::Drive(Fault::Drive)),
        ("supply low", Event::Supply(Supply::Low)),
        ("supply good", Event::Supply(Supply::Good)),
        ("tick", Event::Tick),
    ]
}

fn name(state: State) -> String {
    state.to_string().replace(", ", " ")
}

#[test]
fn every_event_in_every_state_does_what_the_table_says() {
    let mut found = String::from("state,event,next state,records\n");
    for (index, bench) in states().iter().enumerate() {
        let before = bench.camera.controller().state();
        for (event_name, event) in events(bench) {
            let mut bench = states().swap_remove(index);
            let kept = bench.records().len();
            let triggers = bench.camera.controller().counts().triggers;
            bench.now = bench.now.plus_s(1e-4);
            bench.send(event);
            let next = bench.camera.controller().state();
            let made = bench.records().len() - kept;
            writeln!(found, "{},{event_name},{},{made}", name(before), name(next)).unwrap();
            // After any event, every trigger gets its record within a second.
            bench.run(1000);
            let counts = bench.camera.controller().counts();
            assert_eq!(
                counts.triggers,
                counts.exposed + counts.refused,
                "{event_name}"
            );
            assert!(counts.triggers - triggers <= 1);
            assert_eq!(
                bench.records().len(),
                usize::try_from(counts.triggers).unwrap()
            );
        }
    }
    if std::env::var_os("FMC_WRITE_TABLE").is_some() {
        std::fs::write("tests/controller/table.csv", &found).unwrap();
    }
    for (found, expected) in found.lines().zip(TABLE.lines()) {
        assert_eq!(found, expected);
    }
    assert_eq!(found.lines().count(), TABLE.lines().count());
}

/// Triggers come at random, far closer than the mechanism allows as well as far apart.
#[test]
fn a_million_random_triggers_are_all_answered() {
    const TRIGGERS: u32 = 1_000_000;
    let mut bench = Bench::armed();
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = move || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        random
    };
    let (mut exposed, mut refused, mut expected) = (0_u32, 0_u32, 1);
    let mut triggers = 0;
    while triggers < TRIGGERS {
        let burst = match next() % 8 {
            0 => 0,
            // These are more than the record log has room for.
            1 if next() % 64 == 0 => 100,
            few => few,
        };
        for _ in 0..burst {
            let stamp = Time::from_us(bench.now.us() + next() % 1000);
            bench.send_at(stamp, Event::Trigger);
            triggers += 1;
        }
        bench.actions.clear();
        bench.run(1 + u32::try_from(next() % 4).unwrap());
        while let Some(record) = bench.camera.controller().record(expected) {
            assert_eq!(record.sequence, expected);
            expected += 1;
            match record.outcome {
                Outcome::Exposed(_) => exposed += 1,
                Outcome::Refused(_) => refused += 1,
            }
        }
        bench.camera.controller_mut().acknowledge(expected - 1);
    }
    bench.run(1000);
    while let Some(record) = bench.camera.controller().record(expected) {
        expected += 1;
        match record.outcome {
            Outcome::Exposed(_) => exposed += 1,
            Outcome::Refused(_) => refused += 1,
        }
    }
    assert_eq!(exposed + refused, triggers);
    let counts = bench.camera.controller().counts();
    assert_eq!(
        (counts.triggers, counts.exposed, counts.refused),
        (triggers, exposed, refused)
    );
    assert!(exposed > 1000, "{exposed} exposed");
}
