//! `export`: the calibration, or the frames of a flight, as another program's files.

mod frames;

use std::io::Write;

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices, GOOD_ENOUGH_PX, Misfit};
use fmc_exchange::program::Program;
use fmc_frames::FrameCamera;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_report::exchange::ExportSummary;

use crate::cli::ExportArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder, OutputSet};

pub(super) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let choices = Choices {
        model: args.model.as_deref(),
        container: args.container.map(Into::into),
        is_binary: args.binary,
        key: args.id.as_deref(),
    };
    check_options(args, &choices)?;
    let (camera, grids) = super::read_camera_with_grids(&args.camera)?;
    let bytes =
        std::fs::read(&args.camera).map_err(|error| Failure::reading(&args.camera, &error))?;
    if let Some(records) = &args.records {
        return frames::run(args, records, (&camera, grids), &bytes, &choices);
    }
    let name = args.camera.display().to_string();
    let frame_camera = FrameCamera::with_grids(&name, &camera, grids)?;
    let splines = ResidualSplines::of(&frame_camera.grids()?);
    let calibrated = Calibrated::of(&camera).with_residual(splines);
    let exported = export::export(&calibrated, args.format, &choices)?;
    let summary = ExportSummary::of(&camera, &bytes, args.format, &exported);
    check_residual(args, &summary)?;
    let folder = OutputFolder::create(&args.out)?;
    let mut set = OutputSet::new(&folder);
    for (name, bytes) in &exported.files {
        set.write(name, |sink| sink.write_all(bytes))?;
    }
    conclude(set, &summary)
}

/// Refuses a residual above the one that was asked for, and warns of a large one.
fn check_residual(args: &ExportArgs, summary: &ExportSummary) -> Result<(), Failure> {
    if let Some(limit) = args.max_residual_um
        && summary.residual_max_um > limit
    {
        return Err(Failure::check(format!(
            "{} {}: the largest residual, {:.4} µm, is above --max-residual-um {limit}; nothing \
             is written",
            summary.format, summary.model, summary.residual_max_um
        )));
    }
    if summary.residual_max_px >= GOOD_ENOUGH_PX {
        note(format_args!(
            "warning: {} {}: the largest residual is {:.3} px, not below {GOOD_ENOUGH_PX} px",
            summary.format, summary.model, summary.residual_max_px
        ));
    }
    Ok(())
}

/// Writes the statement, into the folder and to the terminal.
fn conclude(mut set: OutputSet<'_>, summary: &ExportSummary) -> Result<(), Failure> {
    set.write_json(ExportSummary::FILE, summary)?;
    set.complete()?;
    output::write(None, |sink: &mut dyn Write| {
        writeln!(sink, "{}", summary.text())
    })
}

/// Refuses options of another format.
fn check_options(args: &ExportArgs, choices: &Choices<'_>) -> Result<(), Failure> {
    let Err(misfit) = choices.check(args.format, args.records.is_some()) else {
        return Ok(());
    };
    let name = args.format.name();
    let option_of =
        |option: &str, program: Program| format!("{option} is an option of {}", program.name());
    let text = match misfit {
        Misfit::Container => option_of("--as", Program::OpenCv),
        Misfit::Binary => option_of("--binary", Program::Colmap),
        Misfit::Key => option_of("--id", Program::OpenSfm),
        Misfit::Frames => {
            let others = Program::WITH_FRAMES.map(Program::name).join(", ");
            let text = format!(
                "--records: {name} has one camera for all images; a camera per image have {others}"
            );
            return Err(Failure::bad_input(text).with_help(format!(
                "move the points of every frame instead: host-sim correct --records … --answer \
                 measured-shifted goes with the one camera of export {name} without --records, \
                 --answer ideal-shifted with a camera without distortion"
            )));
        }
        Misfit::NoFrames => format!(
            "{name} is a format of frames: --records with the records of a flight is missing"
        ),
        Misfit::KeyOfFrames => {
            "--id names one camera; with --records every image has a camera of its own".to_owned()
        }
    };
    Err(Failure::bad_input(text))
}
