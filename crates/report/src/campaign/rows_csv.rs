//! The heat map as a table: `heat-map.csv`, one line per fault and phase.

use std::io::Write;

use fmc_simulation::campaign::results::{CELL_MS, Results};

/// Writes the table; a phase without a frame that has neither fault nor flag has no value.
///
/// # Errors
/// Those of the sink.
pub fn write(results: &Results, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record(["fault", "phase_ms", "worst"])?;
    for row in &results.rows {
        for (index, cell) in (0_u32..).zip(&row.cells) {
            let worst = cell.map_or(String::new(), |used| format!("{used:.6}"));
            writer.write_record([row.name.clone(), (index * CELL_MS).to_string(), worst])?;
        }
    }
    writer.flush()?;
    Ok(())
}
