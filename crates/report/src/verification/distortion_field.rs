//! Distortion as arrows on the sensor.

use fmc_reference::verification::result::{CameraResult, FieldPoint};

use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::figure::FigureError;
use crate::{length, wording};

/// Draws the static distortion, measured - ideal, in SVG.
///
/// # Errors
/// [`FigureError`] without exposures or if the drawing fails.
pub fn distortion(camera: &CameraResult) -> Result<String, FigureError> {
    let titles = [
        "Static distortion, measured − ideal".to_owned(),
        camera.name.clone(),
    ];
    draw(camera, &titles, |point| point.static_mm)
}

/// Draws the change of the static distortion in the exposure with the largest change, in SVG.
///
/// # Errors
/// [`FigureError`] without exposures or if the drawing fails.
pub fn dynamic(camera: &CameraResult) -> Result<String, FigureError> {
    let frame = camera
        .frames
        .get(camera.field.frame)
        .ok_or(FigureError::NothingToDraw)?;
    let titles = [
        "Dynamic change: strict exposure mean − static".to_owned(),
        format!(
            "V/H {}, {}, δ {}, {}",
            wording::vh(frame.vh_per_s),
            wording::exposure(frame.exposure_s),
            length::text(frame.travel_mm),
            wording::strategy(frame.strategy)
        ),
    ];
    draw(camera, &titles, |point| point.dynamic_mm)
}

fn draw(
    camera: &CameraResult,
    titles: &[String; 2],
    displacement: impl Fn(&FieldPoint) -> [f64; 2],
) -> Result<String, FigureError> {
    let arrows: Vec<Arrow> = camera
        .field
        .points
        .iter()
        .map(|point| Arrow {
            from_mm: point.point_mm,
            displacement_mm: displacement(point),
        })
        .collect();
    ArrowField {
        titles: titles.clone(),
        format_mm: camera.format_mm,
        axis: camera.axis,
        arrows: &arrows,
    }
    .svg()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    fn arrows_in(svg: &str) -> usize {
        svg.matches(r##"stroke="#005AA0""##).count()
    }

    #[test]
    fn every_point_has_its_arrow_and_the_legend_one() {
        let camera = fixture::camera("Alpha", 0.1);
        for svg in [distortion(&camera).unwrap(), dynamic(&camera).unwrap()] {
            assert_eq!(arrows_in(&svg), 9 + 1);
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert!(svg.contains("the principal point moves this way (+y)"));
        }
    }

    #[test]
    fn sensor_keeps_its_proportions() {
        let svg = distortion(&fixture::camera("Alpha", 0.1)).unwrap();
        let outline = svg.split('<').find(|tag| tag.contains("#6E7682")).unwrap();
        let number = |name: &str| -> f64 {
            let (_, rest) = outline.split_once(&format!(" {name}=\"")).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let ratio = number("width") / number("height");
        assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn distortion_of_zero_is_drawn_as_points() {
        let mut camera = fixture::camera("Alpha", 0.1);
        for point in &mut camera.field.points {
            point.dynamic_mm = [0.0, 0.0];
        }
        let svg = dynamic(&camera).unwrap();
        assert_eq!(arrows_in(&svg), 0);
        assert!(svg.contains("zero at every point"));
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn camera_without_exposures_has_no_figure() {
        let mut camera = fixture::camera("Alpha", 0.1);
        camera.frames.clear();
        camera.field.points.clear();
        assert!(distortion(&camera).is_err());
        assert!(dynamic(&camera).is_err());
    }
}
