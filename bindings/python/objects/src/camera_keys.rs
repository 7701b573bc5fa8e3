//! The keys of a camera file with their values, as a dictionary and as a table.

use std::fmt::Write as _;

use fmc_camera_file::{CameraFile, MechanismName, Profile};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A value of a key.
#[derive(Debug, Clone, PartialEq)]
enum Value {
    Text(String),
    Number(f64),
    Whole(i64),
    Numbers(Vec<f64>),
}

/// A key with its table, which is empty for the keys before the first table.
type Row = (&'static str, &'static str, Value);

/// Returns the keys of a camera file in its order, defaults included.
fn rows(file: &CameraFile) -> Vec<Row> {
    let (fmc, shutter, limits) = (&file.fmc, &file.shutter, &file.limits);
    let distortion = file.distortion.measured_minus_ideal();
    let number = Value::Number;
    let mechanism = match fmc.mechanism {
        MechanismName::Stage => "stage",
        MechanismName::Tdi => "tdi",
    };
    let profile = match shutter.profile {
        Profile::Uniform => "uniform",
        Profile::Trapezoid => "trapezoid",
    };
    let text = |text: &str| Value::Text(text.to_owned());
    let mut rows = vec![
        ("", "name", text(&file.name)),
        ("", "serial", text(&file.serial)),
        ("", "version", Value::Whole(file.version)),
        (
            "",
            "principal_distance_mm",
            number(file.principal_distance_mm),
        ),
        ("", "exit_pupil_mm", number(file.exit_pupil_mm())),
        (
            "",
            "principal_point_mm",
            Value::Numbers(file.principal_point_mm.to_vec()),
        ),
        ("sensor", "width_px", Value::Whole(file.sensor.width_px)),
        ("sensor", "height_px", Value::Whole(file.sensor.height_px)),
        ("sensor", "pixel_um", number(file.sensor.pixel_um)),
        ("distortion", "sign", text("distortion")),
        ("distortion", "k0", number(distortion.k0)),
        ("distortion", "k1", number(distortion.k1)),
        ("distortion", "k2", number(distortion.k2)),
        ("distortion", "k3", number(distortion.k3)),
        ("distortion", "p1", number(distortion.p1)),
        ("distortion", "p2", number(distortion.p2)),
        ("distortion", "b1", number(distortion.b1)),
        ("distortion", "b2", number(distortion.b2)),
        ("fmc", "axis", text(fmc.axis.name())),
        ("fmc", "mechanism", text(mechanism)),
        ("fmc", "first_transfer", number(fmc.first_transfer)),
    ];
    if fmc.mechanism == MechanismName::Stage {
        let strategy = fmc.strategy.unwrap_or_default();
        rows.push(("fmc", "strategy", text(strategy.name())));
    }
    rows.extend([
        ("fmc", "acceleration_mm_s2", number(fmc.acceleration_mm_s2)),
        ("fmc", "settling_ms", number(fmc.settling_ms)),
        ("fmc", "stroke_mm", number(fmc.stroke_mm)),
        (
            "fmc",
            "flatness_um",
            Value::Numbers(fmc.flatness_um.clone()),
        ),
        ("fmc", "jerk_mm_s3", number(fmc.jerk_mm_s3)),
        ("fmc", "max_speed_mm_s", number(fmc.max_speed_mm_s)),
        ("shutter", "profile", text(profile)),
        (
            "shutter",
            "opening_fraction",
            number(shutter.opening_fraction),
        ),
        (
            "shutter",
            "closing_fraction",
            number(shutter.closing_fraction),
        ),
        (
            "limits",
            "vh_per_s",
            Value::Numbers(limits.vh_per_s.to_vec()),
        ),
        (
            "limits",
            "exposure_s",
            Value::Numbers(limits.exposure_s.to_vec()),
        ),
    ]);
    rows.extend(optional_rows(file));
    rows
}

/// Returns the keys of the tables that a camera file need not have.
fn optional_rows(file: &CameraFile) -> Vec<Row> {
    let (mut rows, number) = (Vec::new(), Value::Number);
    let text = |text: &str| Value::Text(text.to_owned());
    if let Some(fitted) = &file.fitted {
        rows.extend([
            ("fitted", "km0", number(fitted.km0)),
            ("fitted", "km1", number(fitted.km1)),
            ("fitted", "km2", number(fitted.km2)),
            ("fitted", "kd1", number(fitted.kd1)),
            ("fitted", "pm1", number(fitted.pm1)),
            ("fitted", "per", text(fitted.per.name())),
        ]);
    }
    if let Some(focus) = &file.focus {
        for (key, values) in [
            ("temperature_c", &focus.temperature_c),
            ("focus_shift_um", &focus.focus_shift_um),
        ] {
            rows.push(("focus", key, Value::Numbers(values.clone())));
        }
    }
    if let Some(grid) = &file.grid {
        for (key, value) in [
            ("lens", &grid.lens),
            ("lens_crc32", &grid.lens_crc32),
            ("sensor", &grid.sensor),
            ("sensor_crc32", &grid.sensor_crc32),
        ] {
            rows.extend(value.as_deref().map(|value| ("grid", key, text(value))));
        }
    }
    rows
}

/// Returns the keys as a dictionary with one for every table, as `tomllib` reads the file.
pub(crate) fn dictionary<'py>(py: Python<'py>, file: &CameraFile) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let mut inner = ("", all.clone());
    for (table, key, value) in rows(file) {
        if inner.0 != table {
            let new = PyDict::new(py);
            all.set_item(table, &new)?;
            inner = (table, new);
        }
        match value {
            Value::Text(text) => inner.1.set_item(key, text)?,
            Value::Number(number) => inner.1.set_item(key, number)?,
            Value::Whole(number) => inner.1.set_item(key, number)?,
            Value::Numbers(numbers) => inner.1.set_item(key, numbers)?,
        }
    }
    Ok(all)
}

/// Returns the keys as a table of HTML.
pub(crate) fn html(file: &CameraFile) -> String {
    let mut html = String::from("<table>\n");
    for (table, key, value) in rows(file) {
        let value = match value {
            Value::Text(text) => text,
            Value::Number(number) => number.to_string(),
            Value::Whole(number) => number.to_string(),
            Value::Numbers(numbers) => {
                let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
                numbers.join(", ")
            }
        };
        let value = escaped(&value);
        // Writing to a string does not fail.
        let _ = writeln!(
            html,
            "<tr><td>{table}</td><td>{key}</td><td>{value}</td></tr>"
        );
    }
    html + "</table>"
}

/// Returns a text as HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
