//! Distortion as arrows on the sensor.

use fmc_reference::verification::result::{CameraResult, FieldPoint};

use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::figure::FigureError;
use crate::{length, wording};

/// The camera whose distortion is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Sensor<'a> {
    /// Name of the camera.
    pub name: &'a str,
    /// Width and height of the sensor, mm.
    pub format_mm: [f64; 2],
    /// The FMC axis as the camera file spells it.
    pub axis: &'a str,
}

/// The exposure by which the distortion is changed.
#[derive(Debug, Clone, Copy)]
pub struct ChangedBy<'a> {
    /// η = V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// δ, mm.
    pub travel_mm: f64,
    /// `centred`, `from-rest` or `tdi`; another text is taken as it is.
    pub strategy: &'a str,
}

/// Draws the static distortion, measured - ideal, in SVG.
///
/// # Errors
/// [`FigureError`] without exposures or if the drawing fails.
pub fn distortion(camera: &CameraResult) -> Result<String, FigureError> {
    of_lens(sensor(camera), &arrows(camera, |point| point.static_mm))
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
    let exposure = ChangedBy {
        vh_per_s: frame.vh_per_s,
        exposure_s: frame.exposure_s,
        travel_mm: frame.travel_mm,
        strategy: frame.strategy,
    };
    let arrows = arrows(camera, |point| point.dynamic_mm);
    of_exposure(sensor(camera), &exposure, &arrows)
}

/// Draws the static distortion, measured - ideal, in SVG.
///
/// # Errors
/// [`FigureError`] without arrows or if the drawing fails.
pub fn of_lens(sensor: Sensor<'_>, arrows: &[Arrow]) -> Result<String, FigureError> {
    let title = "Static distortion, measured − ideal".to_owned();
    draw(sensor, [title, sensor.name.to_owned()], arrows)
}

/// Draws the change of the static distortion by an exposure, in SVG.
///
/// # Errors
/// [`FigureError`] without arrows or if the drawing fails.
pub fn of_exposure(
    sensor: Sensor<'_>,
    exposure: &ChangedBy<'_>,
    arrows: &[Arrow],
) -> Result<String, FigureError> {
    let titles = [
        "Dynamic change: strict exposure mean − static".to_owned(),
        format!(
            "V/H {}, {}, δ {}, {}",
            wording::vh(exposure.vh_per_s),
            wording::exposure(exposure.exposure_s),
            length::text(exposure.travel_mm),
            wording::strategy(exposure.strategy)
        ),
    ];
    draw(sensor, titles, arrows)
}

fn sensor(camera: &CameraResult) -> Sensor<'_> {
    Sensor {
        name: &camera.name,
        format_mm: camera.format_mm,
        axis: camera.axis,
    }
}

fn arrows(camera: &CameraResult, displacement: impl Fn(&FieldPoint) -> [f64; 2]) -> Vec<Arrow> {
    let points = camera.field.points.iter();
    points
        .map(|point| Arrow {
            from_mm: point.point_mm,
            displacement_mm: displacement(point),
        })
        .collect()
}

fn draw(sensor: Sensor<'_>, titles: [String; 2], arrows: &[Arrow]) -> Result<String, FigureError> {
    ArrowField {
        titles,
        format_mm: sensor.format_mm,
        axis: sensor.axis,
        arrows,
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
