//! `camera inputs`, `jog`, `duty` and `shutter`: a board before a camera is loaded.

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Action, Event, ShutterEdge};
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::message::ResetCause;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::support::Bench;

/// Rounds of the control loop between two looks at the link.
const ROUNDS: u32 = 50;

/// A board whose stage of 0.3 kg and 22 N·s/m has a force of `force_n` at full duty, and whose
/// shutter has a sensor or none.
fn board(force_n: f32, has_sensor: bool) -> Port {
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let deck = FlownDeck::new(drive, ResetCause::PowerOn.unreferenced());
    let mut camera = FakeCamera::with(deck);
    let (mut now, mut way_mm, mut speed_mm_s) = (Time::START, 0.0, 0.0);
    camera.before = Box::new(move |deck: &mut FlownDeck<RigDrive>| {
        for _ in 0..ROUNDS {
            now = now.plus_s(1e-3);
            for _ in 0..10 {
                let force_n = force_n * deck.drive().duty() - 22e-3 * speed_mm_s;
                speed_mm_s += 1e3 * force_n / 0.3 * 1e-4;
                way_mm += speed_mm_s * 1e-4;
            }
            let counts = format!("{:.0}", 1e4 * way_mm).parse().unwrap();
            deck.drive_mut().set_count(counts);
            for action in deck.round(now) {
                if matches!(action, Action::OpenShutter { .. }) && has_sensor {
                    for edge in [ShutterEdge::Opened, ShutterEdge::Closed] {
                        deck.capture(now, Event::Shutter(edge));
                    }
                }
            }
        }
    });
    Port::with_camera(camera)
}

fn run(bench: &Bench, port: &Port, action: &[&str]) -> crate::command_line::support::Answer {
    bench.run(&[&["camera", "--device", &port.device()], action].concat())
}

#[test]
fn lines_are_shown_and_trials_are_made_before_a_camera_is_loaded() {
    let (bench, port) = (Bench::new(), board(6.0, true));
    let shown = run(&bench, &port, &["inputs"]).ok().stdout;
    for part in [
        "none is closed",
        "0 trigger",
        "mm from its zero",
        "not measured",
    ] {
        assert!(shown.contains(part), "{shown}");
    }
    let jog = run(&bench, &port, &["jog", "-100"]).ok().stdout;
    assert!(jog.starts_with("jog of -100 µm, "), "{jog}");
    assert!(jog.contains("complete, moved by -"), "{jog}");
    let duty = run(&bench, &port, &["duty", "0.05", "--for", "0.02"])
        .ok()
        .stdout;
    assert!(
        duty.starts_with("duty 0.05 for 0.02 s: complete, moved by +1"),
        "{duty}"
    );
    let shutter = run(&bench, &port, &["shutter", "1/200"]).ok().stdout;
    assert!(
        shutter.contains("1 shutter opened, 1 shutter closed"),
        "{shutter}"
    );
    let json = run(&bench, &port, &["inputs", "--json"]).ok().stdout;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["edges"]["shutter_opened"], 1);
    assert_eq!(json["trial"]["end"], "Done");
}

#[test]
fn trial_that_fails_says_why_and_what_to_look_at() {
    let bench = Bench::new();
    let reversed = board(-6.0, false);
    for (action, named) in [
        (["jog", "100"], ["does not follow", "reversed"]),
        (["shutter", "1/100"], ["0 edges \"opened\"", "connected"]),
    ] {
        // The trial itself is shown, too.
        let answer = run(&bench, &reversed, &action);
        assert_eq!(answer.code, 1, "{}", answer.stderr);
        assert!(answer.stdout.starts_with(action[0]), "{}", answer.stdout);
        for part in named {
            assert!(answer.stderr.contains(part), "{}", answer.stderr);
        }
    }
    let held = board(0.0, false);
    for (action, named) in [
        (&["jog", "20"][..], "encoder is silent"),
        (&["duty", "0.2", "--for", "0.2"], "encoder stood still"),
    ] {
        let answer = run(&bench, &held, action);
        assert_eq!(answer.code, 1, "{}", answer.stderr);
        assert!(answer.stderr.contains(named), "{}", answer.stderr);
    }
    for (action, named) in [
        (&["jog", "201"][..], "-200"),
        (&["jog", "nan"], "not a number"),
        (&["duty", "0.3"], "0.2"),
        (&["duty", "0.1", "--for", "1"], "0.2"),
        (&["shutter", "1"], "0.1"),
        (&["shutter", "-1"], "positive"),
    ] {
        run(&bench, &reversed, action).refused(&[named]);
    }
    // A camera that is prepared, and one on a rig.
    run(&bench, &reversed, &["prepare", "--camera", "camera.toml"]).ok();
    run(&bench, &reversed, &["inputs"]).ok();
    for action in [&["jog", "10"][..], &["duty", "0.1"], &["shutter", "1/100"]] {
        run(&bench, &reversed, action).failed(3, &["prepared for flight", "switched off and on"]);
    }
    let rig = Port::with_camera(FakeCamera::new());
    run(&bench, &rig, &["inputs"]).failed(3, &["test rig"]);
    run(&bench, &rig, &["jog", "10"]).failed(3, &["test rig"]);
}
