//! The faults of `docs/integration.md`: their consequences, and the ways out of them.

use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::{Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::settings::FlightSettings;

use crate::controller::bench::{Bench, camera};

const DOCUMENT: &str = include_str!("../../docs/integration.md");

/// Returns code, *leads to* and *ends* of the table of faults.
fn documented() -> Vec<[&'static str; 3]> {
    DOCUMENT
        .lines()
        .skip_while(|line| !line.starts_with("| code |"))
        .skip(2)
        .map_while(|line| line.strip_prefix("| "))
        .map(|row| {
            let cells: Vec<_> = row.split(" | ").collect();
            [cells[0], cells[2], cells[3]]
        })
        .collect()
}

/// Returns a camera in a state after a trigger.
fn in_state(state: State) -> Bench {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == state);
    bench
}

/// Returns a camera whose stage departs from its set points: its motion from now on is multiplied
/// by `factor`.
fn moving_by(factor: f32) -> Bench {
    let mut bench = in_state(State::Tracking);
    bench.is_read = false;
    let place_mm = bench.place_mm();
    for _ in 0..10 {
        bench.round();
        let reading = StageReading {
            time: bench.now,
            offset_mm: place_mm + factor * (bench.place_mm() - place_mm),
        };
        bench.send(Event::Stage(reading));
        if let State::Fault(_) = bench.camera.controller().state() {
            break;
        }
    }
    bench
}

/// Returns a camera in which the fault has just happened.
fn with(fault: Fault) -> Bench {
    match fault {
        Fault::Stall => {
            let mut bench = in_state(State::Tracking);
            bench.stage_follows = false;
            bench
        }
        Fault::Runaway => moving_by(4.0),
        Fault::WrongDirection => moving_by(-1.0),
        Fault::LimitSwitch => {
            let mut bench = in_state(State::RunUp);
            bench.send(Event::LimitSwitch);
            bench
        }
        Fault::Encoder | Fault::Drive => {
            let mut bench = in_state(State::RunUp);
            bench.send(Event::Drive(fault));
            bench
        }
        Fault::IndexMark => {
            let mut settings = FlightSettings::default();
            settings.drive.index_mm = Some(0.0);
            let mut bench = Bench::new(settings);
            bench.arm();
            bench.index_is_seen = false;
            for _ in 0..3 {
                bench.send(Event::Trigger);
                bench.run(300);
            }
            bench
        }
        Fault::ShutterLate => {
            let mut bench = Bench::armed();
            bench.shutter_late_s = 0.0025;
            bench.send(Event::Trigger);
            bench
        }
        Fault::ShutterMissing => {
            let mut bench = Bench::armed();
            bench.shutter_obeys = false;
            bench.send(Event::Trigger);
            bench
        }
        Fault::ShutterUnexpected => {
            let mut bench = in_state(State::Exposing);
            bench.send(Event::Shutter(ShutterEdge::Opened));
            bench
        }
        Fault::ShutterLong => {
            let mut bench = in_state(State::Exposing);
            bench.edges.clear();
            bench
        }
        Fault::ShutterShort => {
            let mut bench = in_state(State::Exposing);
            bench.edges = vec![(bench.now.plus_s(1e-3), ShutterEdge::Closed)];
            bench
        }
        Fault::Overload => {
            let mut bench = Bench::armed();
            for _ in 0..3 {
                bench.now = bench.now.plus_s(0.004);
                bench.round();
            }
            bench
        }
        Fault::Clock => {
            let mut bench = in_state(State::RunUp);
            bench.now = bench.now.plus_s(2.0);
            bench
        }
        Fault::BrownOut => {
            let mut bench = in_state(State::RunUp);
            bench.send(Event::Supply(Supply::Low));
            bench
        }
        Fault::Watchdog => Bench::with(&camera(), FlightSettings::default(), Start::AfterWatchdog),
        Fault::VhLost => {
            let mut bench = Bench::armed();
            bench.vh_per_s = None;
            bench
        }
    }
}

/// Returns the states to which the fault leads, in the document's words.
fn leads_to(bench: &mut Bench, fault: Fault) -> String {
    let mut found: Vec<&str> = Vec::new();
    for _ in 0..8000 {
        let state = bench.camera.controller().state();
        if let State::Fault(it) | State::Degraded(it) = state {
            assert_eq!(it, fault);
            if found.last() != Some(&state.name()) {
                found.push(state.name());
            }
        }
        // [`ends`] checks that it recovers.
        if let State::Degraded(_) = state {
            break;
        }
        bench.round();
    }
    if found.is_empty() {
        "stays".to_owned()
    } else {
        found.join(", then ")
    }
}

/// Returns the way in which the camera is armed again once the cause has gone, in the document's
/// words.
fn ends(bench: &mut Bench) -> &'static str {
    bench.is_read = true;
    bench.stage_follows = true;
    bench.vh_per_s = Some(0.1);
    if let State::Fault(Fault::BrownOut) = bench.camera.controller().state() {
        bench.send(Event::Supply(Supply::Good));
    }
    bench.run(3000);
    if bench.camera.controller().state() == State::Armed {
        return "by itself";
    }
    bench.send(Event::Command(Command::Arm));
    bench.run(2000);
    assert_ne!(
        bench.camera.controller().state(),
        State::Armed,
        "not cleared"
    );
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Arm));
    bench.run(2000);
    if bench.camera.controller().state() == State::Armed {
        return "clear, arm";
    }
    assert_eq!(
        bench.camera.controller().state(),
        State::Degraded(Fault::Encoder)
    );
    bench.send(Event::Command(Command::ClearFault));
    bench.send(Event::Command(Command::Referenced));
    bench.arm();
    "clear, reference, arm"
}

#[test]
fn faults_lead_to_what_the_document_says() {
    let found: Vec<_> = Fault::ALL
        .into_iter()
        .map(|fault| {
            let mut bench = with(fault);
            let leads_to = leads_to(&mut bench, fault);
            let is_known = bench.records().iter().any(|it| it.faults.contains(fault));
            let is_of_no_frame = matches!(fault, Fault::Overload | Fault::Watchdog | Fault::VhLost);
            assert!(is_known || is_of_no_frame, "{fault} is in no record");
            [
                fault.code().to_string(),
                leads_to,
                ends(&mut bench).to_owned(),
            ]
        })
        .collect();
    assert_eq!(documented(), found);
}

/// Returns the name and the states of each machine in the document.
fn machines() -> Vec<[&'static str; 2]> {
    DOCUMENT
        .lines()
        .skip_while(|line| !line.starts_with("| machine |"))
        .skip(2)
        .map_while(|line| line.strip_prefix("| "))
        .map(|row| {
            let cells: Vec<_> = row.split(" | ").collect();
            [cells[0], cells[1]]
        })
        .collect()
}

#[test]
fn every_state_is_one_of_the_documented_machines() {
    let machines = machines();
    assert_eq!(
        machines.iter().map(|[name, _]| *name).collect::<Vec<_>>(),
        ["`readiness`", "`frame`", "`stage`"]
    );
    let fault = Fault::Drive;
    for (state, machine, word) in [
        (State::Standby, "`readiness`", "standby"),
        (State::Armed, "`readiness`", "armed"),
        (State::Degraded(fault), "`readiness`", "degraded"),
        (State::FlyBack, "`readiness`", "flying back"),
        (State::Fault(fault), "`readiness`", "fault"),
        (State::RunUp, "`frame`", "run-up"),
        (State::Tracking, "`frame`", "tracking"),
        (State::Exposing, "`frame`", "exposing"),
    ] {
        let [_, is] = machines.iter().find(|[name, _]| *name == machine).unwrap();
        assert!(is.contains(word), "{state}: {is}");
    }
}
