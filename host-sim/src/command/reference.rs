//! `reference`: points through the strict solver.

use fmc_camera::Camera;
use fmc_reference::fitted::FittedModel;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{Reading, StrictMean, StrictSolver, Weight};

use super::point_stream::PointStream;
use crate::cli::{ModelName, ReadingName, ReferenceArgs, WeightName};
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
    let solver =
        StrictSolver::new(&camera, &request.request(), weight).with_splines(splines.clone());
    let fitted = FittedModel::new(&camera, solver.path());
    let total = |point_mm: [f64; 2]| match (request.model, &fitted) {
        (ModelName::Fitted, Some(fitted)) => {
            // The fitted enlargement is part of the model; the grid of the lens moves alone.
            let ([x, y], [ex, ey]) = (point_mm, camera.fmc.axis.unit());
            let centroid_mm = solver.path().centroid_mm();
            let of_lens = splines.of_lens([x - centroid_mm * ex, y - centroid_mm * ey]);
            let residual = sum(of_lens, splines.of_sensor(point_mm));
            exactly(sum(fitted.distortion(point_mm), residual))
        }
        (ModelName::Static, _) => {
            let [x, y] = point_mm;
            let [x0, y0] = camera.principal_point_mm;
            let polynomial = Lens::of(&camera).displacement([x - x0, y - y0]);
            exactly(sum(polynomial, splines.calibrated(point_mm)))
        }
        _ => solver.total(point_mm, reading),
    };
    let mut error_mm = 0.0_f64;
    points.answer(|_, block, answers| {
        block.widen();
        answers
            .numbers
            .extend(block.points_mm.iter().map(|point_mm| {
                let [x, y] = *point_mm;
                let mean = total(*point_mm);
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

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

const fn exactly(distortion_mm: [f64; 2]) -> StrictMean {
    StrictMean {
        distortion_mm,
        error_mm: 0.0,
    }
}
