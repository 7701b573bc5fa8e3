//! `frame`: the interior orientation of one frame.

use std::io::Write;

use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera_file::CameraFile;
use fmc_frames::row;
use fmc_report::terminal;
use fmc_report::wording::FOCUS_CONVENTION;
use serde::Serialize;

use super::frames;
use crate::cli::{ExposureArgs, FrameArgs};
use crate::failure::Failure;
use crate::formats::output;

/// Columns of the names in the answer.
const NAMES: u16 = 25;

pub(super) fn run(args: &FrameArgs) -> Result<(), Failure> {
    if args.frames.are_given() {
        return frames::list::run(args);
    }
    let request = &args.exposure;
    let (camera, grids) = request.read_camera_with_grids()?;
    output::check_not_the_input(args.out.as_deref(), &request.camera)?;
    let mut device = args.device.open()?;
    let record = device
        .load_grids(&grids)
        .and_then(|()| device.load(&camera.parameters()))
        .and_then(|()| device.expose(&request.exposure()))
        .map_err(|error| request.refused(&camera, &error))?;
    let report = FrameReport::new(&camera, request, &record);
    output::write(args.out.as_deref(), |sink| {
        if args.json {
            serde_json::to_writer_pretty(&mut *sink, &report)?;
            writeln!(sink)
        } else {
            report.print(sink)
        }
    })
}

/// Frame record as users read it; units are in the names.
#[derive(Debug, Serialize)]
struct FrameReport {
    camera: String,
    model: &'static str,
    vh_per_s: f32,
    exposure_s: f32,
    fmc_axis: &'static str,
    direction: &'static str,
    opening_offset_mm: f32,
    travel_mm: f32,
    centroid_offset_mm: f32,
    centroid_time_s: f32,
    travel_variance_mm2: f32,
    principal_point_mm: [f32; 2],
    principal_distance_mm: f32,
    focus_shift_um: f32,
    enlargement: f32,
    focus_convention: &'static str,
    kernel: &'static str,
    left_out_nm: f32,
}

impl FrameReport {
    fn new(camera: &CameraFile, request: &ExposureArgs, record: &InteriorOrientation) -> Self {
        Self {
            camera: camera.name.clone(),
            model: row::model(record.model),
            vh_per_s: record.vh_per_s,
            exposure_s: record.exposure_s,
            fmc_axis: camera.fmc.axis.name(),
            direction: request.direction.name(),
            opening_offset_mm: record.motion.opening_offset_mm,
            travel_mm: record.motion.travel_mm,
            centroid_offset_mm: record.motion.centroid_mm,
            centroid_time_s: record.motion.centroid_time_s,
            travel_variance_mm2: record.motion.moments.second,
            principal_point_mm: [record.principal_point.x_mm, record.principal_point.y_mm],
            principal_distance_mm: record.principal_distance_mm,
            focus_shift_um: record.focus_shift_mm * 1000.0,
            enlargement: record.enlargement,
            focus_convention: FOCUS_CONVENTION,
            kernel: row::kernel(record.terms),
            left_out_nm: record.left_out_nm,
        }
    }

    fn print(&self, sink: &mut dyn Write) -> std::io::Result<()> {
        let [x0, y0] = self.principal_point_mm;
        let pairs = [
            ("camera", self.camera.clone()),
            ("model", self.model.to_owned()),
            ("V/H", format!("{} 1/s", self.vh_per_s)),
            ("exposure t", format!("{} s", self.exposure_s)),
            (
                "FMC axis",
                format!("{}, flight {}", self.fmc_axis, self.direction),
            ),
            (
                "opening offset Δδ",
                format!("{:.6} mm", self.opening_offset_mm),
            ),
            ("travel while open δ", format!("{:.6} mm", self.travel_mm)),
            (
                "centroid offset",
                format!("{:.6} mm", self.centroid_offset_mm),
            ),
            (
                "centroid time",
                format!("opening + {:.7} s", self.centroid_time_s),
            ),
            ("centroid principal point", format!("({x0:.6}, {y0:.6}) mm")),
            (
                "principal distance",
                format!("{} mm", self.principal_distance_mm),
            ),
            (
                "focus shift Δz",
                format!(
                    "{:.3} µm, enlargement {:.3e}, convention ({}): principal distance unchanged",
                    self.focus_shift_um, self.enlargement, self.focus_convention
                ),
            ),
            (
                "left out of the model",
                format!(
                    "at most {:.3} nm ({} kernel)",
                    self.left_out_nm, self.kernel
                ),
            ),
        ];
        writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
    }
}
