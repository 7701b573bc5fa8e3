//! `statistics`: random missions.

use std::fs;

use crate::command_line::support::{Answer, Bench};

/// Runs the command on a number of threads. It ends with 0, or with 1 where a limit is exceeded.
fn run(bench: &Bench, threads: &str, more: &[&str]) -> Answer {
    let mut arguments = vec!["statistics", "--seed", "3"];
    arguments.extend(more);
    let output = bench
        .command(&arguments)
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .unwrap();
    let answer = Answer::new(&output);
    assert!([0, 1].contains(&answer.code), "{}", answer.stderr);
    answer
}

fn summary(bench: &Bench, folder: &str) -> serde_json::Value {
    serde_json::from_slice(&fs::read(bench.path(&format!("{folder}/summary.json"))).unwrap())
        .unwrap()
}

#[test]
fn result_is_the_same_on_one_and_on_two_threads_and_its_table_fits_a_terminal() {
    let bench = Bench::new();
    let request = ["--missions", "6", "--faults", "two", "--out"];
    let one = run(&bench, "1", &[&request[..], &["one"]].concat());
    let two = run(&bench, "2", &[&request[..], &["two"]].concat());
    assert_eq!(one.stdout, two.stdout);
    for file in [
        "report.html",
        "summary.json",
        "missions.csv",
        "principal-point.svg",
        "smear.svg",
    ] {
        let read = |folder: &str| fs::read(bench.path(&format!("{folder}/{file}"))).unwrap();
        assert!(read("one") == read("two"), "{file}");
    }
    let rows = fs::read_to_string(bench.path("one/missions.csv")).unwrap();
    assert_eq!(rows.lines().count(), 7);
    for line in one.stdout.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    let summary = summary(&bench, "one");
    assert_eq!(summary["passed"], one.code == 0);
    assert_eq!(summary["request"]["missions"], 6);
    assert_eq!(summary["unanswered"], 0);
    let page = fs::read_to_string(bench.path("one/report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 4);
    assert!(!page.contains("NaN"));
}

#[test]
fn every_error_is_as_large_as_its_sigma_says_and_nothing_goes_wrong_by_itself() {
    let bench = Bench::new();
    let request = [
        "statistics",
        "--missions",
        "40",
        "--seed",
        "2",
        "--out",
        "statistics",
    ];
    bench.run(&request).ok();
    let summary = summary(&bench, "statistics");
    assert_eq!(summary["passed"], true);
    let checks = summary["checks"].as_array().unwrap();
    assert_eq!(checks.len(), 14, "{checks:?}");
    assert!(summary["exposed"].as_u64().unwrap() > 400);
}

#[test]
fn faults_are_named_and_leave_no_frame_silently_wrong() {
    let bench = Bench::new();
    let request = ["--missions", "60", "--faults", "two", "--out", "faults"];
    run(&bench, "2", &request);
    let summary = summary(&bench, "faults");
    assert!(summary["exposed"].as_u64().unwrap() > 500);
    let checks = summary["checks"].as_array().unwrap();
    for what in [
        "principal point, beyond 5 σ",
        "missions with a spurious fault",
        "triggers without a record",
        "silent frames",
        "missions that pass with nothing to judge",
    ] {
        let check = checks.iter().find(|check| check["what"] == what);
        assert_eq!(check.unwrap()["passed"], true, "{check:?}");
    }
}

#[test]
fn every_worst_case_is_repeated_by_its_scenario() {
    let bench = Bench::new();
    run(&bench, "2", &["--missions", "4", "--out", "statistics"]);
    let summary = summary(&bench, "statistics");
    let cases = summary["cases"].as_array().unwrap();
    let mut repeated = 0;
    let mut flown = String::new();
    for case in cases {
        let (Some(size), Some(trigger)) = (case["size"].as_f64(), case["trigger"].as_u64()) else {
            continue;
        };
        let scenario = format!("statistics/{}", case["scenario"].as_str().unwrap());
        if flown != scenario {
            bench.run(&["mission", "--scenario", &scenario, "--out", "mission"]);
            flown = scenario;
        }
        let rows = csv::Reader::from_path(bench.path("mission/truth.csv"));
        let mut rows = rows.unwrap();
        let header = rows.headers().unwrap().clone();
        let row = rows
            .records()
            .map(Result::unwrap)
            .find(|row| row[0] == *trigger.to_string())
            .unwrap();
        let value = |name: &str| -> f64 {
            let column = header.iter().position(|one| one == name).unwrap();
            row[column].parse().unwrap()
        };
        let what = case["what"].as_str().unwrap();
        let found = match what {
            "principal point, error/σ" => value("principal_point_error_per_sigma"),
            "V/H, error/σ" => value("vh_error_per_sigma"),
            "UTC, error/σ" => value("utc_error_per_sigma"),
            _ => value("smear_px") - value("predicted_smear_px"),
        };
        // The decimals of the file.
        assert!((found - size).abs() < 1e-4, "{what}: {found} and {size}");
        repeated += 1;
    }
    assert!(repeated >= 8, "{cases:?}");
}

#[test]
fn number_of_missions_and_faults_are_checked() {
    let bench = Bench::new();
    for arguments in [
        ["--missions", "0"],
        ["--missions", "x"],
        ["--faults", "three"],
    ] {
        let [name, value] = arguments;
        bench
            .run(&["statistics", name, value])
            .refused(&[name, value]);
    }
}
