//! Times as CSV on standard output.

use std::io;

use crate::timing::Times;

/// Rows of times on standard output.
pub(crate) struct Table(csv::Writer<io::Stdout>);

impl Table {
    pub(crate) fn begin() -> Result<Self, String> {
        let mut table = Self(csv::Writer::from_writer(io::stdout()));
        table.write(&[
            "core",
            "kernel",
            "points",
            "ns_per_point",
            "median_ns_per_point",
            "of_memcpy",
            "clock_ghz",
        ])?;
        Ok(table)
    }

    /// Writes the row of a contender; `copy` copies the same bytes, and `clock_ghz` is the clock of
    /// the core at that time.
    pub(crate) fn row(
        &mut self,
        time: &Times,
        points: usize,
        copy: Option<&Times>,
        clock_ghz: Option<f64>,
    ) -> Result<(), String> {
        let count = u32::try_from(points).map_or(f64::NAN, f64::from);
        let per_point = |seconds: f64| format!("{:.4}", 1e9 * seconds / count);
        self.write(&[
            "host",
            &time.name,
            &points.to_string(),
            &per_point(time.best()),
            &per_point(time.median()),
            &copy.map_or_else(String::new, |copy| format!("{:.3}", time.ratio(copy))),
            &clock_ghz.map_or_else(String::new, |ghz| format!("{ghz:.3}")),
        ])
    }

    fn write(&mut self, fields: &[&str]) -> Result<(), String> {
        let written = self.0.write_record(fields);
        written.map_err(|error| error.to_string())
    }

    pub(crate) fn flush(&mut self) -> Result<(), String> {
        self.0.flush().map_err(|error| error.to_string())
    }
}
