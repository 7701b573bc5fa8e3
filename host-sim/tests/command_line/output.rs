//! Output files that appear complete or not at all.

use std::fs;
use std::process::Command;

use crate::command_line::support::{Answer, Bench, CAMERA};

#[test]
fn output_file_is_the_same_as_standard_output_and_replaces_an_older_one() {
    let bench = Bench::new();
    let stdout = bench.points("correct", &[]).ok().stdout;
    fs::write(bench.path("out.csv"), "old").unwrap();
    bench.points("correct", &["--out", "out.csv"]).ok();
    assert_eq!(fs::read_to_string(bench.path("out.csv")).unwrap(), stdout);
    assert_eq!(bench.files(), ["camera.toml", "out.csv", "points.csv"]);
}

#[test]
fn refused_input_leaves_an_older_output_alone() {
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,2\nb,oops,2\n");
    fs::write(bench.path("out.csv"), "old").unwrap();
    bench
        .points("correct", &["--out", "out.csv"])
        .refused(&["oops"]);
    assert_eq!(fs::read_to_string(bench.path("out.csv")).unwrap(), "old");
}

#[test]
fn output_that_cannot_be_written_is_an_io_failure() {
    let bench = Bench::new();
    bench
        .points("correct", &["--out", "nowhere/out.csv"])
        .failed(3, &["nowhere/out.csv"]);
    fs::create_dir(bench.path("folder")).unwrap();
    bench
        .points("correct", &["--out", "folder"])
        .failed(3, &["folder"]);
    fs::write(bench.path("file"), "").unwrap();
    bench
        .run(&["verify", "--camera", "camera.toml", "--out", "file"])
        .failed(3, &["file"]);
}

#[test]
fn answer_never_replaces_the_camera_file() {
    let bench = Bench::new();
    for command in ["correct", "distort", "reference", "frame"] {
        bench
            .points(command, &["--out", "./camera.toml"])
            .refused(&["camera.toml", "is the camera file itself"]);
    }
    assert_eq!(
        fs::read_to_string(bench.path("camera.toml")).unwrap(),
        CAMERA
    );
}

#[cfg(unix)]
#[test]
fn permissions_and_symbolic_links_stay_as_they_were() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let bench = Bench::new();
    let mode = |name: &str| fs::metadata(bench.path(name)).unwrap().permissions().mode() & 0o777;
    bench.points("correct", &["--out", "new.csv"]).ok();
    assert_eq!(
        mode("new.csv"),
        mode("points.csv"),
        "as any new file of this user"
    );
    fs::write(bench.path("private.csv"), "old").unwrap();
    fs::set_permissions(bench.path("private.csv"), fs::Permissions::from_mode(0o600)).unwrap();
    bench.points("correct", &["--out", "private.csv"]).ok();
    assert_eq!(mode("private.csv"), 0o600);
    for target in ["private.csv", "not-yet.csv"] {
        symlink(target, bench.path("link.csv")).unwrap();
        bench.points("correct", &["--out", "link.csv"]).ok();
        assert!(
            fs::symlink_metadata(bench.path("link.csv"))
                .unwrap()
                .is_symlink()
        );
        assert!(
            fs::read_to_string(bench.path(target))
                .unwrap()
                .starts_with("id,")
        );
        fs::remove_file(bench.path("link.csv")).unwrap();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn full_device_is_an_io_failure_and_stays_a_device() {
    use std::os::unix::fs::FileTypeExt;
    let bench = Bench::new();
    for command in ["correct", "distort", "reference"] {
        bench
            .points(command, &["--out", "/dev/full"])
            .failed(3, &["/dev/full", "No space left"]);
    }
    assert!(
        fs::metadata("/dev/full")
            .unwrap()
            .file_type()
            .is_char_device()
    );
    for arguments in ["correct {} points.csv", "frame {}", "frame {} --json"] {
        let options = "--camera camera.toml --vh 0.1 --exposure 1/200";
        shell(
            &bench,
            &format!(
                "\"$HOST_SIM\" {} > /dev/full",
                arguments.replace("{}", options)
            ),
        )
        .failed(3, &["standard output", "No space left"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn disk_that_fills_up_half_way_leaves_nothing_behind() {
    let rows = "p,1,2\n".repeat(5000);
    let bench = Bench::with(CAMERA, format!("id,x_mm,y_mm\n{rows}").as_bytes());
    // The limit lets files grow to 64 blocks of 512 or 1024 bytes, less than the answer.
    shell(
        &bench,
        "trap '' XFSZ; ulimit -f 64; exec \"$HOST_SIM\" correct --camera camera.toml --vh 0.1 \
         --exposure 1/200 points.csv --out out.csv",
    )
    .failed(3, &["out.csv", "too large"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}

#[cfg(unix)]
#[test]
fn closed_pipe_is_no_panic() {
    let rows = "p,1,2\n".repeat(50_000);
    let bench = Bench::with(CAMERA, format!("id,x_mm,y_mm\n{rows}").as_bytes());
    let answer = shell(
        &bench,
        "\"$HOST_SIM\" correct --camera camera.toml --vh 0.1 --exposure 1/200 points.csv | head -n 1 >&2",
    );
    assert!(answer.stderr.contains("id,x_mm"));
    assert!(!answer.stderr.contains("panicked"), "{}", answer.stderr);
}

#[cfg(unix)]
fn shell(bench: &Bench, script: &str) -> Answer {
    let output = Command::new("sh")
        .args(["-c", script])
        .current_dir(bench.folder())
        .env("HOST_SIM", assert_cmd::cargo::cargo_bin!("host-sim"))
        .output()
        .unwrap();
    Answer::new(&output)
}
