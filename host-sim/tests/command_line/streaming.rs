//! Files longer than a block, pipes, and the output up to a wrong later row.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::process::Stdio;
use std::thread;

use crate::command_line::support::{Answer, Bench, CAMERA, EXPOSURE};

/// Number of points: more than three blocks hold.
const MANY: usize = 60_000;

fn many(rows: usize) -> String {
    let mut points = String::from("id,x_mm,y_mm\n");
    for row in 0..rows {
        let x = f64::from(u32::try_from(row % 8000).unwrap()) * 0.01 - 40.0;
        let y = f64::from(u32::try_from(row % 7919).unwrap()) * 0.01 - 39.5;
        writeln!(points, "p{row},{x},{y}").unwrap();
    }
    points
}

/// Runs a command with `input` on its standard input.
fn piped(bench: &Bench, arguments: &[&str], input: &[u8]) -> Answer {
    let mut child = bench
        .command(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    // A command that refuses its input closes the pipe.
    let writer = thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    Answer::new(&output)
}

#[test]
fn every_row_of_many_blocks_is_answered_in_order() {
    let bench = Bench::with(CAMERA, many(MANY).as_bytes());
    let answer = bench.points("correct", &[]).ok();
    let rows = answer.rows();
    assert_eq!(rows.len(), MANY);
    for (number, (id, _)) in rows.iter().enumerate() {
        assert_eq!(*id, format!("p{number}"));
    }
    // A row does not depend on the block that contains it.
    let few = Bench::with(CAMERA, many(3).as_bytes());
    let first = few.points("correct", &[]).ok();
    assert!(answer.stdout.starts_with(&first.stdout));
}

#[test]
fn standard_input_is_a_file_of_points() {
    let points = many(MANY);
    let bench = Bench::with(CAMERA, points.as_bytes());
    for command in ["correct", "distort"] {
        let arguments = [&[command][..], &EXPOSURE, &["-"]].concat();
        let answer = piped(&bench, &arguments, points.as_bytes()).ok();
        assert_eq!(answer.stdout, bench.points(command, &[]).ok().stdout);
    }
    let arguments = [&["correct"][..], &EXPOSURE, &["-"]].concat();
    piped(&bench, &arguments, b"id,x_mm,y_mm\na,1,oops\n")
        .refused(&["standard input, line 2", "oops"]);
}

#[test]
fn wrong_row_behind_many_good_ones_leaves_no_file_and_is_named() {
    for (row, words) in [
        ("bad,oops,1", ["x_mm", "oops"]),
        ("off,1,40.33", ["point off", "off the sensor"]),
    ] {
        let points = format!("{}{row}\n", many(MANY));
        let bench = Bench::with(CAMERA, points.as_bytes());
        let line = format!("line {}", MANY + 2);
        let answer = bench.points("correct", &["--out", "out.csv"]);
        answer.refused(&words);
        answer.refused(&[&line]);
        assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
    }
}

#[test]
fn standard_output_keeps_the_answers_before_a_wrong_row_and_the_exit_code_tells() {
    let points = format!("{}bad,1,oops\n", many(MANY));
    let bench = Bench::with(CAMERA, points.as_bytes());
    let answer = bench.points("correct", &[]);
    assert_eq!(answer.code, 2);
    assert!(answer.stderr.contains("oops"));
    let good = Bench::with(CAMERA, many(MANY).as_bytes());
    let whole = good.points("correct", &[]).ok().stdout;
    assert!(whole.starts_with(&answer.stdout));
    assert!(answer.stdout.ends_with('\n'), "no half row");
    // A wrong row in a file of one block prevents all output.
    let short = format!("{}bad,1,oops\n", many(1000));
    Bench::with(CAMERA, short.as_bytes())
        .points("correct", &[])
        .refused(&["oops"]);
}

#[test]
fn first_wrong_row_is_named_whatever_is_wrong_behind_it() {
    let bench = Bench::with(CAMERA, b"id,x_mm,y_mm\na,1,1\nout,41,0\nb,oops,2\n");
    bench
        .points("correct", &[])
        .refused(&["line 3", "point out"]);
}

#[test]
fn points_may_be_replaced_by_their_answers() {
    let bench = Bench::with(CAMERA, many(MANY).as_bytes());
    let answer = bench.points("correct", &[]).ok().stdout;
    bench.points("correct", &["--out", "points.csv"]).ok();
    assert!(fs::read_to_string(bench.path("points.csv")).unwrap() == answer);
}

#[cfg(target_os = "linux")]
#[test]
fn a_million_points_need_no_more_memory_than_one() {
    // Limit of the address space, KiB, with code and the stacks of threads. The rows alone, read
    // whole, would take twice that.
    const LIMIT: u32 = 120_000;
    let bench = Bench::with(CAMERA, many(1_000_000).as_bytes());
    let script = format!(
        "ulimit -v {LIMIT}; exec \"$HOST_SIM\" correct {} points.csv --out out.csv",
        EXPOSURE.join(" ")
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(bench.folder())
        .env("HOST_SIM", assert_cmd::cargo::cargo_bin!("host-sim"))
        // Every thread has a stack, so the number of threads must not depend on the number of
        // cores.
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    Answer::new(&output).ok();
    let answers = fs::read_to_string(bench.path("out.csv")).unwrap();
    assert_eq!(answers.lines().count(), 1_000_001);
}
