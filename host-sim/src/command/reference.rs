//! `reference`: points through the strict solver.

use fmc_camera::Camera;
use fmc_reference::model_reference::ModelReference;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{Reading, Weight};

use super::point_stream::PointStream;
use crate::cli::{ReadingName, ReferenceArgs, WeightName};
use crate::device::DeviceError;
use crate::failure::{Failure, note};
use crate::formats::output;
use crate::formats::points::{Answer, Checked};

pub(super) fn run(args: &ReferenceArgs) -> Result<(), Failure> {
    let request = &args.exposure;
    let (camera, grids) = request.read_camera_with_grids()?;
    output::check_not_the_input(args.files.out.as_deref(), &request.camera)?;
    let points = PointStream::open(&args.files, &camera, Checked::OnSensor)?;
    // The reference accepts only what the camera accepts.
    let splines = Camera::new(camera.parameters())
        .map_err(DeviceError::Calibration)
        .and_then(|checked| {
            checked
                .frame(&request.exposure())
                .map_err(DeviceError::Frame)?;
            let grids = grids.grids(checked.calibration());
            Ok(ResidualSplines::of(&grids.map_err(DeviceError::Grids)?))
        })
        .map_err(|error| request.refused(&camera, &error))?;

    let weight = match args.weight {
        WeightName::Exposure => Weight::Exposure,
        WeightName::ArcLength => Weight::ArcLength,
    };
    let reading = match args.reading {
        ReadingName::Consistent => Reading::Consistent,
        ReadingName::Literal => Reading::Literal,
    };
    let model = request.exposure().model;
    let reference = ModelReference::new(&camera, &request.request(), model, weight, splines);
    let mut error_mm = 0.0_f64;
    points.answer(|_, block, answers| {
        block.widen();
        answers
            .numbers
            .extend(block.points_mm.iter().map(|point_mm| {
                let [x, y] = *point_mm;
                let mean = reference.total(*point_mm, reading);
                error_mm = error_mm.max(mean.error_mm);
                let [dx, dy] = mean.distortion_mm;
                Answer {
                    point_mm: [x - dx, y - dy],
                    distortion_mm: mean.distortion_mm,
                }
            }));
        Ok(())
    })?;
    if reading == Reading::Literal {
        note(format_args!(
            "note: literal reading of eqs. 12-13: the static distortion is counted twice; not for use"
        ));
    }
    note(format_args!(
        "quadrature error at most {:.1e} nm",
        1e6 * error_mm
    ));
    Ok(())
}
