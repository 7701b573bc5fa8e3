//! OPF, the Open Photogrammetry Format: `calibrated_cameras.json`.

use fmc_camera_file::InputError;
use serde_json::{Value, json};

use crate::fields::Field;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_3, Model};
use crate::source::Source;

/// Models.
pub(crate) const MODELS: &[Model] = &[Model::new("perspective", BROWN_3, &[])];

/// Name of the file.
pub(crate) const FILE: &str = "calibrated_cameras.json";

/// Format that the file names.
pub(crate) const FORMAT: &str = "application/opf-calibrated-cameras+json";

/// Writes the file, with one sensor and no image. Its first pixel centre is at (½, ½).
pub(crate) fn write(pinhole: &Pinhole) -> String {
    let tree = json!({
        "format": FORMAT,
        "version": "1.0",
        "sensors": [sensor(pinhole, 1)],
        "cameras": [],
    });
    format!("{tree:#}\n")
}

/// Returns one sensor.
pub(crate) fn sensor(pinhole: &Pinhole, id: u32) -> Value {
    let [focal, _] = pinhole.focal_px;
    let [k1, k2, k3, _] = pinhole.radial;
    json!({
        "id": id,
        "internals": {
            "type": "perspective",
            "principal_point_px": pinhole.centre_px.map(|centre| centre + 0.5),
            "focal_length_px": focal,
            "radial_distortion": [k1, k2, k3],
            "tangential_distortion": pinhole.decentring,
        },
    })
}

/// Reads the file.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let tree = source.json()?;
    let root = Field::root(*source, &tree);
    let format = root.get("format")?.word()?;
    if format != FORMAT {
        return Err(root.invalid(format!("format is {format:?}, not {FORMAT:?}")));
    }
    let mut sensors = Vec::new();
    for sensor in root.get("sensors")?.elements()? {
        let id = sensor.get("id")?.value();
        let name = id.as_str().map_or_else(|| id.to_string(), str::to_owned);
        sensors.push((name, sensor));
    }
    let (name, sensor) = chosen(source, sensors, stated.id)?;
    let internals = sensor.get("internals")?;
    let kind = internals.get("type")?.word()?;
    if kind != "perspective" {
        return Err(unsupported(source, kind, "perspective"));
    }
    let [cx, cy] = internals.get("principal_point_px")?.exactly()?;
    let [k1, k2, k3] = internals.get("radial_distortion")?.exactly()?;
    let focal = internals.number_of("focal_length_px")?;
    let pinhole = Pinhole {
        radial: [k1, k2, k3, 0.0],
        decentring: internals.get("tangential_distortion")?.exactly()?,
        ..Pinhole::ideal(focal, [cx - 0.5, cy - 0.5])
    };
    Found::new(format!("sensor {name}"), Formula::Pinhole(pinhole)).checked(source)
}
