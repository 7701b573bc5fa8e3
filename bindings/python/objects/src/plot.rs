//! Figures of a camera.

use fmc_camera_file::MechanismName;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::verification::grid;
use fmc_report::arrow::Arrow;
use fmc_report::verification::distortion_field::{self, ChangedBy, Sensor};
use pyo3::prelude::*;

use crate::camera::CameraParts;
use crate::figure::Figure;
use crate::frame::Frame;
use crate::reference::ReferencePoints;

/// Draws the static distortion of a camera, or what an exposure changes of it.
///
/// # Errors
/// `fmc_camera.Error` for a drawing that fails.
pub(crate) fn plot(camera: &CameraParts, frame: Option<&Frame>) -> PyResult<Figure> {
    let file = &camera.file;
    let [x0, y0] = file.principal_point_mm;
    let lens = Lens::of(file);
    let splines = ResidualSplines::of(camera.grids());
    let static_mm = |point_mm: [f64; 2]| {
        let [x, y] = point_mm;
        let polynomial = lens.displacement([x - x0, y - y0]);
        sum(polynomial, splines.calibrated(point_mm))
    };
    let reference = frame.map(ReferencePoints::new);
    let displacement_mm = |point_mm| match &reference {
        None => static_mm(point_mm),
        Some(reference) => {
            let [dx, dy] = static_mm(point_mm);
            sum(reference.distortion_mm(point_mm), [-dx, -dy])
        }
    };
    let half_format_mm = file.half_format_mm();
    let points = grid::points(half_format_mm);
    let arrows = points.points().map(|point| {
        let from_mm = [point.x_mm, point.y_mm].map(f64::from);
        Arrow {
            from_mm,
            displacement_mm: displacement_mm(from_mm),
        }
    });
    let arrows: Vec<Arrow> = arrows.collect();
    let sensor = Sensor {
        name: &file.name,
        format_mm: half_format_mm.map(|half| 2.0 * half),
        axis: file.fmc.axis.name(),
    };
    Figure::of(match frame {
        None => distortion_field::of_lens(sensor, &arrows),
        Some(frame) => {
            let strategy = match (frame.arguments.opening_offset_mm, file.fmc.mechanism) {
                (Some(offset_mm), _) => format!("opening offset {:.1} µm", 1000.0 * offset_mm),
                (None, MechanismName::Tdi) => "tdi".to_owned(),
                (None, MechanismName::Stage) => {
                    file.fmc.strategy.unwrap_or_default().name().to_owned()
                }
            };
            let exposure = ChangedBy {
                vh_per_s: frame.arguments.vh_per_s,
                exposure_s: frame.arguments.exposure_s,
                travel_mm: f64::from(frame.travel_mm()),
                strategy: &strategy,
            };
            distortion_field::of_exposure(sensor, &exposure, &arrows)
        }
    })
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}
