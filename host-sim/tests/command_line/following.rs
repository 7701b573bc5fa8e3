//! `records --follow`: a line and a row for each frame of a camera that flies.

use std::fs;
use std::io::{BufRead as _, BufReader, Lines};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::process::{Child, ChildStdout, Stdio};
use std::sync::mpsc;
use std::thread;

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::message::{Answer, ResetCause};
use rustix::process::{Pid, Signal, kill_process};

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::records::fly;
use crate::command_line::serial::Port;
use crate::command_line::signals::ctrl_c;
use crate::command_line::support::Bench;

/// Rounds of bytes from one trigger to the next.
const TRIGGER_EVERY: u32 = 10;

/// Serves a camera that meets a trigger now and then; returns its device and its connections.
fn camera() -> (String, mpsc::Receiver<TcpStream>) {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let device = format!("tcp:127.0.0.1:{}", listener.local_addr().unwrap().port());
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut camera = FakeCamera::with(FlownDeck::new(drive, ResetCause::PowerOn.unreferenced()));
    let (mut round, mut now) = (0_u32, Time::START);
    camera.before = Box::new(move |deck: &mut FlownDeck<RigDrive>| {
        round += 1;
        now = now.plus_s(1e-3);
        if round.is_multiple_of(TRIGGER_EVERY) && deck.controller().is_some() {
            deck.capture(now, Event::Trigger);
        }
        deck.round(now);
    });
    let (connected, connections) = mpsc::channel();
    thread::spawn(move || {
        for wire in listener.incoming() {
            let mut wire = wire.unwrap();
            let _ = connected.send(wire.try_clone().unwrap());
            camera.serve(&mut wire);
        }
    });
    (device, connections)
}

/// A program that follows, and the lines that it has not printed yet.
struct Follower {
    program: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Follower {
    fn start(bench: &Bench, device: &str, out: &str) -> Self {
        let mut command = bench.command(&["records", "--device", device, "--follow", "--out", out]);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = command.spawn().unwrap();
        let lines = BufReader::new(program.stdout.take().unwrap()).lines();
        Self { program, lines }
    }

    /// The numbers with which the next lines begin.
    fn numbers(&mut self, count: usize) -> Vec<u32> {
        let lines = self.lines.by_ref().take(count).map(Result::unwrap);
        let number = |line: String| line.split(' ').next().unwrap().parse().unwrap();
        lines.map(number).collect()
    }

    fn signal(&self, signal: Signal) {
        let pid = Pid::from_child(&self.program);
        kill_process(pid, signal).unwrap();
    }

    /// Waits for the end. Returns exit code, the last line, and the error stream.
    fn end(self) -> (Option<i32>, String, String) {
        let last = self.lines.map(Result::unwrap).last().unwrap_or_default();
        let output = self.program.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), last, said)
    }
}

/// Returns the numbers of the rows of a table, which must be whole.
fn rows(bench: &Bench, folder: &str) -> Vec<u32> {
    let table = fs::read_to_string(bench.path(folder).join("records.csv")).unwrap();
    assert!(table.ends_with('\n'));
    let mut table = csv::Reader::from_reader(table.as_bytes());
    let number = |row: csv::Result<csv::StringRecord>| row.unwrap()[0].parse().unwrap();
    table.records().map(number).collect()
}

fn prepare(bench: &Bench, device: &str) {
    let prepare = ["camera", "--device", device, "prepare"];
    bench
        .run(&[&prepare[..], &["--camera", "camera.toml"]].concat())
        .ok();
}

#[test]
fn frames_are_lines_and_rows_as_they_come_until_ctrl_c_a_cut_link_or_a_kill() {
    let (bench, (device, connections)) = (Bench::new(), camera());
    let out = ["records", "--device", &device, "--follow", "--out", "early"];
    bench.run(&out).failed(3, &["not been prepared"]);
    assert!(!bench.path("early").exists());
    prepare(&bench, &device);

    let mut asked = Follower::start(&bench, &device, "asked");
    assert_eq!(asked.numbers(3), [1, 2, 3]);
    asked.signal(ctrl_c());
    let (code, last, said) = asked.end();
    assert_eq!((code, said.as_str()), (Some(0), ""), "{last}");
    let count = rows(&bench, "asked").len();
    assert!(
        last.contains(&format!("{count} records, of triggers 1 to {count}")),
        "{last}"
    );
    let json = fs::read(bench.path("asked/records.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(json["records"].as_array().unwrap().len(), count);

    // A folder with records is not written into.
    bench
        .run(&["records", "--device", &device, "--follow", "--out", "asked"])
        .refused(&["asked/records.csv", "another folder"]);

    let mut killed = Follower::start(&bench, &device, "killed");
    let first = killed.numbers(1);
    assert_eq!(first, [u32::try_from(count).unwrap() + 1]);
    killed.signal(Signal::KILL);
    assert_eq!(killed.end().0, None);
    assert_eq!(rows(&bench, "killed")[0], first[0]);
    assert!(!bench.path("killed/records.json").exists());

    for connection in connections.try_iter() {
        let _ = connection.shutdown(Shutdown::Both);
    }
    let mut cut = Follower::start(&bench, &device, "cut");
    cut.numbers(2);
    let connection = connections.try_iter().last().unwrap();
    connection.shutdown(Shutdown::Both).unwrap();
    let (code, last, said) = cut.end();
    assert_eq!(code, Some(3), "{said}");
    let count = rows(&bench, "cut").len();
    assert!(last.starts_with(&format!("{count} records")), "{last}");
    for part in [
        "these records are complete",
        "--earlier cut",
        "the port closed",
    ] {
        assert!(said.contains(part), "{said}");
    }

    // The advice holds, also for a folder without records.json.
    let mut rest = vec!["records", "--device", &device, "--out", "rest"];
    for folder in ["asked", "killed", "cut"] {
        rest.extend(["--earlier", folder]);
    }
    bench.run(&rest).ok();
    let of = |folder| rows(&bench, folder);
    let mut all = [of("asked"), of("killed"), of("cut"), of("rest")].concat();
    all.dedup();
    assert!(all.iter().copied().eq(1..=*all.last().unwrap()), "{all:?}");
}

#[test]
fn ctrl_c_and_sigterm_complete_the_files_after_records_have_been_marked() {
    for signal in [ctrl_c(), Signal::TERM] {
        let bench = Bench::new();
        let mut camera = FakeCamera::new();
        // A crossing of the index mark after two of the three records that are left.
        camera.change = |answer| {
            if let Answer::Status(status) = answer
                && status.kept < 2
            {
                status.in_doubt = Some(InDoubt::between([1, 3], 0.0162, true));
            }
        };
        let port = Port::with_camera(camera);
        let device = fly(&bench, &port);
        let mut follower = Follower::start(&bench, &device, "marked");
        assert_eq!(follower.numbers(2), [2, 3]);
        let doubt = follower.lines.next().unwrap().unwrap();
        assert!(
            doubt.starts_with("in doubt by 16.20 µm, and marked: 2"),
            "{doubt}"
        );
        assert_eq!(follower.numbers(1), [4]);
        follower.signal(signal);
        let (code, last, said) = follower.end();
        assert_eq!(code, Some(0), "{last}; {said}");
        assert!(last.starts_with("3 records, of triggers 2 to 4"), "{last}");
        assert_eq!(rows(&bench, "marked"), [2, 3, 4]);
        assert!(bench.path("marked/records.json").exists());
    }
}
