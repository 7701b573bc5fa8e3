//! The program on the camera in QEMU.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use tempfile::TempDir;

fn host_sim(folder: &Path, line: &str) -> Output {
    Command::new(cargo_bin!("host-sim"))
        .current_dir(folder)
        .args(line.split_whitespace())
        .output()
        .unwrap()
}

/// Returns the standard output of a command that succeeds.
fn ok(folder: &Path, line: &str) -> String {
    let output = host_sim(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn verification_in_qemu_passes_on_every_published_camera() {
    let folder = TempDir::new().unwrap();
    for (line, device) in [
        ("verify", "qemu:an386 (Cortex-M4F in QEMU"),
        (
            "verify --device qemu:an500",
            "qemu:an500 (Cortex-M7 in QEMU",
        ),
    ] {
        let text = ok(folder.path(), &format!("{line} --out report"));
        let first = text.lines().next().unwrap();
        let expected = format!("device: {device}, board mps2, firmware ");
        assert!(first.starts_with(&expected), "{first}");
        let summary = fs::read(folder.path().join("report/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
        assert_eq!(summary["passed"], true);
        assert_eq!(summary["points"], 264_600);
        assert_eq!(summary["points_by_digest"], 264_600);
        assert_eq!(summary["points_by_value"], 33_600);
        assert_eq!(summary["difference"], serde_json::Value::Null);
        assert_eq!(summary["link"]["wrong_crc"], 0);
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn correct_distort_and_frame_answer_as_in_process_on_both_machines() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let camera = Path::new(env!("CARGO_MANIFEST_DIR")).join("cameras/rc30-5324.toml");
    fs::copy(camera, folder.join("camera.toml")).unwrap();
    let rows: Vec<String> = (0..1000)
        .map(|row| format!("{row},{},{}", row % 200 - 100, row / 10 - 50))
        .collect();
    let points = format!("id,x_mm,y_mm\n{}\n", rows.join("\n"));
    fs::write(folder.join("points.csv"), points).unwrap();
    let options = "--camera camera.toml --vh 0.17 --exposure 1/200 --opening-offset-mm -0.04";
    for command in ["correct points.csv", "distort points.csv", "frame --json"] {
        let here = ok(folder, &format!("{command} {options}"));
        for device in ["qemu:an386", "qemu:an500"] {
            let there = ok(folder, &format!("{command} {options} --device {device}"));
            assert_eq!(here, there, "{command} on {device}");
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn log_is_shown_when_asked_for() {
    let folder = TempDir::new().unwrap();
    let camera = Path::new(env!("CARGO_MANIFEST_DIR")).join("cameras/rc30-5324.toml");
    let line = format!(
        "frame --vh 0.17 --exposure 1/200 --device qemu --camera {}",
        camera.display()
    );
    let quiet = host_sim(folder.path(), &line);
    assert!(quiet.status.success() && quiet.stderr.is_empty());
    let logged = host_sim(folder.path(), &format!("{line} --log"));
    assert_eq!(logged.stdout, quiet.stdout);
    let log = String::from_utf8(logged.stderr).unwrap();
    assert!(
        log.contains("firmware: ") && log.contains("starts after power on"),
        "{log}"
    );
}
