//! Load of a core by the control loop, from the instructions of its rounds.

use std::fmt;

use anyhow::{Result, ensure};

use super::cost::Instructions;

/// Clocks: those of the emulated machines, and that of a usual Cortex-M4F.
const CLOCKS_MHZ: [f64; 2] = [25.0, 168.0];

/// Period of the control loop.
const ROUND_MS: f64 = 1.0;

/// Row with the mean over the frame cycle at 2 frames/s.
const MEAN: &str = "control_round";
/// Row with the longest round at the longest exposure within the camera's limits.
const WORST: &str = "control_round_worst";
/// Row with the longest round with a shutter that stays open until the camera gives it up.
const STUCK: &str = "control_round_stuck_shutter";

/// Least mean share of the time that must be left at the slowest clock.
pub(crate) const LEAST_IDLE: f64 = 0.8;

/// Load of one core at one clock, at one instruction per cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Load {
    core: String,
    clock_mhz: f64,
    /// Share of the time that is left.
    idle: f64,
    worst_ms: f64,
    stuck_ms: f64,
}

impl Load {
    /// Returns true if enough time is left and no round lasts into the next.
    pub(crate) fn is_allowed(&self) -> bool {
        self.idle >= LEAST_IDLE && self.worst_ms.max(self.stuck_ms) < ROUND_MS
    }
}

impl fmt::Display for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "control loop on {} at {} MHz, 1 kHz, 2 frames/s: {:.1} % idle, worst round {:.2} ms, {:.2} ms with a stuck shutter",
            self.core,
            self.clock_mhz,
            100.0 * self.idle,
            self.worst_ms,
            self.stuck_ms
        )
    }
}

/// Returns the loads of every core of the rows.
pub(crate) fn loads(rows: &[Instructions]) -> Vec<Load> {
    let mut loads = Vec::new();
    for mean in rows.iter().filter(|row| row.kernel == MEAN) {
        let of = |kernel| {
            let is_it = |row: &&Instructions| {
                (&row.core, &row.compiler, row.kernel.as_str())
                    == (&mean.core, &mean.compiler, kernel)
            };
            rows.iter().find(is_it).map(|row| row.count)
        };
        let (Some(worst), Some(stuck)) = (of(WORST), of(STUCK)) else {
            continue;
        };
        for clock_mhz in CLOCKS_MHZ {
            let ms = |instructions: f64| instructions / (1000.0 * clock_mhz);
            loads.push(Load {
                core: mean.core.clone(),
                clock_mhz,
                idle: 1.0 - ms(mean.count) / ROUND_MS,
                worst_ms: ms(worst),
                stuck_ms: ms(stuck),
            });
        }
    }
    loads
}

/// Prints every load and checks that enough time is left.
///
/// # Errors
/// An error if a load is not allowed, or if there is none.
pub(crate) fn check(loads: &[Load]) -> Result<()> {
    ensure!(
        !loads.is_empty(),
        "no round of the control loop was counted"
    );
    for load in loads {
        eprintln!("{load}");
        ensure!(
            load.is_allowed(),
            "{load}: {:.0} % must be left at least, and a round must end before the next",
            100.0 * LEAST_IDLE
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::cost::Instructions;
    use super::super::documented;
    use super::super::limit::{LIMITS, Limit};
    use super::{CLOCKS_MHZ, LEAST_IDLE, MEAN, ROUND_MS, STUCK, WORST, check, loads};

    const DOCUMENT: &str = include_str!("../../../docs/control_loop.md");

    fn rows([mean, worst, stuck]: [f64; 3]) -> Vec<Instructions> {
        [
            ("control_round", mean),
            ("control_round_worst", worst),
            ("control_round_stuck_shutter", stuck),
        ]
        .map(|(kernel, count)| Instructions {
            core: "cortex-m4f".to_owned(),
            kernel: kernel.to_owned(),
            count,
            unit: "round".to_owned(),
            compiler: "rustc".to_owned(),
        })
        .to_vec()
    }

    #[test]
    fn load_is_that_of_an_instruction_per_cycle() {
        let found = loads(&rows([4000.0, 12_500.0, 20_000.0]));
        let text = found[0].to_string();
        assert!(
            text.ends_with("84.0 % idle, worst round 0.50 ms, 0.80 ms with a stuck shutter"),
            "{text}"
        );
        assert!(found.iter().all(super::Load::is_allowed));
    }

    #[test]
    fn too_little_left_and_a_round_into_the_next_are_not_allowed() {
        let allowed = |counts| {
            let loads = loads(&rows(counts));
            loads.len() == 2 && check(&loads).is_ok()
        };
        assert!(allowed([4999.0, 24_999.0, 24_999.0]));
        assert!(!allowed([5001.0, 24_999.0, 24_999.0]));
        assert!(!allowed([4000.0, 25_000.0, 24_999.0]));
        assert!(!allowed([4000.0, 24_999.0, 25_000.0]));
    }

    #[test]
    fn no_load_at_all_is_not_allowed() {
        let counted = rows([4000.0, 12_500.0, 20_000.0]);
        for none in [&counted[1..], &counted[..2], &[]] {
            let fault = check(&loads(none)).unwrap_err().to_string();
            assert_eq!(fault, "no round of the control loop was counted");
        }
    }

    #[test]
    fn committed_table_is_within_the_limits() {
        check(&loads(&documented::tables().0)).unwrap();
    }

    #[test]
    fn limits_of_rounds_are_what_has_to_be_left() {
        let limits: Vec<Limit> = documented::table(LIMITS);
        let cycles = 1000.0 * CLOCKS_MHZ[0] * ROUND_MS;
        for (kernel, most) in [
            (MEAN, (1.0 - LEAST_IDLE) * cycles),
            (WORST, cycles),
            (STUCK, cycles),
        ] {
            let mut of_kernel = limits.iter().filter(|limit| limit.cost == kernel);
            let is_within = |limit: &Limit| limit.most <= most.round();
            assert!(
                of_kernel.clone().count() >= 3 && of_kernel.all(is_within),
                "{kernel}"
            );
        }
    }

    #[test]
    fn documented_loads_are_those_of_the_committed_table() {
        let rows = documented::rows(DOCUMENT, "| Cortex-M4F at | idle, mean | worst round |");
        let loads: Vec<_> = loads(&documented::instructions())
            .into_iter()
            .filter(|load| load.core == "cortex-m4f")
            .collect();
        assert_eq!(rows.len(), loads.len());
        for (row, load) in rows.iter().zip(loads) {
            let clock = format!("{} MHz", load.clock_mhz);
            assert!(row[0].starts_with(&clock), "{row:?}");
            let numbers = [
                format!("{:.1} %", 100.0 * load.idle),
                format!("{:.2} ms", load.worst_ms),
                format!("{:.2} ms", load.stuck_ms),
            ];
            assert_eq!(row[1..4], numbers);
        }
    }

    #[test]
    fn documented_interrupts_and_bytes_are_those_of_the_committed_table() {
        let rows = documented::rows(DOCUMENT, "| row | instructions | per |");
        assert!(rows.len() > 10);
        for row in rows {
            let kernel = row[0].trim_matches('`');
            let counted = documented::count("cortex-m4f", kernel);
            assert_eq!(counted.to_string(), row[1], "{kernel}");
        }
    }
}
