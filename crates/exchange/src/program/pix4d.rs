//! `PIX4Dmapper`: `.cam` files, and the XMP that it reads from images and sidecars.

use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;

use crate::calibrated::Calibrated;
use crate::decimal::{list, number};
use crate::elements::numbers;
use crate::fields::pixel_count;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_3, Model};
use crate::source::Source;

/// Models.
pub(crate) const MODELS: &[Model] = &[Model::new("perspective", BROWN_3, &[])];

/// Names of the files.
pub(crate) const FILES: [&str; 2] = ["camera.cam", "camera.xmp"];

const NAMESPACE: &str = "http://pix4d.com/camera/1.0";

/// Radial k1..k3 and tangential t1, t2: those of the formula, in its order.
fn distortion(pinhole: &Pinhole) -> [f64; 5] {
    let [k1, k2, k3, _] = pinhole.radial;
    let [t1, t2] = pinhole.decentring;
    [k1, k2, k3, t1, t2]
}

/// Returns F and the principal point from the upper left corner, mm.
fn lengths_mm(camera: &Calibrated, pinhole: &Pinhole) -> [f64; 3] {
    let [focal, _] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px;
    [focal, cx + 0.5, cy + 0.5].map(|px| px * camera.pixel_mm)
}

/// Writes the `.cam` file.
pub(crate) fn write_cam(camera: &Calibrated, pinhole: &Pinhole) -> String {
    let [width, height] = camera.half_format_mm().map(|half| number(2.0 * half));
    let [focal, px, py] = lengths_mm(camera, pinhole).map(number);
    let [k1, k2, k3, t1, t2] = distortion(pinhole).map(number);
    format!(
        "Pix4D camera calibration file 0\n\
         #Focal Length mm assuming a sensor width of {width}x{height}mm\nF {focal}\n\
         #Principal Point mm\nPx {px}\nPy {py}\n\
         #Symmetrical Lens Distortion Coeffs\nK1 {k1}\nK2 {k2}\nK3 {k3}\n\
         #Tangential Lens Distortion Coeffs\nT1 {t1}\nT2 {t2}\n"
    )
}

/// Writes the sidecar.
pub(crate) fn write_xmp(camera: &Calibrated, pinhole: &Pinhole) -> String {
    let [focal, px, py] = lengths_mm(camera, pinhole);
    let items = distortion(pinhole)
        .map(|value| format!("     <rdf:li>{}</rdf:li>\n", number(value)))
        .concat();
    format!(
        "<?xpacket begin=\"\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n\
         <x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n \
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n  \
         <rdf:Description rdf:about=\"\" xmlns:Camera=\"{NAMESPACE}/\">\n   \
         <Camera:ModelType>perspective</Camera:ModelType>\n   \
         <Camera:PrincipalPoint>{}</Camera:PrincipalPoint>\n   \
         <Camera:PerspectiveFocalLength>{}</Camera:PerspectiveFocalLength>\n   \
         <Camera:PerspectiveDistortion>\n    <rdf:Seq>\n{items}    </rdf:Seq>\n   \
         </Camera:PerspectiveDistortion>\n  </rdf:Description>\n </rdf:RDF>\n</x:xmpmeta>\n\
         <?xpacket end=\"w\"?>\n",
        list(&[px, py]).replace(' ', ""),
        number(focal),
    )
}

/// Reads a `.cam` file or a sidecar.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let pitch = stated
        .pixel_mm
        .ok_or_else(|| source.invalid("lengths are in mm, and the pixel pitch is not stated"))?;
    if source.text()?.trim_start().starts_with('<') {
        from_xmp(source, pitch)
    } else {
        from_cam(source, stated, pitch)
    }
}

/// Returns the camera of F and principal point in mm and of the coefficients.
fn camera(pitch: f64, [focal, px, py]: [f64; 3], [k1, k2, k3, t1, t2]: [f64; 5]) -> Formula {
    Formula::Pinhole(Pinhole {
        radial: [k1, k2, k3, 0.0],
        decentring: [t1, t2],
        ..Pinhole::ideal(focal / pitch, [px / pitch - 0.5, py / pitch - 0.5])
    })
}

fn from_cam(source: &Source<'_>, stated: &Stated<'_>, pitch: f64) -> Result<Found, InputError> {
    let text = source.text()?;
    let mut cameras: Vec<(String, Vec<&str>)> = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(id) = line.strip_prefix("Pix4D camera calibration file") {
            cameras.push((id.trim().to_owned(), Vec::new()));
        } else if let Some((_, lines)) = cameras.last_mut() {
            lines.push(line);
        }
    }
    let (id, lines) = chosen(source, cameras, stated.id)?;
    let is_fisheye = |line: &&str| line.to_lowercase().contains("fisheye");
    if lines.iter().any(is_fisheye) {
        return Err(unsupported(source, "fisheye", "perspective"));
    }
    let value = |key: &str| {
        let word = lines.iter().find_map(|line| {
            let (name, value) = line.split_once(' ')?;
            (name == key).then_some(value)
        });
        let word = word.ok_or_else(|| source.invalid(format!("{key} is missing")))?;
        finite(word).map_err(|fault| source.invalid(format!("{key}: {word:?} is {fault}")))
    };
    let lengths = [value("F")?, value("Px")?, value("Py")?];
    let coefficients = [
        value("K1")?,
        value("K2")?,
        value("K3")?,
        value("T1")?,
        value("T2")?,
    ];
    let mut found = Found::new(format!("camera {id}"), camera(pitch, lengths, coefficients));
    // The size stands in a comment.
    let sides = lines
        .iter()
        .find_map(|line| line.split("sensor width of").nth(1))
        .and_then(|rest| rest.trim().trim_end_matches("mm").split_once('x'));
    if let Some((width, height)) = sides {
        let count = |word: &str| pixel_count_near(finite(word).ok()? / pitch);
        if let (Some(width), Some(height)) = (count(width), count(height)) {
            found.size_px = Some([width, height]);
        }
    }
    found.checked(source)
}

/// Returns the number of pixels of a length that was rounded when it was written.
fn pixel_count_near(pixels: f64) -> Option<u32> {
    let nearest = pixels.round();
    ((pixels - nearest).abs() < 0.1)
        .then(|| pixel_count(nearest))
        .flatten()
}

fn from_xmp(source: &Source<'_>, pitch: f64) -> Result<Found, InputError> {
    let document = source.xml()?;
    let is_ours = |namespace: Option<&str>| {
        namespace.is_some_and(|name| name.trim_end_matches('/') == NAMESPACE)
    };
    let value = |name: &str| {
        document.descendants().find_map(|node| {
            let attribute = node
                .attributes()
                .find(|one| one.name() == name && is_ours(one.namespace()))
                .map(|one| one.value().to_owned());
            let is_element = node.is_element()
                && node.tag_name().name() == name
                && is_ours(node.tag_name().namespace());
            let text = || {
                node.descendants()
                    .filter(roxmltree::Node::is_text)
                    .filter_map(|one| one.text())
                    .collect::<Vec<_>>()
                    .join(" ")
            };
            attribute.or_else(|| is_element.then(text))
        })
    };
    let required =
        |name: &str| value(name).ok_or_else(|| source.invalid(format!("Camera:{name} is missing")));
    if let Some(kind) = value("ModelType")
        && kind.trim() != "perspective"
    {
        return Err(unsupported(source, kind.trim(), "perspective"));
    }
    let listed = |name: &str| numbers(source, name, &required(name)?);
    let point = listed("PrincipalPoint")?;
    let focal = listed("PerspectiveFocalLength")?;
    let coefficients = listed("PerspectiveDistortion")?;
    let (&[px, py], &[focal], Ok(coefficients)) = (
        point.as_slice(),
        focal.as_slice(),
        <[f64; 5]>::try_from(coefficients),
    ) else {
        return Err(source.invalid(
            "PrincipalPoint, PerspectiveFocalLength, PerspectiveDistortion: 2, 1 and 5 numbers \
             are expected",
        ));
    };
    Found::new("camera", camera(pitch, [focal, px, py], coefficients)).checked(source)
}
