//! Programs that a signal or a full disk ends while they write: the folder stays as it was.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use rustix::fs::{CWD, Mode, OFlags, openat};
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process, waitid};

use crate::command_line::signals::is_ignored;
use crate::command_line::support::{Answer, Bench, CAMERA, EXPOSURE};

/// Runs until one is caught while it writes; most are at the first.
const ATTEMPTS: usize = 200;

/// A camera whose frames have 4 megapixels.
const LARGE: &str = r#"name = "Large camera"
principal_distance_mm = 20.0
[sensor]
width_px = 2000
height_px = 2000
pixel_um = 4.0
[distortion]
k1 = -1.0e-4
[fmc]
axis = "+y"
stroke_mm = 4.0
"#;

/// Returns the files below a folder with their bytes.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(contents(&path));
        } else {
            files.insert(path.clone(), fs::read(&path).unwrap());
        }
    }
    files
}

/// Returns the signals that end a program without leaving it a choice, and those that a caller of
/// this test has not told its children to ignore.
fn signals(folder: &Path) -> Vec<Signal> {
    let mut signals = vec![Signal::TERM];
    let others = [Signal::INT, Signal::HUP].into_iter();
    signals.extend(others.filter(|signal| !is_ignored(*signal)));
    // A file that has a name from the beginning is left by this one for the next program.
    let flags = OFlags::TMPFILE | OFlags::RDWR;
    if openat(CWD, folder, flags, Mode::RUSR).is_ok() {
        signals.push(Signal::KILL);
    }
    signals
}

/// Returns true if a program has a file below a folder open, which has bytes but not its name.
fn is_writing(child: &Child, folder: &Path) -> bool {
    let Ok(handles) = fs::read_dir(format!("/proc/{}/fd", child.id())) else {
        return false;
    };
    handles.filter_map(Result::ok).any(|handle| {
        let is_unfinished = fs::read_link(handle.path()).is_ok_and(|name| {
            let text = name.to_string_lossy();
            name.starts_with(folder) && (text.ends_with(" (deleted)") || text.ends_with(".part"))
        });
        is_unfinished && fs::metadata(handle.path()).is_ok_and(|file| file.len() > 0)
    })
}

/// Interrupts a program while it writes, by every signal.
fn interrupt(bench: &Bench, arguments: &[&str]) {
    let folder = bench.folder().canonicalize().unwrap();
    let before = contents(&folder);
    for signal in signals(&folder) {
        let caught = (0..ATTEMPTS).any(|_| {
            let caught = interrupt_once(bench, &folder, arguments, signal);
            if !caught {
                // It was complete before; the folder is made again what it was.
                for path in contents(&folder).into_keys() {
                    if let Some(bytes) = before.get(&path) {
                        fs::write(path, bytes).unwrap();
                    } else {
                        fs::remove_file(path).unwrap();
                    }
                }
            }
            caught
        });
        assert!(caught, "{arguments:?} is never caught while it writes");
        assert_eq!(
            contents(&folder).keys().collect::<Vec<_>>(),
            before.keys().collect::<Vec<_>>(),
            "{arguments:?}, {signal:?}"
        );
        assert!(contents(&folder) == before, "{arguments:?}, {signal:?}");
    }
}

/// Returns true if the signal came while the program was writing.
fn interrupt_once(bench: &Bench, folder: &Path, arguments: &[&str], signal: Signal) -> bool {
    let mut child = bench
        .command(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let pid = Pid::from_child(&child);
    let until = Instant::now() + Duration::from_mins(2);
    while child.try_wait().unwrap().is_none() {
        assert!(Instant::now() < until, "{arguments:?} does not end");
        if is_writing(&child, folder) {
            // It is looked at again while it stands still.
            kill_process(pid, Signal::STOP).unwrap();
            let stands = WaitIdOptions::STOPPED | WaitIdOptions::EXITED | WaitIdOptions::NOWAIT;
            waitid(WaitId::Pid(pid), stands).unwrap();
            let caught = is_writing(&child, folder);
            if caught {
                kill_process(pid, signal).unwrap();
            }
            kill_process(pid, Signal::CONT).unwrap();
            if caught {
                let status = child.wait().unwrap();
                assert_eq!(status.signal(), Some(signal.as_raw()), "{arguments:?}");
                return true;
            }
        }
    }
    false
}

/// Runs a program in which no file can have more than 32 or 64 KiB.
fn on_a_full_disk(bench: &Bench, arguments: &[&str]) {
    let before = contents(bench.folder());
    let output = Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" \"$@\""])
        .arg(cargo_bin!("host-sim"))
        .args(arguments)
        .current_dir(bench.folder())
        .env_remove("FMC_FIRMWARE")
        .output()
        .unwrap();
    Answer::new(&output).failed(3, &["too large"]);
    assert!(contents(bench.folder()) == before, "{arguments:?}");
}

fn of_many_points() -> Bench {
    let mut points = String::from("id,x_mm,y_mm\n");
    for row in 0..40_000 {
        writeln!(points, "p{row},{},2", row % 40).unwrap();
    }
    Bench::with(CAMERA, points.as_bytes())
}

#[test]
fn points_leave_the_folder_as_it_was() {
    let bench = of_many_points();
    let arguments = [
        &["correct"],
        &EXPOSURE[..],
        &["points.csv", "--out", "out.csv"],
    ]
    .concat();
    on_a_full_disk(&bench, &arguments);
    interrupt(&bench, &arguments);
    fs::write(bench.path("out.csv"), "old").unwrap();
    on_a_full_disk(&bench, &arguments);
    interrupt(&bench, &arguments);
    bench.run(&arguments).ok();
    let rows = fs::read_to_string(bench.path("out.csv")).unwrap();
    assert_eq!(rows.lines().count(), 40_001);
}

#[test]
fn rectified_frame_leaves_the_folder_as_it_was() {
    let bench = Bench::with(LARGE, b"");
    let render = [&["render"], &EXPOSURE[..], &["--out", "scene"]].concat();
    bench.run(&render).ok();
    let rectify = [
        &["rectify"],
        &EXPOSURE[..],
        &["--out", "answer", "scene/frame.tif"],
    ]
    .concat();
    on_a_full_disk(&bench, &rectify);
    interrupt(&bench, &rectify);
    bench.run(&rectify).ok();
    // The answer of an earlier run stays whole.
    on_a_full_disk(&bench, &render);
    interrupt(&bench, &render);
    interrupt(&bench, &rectify);
}

#[test]
fn mission_leaves_the_folder_as_it_was() {
    let bench = Bench::new();
    let arguments = ["mission", "--exposures", "5", "--out", "report"];
    on_a_full_disk(&bench, &arguments);
    interrupt(&bench, &arguments);
    bench.run(&arguments);
    assert!(bench.path("report/summary.json").exists());
    let other = [
        "mission",
        "--exposures",
        "6",
        "--seed",
        "7",
        "--out",
        "report",
    ];
    on_a_full_disk(&bench, &other);
    interrupt(&bench, &other);
}

#[test]
fn export_of_a_flight_leaves_the_folder_as_it_was() {
    let camera = include_str!("../../scenarios/cameras/mission.toml");
    let bench = Bench::with(camera, b"");
    let scenario = include_str!("../../scenarios/mission.toml");
    let scenario = scenario.replace("cameras/mission.toml", "camera.toml");
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    let mission = ["mission", "--scenario", "scenario.toml"];
    bench.run(&[&mission[..], &["--exposures", "2", "--out", "flown"]].concat());
    // The last exposure over and over, a second apart.
    let mut reader = csv::Reader::from_path(bench.path("flown/records.csv")).unwrap();
    let headings = reader.headers().unwrap().clone();
    let row = reader.records().map(Result::unwrap).last().unwrap();
    let mut writer = csv::Writer::from_path(bench.path("records.csv")).unwrap();
    writer.write_record(&headings).unwrap();
    for number in 1_u64..=2000 {
        let cells =
            headings
                .iter()
                .zip(&row)
                .map(|(name, cell)| match (name, cell.parse::<u64>()) {
                    ("sequence", _) => number.to_string(),
                    ("trigger_us", Ok(us)) => (us + 1_000_000 * number).to_string(),
                    _ => cell.to_owned(),
                });
        writer.write_record(cells).unwrap();
    }
    writer.flush().unwrap();
    drop(writer);
    let mut arguments = vec!["export", "colmap", "--camera", "camera.toml"];
    arguments.extend(["--records", "records.csv", "--out", "answer"]);
    on_a_full_disk(&bench, &arguments);
    interrupt(&bench, &arguments);
    bench.run(&arguments).ok();
    fs::write(bench.path("answer/cameras.txt"), "old").unwrap();
    on_a_full_disk(&bench, &arguments);
    interrupt(&bench, &arguments);
}
