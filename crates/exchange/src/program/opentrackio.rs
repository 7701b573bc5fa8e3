//! `OpenTrackIO` with the lens model of `OpenLensIO`: Brown-Conrady D-U, measured -> ideal.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;
use serde_json::{Value, json};

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::fields::Field;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::source::Source;

/// Name of the file.
pub(crate) const FILE: &str = "lens.json";

/// Model of the distortion, and the one that is meant where none is named.
const MODEL: &str = "Brown-Conrady D-U";

/// Writes one sample: mm, y down. Numerator and denominator of the radial part alternate.
pub(crate) fn write(camera: &Calibrated) -> String {
    let correction = Correction::of(&camera.without_k0());
    format!("{:#}\n", sample(camera, &correction))
}

/// Returns a sample of a camera without K0.
pub(crate) fn sample(camera: &Calibrated, correction: &Correction) -> Value {
    let [_, k1, k2, k3] = correction.lens.k;
    let [p1, p2] = correction.lens.p;
    let [x0, y0] = correction.principal_point_mm;
    let [width_mm, height_mm] = camera.half_format_mm().map(|half| 2.0 * half);
    let [width, height] = camera.size_px;
    json!({
        "protocol": { "name": "OpenTrackIO", "version": [1, 0, 1] },
        "static": {
            "camera": {
                "label": camera.name,
                "activeSensorPhysicalDimensions": { "width": width_mm, "height": height_mm },
                "activeSensorResolution": { "width": width, "height": height },
            },
            "lens": { "nominalFocalLength": camera.principal_distance_without_k0_mm() },
        },
        "lens": {
            "pinholeFocalLength": correction.principal_distance_mm,
            "projectionOffset": { "x": x0, "y": -y0 },
            "distortionOffset": { "x": 0.0, "y": 0.0 },
            "distortion": [{
                "model": MODEL,
                "radial": [-k1, 0.0, -k2, 0.0, -k3, 0.0],
                "tangential": [p2, -p1],
            }],
        },
    })
}

/// Reads one sample.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let tree = source.json()?;
    let root = Field::root(*source, &tree);
    let lens = root.get("lens")?;
    let mut models = Vec::new();
    for one in lens.get("distortion")?.elements()? {
        let name = match one.find("model") {
            Some(model) => model.word()?,
            None => MODEL,
        };
        models.push((name.to_owned(), one));
    }
    // A sample may have the model of either direction; the one that is exact is taken.
    let is_known = models.iter().any(|(name, _)| name == MODEL);
    if !is_known && let Some((name, _)) = models.first() {
        return Err(unsupported(source, name, MODEL));
    }
    models.retain(|(name, _)| name == MODEL);
    let (_, distortion) = chosen(source, models, stated.id.map(|_| MODEL))?;
    let pair = |name: &str| -> Result<[f64; 2], InputError> {
        match lens.find(name) {
            Some(offset) => Ok([offset.number_of("x")?, offset.number_of("y")?]),
            None => Ok([0.0; 2]),
        }
    };
    let radial_field = distortion.get("radial")?;
    let mut radial = radial_field.numbers()?;
    if radial.len() > 6 {
        return Err(radial_field.invalid("more than 6 numbers"));
    }
    radial.resize(6, 0.0);
    let [l1, l2, l3, l4, l5, l6] = <[f64; 6]>::try_from(radial).unwrap_or_default();
    let [q1, q2] = match distortion.find("tangential") {
        Some(tangential) => tangential.exactly()?,
        None => [0.0; 2],
    };
    let [x, y] = pair("projectionOffset")?;
    let [offset_x, offset_y] = pair("distortionOffset")?;
    let correction = Correction {
        principal_distance_mm: lens.number_of("pinholeFocalLength")?,
        principal_point_mm: [x, -y],
        lens: Lens {
            k: [0.0, -l1, -l3, -l5],
            p: [-q2, q1],
            b: [0.0; 2],
        },
        k4: 0.0,
        divisor: [l2, l4, l6],
        offset_mm: [offset_x, -offset_y],
    };
    let mut found = Found::new("camera", Formula::Correction(correction));
    if let Some(camera) = root.find("static").and_then(|one| one.find("camera")) {
        if let Some(label) = camera.find("label") {
            label.word()?.clone_into(&mut found.name);
        }
        if let Some(size) = camera.find("activeSensorResolution") {
            found.size_px = Some([size.get("width")?.count()?, size.get("height")?.count()?]);
        }
        if let (Some(size), Some([width, _])) =
            (camera.find("activeSensorPhysicalDimensions"), found.size_px)
        {
            found.pixel_mm = Some(size.number_of("width")? / f64::from(width));
        }
    }
    found.checked(source)
}
