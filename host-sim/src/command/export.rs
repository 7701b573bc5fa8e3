//! `export`: the calibration as another program's camera file.

use std::io::Write;

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices, GOOD_ENOUGH_PX};
use fmc_exchange::program::Program;
use fmc_report::exchange::ExportSummary;

use crate::cli::{ExportArgs, ExportFormat};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &ExportArgs) -> Result<(), Failure> {
    check_options(args)?;
    let (camera, _) = super::read_camera(&args.camera)?;
    let bytes =
        std::fs::read(&args.camera).map_err(|error| Failure::reading(&args.camera, &error))?;
    let program = Program::from(args.format);
    let choices = Choices {
        model: args.model.as_deref(),
        container: args.container.map(Into::into).unwrap_or_default(),
        is_binary: args.binary,
        key: args.id.as_deref(),
    };
    let exported = export::export(&Calibrated::of(&camera), program, &choices)?;
    let summary = ExportSummary::of(&camera, &bytes, program, &exported);
    if let Some(limit) = args.max_residual_um
        && summary.residual_max_um > limit
    {
        return Err(Failure::check(format!(
            "{} {}: the largest residual, {:.4} µm, is above --max-residual-um {limit}; nothing \
             is written",
            program.name(),
            exported.model,
            summary.residual_max_um
        )));
    }
    if summary.residual_max_px >= GOOD_ENOUGH_PX {
        note(format_args!(
            "warning: {} {}: the largest residual is {:.3} px, not below {GOOD_ENOUGH_PX} px",
            program.name(),
            exported.model,
            summary.residual_max_px
        ));
    }
    let folder = OutputFolder::create(&args.out)?;
    for (name, bytes) in &exported.files {
        folder.write(name, |sink| sink.write_all(bytes))?;
    }
    folder.write_json("export.json", &summary)?;
    output::write(None, |sink: &mut dyn Write| {
        writeln!(sink, "{}", summary.text())
    })
}

/// Refuses options of another format.
fn check_options(args: &ExportArgs) -> Result<(), Failure> {
    for (option, is_given, format) in [
        ("--as", args.container.is_some(), ExportFormat::Opencv),
        ("--binary", args.binary, ExportFormat::Colmap),
        ("--id", args.id.is_some(), ExportFormat::Opensfm),
    ] {
        if is_given && args.format != format {
            return Err(Failure::bad_input(format!(
                "{option} is an option of {}",
                Program::from(format).name()
            )));
        }
    }
    Ok(())
}
