//! Wall time, by turns.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Name of [`clock`].
pub(crate) const CLOCK: &str = "clock";
/// Steps of [`clock`], each of two operations that wait for one another and take a cycle each.
const STEPS: u32 = 10_000;

/// Least duration of one measurement: the clock and the call of it are nothing beside it, and another process seldom
/// comes between.
const LEAST: Duration = Duration::from_micros(20);

/// What is timed against others.
pub(crate) struct Contender<'a> {
    pub(crate) name: String,
    /// The contender that copies the same bytes.
    pub(crate) copy: &'static str,
    pub(crate) work: Box<dyn FnMut() + 'a>,
}

impl<'a> Contender<'a> {
    pub(crate) fn new(
        name: impl Into<String>,
        copy: &'static str,
        work: impl FnMut() + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            copy,
            work: Box::new(work),
        }
    }
}

/// The times of one contender, seconds per call, a round each.
pub(crate) struct Times {
    pub(crate) name: String,
    pub(crate) copy: &'static str,
    pub(crate) rounds: Vec<f64>,
}

impl Times {
    pub(crate) fn best(&self) -> f64 {
        self.rounds.iter().copied().fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn median(&self) -> f64 {
        median(self.rounds.clone())
    }

    /// Median of the ratios of rounds: what slows the machine down slows down both.
    pub(crate) fn ratio(&self, to: &Self) -> f64 {
        median(
            self.rounds
                .iter()
                .zip(&to.rounds)
                .map(|(time, other)| time / other)
                .collect(),
        )
    }
}

/// Times all, each once per round, so that they meet the same state of the machine.
pub(crate) fn by_turns(contenders: &mut [Contender<'_>], rounds: usize) -> Vec<Times> {
    let calls: Vec<u32> = contenders.iter_mut().map(calls_of).collect();
    let mut times: Vec<Times> = contenders
        .iter()
        .map(|contender| Times {
            name: contender.name.clone(),
            copy: contender.copy,
            rounds: Vec::with_capacity(rounds),
        })
        .collect();
    for _ in 0..rounds {
        for ((contender, times), calls) in contenders.iter_mut().zip(&mut times).zip(&calls) {
            // What the one before left in the caches is not this one's.
            (contender.work)();
            let start = Instant::now();
            for _ in 0..*calls {
                (contender.work)();
            }
            let taken = start.elapsed().as_secs_f64();
            times.rounds.push(taken / f64::from(*calls));
        }
    }
    times
}

/// Cycles of the clock by which a core counts its operations, as a contender: what it takes is the clock of the moment.
pub(crate) fn clock() -> Contender<'static> {
    Contender::new(CLOCK, "", || {
        let mut number = black_box(1_u64);
        for _ in 0..STEPS {
            // A rotation and an exclusive or, which no core makes one of.
            number = number.rotate_left(7) ^ 0x5bd1;
        }
        black_box(number);
    })
}

/// The clock that [`clock`] has met where it was least disturbed, GHz.
pub(crate) fn clock_ghz(times: &[Times]) -> f64 {
    let clock = times.iter().find(|time| time.name == CLOCK);
    clock.map_or(f64::NAN, |clock| {
        f64::from(2 * STEPS) / (1e9 * clock.best())
    })
}

/// Calls that take [`LEAST`] together.
fn calls_of(contender: &mut Contender<'_>) -> u32 {
    let mut calls = 1;
    loop {
        let start = Instant::now();
        for _ in 0..calls {
            (contender.work)();
        }
        if start.elapsed() >= LEAST {
            return calls;
        }
        calls *= 2;
    }
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}
