//! `frame` for the frames of a flight: a row each.

use std::io::{self, Write};

use csv::Writer;
use fmc_camera::flight::time::Time;
use fmc_frames::{FlightFrame, Outcome, row};
use serde::Serialize;

use super::FlightFile;
use super::orientation_columns::OrientationColumns;
use super::orientations::Orientations;
use crate::cli::FrameArgs;
use crate::failure::Failure;
use crate::formats::output::{self, Stopped};

pub(in crate::command) fn run(args: &FrameArgs) -> Result<(), Failure> {
    let out = args.out.as_deref();
    output::check_not_the_input(out, &args.exposure.camera)?;
    args.frames.check_out(out)?;
    args.trajectory.check_out(out)?;
    let mut flight = FlightFile::open(&args.exposure, &args.frames, &args.device)?;
    let trajectory = &args.trajectory;
    let with_table = trajectory.orientation.is_some();
    let mut orientations = match &trajectory.trajectory {
        Some(path) => Some(Orientations::open(trajectory, path, with_table)?),
        None => None,
    };
    if let Some(orientations) = &mut orientations {
        orientations.write_table(&flight)?;
    }
    flight.answers_elsewhere = out.is_some();
    output::stream(out, |sink| {
        let mut rows = Rows::new(sink, args.json);
        flight.read(|frame| {
            let line = Line::of(&frame);
            match (&mut orientations, frame.exposed()) {
                (None, _) => rows.write(&line),
                (Some(_), None) => rows.write_with(&line, &OrientationColumns::default()),
                (Some(orientations), Some(exposed)) => {
                    let found = orientations.of(frame.sequence, exposed.centroid_utc)?;
                    rows.write_with(&line, &OrientationColumns::of(found))
                }
            }
        })?;
        rows.end()
    })?;
    orientations.map_or(Ok(()), |mut orientations| orientations.conclude())
}

/// Writer of the rows, as CSV or as lines of JSON.
enum Rows<'a> {
    Csv(Box<Writer<&'a mut dyn Write>>),
    Json(&'a mut dyn Write),
}

impl<'a> Rows<'a> {
    fn new(sink: &'a mut dyn Write, json: bool) -> Self {
        if json {
            Self::Json(sink)
        } else {
            Self::Csv(Box::new(Writer::from_writer(sink)))
        }
    }

    fn write(&mut self, line: &Line<'_>) -> Result<(), Stopped> {
        match self {
            Self::Csv(writer) => Ok(writer.serialize(line).map_err(io::Error::from)?),
            Self::Json(sink) => json_line(sink, line),
        }
    }

    fn write_with(
        &mut self,
        line: &Line<'_>,
        orientation: &OrientationColumns,
    ) -> Result<(), Stopped> {
        match self {
            Self::Csv(writer) => {
                let row = (line, orientation);
                Ok(writer.serialize(row).map_err(io::Error::from)?)
            }
            Self::Json(sink) => json_line(sink, &Whole { line, orientation }),
        }
    }

    fn end(&mut self) -> Result<(), Stopped> {
        match self {
            Self::Csv(writer) => Ok(writer.flush()?),
            Self::Json(_) => Ok(()),
        }
    }
}

fn json_line(sink: &mut dyn Write, line: &impl Serialize) -> Result<(), Stopped> {
    serde_json::to_writer(&mut *sink, line).map_err(io::Error::from)?;
    Ok(writeln!(sink)?)
}

/// Interior and exterior orientation as one object.
#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    line: &'a Line<'a>,
    #[serde(flatten)]
    orientation: &'a OrientationColumns,
}

/// The interior orientation of a frame; the names are those of `records.csv`.
#[derive(Debug, Serialize)]
struct Line<'a> {
    sequence: u32,
    image: Option<&'a str>,
    outcome: &'static str,
    reason: Option<&'a str>,
    principal_point_x_mm: Option<f32>,
    principal_point_y_mm: Option<f32>,
    principal_point_frame_sigma_mm: Option<f32>,
    principal_point_common_sigma_mm: Option<f32>,
    principal_distance_mm: Option<f32>,
    focus_shift_mm: Option<f32>,
    enlargement: Option<f32>,
    centroid_us: Option<u64>,
    centroid_unix_us: Option<u64>,
    utc_sigma_s: Option<f32>,
    centroid_after_opening_s: Option<f32>,
    exposure_s: Option<f32>,
    compensated_vh_per_s: Option<f32>,
    opening_offset_mm: Option<f32>,
    travel_mm: Option<f32>,
    centroid_offset_mm: Option<f32>,
    variance_mm2: Option<f32>,
    model: Option<&'static str>,
    kernel: Option<&'static str>,
    left_out_nm: Option<f32>,
    faults: &'a str,
    flags: &'a str,
}

impl<'a> Line<'a> {
    fn of(frame: &'a FlightFrame) -> Self {
        let exposed = frame.exposed();
        let interior = exposed.map(|exposed| exposed.interior);
        let motion = interior.map(|interior| interior.motion);
        let sigma = exposed.and_then(|exposed| exposed.sigma);
        let utc = exposed.and_then(|exposed| exposed.centroid_utc);
        let centroid = exposed.and_then(|exposed| exposed.centroid);
        Self {
            sequence: frame.sequence,
            image: frame.image.as_deref(),
            outcome: if exposed.is_some() {
                "exposed"
            } else {
                "refused"
            },
            reason: match &frame.outcome {
                Outcome::Exposed(_) => None,
                Outcome::Refused(reason) => Some(reason),
            },
            principal_point_x_mm: interior.map(|interior| interior.principal_point.x_mm),
            principal_point_y_mm: interior.map(|interior| interior.principal_point.y_mm),
            principal_point_frame_sigma_mm: sigma.map(|sigma| sigma.frame_mm),
            principal_point_common_sigma_mm: sigma.map(|sigma| sigma.common_mm),
            principal_distance_mm: interior.map(|interior| interior.principal_distance_mm),
            focus_shift_mm: interior.map(|interior| interior.focus_shift_mm),
            enlargement: interior.map(|interior| interior.enlargement),
            centroid_us: centroid.map(Time::us),
            centroid_unix_us: utc.map(|utc| utc.unix_us),
            utc_sigma_s: utc.map(|utc| utc.sigma_s),
            centroid_after_opening_s: motion.map(|motion| motion.centroid_time_s),
            exposure_s: interior.map(|interior| interior.exposure_s),
            compensated_vh_per_s: interior.map(|interior| interior.vh_per_s),
            opening_offset_mm: motion.map(|motion| motion.opening_offset_mm),
            travel_mm: motion.map(|motion| motion.travel_mm),
            centroid_offset_mm: motion.map(|motion| motion.centroid_mm),
            variance_mm2: motion.map(|motion| motion.moments.second),
            model: interior.map(|interior| row::model(interior.model)),
            kernel: interior.map(|interior| row::kernel(interior.terms)),
            left_out_nm: interior.map(|interior| interior.left_out_nm),
            faults: &frame.faults,
            flags: &frame.flags,
        }
    }
}
