//! Kalibr: the camera chain.

use fmc_camera_file::InputError;

use crate::calibrated::Calibrated;
use crate::decimal::list;
use crate::fields::Field;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_2, Model, TWO_FOCALS};
use crate::source::Source;

/// Models.
pub(crate) const MODELS: &[Model] = &[Model::new("radtan", BROWN_2, TWO_FOCALS)];

/// Name of the file.
pub(crate) const FILE: &str = "camchain.yaml";

/// Writes the file.
pub(crate) fn write(camera: &Calibrated, pinhole: &Pinhole) -> String {
    let [width, height] = camera.size_px;
    let [fx, fy] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px;
    let [k1, k2, ..] = pinhole.radial;
    let [p1, p2] = pinhole.decentring;
    format!(
        "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [{}]\n  distortion_model: radtan\n  \
         intrinsics: [{}]\n  resolution: [{width}, {height}]\n  rostopic: /cam0/image_raw\n",
        list(&[k1, k2, p1, p2]),
        list(&[fx, fy, cx, cy]),
    )
}

/// Reads the file.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let tree = source.yaml()?;
    let cameras = Field::root(*source, &tree).members()?;
    let cameras = cameras
        .into_iter()
        .filter(|(name, _)| name.starts_with("cam"))
        .collect();
    let (name, camera) = chosen(source, cameras, stated.id)?;
    let projection = camera.get("camera_model")?.word()?;
    if projection != "pinhole" {
        return Err(unsupported(source, projection, "pinhole"));
    }
    let [fx, fy, cx, cy] = camera.get("intrinsics")?.exactly()?;
    let mut pinhole = Pinhole {
        focal_px: [fx, fy],
        ..Pinhole::ideal(1.0, [cx, cy])
    };
    match camera.get("distortion_model")?.word()? {
        "none" => {}
        "radtan" => {
            let [k1, k2, p1, p2] = camera.get("distortion_coeffs")?.exactly()?;
            pinhole.radial = [k1, k2, 0.0, 0.0];
            pinhole.decentring = [p1, p2];
        }
        other => return Err(unsupported(source, other, "radtan, none")),
    }
    let size = match camera.get("resolution")?.elements()?.as_slice() {
        [width, height] => [width.count()?, height.count()?],
        _ => return Err(camera.invalid("resolution is not width and height")),
    };
    Found::new(name, Formula::Pinhole(pinhole))
        .sized(size)
        .checked(source)
}
