//! `smear`: the image motion that the compensation leaves.

use std::io;

use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::image_motion::{ImageMotionError, View};
use fmc_camera_file::CameraFile;
use fmc_report::smear::SmearReport;
use fmc_simulation::smear::field::{SmearField, SmearRequest};
use fmc_simulation::smear::term::{Disturbances, Term};

use crate::cli::{DirectionName, ExposureArgs, FocusSignName, ModelName, SmearArgs, VhOption};
use crate::device::DeviceError;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &SmearArgs) -> Result<(), Failure> {
    let disturbances = args
        .disturbances()
        .map_err(|error| Failure::bad_input(error.to_string()))?;
    let (camera, checked, grids) = CameraFile::read_with_grids(&args.camera)?;
    super::warn_of_distortion(&args.camera, &camera);
    let exposure = args.exposure_args(&disturbances);
    let record = checked
        .frame(&exposure.exposure())
        .map_err(|error| exposure.refused(&camera, &DeviceError::Frame(error)))?
        .interior;
    let view = View {
        principal_point: record.principal_point,
        ..View::calibrated(checked.calibration())
    };
    let request = SmearRequest {
        vh_per_s: args.vh.per_s(),
        exposure_s: args.exposure,
        disturbances,
    };
    let fields = request
        .fields(&camera, &view)
        .map_err(|error| args.refused(&error))?;
    if !grids.is_empty() {
        let grids = grids.grids(checked.calibration()).map_err(|refusal| {
            Failure::bad_input(format!("{}: [grid]: {refusal}", args.camera.display()))
        })?;
        note(format_args!(
            "note: {}: the residual grids are left out of the simulated exposure: they change its smear by at most {:.3} µm; \
             the predicted smear knows no distortion",
            args.camera.display(),
            left_out_um(&grids, &fields, record.motion.travel_mm)
        ));
    }
    let folder = args.out.as_deref().map(OutputFolder::create).transpose()?;
    let report = SmearReport {
        camera: &camera,
        request: &request,
        fields: &fields,
    };
    if let Some(folder) = &folder {
        write(folder, &report)?;
    }
    output::write(None, |sink| sink.write_all(report.text().as_bytes()))
}

/// Returns a bound of the smear that the residual grids add to an exposure, µm: their slope times
/// the path of the image in the lens, which the stage follows, and over the sensor, which is the
/// smear with theirs, over the least scale of the image.
fn left_out_um(grids: &CameraGrids<'_>, fields: &[SmearField], travel_mm: f32) -> f64 {
    let smears = fields.iter().map(|field| field.simulated_max_um);
    let path_um = 1e3 * f64::from(travel_mm.abs()) + smears.fold(0.0, f64::max);
    let (slope, scale) = (f64::from(grids.slope()), f64::from(grids.least_scale()));
    slope * path_um / (scale - slope).max(f64::MIN_POSITIVE)
}

fn write(folder: &OutputFolder, report: &SmearReport<'_>) -> Result<(), Failure> {
    let figures = report
        .figures()
        .map_err(|error| Failure::device_or_io(format!("figure: {error}")))?;
    folder.write("summary.json", |sink| report.write_summary(sink))?;
    folder.write("smear.csv", |sink| {
        report.write_points(sink).map_err(io::Error::other)
    })?;
    for (name, svg) in figures {
        folder.write(&name, |sink| sink.write_all(svg.as_bytes()))?;
    }
    note(format_args!(
        "figure: {}",
        folder.path().join("smear.svg").display()
    ));
    Ok(())
}

impl SmearArgs {
    fn disturbances(&self) -> Result<Disturbances, fmc_simulation::smear::term::NotBelievable> {
        Disturbances::new([
            (Term::VhError, self.vh_error_percent),
            (Term::Relief, self.relief_percent),
            (Term::Pitch, self.pitch_deg),
            (Term::Roll, self.roll_deg),
            (Term::Drift, self.drift_deg),
            (Term::PitchRate, self.pitch_rate_deg_s),
            (Term::RollRate, self.roll_rate_deg_s),
            (Term::YawRate, self.yaw_rate_deg_s),
        ])
    }

    /// Returns the exposure for the V/H that the camera is told, in the form of the other commands,
    /// so that it is refused in the same words.
    fn exposure_args(&self, disturbances: &Disturbances) -> ExposureArgs {
        let vh_per_s = self.vh.per_s();
        let told_per_s = disturbances.told_vh_per_s(vh_per_s);
        ExposureArgs {
            camera: self.camera.clone(),
            vh: if told_per_s.to_bits() == vh_per_s.to_bits() {
                self.vh
            } else {
                VhOption::of(told_per_s)
            },
            exposure: Some(self.exposure),
            opening_offset_mm: None,
            focus_shift_um: 0.0,
            direction: DirectionName::Forward,
            focus_sign: FocusSignName::Physical,
            model: ModelName::Exact,
        }
    }

    fn refused(&self, error: &ImageMotionError) -> Failure {
        match error {
            ImageMotionError::Horizon(_) => Failure::bad_input(format!(
                "--pitch-deg = {} with --roll-deg = {}: {error}",
                self.pitch_deg, self.roll_deg
            )),
            ImageMotionError::OutOfRange(range) => Failure::bad_input(range.to_string()),
        }
    }
}
