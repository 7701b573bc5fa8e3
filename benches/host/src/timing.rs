//! Wall time of contenders, in turns.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Name of [`clock`].
pub(crate) const CLOCK: &str = "clock";
/// Number of steps of [`clock`], each of two operations, of which the second needs the result of
/// the first, and which take a cycle each.
const STEPS: u32 = 10_000;

/// Shortest duration of one measurement: the time of reading the clock is negligible in it, and
/// another process rarely interrupts it.
const LEAST: Duration = Duration::from_micros(20);

/// Bytes that replace everything in the caches of a processor.
const EVICTING: usize = 256 << 20;

/// Rounds of contenders that find nothing in the caches, which are emptied before each, and of
/// those that are told: spread over the rounds of the others.
const SELDOM_ROUNDS: usize = 50;

/// Work that is timed against others.
pub(crate) struct Contender<'a> {
    pub(crate) name: String,
    /// Name of the contender that copies the same bytes.
    pub(crate) copy: &'static str,
    pub(crate) work: Work<'a>,
}

/// Work of a contender.
pub(crate) enum Work<'a> {
    /// It is called, with all in the caches that fits them.
    Warm(Box<dyn FnMut() + 'a>),
    /// It is called with nothing in the caches.
    Cold(Box<dyn FnMut() + 'a>),
    /// It is done elsewhere, and tells the seconds of a call.
    Told(Box<dyn FnMut() -> f64 + 'a>),
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
            work: Work::Warm(Box::new(work)),
        }
    }

    /// Returns a contender that says how long a call took.
    pub(crate) fn told(name: String, work: impl FnMut() -> f64 + 'a) -> Self {
        Self {
            name,
            copy: "",
            work: Work::Told(Box::new(work)),
        }
    }

    /// Returns the contender with nothing in the caches, as far as its work is called here.
    pub(crate) fn cold(self) -> Self {
        Self {
            name: format!("{}, cold", self.name),
            copy: "",
            work: match self.work {
                Work::Warm(work) => Work::Cold(work),
                other => other,
            },
        }
    }
}

/// Times of one contender, in seconds per call, one for each round.
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

    /// Returns the median of the ratios of rounds; a disturbance of the machine slows both parts of
    /// a ratio.
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

/// Times all contenders, each once per round, so that they meet the same state of the machine.
pub(crate) fn by_turns(contenders: &mut [Contender<'_>], rounds: usize) -> Vec<Times> {
    let calls: Vec<u32> = contenders
        .iter_mut()
        .map(|contender| match &mut contender.work {
            Work::Warm(work) => calls_of(work),
            Work::Cold(_) | Work::Told(_) => 1,
        })
        .collect();
    let mut times: Vec<Times> = contenders
        .iter()
        .map(|contender| Times {
            name: contender.name.clone(),
            copy: contender.copy,
            rounds: Vec::with_capacity(rounds),
        })
        .collect();
    let mut other = vec![0_u8; EVICTING];
    let seldom = rounds.div_ceil(SELDOM_ROUNDS);
    for round in 0..rounds {
        let is_seldom = round.is_multiple_of(seldom);
        for ((contender, times), calls) in contenders.iter_mut().zip(&mut times).zip(&calls) {
            match &mut contender.work {
                Work::Warm(work) => {
                    // One call before the measurement replaces what the previous contender left in
                    // the caches.
                    work();
                    times.rounds.push(seconds(work, *calls));
                }
                Work::Cold(_) | Work::Told(_) if !is_seldom => {}
                Work::Cold(work) => {
                    for byte in &mut other {
                        *byte = byte.wrapping_add(1);
                    }
                    black_box(&mut other);
                    times.rounds.push(seconds(work, 1));
                }
                Work::Told(work) => times.rounds.push(work()),
            }
        }
    }
    times
}

/// Returns the time of a call, s.
fn seconds(work: &mut Box<dyn FnMut() + '_>, calls: u32) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        work();
    }
    start.elapsed().as_secs_f64() / f64::from(calls)
}

/// Contender that takes a known number of cycles, so that its time gives the clock of the core at
/// that moment.
pub(crate) fn clock() -> Contender<'static> {
    Contender::new(CLOCK, "", || {
        let mut number = black_box(1_u64);
        for _ in 0..STEPS {
            // A core cannot combine a rotation and an exclusive or into one operation.
            number = number.rotate_left(7) ^ 0x5bd1;
        }
        black_box(number);
    })
}

/// Returns the clock that [`clock`] measured in its least disturbed round, GHz.
pub(crate) fn clock_ghz(times: &[Times]) -> f64 {
    let clock = times.iter().find(|time| time.name == CLOCK);
    clock.map_or(f64::NAN, |clock| {
        f64::from(2 * STEPS) / (1e9 * clock.best())
    })
}

/// Returns the number of calls that take [`LEAST`] together.
fn calls_of(work: &mut Box<dyn FnMut() + '_>) -> u32 {
    let mut calls = 1;
    loop {
        let start = Instant::now();
        for _ in 0..calls {
            work();
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
