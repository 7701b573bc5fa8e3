//! Readers of the tables of a network: image points, object points, images, scale bars.

use std::path::Path;

use fmc_adjustment::bundle::tables::{
    ImagePointRow, ImageRow, ObjectPointRow, RowRole, ScaleBarRow, Table,
};
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera_file::CameraFile;

use super::named_columns::{NamedColumns, Row};
use crate::failure::Failure;

/// Coordinates that no ground frame has, m.
const MOST_METRES: f64 = 1e8;

/// A table, and the file it was read from.
pub type Read<TableRow> = (Table<TableRow>, InputFile);

fn table<TableRow>(
    columns: NamedColumns,
    row: impl Fn(Row<'_>) -> Result<TableRow, Failure>,
) -> Result<Read<TableRow>, Failure> {
    let rows: Vec<TableRow> = columns.rows().map(row).collect::<Result<_, _>>()?;
    let file = columns.input.file.clone();
    if rows.is_empty() {
        return Err(Failure::bad_input(format!("{file}: the file has no rows")));
    }
    Ok((Table { file, rows }, columns.input))
}

/// Reads `image,point,x_mm,y_mm[,sigma_um]` or `image,point,col_px,row_px[,sigma_px]`.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn image_points(path: &Path, camera: &CameraFile) -> Result<Read<ImagePointRow>, Failure> {
    let columns = NamedColumns::read(path, &["image", "point"])?;
    let has_sigma = columns.check_image_columns()?;
    table(columns, |row| {
        let measured = row.image_point(camera)?;
        Ok(ImagePointRow {
            line: row.line,
            image: row.name("image")?,
            point: row.name("point")?,
            measured_mm: measured.point_mm,
            by_grids_mm: [0.0; 2],
            sigma_mm: has_sigma.then_some(measured.sigma_mm),
        })
    })
}

/// Reads `point,x_m,y_m,z_m[,sigma_x_m,sigma_y_m,sigma_z_m][,role]`; without σ control is held.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn object_points(path: &Path) -> Result<Read<ObjectPointRow>, Failure> {
    let columns = NamedColumns::read(path, &["point", "x_m", "y_m", "z_m"])?;
    table(columns, |row| {
        let mut sigmas_m = [0.0; 3];
        for (sigma, column) in sigmas_m
            .iter_mut()
            .zip(["sigma_x_m", "sigma_y_m", "sigma_z_m"])
        {
            *sigma = row.optional_number(column)?.unwrap_or(0.0);
        }
        Ok(ObjectPointRow {
            line: row.line,
            point: row.name("point")?,
            position_m: metres(row, ["x_m", "y_m", "z_m"])?,
            sigmas_m,
            role: match row.optional("role").unwrap_or_default() {
                "control" | "" => RowRole::Control,
                "check" => RowRole::Check,
                "approximate" => RowRole::Approximate,
                other => {
                    return Err(row.failure(format!(
                        "role = \"{}\" is none of control, check, approximate",
                        other.escape_debug()
                    )));
                }
            },
        })
    })
}

/// Reads `image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg` with optional σ, velocities and strip.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn images(path: &Path) -> Result<Read<ImageRow>, Failure> {
    let required = [
        "image",
        "x_m",
        "y_m",
        "z_m",
        "pitch_deg",
        "roll_deg",
        "yaw_deg",
    ];
    table(NamedColumns::read(path, &required)?, |row| {
        let mut attitude_deg = [0.0; 3];
        for (angle, column) in attitude_deg
            .iter_mut()
            .zip(["pitch_deg", "roll_deg", "yaw_deg"])
        {
            *angle = row.number(column)?;
            if angle.abs() > 360.0 {
                return Err(row.failure(format!(
                    "{column} = {angle} is outside -360 to 360°; is it in gon or in seconds?"
                )));
            }
        }
        let mut sigmas = [None; 6];
        let columns = [
            "sigma_x_m",
            "sigma_y_m",
            "sigma_z_m",
            "sigma_pitch_deg",
            "sigma_roll_deg",
            "sigma_yaw_deg",
        ];
        for (sigma, column) in sigmas.iter_mut().zip(columns) {
            *sigma = row.optional_number(column)?;
        }
        let velocity = [
            row.optional_number("vx_m_s")?,
            row.optional_number("vy_m_s")?,
            row.optional_number("vz_m_s")?,
        ];
        Ok(ImageRow {
            line: row.line,
            image: row.name("image")?,
            position_m: metres(row, ["x_m", "y_m", "z_m"])?,
            attitude_deg,
            sigmas,
            velocity_m_s: match velocity {
                [None, None, None] => None,
                parts => Some(parts.map(|part| part.unwrap_or(0.0))),
            },
            strip: row.optional("strip").map(Into::into),
        })
    })
}

/// Reads `point_a,point_b,length_m,sigma_m`.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn scale_bars(path: &Path) -> Result<Read<ScaleBarRow>, Failure> {
    let columns = NamedColumns::read(path, &["point_a", "point_b", "length_m", "sigma_m"])?;
    table(columns, |row| {
        Ok(ScaleBarRow {
            line: row.line,
            ends: [row.name("point_a")?, row.name("point_b")?],
            length_m: row.number("length_m")?,
            sigma_m: row.number("sigma_m")?,
        })
    })
}

fn metres(row: Row<'_>, columns: [&str; 3]) -> Result<[f64; 3], Failure> {
    let mut position = [0.0; 3];
    for (coordinate, column) in position.iter_mut().zip(columns) {
        *coordinate = row.number(column)?;
        if coordinate.abs() > MOST_METRES {
            return Err(row.failure(format!(
                "{column} = {coordinate} is outside -{MOST_METRES:e} to {MOST_METRES:e} m"
            )));
        }
    }
    Ok(position)
}
