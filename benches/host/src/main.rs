//! Time per point on this PC, as CSV on standard output.
//!
//! `cargo run --release -p host-benches` measures all sizes; sizes as arguments replace them. Every contender is timed
//! once per round, so that all meet the same state of the machine; `of_memcpy` is the median over the rounds of a
//! contender's time by that of copying the same bytes, `clock_ghz` the clock of the core in the same rounds. Nothing
//! asserts these times: they belong to a machine and an hour.
//!
//! `host-benches --stream ROWS` (a multiple of 100 000) times `host-sim correct`, which must have been built beside it,
//! at the end of a pipe: as text beside its parser alone, as an array beside a copy of the same bytes through a pipe,
//! wall time and processor time. How the command compares with its bound, in the median of the rounds, ends on the
//! error stream.
//!
//! `host-benches --calls CALLS KERNEL POINTS` runs one contender so often and prints nothing: the difference of two
//! runs under an instruction counter is its cost.

mod contenders;
mod cpu_time;
mod points;
mod stream;
mod table;
mod timing;

use std::process::ExitCode;

use points::Points;
use table::Table;
use timing::CLOCK;

/// Sizes measured without arguments.
const SIZES: [usize; 5] = [1_000, 10_000, 100_000, 1_000_000, 10_000_000];

/// Point times rounds: short sizes are repeated until an undisturbed moment is met.
const POINT_ROUNDS: usize = 200_000_000;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--calls", calls, kernel, points] => call(calls, kernel, points),
        ["--stream", rows] => stream(rows),
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
    let mut table = Table::begin()?;
    for size in sizes {
        let points = Points::new(*size);
        let mut contenders = contenders::all(&points);
        contenders.push(timing::clock());
        let rounds = (POINT_ROUNDS / size.max(&1)).clamp(15, 3_000);
        let times = timing::by_turns(&mut contenders, rounds);
        let clock_ghz = Some(timing::clock_ghz(&times));
        for time in times.iter().filter(|time| time.name != CLOCK) {
            let copy = times.iter().find(|other| other.name == time.copy);
            table.row(time, *size, copy, clock_ghz)?;
        }
        table.flush()?;
    }
    Ok(())
}

/// Rows times rounds of a stream.
const STREAM_ROUNDS: usize = 50_000_000;

fn stream(rows: &str) -> Result<(), String> {
    let Ok(rows @ 1..) = rows.parse::<usize>() else {
        return Err("rows are a whole number".to_owned());
    };
    let rows = rows.next_multiple_of(stream::ROWS);
    let times = stream::times(rows, (STREAM_ROUNDS / rows).clamp(3, 25))?;
    let mut table = Table::begin()?;
    for time in &times {
        table.row(time, rows, None, None)?;
    }
    table.flush()?;
    for [bound, command] in times.as_chunks().0 {
        let [time, of] = [&command.name, &bound.name];
        eprintln!("{time}: {:.2} of {of}", command.ratio(bound));
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
