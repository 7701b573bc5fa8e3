//! Time per point on this PC, as CSV on standard output.
//!
//! `cargo run --release -p host-benches` measures all sizes; sizes as arguments replace them. Every contender is timed
//! once per round, so that all meet the same state of the machine; `of_memcpy` is the median over the rounds of a
//! contender's time by that of copying the same bytes, `clock_ghz` the clock of the core in the same rounds. Nothing
//! asserts these times: they belong to a machine and an hour.
//!
//! `host-benches --calls CALLS KERNEL POINTS` runs one contender so often and prints nothing: the difference of two
//! runs under an instruction counter is its cost.

mod contenders;
mod points;
mod timing;

use std::io::{self, Write as _};
use std::process::ExitCode;

use points::Points;
use timing::CLOCK;

/// Sizes measured without arguments.
const SIZES: [usize; 5] = [1_000, 10_000, 100_000, 1_000_000, 10_000_000];

/// Point times rounds: short sizes are repeated until an undisturbed moment is met.
const POINT_ROUNDS: usize = 200_000_000;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--calls", calls, kernel, points] => call(calls, kernel, points),
        [] => measure(&SIZES),
        ref sizes => sizes
            .iter()
            .map(|size| size.parse().ok())
            .collect::<Option<Vec<_>>>()
            .ok_or_else(|| "sizes are whole numbers of points".to_owned())
            .and_then(|sizes| measure(&sizes)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("{fault}");
            ExitCode::from(2)
        }
    }
}

fn measure(sizes: &[usize]) -> Result<(), String> {
    let mut sink = csv::Writer::from_writer(io::stdout());
    let mut row = |fields: &[&str]| sink.write_record(fields).map_err(|error| error.to_string());
    row(&[
        "core",
        "kernel",
        "points",
        "ns_per_point",
        "median_ns_per_point",
        "of_memcpy",
        "clock_ghz",
    ])?;
    for size in sizes {
        let points = Points::new(*size);
        let mut contenders = contenders::all(&points);
        contenders.push(timing::clock());
        let rounds = (POINT_ROUNDS / size.max(&1)).clamp(15, 3_000);
        let times = timing::by_turns(&mut contenders, rounds);
        let per_point = |seconds: f64| format!("{:.4}", 1e9 * seconds / points.count());
        let clock_ghz = format!("{:.3}", timing::clock_ghz(&times));
        for time in times.iter().filter(|time| time.name != CLOCK) {
            let copy = times.iter().find(|other| other.name == time.copy);
            row(&[
                "host",
                &time.name,
                &size.to_string(),
                &per_point(time.best()),
                &per_point(time.median()),
                &copy.map_or_else(String::new, |copy| format!("{:.3}", time.ratio(copy))),
                &clock_ghz,
            ])?;
        }
        io::stdout().flush().map_err(|error| error.to_string())?;
    }
    Ok(())
}

fn call(calls: &str, kernel: &str, points: &str) -> Result<(), String> {
    let (Ok(calls), Ok(points)) = (calls.parse::<u32>(), points.parse()) else {
        return Err("calls and points are whole numbers".to_owned());
    };
    let points = Points::new(points);
    let mut contenders = contenders::all(&points);
    let Some(contender) = contenders.iter_mut().find(|one| one.name == kernel) else {
        let names: Vec<_> = contenders.iter().map(|one| one.name.as_str()).collect();
        return Err(format!("{kernel} is none of\n{}", names.join("\n")));
    };
    for _ in 0..calls {
        (contender.work)();
    }
    Ok(())
}
