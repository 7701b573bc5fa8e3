//! `OpenCV`: `FileStorage` in YAML, JSON and XML, as its calibration writes and reads it.

use fmc_camera_file::InputError;
use serde_json::{Value, json};

use crate::calibrated::Calibrated;
use crate::decimal::{list, number};
use crate::fields::Field;
use crate::found::{Formula, Found, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_3, Model, RATIONAL, TILTED, TWO_FOCALS};
use crate::source::Source;

/// Models, by the number of their coefficients.
pub(crate) const MODELS: &[Model] = &[
    Model::new("opencv5", BROWN_3, TWO_FOCALS),
    Model::new("opencv8", RATIONAL, TWO_FOCALS),
    Model::new("opencv14", TILTED, TWO_FOCALS),
];

/// Container of `FileStorage`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Container {
    /// `camera.yaml`.
    #[default]
    Yaml,
    /// `camera.json`.
    Json,
    /// `camera.xml`.
    Xml,
}

impl Container {
    /// Returns the name of the file.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::Yaml => "camera.yaml",
            Self::Json => "camera.json",
            Self::Xml => "camera.xml",
        }
    }
}

/// Returns the matrix [fx 0 cx; 0 fy cy; 0 0 1], row by row.
pub(crate) fn matrix(pinhole: &Pinhole) -> [f64; 9] {
    let [fx, fy] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px;
    [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

/// Returns the coefficients in the order k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 τx τy, `count` of
/// them.
pub(crate) fn coefficients(pinhole: &Pinhole, count: usize) -> Vec<f64> {
    let [k1, k2, k3, _] = pinhole.radial;
    let [p1, p2] = pinhole.decentring;
    let mut all = vec![k1, k2, p1, p2, k3];
    all.extend(pinhole.divisor);
    all.extend(pinhole.prism);
    all.extend(pinhole.tilt);
    all.truncate(count);
    all
}

/// Returns the number of coefficients of a model.
fn count(model: &Model) -> usize {
    match model.name {
        "opencv5" => 5,
        "opencv8" => 8,
        _ => 14,
    }
}

/// Writes the file.
pub(crate) fn write(
    camera: &Calibrated,
    pinhole: &Pinhole,
    model: &Model,
    container: Container,
) -> String {
    let coefficients = coefficients(pinhole, count(model));
    let [width, height] = camera.size_px;
    match container {
        Container::Yaml => format!(
            "%YAML:1.0\n---\nimage_width: {width}\nimage_height: {height}\n\
             camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ {} ]\n\
             distortion_coefficients: !!opencv-matrix\n   rows: {}\n   cols: 1\n   dt: d\n   \
             data: [ {} ]\n",
            list(&matrix(pinhole)),
            coefficients.len(),
            list(&coefficients),
        ),
        Container::Json => {
            let tree = json!({
                "image_width": width,
                "image_height": height,
                "camera_matrix": {
                    "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
                    "data": matrix(pinhole),
                },
                "distortion_coefficients": {
                    "type_id": "opencv-matrix", "rows": coefficients.len(), "cols": 1, "dt": "d",
                    "data": coefficients,
                },
            });
            format!("{tree:#}\n")
        }
        Container::Xml => {
            let words = |numbers: &[f64]| {
                let words: Vec<_> = numbers.iter().map(|value| number(*value)).collect();
                words.join(" ")
            };
            format!(
                "<?xml version=\"1.0\"?>\n<opencv_storage>\n\
                 <image_width>{width}</image_width>\n<image_height>{height}</image_height>\n\
                 <camera_matrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  \
                 <dt>d</dt>\n  <data>\n    {}</data></camera_matrix>\n\
                 <distortion_coefficients type_id=\"opencv-matrix\">\n  <rows>{}</rows>\n  \
                 <cols>1</cols>\n  <dt>d</dt>\n  <data>\n    {}</data></distortion_coefficients>\n\
                 </opencv_storage>\n",
                words(&matrix(pinhole)),
                coefficients.len(),
                words(&coefficients),
            )
        }
    }
}

/// Reads the file, in any of the three containers.
pub(crate) fn read(source: &Source<'_>) -> Result<Found, InputError> {
    let text = source.text()?;
    let tree = match text.trim_start().chars().next() {
        Some('<') => from_xml(source)?,
        Some('{') => source.json()?,
        _ => source.yaml()?,
    };
    let root = Field::root(*source, &tree);
    // The parameter of the sphere of the omnidirectional model.
    if root.find("xi").is_some() {
        return Err(unsupported(
            source,
            "omnidirectional (xi)",
            "the pinhole models of 4 to 14",
        ));
    }
    for sign in ["fisheye_model", "fisheye"] {
        let is_set = root
            .find(sign)
            .is_some_and(|field| field.value().as_i64() != Some(0));
        if is_set {
            return Err(unsupported(
                source,
                "fisheye",
                "the pinhole models of 4 to 14",
            ));
        }
    }
    let size_px = match (root.find("image_width"), root.find("image_height")) {
        (Some(width), Some(height)) => Some([width.count()?, height.count()?]),
        _ => None,
    };
    let matrix = first(&root, &["camera_matrix", "cameraMatrix", "Camera_Matrix"])?;
    let coefficients = first(
        &root,
        &[
            "distortion_coefficients",
            "Distortion_Coefficients",
            "distCoeffs",
            "dist_coeffs",
        ],
    )?;
    let data = coefficients.get("data")?;
    let mut pinhole = from_matrix(&matrix)?;
    put_coefficients(&mut pinhole, &data)?;
    let found = Found::new("camera", Formula::Pinhole(pinhole));
    Found { size_px, ..found }.checked(source)
}

/// Returns the first of the fields that the file has.
fn first<'a>(root: &Field<'a>, names: &[&str]) -> Result<Field<'a>, InputError> {
    names
        .iter()
        .find_map(|name| root.find(name))
        .ok_or_else(|| root.invalid(format!("{} is missing", names.join(" or "))))
}

/// Reads the matrix of a field with `data`.
pub(crate) fn from_matrix(field: &Field<'_>) -> Result<Pinhole, InputError> {
    let data = field.get("data")?;
    let [fx, skew, cx, below, fy, cy, left, middle, one] = data.exactly()?;
    if [below, left, middle, one - 1.0]
        .iter()
        .any(|x| x.abs() > 0.0)
    {
        return Err(data.invalid("not of the form fx s cx 0 fy cy 0 0 1"));
    }
    Ok(Pinhole {
        focal_px: [fx, fy],
        skew_px: skew,
        ..Pinhole::ideal(1.0, [cx, cy])
    })
}

/// Puts 0, 4, 5, 8, 12 or 14 coefficients into a camera.
pub(crate) fn put_coefficients(pinhole: &mut Pinhole, data: &Field<'_>) -> Result<(), InputError> {
    let mut numbers = data.numbers()?;
    let count = numbers.len();
    if ![0, 4, 5, 8, 12, 14].contains(&count) {
        let fault = format!("{count} coefficients where 4, 5, 8, 12 or 14 are expected");
        return Err(data.invalid(fault));
    }
    numbers.resize(14, 0.0);
    if let [k1, k2, p1, p2, k3, d1, d2, d3, s1, s2, s3, s4, tau_x, tau_y] = *numbers {
        pinhole.radial = [k1, k2, k3, 0.0];
        pinhole.divisor = [d1, d2, d3];
        pinhole.decentring = [p1, p2];
        pinhole.prism = [s1, s2, s3, s4];
        pinhole.tilt = [tau_x, tau_y];
    }
    Ok(())
}

/// Returns the tree of an XML file: a matrix has its rows and columns as numbers, its data as a
/// list.
fn from_xml(source: &Source<'_>) -> Result<Value, InputError> {
    let document = source.xml()?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        return Err(source.invalid("no opencv_storage"));
    }
    let mut tree = serde_json::Map::new();
    for element in root.children().filter(roxmltree::Node::is_element) {
        let text =
            |node: roxmltree::Node<'_, '_>| node.text().unwrap_or_default().trim().to_owned();
        let data = element.children().find(|child| child.has_tag_name("data"));
        let parsed = |word: &str| {
            word.parse::<f64>()
                .map_or_else(|_| Value::from(word), Value::from)
        };
        let value = if let Some(data) = data {
            let numbers: Vec<_> = text(data).split_whitespace().map(parsed).collect();
            json!({ "data": numbers })
        } else {
            parsed(&text(element))
        };
        tree.insert(element.tag_name().name().to_owned(), value);
    }
    Ok(Value::Object(tree))
}
