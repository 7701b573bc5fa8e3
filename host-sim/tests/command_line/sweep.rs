//! `sweep`: the five coefficients over V/H and exposure time.

use std::fs;

use crate::command_line::support::{Bench, CAMERA};

const FILES: [&str; 5] = [
    "coefficients.csv",
    "coefficients.png",
    "coefficients.svg",
    "report.html",
    "summary.json",
];

const SWEEP: [&str; 5] = ["sweep", "--camera", "camera.toml", "--out", "out"];

fn summary(bench: &Bench, folder: &str) -> serde_json::Value {
    let path = bench.path(folder).join("summary.json");
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn report_is_complete_and_the_summary_has_the_promised_keys() {
    let bench = Bench::new();
    let answer = bench
        .run(&[&SWEEP[..], &["--strategy", "from-rest"]].concat())
        .ok();
    for part in ["n - 5", "focus shift alone", "motion alone", "K_d1 = "] {
        assert!(answer.stdout.contains(part), "{}", answer.stdout);
    }
    for file in FILES {
        assert!(fs::metadata(bench.path("out").join(file)).unwrap().len() > 1000);
    }
    let summary = summary(&bench, "out");
    assert_eq!(summary["frames"], 60);
    assert_eq!(summary["points"], 60 * 441);
    for key in [
        "sigma_static_um",
        "sigma_dynamic_um",
        "sigma_exact_um",
        "sigma_dynamic_um_n_minus_5",
        "sigma_static_um_n_minus_5",
        "gain_share_focus",
        "gain_share_motion",
    ] {
        assert!(summary[key].is_number(), "{key}: {}", summary[key]);
    }
    assert_eq!(summary["cases"].as_array().unwrap().len(), 3);
    let rows = fs::read_to_string(bench.path("out/coefficients.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 60);
    let png = fs::read(bench.path("out/coefficients.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn same_seed_gives_the_same_bytes_and_another_does_not() {
    let bench = Bench::new();
    let run = |out: &str, seed: &str| {
        let answer = bench.run(&[
            "sweep",
            "--camera",
            "camera.toml",
            "--seed",
            seed,
            "--out",
            out,
        ]);
        answer.ok().stdout
    };
    assert_eq!(run("a", "42"), run("b", "42"));
    run("c", "43");
    for file in FILES {
        let bytes = |out: &str| fs::read(bench.path(out).join(file)).unwrap();
        assert!(bytes("a") == bytes("b"), "{file}");
        assert!(bytes("a") != bytes("c"), "{file}");
    }
}

#[test]
fn centred_run_up_on_the_centroid_says_that_two_coefficients_do_not_exist() {
    let bench = Bench::new();
    let answer = bench
        .run(&[&SWEEP[..], &["--regress-on", "centroid"]].concat())
        .ok();
    assert!(answer.stdout.contains("do not exist"), "{}", answer.stdout);
    let summary = summary(&bench, "out");
    assert!(summary["sigma_dynamic_um"].is_null());
    assert!(summary["coefficients"].is_null());
    let reason = summary["no_coefficients"].as_str().unwrap();
    assert!(reason.contains("do not exist"), "{reason}");
    assert!(summary["sigma_static_um"].is_number() && summary["sigma_exact_um"].is_number());
    for file in FILES {
        assert!(bench.path("out").join(file).exists(), "{file}");
    }
}

#[test]
fn every_option_is_taken() {
    let bench = Bench::new();
    for (more, key, value) in [
        (&["--tie"][..], "tied", "true"),
        (&["--weight", "arc-length"], "weight", "\"arc-length\""),
        (&["--reading", "literal"], "reading", "\"literal\""),
        (&["--focus-sign", "printed"], "focus_sign", "\"printed\""),
        (&["--focus-shift-um", "-6"], "focus_shift_um", "-6.0"),
        (&["--noise-um", "0"], "noise_um", "0.0"),
        (&["--strategy", "from-rest"], "strategy", "\"from-rest\""),
        (
            &["--strategy", "from-rest", "--regress-on", "centroid"],
            "regress_on",
            "\"centroid\"",
        ),
    ] {
        bench.run(&[&SWEEP[..], more].concat()).ok();
        assert_eq!(summary(&bench, "out")[key].to_string(), value, "{more:?}");
    }
}

#[test]
fn tdi_has_no_run_up_to_choose() {
    let tdi = CAMERA
        .replace("mechanism = \"stage\"", "mechanism = \"tdi\"")
        .replace("strategy = \"centred\"\n", "");
    let bench = Bench::with(&tdi, b"");
    bench.run(&SWEEP).ok();
    assert_eq!(summary(&bench, "out")["strategy"], "tdi");
    bench
        .run(&[&SWEEP[..], &["--strategy", "centred"]].concat())
        .refused(&["--strategy", "camera.toml", "tdi"]);
}

#[test]
fn bad_options_are_refused_with_value_and_range() {
    let bench = Bench::new();
    for noise in ["-0.1", "nan", "inf", "1001", "much", ""] {
        bench
            .run(&[&SWEEP[..], &["--noise-um", noise]].concat())
            .refused(&["--noise-um", noise, "0 to 1000"]);
    }
    for seed in ["x", "-1", "1.5", "18446744073709551616"] {
        bench
            .run(&[&SWEEP[..], &["--seed", seed]].concat())
            .refused(&["--seed", seed]);
    }
    for focus in ["1001", "-1001"] {
        bench
            .run(&[&SWEEP[..], &["--focus-shift-um", focus]].concat())
            .refused(&["--focus-shift-um", focus, "-1000 to 1000"]);
    }
    bench
        .run(&[&SWEEP[..], &["--focus-shift-um", "nan"]].concat())
        .refused(&["--focus-shift-um"]);
    bench
        .run(&["sweep", "--camera", "camera.toml"])
        .refused(&["--out"]);
    bench
        .run(&["sweep", "--camera", "none.toml", "--out", "out"])
        .refused(&["none.toml"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}

#[test]
fn camera_whose_limits_or_stroke_exclude_the_grid_is_refused() {
    for (from, to, words) in [
        (
            "vh_per_s = [0.05, 0.17]",
            "vh_per_s = [0.06, 0.17]",
            &["vh_per_s", "0.05", "0.06 to 0.17"][..],
        ),
        (
            "exposure_s = [0.001, 0.02]",
            "exposure_s = [0.002, 0.02]",
            &["exposure_s", "1/700", "0.002 to 0.02"],
        ),
        ("stroke_mm = 4.0", "stroke_mm = 0.3", &["stroke_mm"]),
    ] {
        let bench = Bench::with(&CAMERA.replace(from, to), b"");
        bench
            .run(&SWEEP)
            .refused(&[words, &["camera.toml"]].concat());
        assert!(!bench.path("out").exists());
    }
}

#[test]
fn folder_that_cannot_be_made_is_an_io_failure() {
    let bench = Bench::new();
    bench
        .run(&[
            "sweep",
            "--camera",
            "camera.toml",
            "--out",
            "points.csv/out",
        ])
        .failed(3, &["points.csv/out"]);
}
