//! Time per point on this PC, as CSV on standard output.
//!
//! Every contender is timed once per round, so that all meet the same state of the machine.
//! `of_memcpy` is the median over the rounds of a contender's time relative to that of copying the
//! same bytes, `clock_ghz` the clock of the core in the same rounds. No test asserts these times,
//! because they depend on the machine and its load.

mod contenders;
mod cpu_time;
mod flight;
#[path = "../../../crates/kernel/tests/host/form.rs"]
mod form;
mod opencv;
mod points;
mod stream;
mod table;
mod timing;

use std::process::ExitCode;

use clap::Parser;

use flight::Flight;
use points::Points;
use table::Table;
use timing::{CLOCK, Times, Work};

/// Points times rounds: short sizes are repeated until there is a round without disturbance.
const POINT_ROUNDS: usize = 200_000_000;

/// Time per point on this PC, as CSV: the kernel, a copy of the same bytes, another crate, and
/// `OpenCV` if `python3` has it
#[derive(Debug, Parser)]
struct Arguments {
    /// Points to a call
    #[arg(default_values_t = [1_000, 10_000, 100_000, 1_000_000, 10_000_000], value_parser = count)]
    sizes: Vec<usize>,
    /// Time `host-sim correct` at the end of a pipe instead, built beside this program: text beside
    /// its parser alone, an array beside a copy of the same bytes through a pipe; wall time and
    /// processor time. Rows come in hundred thousands
    #[arg(long, value_name = "ROWS", value_parser = count, conflicts_with = "sizes")]
    stream: Option<usize>,
    /// Time `host-sim correct --frames` instead: so many frames, and the points of each, as an
    /// array in a pipe beside a copy of it; the memory at most goes to the error stream
    #[arg(
        long,
        value_names = ["FRAMES", "POINTS"],
        num_args = 2,
        value_parser = count,
        conflicts_with_all = ["sizes", "stream"]
    )]
    flight: Option<Vec<usize>>,
    /// Call one contender so often with the first size and print nothing: the difference of two
    /// runs under an instruction counter is its cost
    #[arg(long, requires = "kernel")]
    calls: Option<u32>,
    /// The contender of `--calls`, by its name in the table
    #[arg(long, requires = "calls")]
    kernel: Option<String>,
}

/// Parses a number of points or rows.
fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count @ 1..=MOST) => Ok(count),
        _ => Err(format!("a whole number from 1 to {MOST}")),
    }
}

/// Largest number of points or rows.
const MOST: usize = 1_000_000_000;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let called = arguments.calls.zip(arguments.kernel);
    let done = match (arguments.stream, arguments.flight.as_deref(), called) {
        (_, Some([frames, points]), _) => flight(*frames, *points),
        (Some(rows), ..) => stream(rows),
        (None, _, Some((calls, kernel))) => call(calls, &kernel, &arguments.sizes),
        (None, _, None) => measure(&arguments.sizes),
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
        contenders.extend(opencv::all(*size));
        contenders.push(timing::clock());
        let rounds = (POINT_ROUNDS / size).clamp(15, 3_000);
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

fn stream(rows: usize) -> Result<(), String> {
    let rows = rows.next_multiple_of(stream::ROWS);
    print(&stream::times(rows, rounds(rows))?, rows)
}

fn flight(frames: usize, points: usize) -> Result<(), String> {
    let flight = Flight { frames, points };
    let rows = flight.rows();
    print(&flight.times(rounds(rows))?, rows)?;
    if let Some(mb) = cpu_time::most_memory_of_children_mb() {
        eprintln!("memory of host-sim at most: {mb} MB");
    }
    Ok(())
}

/// Returns the rounds of a stream of so many rows.
fn rounds(rows: usize) -> usize {
    (STREAM_ROUNDS / rows).clamp(3, 25)
}

/// Prints times, each command beside its bound before it.
fn print(times: &[Times], rows: usize) -> Result<(), String> {
    let mut table = Table::begin()?;
    for time in times {
        table.row(time, rows, None, None)?;
    }
    table.flush()?;
    for [bound, command] in times.as_chunks().0 {
        let [time, of] = [&command.name, &bound.name];
        eprintln!("{time}: {:.2} of {of}", command.ratio(bound));
    }
    Ok(())
}

fn call(calls: u32, kernel: &str, sizes: &[usize]) -> Result<(), String> {
    let points = Points::new(sizes.first().copied().unwrap_or_default());
    let mut contenders = contenders::all(&points);
    let Some(contender) = contenders.iter_mut().find(|one| one.name == kernel) else {
        let names: Vec<_> = contenders.iter().map(|one| one.name.as_str()).collect();
        return Err(format!(
            "--kernel {kernel} is not one of\n{}",
            names.join("\n")
        ));
    };
    for _ in 0..calls {
        match &mut contender.work {
            Work::Warm(work) | Work::Cold(work) => work(),
            Work::Told(work) => drop(work()),
        }
    }
    Ok(())
}
