//! `export` and `import`: files of other programs.

use std::fs::{self, File};
use std::time::Instant;

use fmc_exchange::program::Program;
use serde_json::Value;

use crate::command_line::support::{Bench, CAMERA};

const EXPORT: [&str; 4] = ["--camera", "camera.toml", "--out", "out"];

/// The strong lens of the published cameras.
pub(crate) const IXM: &str = include_str!("../../cameras/phase-one-ixm-rs150f-50.toml");

/// Files of each format, without export.json.
pub(crate) const FILES: [(&str, &[&str]); 12] = [
    ("opencv", &["camera.yaml"]),
    ("ros", &["camera_info.yaml"]),
    ("kalibr", &["camchain.yaml"]),
    ("colmap", &["cameras.txt", "images.txt", "points3D.txt"]),
    ("metashape", &["camera.xml"]),
    ("opensfm", &["camera_models.json", "cameras.json"]),
    ("opf", &["calibrated_cameras.json"]),
    ("pix4d", &["camera.cam", "camera.xmp"]),
    ("opentrackio", &["lens.json"]),
    (
        "micmac",
        &["AutoCal_Foc-51371_Cam-Phase_One_iXM_RS150F_50_mm.xml"],
    ),
    ("australis", &["australis.txt"]),
    ("photomodeler", &["photomodeler.txt"]),
];

pub(crate) fn json(bench: &Bench, file: &str) -> Value {
    serde_json::from_slice(&fs::read(bench.path(file)).unwrap()).unwrap()
}

fn names(bench: &Bench, folder: &str) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(bench.path(folder))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn formats_are_those_of_the_library() {
    let written = FILES.map(|(format, _)| format);
    assert_eq!(written, Program::WRITTEN.map(Program::name));
}

#[test]
fn every_format_has_its_files_and_a_statement() {
    let bench = Bench::with(IXM, b"");
    for (format, files) in FILES {
        let arguments = ["export", format, "--camera", "camera.toml", "--out", format];
        let answer = bench.run(&arguments).ok();
        let mut expected: Vec<String> = files.iter().map(|name| (*name).to_owned()).collect();
        expected.push("export.json".to_owned());
        expected.sort();
        assert_eq!(names(&bench, format), expected);
        let statement = json(&bench, &format!("{format}/export.json"));
        assert_eq!(statement["format"], format);
        for key in [
            "residual_max_um",
            "residual_rms_um",
            "residual_max_px",
            "at_mm",
            "not_held",
            "direction",
            "sign",
            "unit",
            "origin",
        ] {
            assert!(!statement[key].is_null(), "{format}: {key}");
        }
        assert_eq!(statement["calibration_sha256"].as_str().unwrap().len(), 64);
        assert_eq!(statement["calibration_crc32"].as_str().unwrap().len(), 8);
        let widest = answer.stdout.lines().map(|line| line.chars().count()).max();
        assert!(widest.unwrap() <= 80, "{}", answer.stdout);
        assert!(answer.stdout.contains(files[0]) && answer.stdout.contains("SHA-256"));
    }
}

#[test]
fn above_the_largest_residual_nothing_is_written() {
    let bench = Bench::with(IXM, b"");
    let export = |limit: &str, model: &str| {
        let more = ["--model", model, "--max-residual-um", limit];
        bench.run(&[&["export", "opencv"], &EXPORT[..], &more].concat())
    };
    export("0.1", "opencv8").failed(1, &["0.19", "--max-residual-um 0.1", "nothing is written"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
    let answer = export("0.25", "opencv8").ok();
    assert!(
        answer
            .stderr
            .contains("warning: opencv opencv8: the largest residual is 0.05")
    );
    assert!(export("0.1", "opencv14").ok().stderr.is_empty());
}

#[test]
fn crc_is_that_of_the_frame_records() {
    let camera = include_str!("../../scenarios/cameras/mission.toml");
    let bench = Bench::with(camera, b"");
    bench
        .run(&[&["export", "colmap"], &EXPORT[..]].concat())
        .ok();
    let scenario = include_str!("../../scenarios/mission.toml");
    let scenario = scenario.replace("cameras/mission.toml", "camera.toml");
    fs::write(bench.path("scenario.toml"), scenario).unwrap();
    let mission = ["mission", "--scenario", "scenario.toml", "--exposures", "2"];
    bench.run(&[&mission[..], &["--out", "flown"]].concat());
    let records = fs::read_to_string(bench.path("flown/records.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(records.as_bytes());
    let headings = reader.headers().unwrap().clone();
    let column = headings.iter().position(|name| name == "calibration_crc32");
    let crc = json(&bench, "out/export.json")["calibration_crc32"].clone();
    let rows: Vec<_> = reader.records().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len(), 2);
    for row in rows {
        assert_eq!(row[column.unwrap()], *crc.as_str().unwrap());
    }
}

#[test]
fn export_and_import_give_the_calibration_back() {
    let bench = Bench::with(IXM, b"");
    for (format, files) in FILES {
        let out = ["--camera", "camera.toml", "--out", format];
        bench.run(&[&["export", format], &out[..]].concat()).ok();
        let file = format!("{format}/{}", files[0]);
        let back = format!("{format}.toml");
        let report = format!("{format}.json");
        let import = [
            "import",
            format,
            &file,
            "--base",
            "camera.toml",
            "--out",
            &back,
            "--report",
            &report,
        ];
        bench.run(&import).ok();
        let text = fs::read_to_string(bench.path(&back)).unwrap();
        let report = json(&bench, &report);
        let hash = report["source_sha256"].as_str().unwrap();
        assert!(text.starts_with("# From ") && text.contains(hash), "{text}");
        assert_eq!(report["assumed"]["pixel_um"], 3.76);
        let exact = ["opentrackio", "micmac", "australis", "photomodeler"].contains(&format);
        assert_eq!(report["exact"], exact, "{format}");
        let residual = report["residual_max_um"].as_f64().unwrap();
        assert!(
            residual < if exact { 1e-9 } else { 6.5 },
            "{format}: {residual}"
        );
        if exact {
            assert!(text.contains("k1 = -1.6056"), "{text}");
        }
        // The camera file is one: the program reads it.
        let exposure = ["--vh", "0.1", "--exposure", "1/200"];
        bench
            .run(&[&["frame", "--camera", &back], &exposure[..]].concat())
            .ok();
    }
}

#[test]
fn mechanism_and_limits_of_the_base_are_kept_and_its_lens_is_not() {
    let bench = Bench::new();
    bench
        .run(&[&["export", "metashape"], &EXPORT[..]].concat())
        .ok();
    let import = [
        "import",
        "metashape",
        "out/camera.xml",
        "--base",
        "camera.toml",
        "--out",
        "new.toml",
    ];
    bench.run(&import).ok();
    let text = fs::read_to_string(bench.path("new.toml")).unwrap();
    for kept in [
        "acceleration_mm_s2 = 1000.0",
        "opening_fraction = 0.2",
        "vh_per_s = [0.05, 0.17]",
        "exit_pupil_mm = 110.0",
        "name = \"Test camera\"",
    ] {
        assert!(text.contains(kept), "{kept}: {text}");
    }
    assert!(!text.contains("[fitted]"), "{text}");
    // Without a base, the pitch must be stated.
    let alone = [
        "import",
        "metashape",
        "out/camera.xml",
        "--out",
        "alone.toml",
    ];
    bench
        .run(&alone)
        .refused(&["out/camera.xml", "pixel pitch", "--pixel-um"]);
    bench
        .run(&[&alone[..], &["--pixel-um", "8.75"]].concat())
        .ok();
    bench
        .run(&[&alone[..], &["--pixel-um", "8.75", "--size", "100x100"]].concat())
        .refused(&["9216 x 9216", "100 x 100"]);
}

#[test]
fn array_of_the_base_is_not_contradicted() {
    let bench = Bench::new();
    bench.run(&[&["export", "opf"], &EXPORT[..]].concat()).ok();
    let file = "out/calibrated_cameras.json";
    let import = [
        "import",
        "opf",
        file,
        "--base",
        "camera.toml",
        "--out",
        "a.toml",
    ];
    let with = |more: &[&str]| bench.run(&[&import[..], more].concat());
    with(&["--pixel-um", "5"]).refused(&["--pixel-um 5", "camera.toml has a pixel pitch of 8.75"]);
    with(&["--size", "9000x9000"]).refused(&["--size 9000x9000", "camera.toml has 9216 x 9216 px"]);
    assert!(!bench.path("a.toml").exists());
    with(&["--pixel-um", "8.75", "--size", "9216x9216"]).ok();
}

#[test]
fn gigabyte_of_zeros_is_refused_by_its_beginning() {
    let bench = Bench::new();
    let zeros = fs::File::create(bench.path("zeros")).unwrap();
    zeros.set_len(1 << 30).unwrap();
    let camera = ["--camera", "camera.toml"];
    let with = |words: &[&str]| bench.run(&[words, &camera].concat());
    for words in [
        &["correct", "--records", "zeros", "points.csv"][..],
        &["correct", "--vh", "0.1", "--exposure", "1/200", "zeros"],
        &["correct", "--frames", "zeros", "points.csv"],
        &["frame", "--records", "zeros"],
        &["export", "frames", "--records", "zeros", "--out", "out"],
        &["calibrate", "bundle", "zeros", "--points", "points.csv"],
        &["calibrate", "dlt3d", "zeros"],
    ] {
        with(words).refused(&["zeros: not a text file: it holds bytes of zero"]);
    }
    bench
        .run(&["camera-file", "check", "zeros"])
        .refused(&["zeros: larger than 1 MiB, which no camera file is"]);
    let import = ["import", "opencv", "zeros", "--out", "a.toml"];
    bench.run(&import).refused(&["zeros: larger than 64 MiB"]);
}

#[test]
fn base_is_named_where_its_size_or_pitch_contradicts_the_file() {
    let bench = Bench::new();
    bench
        .run(&[&["export", "colmap"], &EXPORT[..]].concat())
        .ok();
    bench
        .run(&[
            "export",
            "opentrackio",
            "--camera",
            "camera.toml",
            "--out",
            "sample",
        ])
        .ok();
    let camera = fs::read_to_string(bench.path("camera.toml")).unwrap();
    let changed = |file: &str, from: &str, to: &str| {
        let other = camera.replace(from, to);
        assert_ne!(other, camera);
        fs::write(bench.path(file), other).unwrap();
    };
    changed("narrow.toml", "width_px = 9216", "width_px = 9000");
    changed("fine.toml", "pixel_um = 8.75", "pixel_um = 8.0");
    let import = |program, file, base| {
        bench.run(&["import", program, file, "--base", base, "--out", "a.toml"])
    };
    import("colmap", "out/cameras.txt", "narrow.toml").refused(&[
        "out/cameras.txt: the file is of 9216 x 9216 px",
        "--base narrow.toml of 9000 x 9216 px",
    ]);
    import("opentrackio", "sample/lens.json", "fine.toml").refused(&[
        "sample/lens.json: the file has pixels of 8.75",
        "--base fine.toml of 8.0",
    ]);
    assert!(!bench.path("a.toml").exists());
}

#[test]
fn model_that_the_polynomial_does_not_follow_is_fitted_with_a_warning() {
    let bench = Bench::new();
    // Four coefficients, four of the denominator, four of the thin prism, and a tilt.
    let tilted = "%YAML:1.0\n---\nimage_width: 9216\nimage_height: 9216\n\
                  camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
                  data: [ 11428., 0., 4607.5, 0., 11428., 4607.5, 0., 0., 1. ]\n\
                  distortion_coefficients: !!opencv-matrix\n   rows: 14\n   cols: 1\n   dt: d\n   \
                  data: [ 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.01, 0. ]\n";
    fs::write(bench.path("tilted.yaml"), tilted).unwrap();
    let import = [
        "import",
        "opencv",
        "tilted.yaml",
        "--pixel-um",
        "8.75",
        "--out",
        "a.toml",
    ];
    let answer = bench.run(&import).ok();
    assert!(
        answer.stderr.contains("warning: tilted.yaml"),
        "{}",
        answer.stderr
    );
    let text = fs::read_to_string(bench.path("a.toml")).unwrap();
    assert!(text.contains("# Without a place here: tilt"), "{text}");
}

#[test]
fn a_gigabyte_of_zeros_is_refused_at_once() {
    let bench = Bench::new();
    let zeros = File::create(bench.path("zeros.yaml")).unwrap();
    zeros.set_len(1 << 30).unwrap();
    for format in ["opencv", "colmap", "dji", "metashape"] {
        let start = Instant::now();
        bench
            .run(&[
                "import",
                format,
                "zeros.yaml",
                "--pixel-um",
                "5",
                "--out",
                "a.toml",
            ])
            .refused(&["zeros.yaml", "larger than 64 MiB"]);
        assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    }
    // As large as may be: read, and refused for its content.
    zeros.set_len(64 << 20).unwrap();
    for format in ["opencv", "opensfm", "colmap", "usgs"] {
        bench
            .run(&[
                "import",
                format,
                "zeros.yaml",
                "--pixel-um",
                "5",
                "--out",
                "a.toml",
            ])
            .refused(&["zeros.yaml: "]);
    }
    assert!(!bench.path("a.toml").exists());
}

#[test]
fn options_of_other_formats_and_wrong_names_are_refused() {
    let bench = Bench::new();
    let export =
        |format: &str, more: &[&str]| bench.run(&[&["export", format], &EXPORT[..], more].concat());
    export("ros", &["--as", "json"]).refused(&["--as", "opencv"]);
    export("opencv", &["--binary"]).refused(&["--binary", "colmap"]);
    export("colmap", &["--id", "x"]).refused(&["--id", "opensfm"]);
    export("colmap", &["--model", "FISHEYE"]).refused(&["--model FISHEYE", "FULL_OPENCV"]);
    export("opencv", &["--max-residual-um", "-1"]).refused(&["--max-residual-um"]);
    export("usgs", &[]).refused(&["usgs"]);
    export("australis", &[]).refused(&["B1 or B2"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
    let folding = CAMERA.replace("k1 = -1.0e-6", "k1 = 1.0e-3");
    Bench::with(&folding, b"")
        .run(&[&["export", "opencv"], &EXPORT[..]].concat())
        .refused(&["camera.toml"]);
    // An input is never replaced.
    bench
        .run(&["import", "opencv", "camera.toml", "--out", "camera.toml"])
        .refused(&["camera.toml"]);
    bench
        .run(&["import", "opencv", "missing.yaml", "--out", "a.toml"])
        .refused(&["missing.yaml", "cannot be read"]);
}

#[test]
fn containers_and_binary_and_keys_are_as_asked() {
    let bench = Bench::new();
    let export = |format: &str, more: &[&str]| {
        bench
            .run(&[&["export", format], &EXPORT[..], more].concat())
            .ok()
    };
    export("opencv", &["--as", "json"]);
    assert!(json(&bench, "out/camera.json")["camera_matrix"]["data"].is_array());
    export("opencv", &["--as", "xml"]);
    let xml = fs::read_to_string(bench.path("out/camera.xml")).unwrap();
    assert!(xml.contains("<opencv_storage>"));
    export("colmap", &["--binary"]);
    assert!(fs::read(bench.path("out/cameras.bin")).unwrap().len() > 60);
    export("opensfm", &["--id", "v2 a b 9216 9216 brown 1.2"]);
    assert!(json(&bench, "out/camera_models.json")["v2 a b 9216 9216 brown 1.2"].is_object());
}

#[test]
fn same_camera_gives_the_same_bytes() {
    let bench = Bench::with(IXM, b"");
    for (format, _) in FILES {
        for out in ["a", "b"] {
            let arguments = ["export", format, "--camera", "camera.toml", "--out", out];
            bench.run(&arguments).ok();
        }
        for name in names(&bench, "a") {
            let [a, b] = ["a", "b"].map(|out| fs::read(bench.path(out).join(&name)).unwrap());
            assert_eq!(a, b, "{format}: {name}");
        }
    }
}
