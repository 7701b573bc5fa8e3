//! `correct` and `distort` for points of many frames.

use std::path::Path;

use fmc_frames::CalibrationCovariance;

use super::evaluator::Evaluator;
use super::orientations::Orientations;
use super::{Flight, FlightFile};
use crate::cli::{AnswerName, OffSensorName, PointsArgs, TrajectoryArgs};
use crate::command::point_stream::progress;
use crate::command::points::Direction;
use crate::failure::Failure;
use crate::formats::frame_points::{
    AnsweredBlock, Flag, FrameAnswers, FrameBlock, FrameFinder, FrameSource, ImageList, OutColumns,
};
use crate::formats::output::{self, Stopped};
use crate::formats::points::{CoordinateFrame, PointFormat, off_sensor};

pub(in crate::command) fn run(args: &PointsArgs, direction: Direction) -> Result<(), Failure> {
    let out = args.files.out.as_deref();
    check_out(args, out)?;
    let frames = FlightFile::open(&args.exposure, &args.frames, &args.device)?;
    write_orientations(args, &frames)?;
    let flight = Flight::read(frames)?;
    let covariance = args.answers.uncertainty.as_deref();
    let covariance = match covariance {
        Some(path) => Some(CalibrationCovariance::read(path, &flight.file)?),
        None => None,
    };
    let has_sigma =
        covariance.is_some() || flight.table.rows().iter().any(|row| row.sigma().is_some());
    let columns = OutColumns {
        sigma: has_sigma,
        flag: args.answers.off_sensor == OffSensorName::Flag,
        skip: args.answers.off_sensor == OffSensorName::Skip,
    };
    let finder = FrameFinder::new(flight.table.clone(), flight.name.clone());
    let format = format(args)?;
    let source = FrameSource::open(&args.files.points, format, &flight.file, finder, columns)?;
    let mut list = image_list(args, direction, &flight, &source)?;
    let FrameSource {
        file,
        frame,
        ids: _,
        bytes,
        mut blocks,
        mut writer,
    } = source;
    let mut evaluator = Evaluator::new(
        &flight,
        direction,
        args.answers.answer,
        has_sigma,
        covariance.as_ref(),
    )?;
    let mut next = blocks.next_block()?;
    let bar = progress(bytes, out.is_some());
    let written = output::stream(out, |sink| {
        let mut answers = FrameAnswers::default();
        let mut begun = false;
        while let Some(block) = next.take() {
            let refused = |index: usize, what: &str| {
                let row = block.frames.get(index).map(|place| *place as usize);
                let row = row.and_then(|place| flight.table.rows().get(place));
                let sequence = row.map_or(0, |row| row.sequence);
                let place = block.place(&file, index);
                Failure::bad_input(format!("{place}: frame {sequence}: {what}"))
            };
            evaluator.answer(&block, &mut answers).map_err(|wrong| {
                refused(
                    wrong.index,
                    "--answer measured-shifted: not defined with the printed signs of the focus shift",
                )
            })?;
            if args.answers.off_sensor == OffSensorName::Error
                && let Some(index) = answers.flags.iter().position(|flag| *flag != Flag::None)
            {
                let what = fault(&flight, &block, &answers, index, frame, direction);
                Err(refused(index, &what)
                    .with_help("--off-sensor skip leaves such points out, flag marks them"))?;
            }
            if let Some(list) = &mut list {
                list.push(&file, &block, &answers, &flight.table)?;
            } else {
                // If the first block is refused, nothing is written.
                if !begun {
                    writer.begin(sink)?;
                    begun = true;
                }
                let answered = AnsweredBlock {
                    block: &block,
                    answers: &answers,
                    table: &flight.table,
                    camera: &flight.file,
                };
                writer.write(&answered, sink)?;
            }
            bar.set_position(block.read_bytes);
            blocks.reuse(block);
            next = blocks.next_block()?;
        }
        if let Some(list) = list {
            return list.write(sink);
        }
        if !begun {
            writer.begin(sink)?;
        }
        Ok::<(), Stopped>(writer.end(sink)?)
    });
    bar.finish_and_clear();
    written
}

/// Writes the exterior orientations that are asked for.
fn write_orientations(args: &PointsArgs, frames: &FlightFile) -> Result<(), Failure> {
    let TrajectoryArgs {
        trajectory,
        orientation,
        ..
    } = &args.trajectory;
    match (trajectory, orientation) {
        (None, _) => Ok(()),
        (Some(_), None) => Err(Failure::bad_input(
            "--trajectory: the answers are points; --orientation FILE.csv is missing, for the orientations",
        )),
        (Some(path), Some(table)) => {
            output::check_not_an_input(table, &args.files.points)?;
            Orientations::open(&args.trajectory, path, true)?.write_table(frames)
        }
    }
}

/// Returns the list that is asked for.
fn image_list(
    args: &PointsArgs,
    direction: Direction,
    flight: &Flight,
    source: &FrameSource,
) -> Result<Option<ImageList>, Failure> {
    let Some(program) = args.answers.list else {
        return Ok(None);
    };
    let refused = |text: &str| Err(Failure::bad_input(format!("--list: {text}")));
    if direction == Direction::Distort {
        return refused("the coordinates of a list are those that correct answers with");
    }
    if args.answers.answer == AnswerName::Ideal {
        return refused(
            "ideal points are about the principal point of their frame, and the program has one camera for all \
             images: --answer ideal-shifted or measured-shifted",
        );
    }
    if args.answers.off_sensor == OffSensorName::Flag {
        return refused("it has no place for flags: --off-sensor error or skip");
    }
    let Some(ids) = source.ids else {
        return refused("the points must be CSV with a column point, or id");
    };
    ImageList::new(program, ids, &flight.file, &flight.table).map(Some)
}

/// Describes why a point has no answer.
fn fault(
    flight: &Flight,
    block: &FrameBlock,
    answers: &FrameAnswers,
    index: usize,
    frame: CoordinateFrame,
    direction: Direction,
) -> String {
    let given = block.points_mm.get(index).copied().unwrap_or_default();
    match answers.flags.get(index) {
        Some(Flag::OffSensor) if direction == Direction::Distort => {
            let measured = answers
                .answers
                .get(index)
                .map_or(given, |answer| answer.point_mm);
            off_sensor(frame, "its measured point", measured, &flight.file)
        }
        Some(Flag::OffSensor) => off_sensor(frame, "the point", given, &flight.file),
        Some(Flag::Refused) => {
            let place = block.frames.get(index).map(|place| *place as usize);
            let row = place.and_then(|place| flight.table.rows().get(place));
            let reason = row.and_then(|row| flight.table.reason_of(row));
            format!(
                "its trigger was refused ({}), there is no exposure",
                reason.unwrap_or_default()
            )
        }
        _ => "the iteration to the measured point does not converge".to_owned(),
    }
}

/// Returns the format of points and answers.
fn format(args: &PointsArgs) -> Result<PointFormat, Failure> {
    let points = PointFormat::of(&args.files.points);
    let points = points.or(args.files.format).unwrap_or(PointFormat::Csv);
    match args.files.out.as_deref().and_then(PointFormat::of) {
        Some(out) if out != points => Err(Failure::bad_input(format!(
            "--out {}: answers of frames have the format of the points, whose other columns they keep",
            args.files.out.as_deref().unwrap_or(Path::new("")).display()
        ))),
        _ => Ok(points),
    }
}

/// Refuses to replace an input by the answers.
fn check_out(args: &PointsArgs, out: Option<&Path>) -> Result<(), Failure> {
    output::check_not_the_input(out, &args.exposure.camera)?;
    if let (Some(out), Some(uncertainty)) = (out, &args.answers.uncertainty) {
        output::check_not_an_input(out, uncertainty)?;
    }
    args.frames.check_out(out)?;
    args.trajectory.check_out(out)
}
