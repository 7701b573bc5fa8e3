//! `--device tcp:HOST:PORT`: a camera whose link is forwarded.

use std::net::TcpListener;
use std::thread;

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::message::ResetCause;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::support::Bench;

/// A listener on a free port of this PC, and its device.
fn listener() -> (TcpListener, String) {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let device = format!("tcp:127.0.0.1:{}", listener.local_addr().unwrap().port());
    (listener, device)
}

/// Serves a camera that meets a trigger before its second round of bytes, one program after
/// another.
fn camera() -> String {
    let (listener, device) = listener();
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut camera = FakeCamera::with(FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()));
    let mut now = Time::START;
    camera.before = Box::new(move |deck: &mut FlownDeck<RigDrive>| {
        now = now.plus_s(1e-3);
        if deck
            .controller()
            .is_some_and(|it| it.counts().triggers == 0)
        {
            deck.capture(now, Event::Trigger);
        }
        deck.round(now);
    });
    thread::spawn(move || {
        for wire in listener.incoming() {
            camera.serve(&mut wire.unwrap());
        }
    });
    device
}

#[test]
fn camera_behind_tcp_is_prepared_watched_and_its_records_are_fetched() {
    let (bench, device) = (Bench::new(), camera());
    let camera = |action: &[&str]| bench.run(&[&["camera", "--device", &device], action].concat());
    camera(&["prepare", "--camera", "camera.toml"]).ok();
    let status = camera(&["status"]).ok().stdout;
    assert!(status.contains("1: 0 exposed, 1 refused"), "{status}");
    let fetched = bench
        .run(&["records", "--device", &device, "--out", "kept"])
        .ok();
    assert!(fetched.stdout.contains("1 records"), "{}", fetched.stdout);
    let status = camera(&["status"]).ok().stdout;
    assert!(status.contains("0 to be fetched"), "{status}");
}

#[test]
fn address_without_a_camera_is_named_with_what_to_look_at() {
    let bench = Bench::new();
    let (nobody, device) = listener();
    drop(nobody);
    let address = device.strip_prefix("tcp:").unwrap();
    bench
        .run(&["camera", "--device", &device, "status"])
        .failed(3, &[address, "no connection", "forwards"]);
    // Something that closes every connection.
    let (closing, device) = listener();
    thread::spawn(move || closing.incoming().for_each(drop));
    bench
        .run(&["camera", "--device", &device, "status"])
        .failed(3, &["does not answer as a camera"]);
}
