//! Metashape: the lens file `camera.xml`, and the sensors of `cameras.xml`.

use fmc_camera_file::InputError;
use roxmltree::Node;

use crate::calibrated::Calibrated;
use crate::decimal::number;
use crate::elements::{child, children, number_or, number_text, numbers, pixels};
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_4, FOCALS_AND_SKEW, Model};
use crate::source::Source;
use crate::uncertainty::Uncertainty;

/// Models.
pub(crate) const MODELS: &[Model] = &[Model::new("frame", BROWN_4, FOCALS_AND_SKEW)];

/// Name of the file.
pub(crate) const FILE: &str = "camera.xml";

/// Writes the lens file: f = fy, b1 = fx - fy, b2 = skew, cx and cy from the middle of the image;
/// p1 goes with x².
pub(crate) fn write(camera: &Calibrated, pinhole: &Pinhole) -> String {
    let [width, height] = camera.size_px;
    let elements = elements(camera, pinhole)
        .map(|(name, value)| format!("  <{name}>{}</{name}>\n", number(value)))
        .concat();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration>\n  \
         <projection>frame</projection>\n  <width>{width}</width>\n  <height>{height}</height>\n\
         {elements}</calibration>\n"
    )
}

/// Returns the parameters by name.
pub(crate) fn elements(camera: &Calibrated, pinhole: &Pinhole) -> [(&'static str, f64); 11] {
    let [fx, fy] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px;
    let [middle_col, middle_row] = camera.middle_px();
    let [p1, p2] = pinhole.decentring;
    let [k1, k2, k3, k4] = pinhole.radial;
    [
        ("f", fy),
        ("cx", cx - middle_col),
        ("cy", cy - middle_row),
        ("b1", fx - fy),
        ("b2", pinhole.skew_px),
        ("k1", k1),
        ("k2", k2),
        ("k3", k3),
        ("k4", k4),
        ("p1", p2),
        ("p2", p1),
    ]
}

/// Reads a lens file, or one sensor of an exported chunk.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let document = source.xml()?;
    let root = document.root_element();
    if root.has_tag_name("calibration") {
        return calibration(source, root, "camera");
    }
    let sensors = root
        .descendants()
        .filter(|node| node.has_tag_name("sensor"))
        .filter_map(|sensor| {
            let label = sensor.attribute("label").unwrap_or_default();
            let id = sensor.attribute("id").unwrap_or(label);
            let is_asked_by_label = stated.id.is_some_and(|asked| asked == label);
            let name = if is_asked_by_label { label } else { id };
            Some((name.to_owned(), (sensor, adjusted(sensor)?)))
        })
        .collect();
    let (_, (sensor, node)) = chosen(source, sensors, stated.id)?;
    let kind = sensor.attribute("type").unwrap_or("frame");
    if kind != "frame" {
        return Err(unsupported(source, kind, "frame"));
    }
    let label = sensor.attribute("label").unwrap_or("camera");
    let mut found = calibration(source, node, label)?;
    found.uncertainty = uncertainty(source, sensor)?;
    let property = |name: &str| {
        children(sensor, "property")
            .find(|one| one.attribute("name") == Some(name))
            .and_then(|one| one.attribute("value")?.parse::<f64>().ok())
    };
    // The file gives an array as 1 x 1 mm where it does not know better.
    if let (Some(width_mm), Some(height_mm)) = (property("pixel_width"), property("pixel_height"))
        && (width_mm - height_mm).abs() <= 1e-9 * width_mm.abs()
    {
        found.pixel_mm = Some(width_mm).filter(|pitch| *pitch > 0.0);
    }
    Ok(found)
}

/// Returns the uncertainty that stands beside the adjusted calibration: a covariance matrix, in the
/// units of the parameters.
fn uncertainty(
    source: &Source<'_>,
    sensor: Node<'_, '_>,
) -> Result<Option<Uncertainty>, InputError> {
    let covariance = sensor
        .descendants()
        .find(|node| node.has_tag_name("covariance"));
    let Some(covariance) = covariance else {
        return Ok(None);
    };
    let text = |name: &str| child(covariance, name).and_then(|one| one.text());
    let (Some(parameters), Some(coefficients)) = (text("params"), text("coeffs")) else {
        return Err(source.invalid("covariance: params or coeffs is missing"));
    };
    let parameters = parameters.split_whitespace().map(str::to_owned).collect();
    let cells = numbers(source, "covariance", coefficients)?;
    Uncertainty::of_covariance(parameters, &cells)
        .map(Some)
        .ok_or_else(|| source.invalid("covariance: not a matrix of its parameters"))
}

/// Returns the adjusted calibration of a sensor, or else the first one.
fn adjusted<'a>(sensor: Node<'a, 'a>) -> Option<Node<'a, 'a>> {
    let mut all = children(sensor, "calibration");
    let first = all.next()?;
    let is_adjusted = |node: &Node<'_, '_>| node.attribute("class") == Some("adjusted");
    if is_adjusted(&first) {
        return Some(first);
    }
    all.find(is_adjusted).or(Some(first))
}

fn calibration(source: &Source<'_>, node: Node<'_, '_>, name: &str) -> Result<Found, InputError> {
    let projection = child(node, "projection")
        .and_then(|one| one.text())
        .or_else(|| node.attribute("type"))
        .unwrap_or("frame")
        .trim();
    if projection != "frame" {
        return Err(unsupported(source, projection, "frame"));
    }
    let size = match child(node, "resolution") {
        Some(resolution) => ["width", "height"].map(|side| {
            resolution
                .attribute(side)
                .and_then(|word| word.parse::<u32>().ok())
        }),
        None => [
            Some(pixels(source, node, "width")?),
            Some(pixels(source, node, "height")?),
        ],
    };
    let [Some(width), Some(height)] = size else {
        return Err(source.invalid("resolution: width or height is missing"));
    };
    let middle = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
    if child(node, "fx").is_some() || child(node, "skew").is_some() {
        return Err(source
            .invalid("the older file of PhotoScan (fx, fy, skew), with p1 and p2 exchanged")
            .with_help(
                "export the calibration from Metashape, or write the numbers as OpenCV's: the \
                 order of p is its own",
            ));
    }
    let optional = |name: &str| number_or(source, node, name, 0.0);
    let f = number_text(source, node, "f")?;
    let [middle_col, middle_row] = middle;
    let pinhole = Pinhole {
        focal_px: [f + optional("b1")?, f],
        skew_px: optional("b2")?,
        centre_px: [middle_col + optional("cx")?, middle_row + optional("cy")?],
        radial: [
            optional("k1")?,
            optional("k2")?,
            optional("k3")?,
            optional("k4")?,
        ],
        decentring: [optional("p2")?, optional("p1")?],
        ..Pinhole::ideal(f, middle)
    };
    for unread in node.children().filter(is_another_coefficient) {
        let name = unread.tag_name().name();
        if optional(name)?.abs() > 0.0 {
            return Err(unsupported(source, name, "k1 to k4, p1, p2, b1, b2"));
        }
    }
    Found::new(name, Formula::Pinhole(pinhole))
        .sized([width, height])
        .checked(source)
}

/// Returns true for a coefficient, a letter and a digit, that is not one of those read.
fn is_another_coefficient(node: &Node<'_, '_>) -> bool {
    let name = node.tag_name().name();
    let is_coefficient = matches!(
        name.as_bytes(),
        [b'k' | b'p' | b'b' | b's', digit] if digit.is_ascii_digit()
    );
    is_coefficient && !["k1", "k2", "k3", "k4", "p1", "p2", "b1", "b2"].contains(&name)
}
