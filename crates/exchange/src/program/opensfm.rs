//! `OpenSfM` and `OpenDroneMap`: `camera_models.json` and `cameras.json`.

use fmc_camera_file::InputError;
use serde_json::{Map, Value, json};

use crate::calibrated::Calibrated;
use crate::fields::Field;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_3, Model, TWO_FOCALS};
use crate::source::Source;

/// Models.
pub(crate) const MODELS: &[Model] = &[Model::new("brown", BROWN_3, TWO_FOCALS)];

/// Names of the files; both have the same text.
pub(crate) const FILES: [&str; 2] = ["camera_models.json", "cameras.json"];

/// Writes the file. All lengths are divided by the longer side; `key` is the name under which the
/// program looks for the camera of an image.
pub(crate) fn write(camera: &Calibrated, pinhole: &Pinhole, key: Option<&str>) -> String {
    let [width, height] = camera.size_px;
    let key = key.map_or_else(
        || {
            let [_, focal_y] = pinhole.focal_px;
            let focal_y = focal_y / f64::from(width.max(height));
            let focal: String = focal_y.to_string().chars().take(6).collect();
            format!("v2 unknown unknown {width} {height} brown {focal}")
        },
        str::to_owned,
    );
    let mut tree = Map::new();
    tree.insert(key, model(camera, pinhole));
    format!("{:#}\n", Value::Object(tree))
}

/// Returns the model of one camera.
pub(crate) fn model(camera: &Calibrated, pinhole: &Pinhole) -> Value {
    let [width, height] = camera.size_px;
    let size = f64::from(width.max(height));
    let [focal_x, focal_y] = pinhole.focal_px.map(|focal| focal / size);
    let [cx, cy] = pinhole.centre_px;
    let [middle_col, middle_row] = camera.middle_px();
    let [k1, k2, k3, _] = pinhole.radial;
    let [p1, p2] = pinhole.decentring;
    json!({
        "projection_type": "brown", "width": width, "height": height,
        "focal_x": focal_x, "focal_y": focal_y,
        "c_x": (cx - middle_col) / size, "c_y": (cy - middle_row) / size,
        "k1": k1, "k2": k2, "p1": p1, "p2": p2, "k3": k3,
    })
}

/// Reads the file.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let tree = source.json()?;
    let cameras = Field::root(*source, &tree).members()?;
    let (name, camera) = chosen(source, cameras, stated.id)?;
    let kind = camera.get("projection_type")?.word()?;
    let [width, height] = [
        camera.get("width")?.count()?,
        camera.get("height")?.count()?,
    ];
    let size = f64::from(width.max(height));
    let focals = match kind {
        "brown" | "simple_radial" | "radial" => {
            let x = match camera.find("focal_x") {
                Some(focal) => focal.number()?,
                None => camera.number_of("focal")?,
            };
            let y = match camera.find("focal_y") {
                Some(focal) => focal.number()?,
                None => x,
            };
            [x, y]
        }
        "perspective" => [camera.number_of("focal")?; 2],
        other => {
            return Err(unsupported(
                source,
                other,
                "brown, perspective, radial, simple_radial",
            ));
        }
    };
    let optional = |name: &str| camera.number_or_zero(name);
    let middle = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
    let [middle_col, middle_row] = middle;
    let pinhole = Pinhole {
        focal_px: focals.map(|focal| focal * size),
        centre_px: [
            middle_col + optional("c_x")? * size,
            middle_row + optional("c_y")? * size,
        ],
        radial: [optional("k1")?, optional("k2")?, optional("k3")?, 0.0],
        decentring: [optional("p1")?, optional("p2")?],
        ..Pinhole::ideal(1.0, middle)
    };
    Found::new(name, Formula::Pinhole(pinhole))
        .sized([width, height])
        .checked(source)
}
