//! `campaign`: faults in every round of a frame cycle.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fmc_simulation::judge::silence::SILENT_SIGMAS;

use crate::command_line::support::{Answer, Bench};

/// A campaign that is short enough for a test, and has blocks of runs with one fault and of pairs.
const SHORT: [&str; 9] = [
    "campaign",
    "--quick",
    "--pairs",
    "1500",
    "--fault",
    "vh-nan",
    "--fault",
    "trigger-overlap",
    "--out",
];

/// Part of what its record allows beyond which a frame is a finding.
const ALLOWED: f64 = 0.5;

/// Runs the command on a number of threads. It ends with 0, or with 1 where a limit is exceeded.
fn run(bench: &Bench, threads: &str, folder: &str) -> Answer {
    let output = bench
        .command(&[&SHORT[..], &[folder]].concat())
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .unwrap();
    let answer = Answer::new(&output);
    assert!([0, 1].contains(&answer.code), "{}", answer.stderr);
    answer
}

fn summary(bench: &Bench, folder: &str) -> serde_json::Value {
    let bytes = fs::read(bench.path(&format!("{folder}/summary.json"))).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

/// Waits until a file has so many complete blocks.
fn wait_for_blocks(path: &Path, blocks: usize) {
    let until = Instant::now() + Duration::from_mins(2);
    loop {
        let text = fs::read_to_string(path).unwrap_or_default();
        if text.matches("\nend ").count() >= blocks {
            return;
        }
        assert!(Instant::now() < until, "{text}");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn outcomes_are_the_same_on_one_and_on_two_threads_and_after_a_kill() {
    let bench = Bench::new();
    let one = run(&bench, "1", "one");
    let two = run(&bench, "2", "two");
    assert_eq!(one.stdout, two.stdout);
    for line in one.stdout.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let mut killed = bench
        .command(&[&SHORT[..], &["killed"]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let progress = bench.path("killed/progress.txt");
    wait_for_blocks(&progress, 20);
    killed.kill().unwrap();
    killed.wait().unwrap();
    let before = fs::read_to_string(&progress).unwrap();
    // Nothing but the progress is there, and a torn block is cut off.
    assert_eq!(fs::read_dir(bench.path("killed")).unwrap().count(), 1);
    fs::write(&progress, format!("{before}tick 359\n1|none|")).unwrap();
    let resumed = run(&bench, "2", "killed");
    assert_eq!(resumed.stdout, one.stdout);
    let after = fs::read_to_string(&progress).unwrap();
    let complete = before
        .rfind("end ")
        .map_or(0, |end| end + "end 01234567\n".len());
    assert!(after.starts_with(&before[..complete.min(before.len())]));
    for file in ["report.html", "summary.json", "runs.csv", "heat-map.csv"] {
        let read = |folder: &str| fs::read(bench.path(&format!("{folder}/{file}"))).unwrap();
        assert!(
            read("one") == read("two") && read("one") == read("killed"),
            "{file}"
        );
    }
    let summary = summary(&bench, "one");
    assert!(summary["runs"].as_u64().unwrap() > 500);
    assert!(summary["pairs"].as_u64().unwrap() > 40);
    assert_eq!(summary["silent_bad_exposures"], 0);
    assert_eq!(summary["unanswered_triggers"], 0);
    assert!(summary["faults_arrived_share"].as_f64().unwrap() >= 0.95);
    assert_eq!(summary["passed"], one.code == 0);
}

#[test]
fn scenario_of_a_finding_repeats_its_frame_with_the_seed_of_the_campaign() {
    let bench = Bench::new();
    // Nothing is silently wrong: what comes closest is a finding here.
    let campaign = format!(
        "campaign --quick --pairs 0 --fault encoder-glitch --seed 2 --allowed {ALLOWED} --out near"
    );
    let found = bench.run(&campaign.split(' ').collect::<Vec<_>>());
    assert_eq!(found.code, 1, "{}", found.stderr);
    let finding = &summary(&bench, "near")["findings"][0];
    assert_eq!(finding["scenario"], "finding-01.toml");
    assert_eq!(finding["quantity"], "principal point");
    let mission = "mission --scenario near/finding-01.toml --out again";
    let repeated = bench.run(&mission.split(' ').collect::<Vec<_>>());
    assert_ne!(repeated.code, 2, "{}", repeated.stderr);
    assert_eq!(summary(&bench, "again")["seed"], 2);
    let mut truth = csv::Reader::from_path(bench.path("again/truth.csv")).unwrap();
    let frames: Vec<BTreeMap<String, String>> = truth.deserialize().map(Result::unwrap).collect();
    let sigmas = |frame: &BTreeMap<String, String>| {
        let error = &frame["principal_point_error_per_sigma"];
        error.parse::<f64>().unwrap().abs()
    };
    // The first frame that is beyond and says nothing of it is that of the finding.
    let mut frames = frames;
    frames.retain(|frame| frame["without_fault_or_flag"] == "true");
    let first = frames
        .iter()
        .position(|frame| sigmas(frame) > ALLOWED * SILENT_SIGMAS);
    let wrong = &frames[first.unwrap()..];
    assert_eq!(wrong[0]["sequence"], finding["frame"].to_string());
    // The largest error is that of the finding as well, within the digits of the file.
    let worst = wrong.iter().map(sigmas).fold(0.0, f64::max);
    let found = finding["worst"].as_f64().unwrap() * SILENT_SIGMAS;
    assert!((worst - found).abs() <= 6e-5, "{worst} for {found}");
}

#[test]
fn other_options_in_the_same_folder_are_refused_by_name() {
    let bench = Bench::new();
    let arguments = |seed| {
        [
            "campaign",
            "--quick",
            "--pairs",
            "0",
            "--fault",
            "limit-switch",
            "--out",
            "one",
            "--seed",
            seed,
        ]
    };
    bench.run(&arguments("1")).ok();
    let refused = bench.run(&arguments("2"));
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("seed is 1 there and 2 here"),
        "{}",
        refused.stderr
    );
    // The same command makes the report again, of what is there.
    let report = fs::read(bench.path("one/report.html")).unwrap();
    fs::remove_file(bench.path("one/report.html")).unwrap();
    bench.run(&arguments("1")).ok();
    assert!(fs::read(bench.path("one/report.html")).unwrap() == report);
}

#[cfg(unix)]
#[test]
fn file_that_cannot_grow_is_named_and_the_campaign_goes_on_with_room() {
    let bench = Bench::new();
    let program = bench.command(&[]).get_program().to_owned();
    // Blocks of 512 or 1024 bytes; a write beyond the limit fails as one on a full disk does.
    let script = format!(
        "trap '' XFSZ; ulimit -f 4; exec {} campaign --quick --pairs 0 --fault limit-switch --out full",
        program.display()
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(bench.path("."))
        .output()
        .unwrap();
    let answer = Answer::new(&output);
    assert_eq!(answer.code, 3, "{}", answer.stderr);
    assert!(answer.stderr.contains("progress.txt"), "{}", answer.stderr);
    let whole = [
        "campaign",
        "--quick",
        "--pairs",
        "0",
        "--fault",
        "limit-switch",
        "--out",
    ];
    bench.run(&[&whole[..], &["full"]].concat()).ok();
    bench.run(&[&whole[..], &["roomy"]].concat()).ok();
    assert_eq!(summary(&bench, "full"), summary(&bench, "roomy"));
}

#[test]
fn wrong_arguments_are_refused_with_what_is_allowed() {
    let bench = Bench::new();
    for (option, value, part) in [
        ("--fault", "stal", "stall"),
        ("--pairs", "10000001", "10000000"),
        ("--seed", "x", "--seed"),
        ("--seed", "2147483648", "2147483647"),
    ] {
        let answer = bench.run(&["campaign", option, value, "--out", "never"]);
        assert_eq!(answer.code, 2, "{}", answer.stderr);
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
    assert!(!bench.path("never").exists());
}
