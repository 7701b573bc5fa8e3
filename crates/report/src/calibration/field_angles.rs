//! Reports of precise angles for an area camera and its stage.

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::field_angles::{CalibratedStage, FieldAngles, Mount};
use serde_json::{Map, json};

use super::result::of_method::{OfMethod, PageTable};

/// Seconds of arc in a degree.
const ARCSEC: f64 = 3600.0;

/// Returns the content of the reports that belongs to this method alone.
#[must_use]
pub fn of_method(found: &FieldAngles) -> OfMethod {
    let Mount {
        attitude_deg,
        sigma_deg,
    } = found.mount;
    let mut summary = Map::new();
    let names = ["pitch", "roll", "yaw"];
    let mut mount = Map::new();
    for ((name, value), sigma) in names.into_iter().zip(attitude_deg).zip(sigma_deg) {
        mount.insert(format!("{name}_deg"), json!(value));
        mount.insert(format!("sigma_{name}_deg"), json!(sigma));
    }
    summary.insert("mount".to_owned(), mount.into());
    if let Some(CalibratedStage { offsets, range_mm }) = found.stage {
        summary.insert(
            "stage".to_owned(),
            json!({"offsets": offsets, "range_mm": range_mm}),
        );
    }
    let mut tables = vec![mount_table(found)];
    tables.extend(found.stage.map(|stage| stage_table(&found.result, stage)));
    OfMethod {
        summary,
        tables,
        ..OfMethod::default()
    }
}

fn mount_table(found: &FieldAngles) -> PageTable {
    let Mount {
        attitude_deg,
        sigma_deg,
    } = found.mount;
    let names = ["pitch", "roll", "yaw"];
    let rows = names.into_iter().zip(attitude_deg).zip(sigma_deg);
    PageTable {
        title: "Camera on the turntable".to_owned(),
        columns: ["", "value, °", "σ, \u{2033}"].map(str::to_owned).to_vec(),
        rows: rows
            .map(|((name, value), sigma)| {
                vec![
                    name.to_owned(),
                    format!("{value:.6}"),
                    format!("{:.2}", ARCSEC * sigma),
                ]
            })
            .collect(),
        caption: "turntable_from_camera = Rz(yaw)·Rx(pitch)·Ry(roll). Roll with x0 and pitch with y0 are correlated by nearly 1.".to_owned(),
    }
}

/// Name of a parameter, its title, its factor and its decimals.
const STAGE: [(&str, &str, f64, usize); 4] = [
    ("stage_scale", "scale s, ppm", 1e6, 1),
    ("stage_axis_angle_rad", "angle of the axis, µrad", 1e6, 1),
    ("run_out_mm_per_mm", "run-out z1, µm/mm", 1e3, 4),
    ("run_out_mm_per_mm2", "run-out z2, µm/mm²", 1e3, 4),
];

fn stage_table(result: &CalibrationResult, stage: CalibratedStage) -> PageTable {
    let [least, most] = stage.range_mm;
    let rows = STAGE
        .into_iter()
        .filter_map(|(name, title, factor, decimals)| {
            let value = factor * result.parameter(name)?.value;
            let sigma = result.sigma(name);
            Some(vec![
                title.to_owned(),
                format!("{value:.decimals$}"),
                sigma.map_or_else(
                    || "held".to_owned(),
                    |sigma| format!("{:.decimals$}", factor * sigma),
                ),
            ])
        });
    PageTable {
        title: "Stage".to_owned(),
        columns: ["", "value", "σ"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        caption: format!(
            "{} offsets from {least} to {most} mm. PP = (x0, y0) + (1+s)·c·e(α), e of the camera file turned by α towards +y from +x; Δz = z1·c + z2·c² beside the other terms of flatness_um, away from the lens. The camera file holds z1 and z2; s and α are to be removed at the stage.",
            stage.offsets
        ),
    }
}
