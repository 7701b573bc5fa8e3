//! Readers of the observations of `calibrate dlt3d`, `dlt2d`, `angles` and `grid`.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use fmc_adjustment::calibration::angles::request::AngleObservation;
use fmc_adjustment::calibration::dlt2d::request::PlaneTarget;
use fmc_adjustment::calibration::dlt3d::FieldPoint;
use fmc_adjustment::calibration::result::InputFile;
use fmc_adjustment::field_angles::FieldDirection;
use fmc_adjustment::grid::table::TableObservation;
use fmc_camera_file::CameraFile;

use super::named_columns::{NamedColumns, Row};
use crate::failure::Failure;

/// Names of points that a file has had, with their lines.
struct Names<'a> {
    file: &'a str,
    lines: HashMap<String, u64>,
}

impl<'a> Names<'a> {
    fn new(input: &'a InputFile) -> Self {
        Self {
            file: &input.file,
            lines: HashMap::new(),
        }
    }

    fn add(&mut self, what: &str, name: &str, line: u64) -> Result<(), Failure> {
        match self.lines.insert(name.to_owned(), line) {
            Some(first) => Err(Failure::bad_input(format!(
                "{}, lines {first} and {line}: {what} {name} appears twice",
                self.file
            ))),
            None => Ok(()),
        }
    }
}

/// Points of `calibrate dlt3d`.
#[derive(Debug)]
pub struct FieldPoints {
    /// The file.
    pub input: InputFile,
    /// `true` if it has σ.
    pub has_sigma: bool,
    /// Points.
    pub points: Vec<FieldPoint>,
}

/// Reads `point,x_mm,y_mm,x_m,y_m,z_m[,sigma_um]`, or with `col_px,row_px[,sigma_px]`.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn field_points(path: &Path, camera: &CameraFile) -> Result<FieldPoints, Failure> {
    let file = NamedColumns::read(path, &["point", "x_m", "y_m", "z_m"])?;
    let has_sigma = file.check_image_columns()?;
    let mut names = Names::new(&file.input);
    let mut points = Vec::new();
    for row in file.rows() {
        let point: Arc<str> = row.name("point")?;
        names.add("point", &point, row.line)?;
        let measured = row.image_point(camera)?;
        points.push(FieldPoint {
            line: row.line,
            point,
            measured_mm: measured.point_mm,
            sigma_mm: measured.sigma_mm,
            object_m: [row.number("x_m")?, row.number("y_m")?, row.number("z_m")?],
        });
    }
    Ok(FieldPoints {
        input: file.input.clone(),
        has_sigma,
        points,
    })
}

/// Targets of `calibrate dlt2d` at one focus setting.
#[derive(Debug)]
pub struct FocusTargets {
    /// Focus setting; `None` without a column `focus`.
    pub focus: Option<Arc<str>>,
    /// Targets.
    pub targets: Vec<PlaneTarget>,
}

/// Targets of `calibrate dlt2d`.
#[derive(Debug)]
pub struct PlaneTargets {
    /// The file.
    pub input: InputFile,
    /// `true` if it has σ.
    pub has_sigma: bool,
    /// Focus settings in the order of the file.
    pub settings: Vec<FocusTargets>,
}

/// Reads `target,x_mm,y_mm,x_m,y_m[,focus][,sigma_um]`, or with `col_px,row_px[,sigma_px]`.
///
/// # Errors
/// As [`field_points`].
pub fn plane_targets(path: &Path, camera: &CameraFile) -> Result<PlaneTargets, Failure> {
    let file = NamedColumns::read(path, &["target", "x_m", "y_m"])?;
    let has_sigma = file.check_image_columns()?;
    let mut settings: Vec<(FocusTargets, Names<'_>)> = Vec::new();
    for row in file.rows() {
        let focus = file.has("focus").then(|| row.name("focus")).transpose()?;
        let known = settings.iter().position(|(one, _)| one.focus == focus);
        if known.is_none() {
            let setting = FocusTargets {
                focus: focus.clone(),
                targets: Vec::new(),
            };
            settings.push((setting, Names::new(&file.input)));
        }
        let index = known.unwrap_or(settings.len() - 1);
        let Some((setting, names)) = settings.get_mut(index) else {
            continue;
        };
        let target: Arc<str> = row.name("target")?;
        names.add("target", &target, row.line)?;
        setting.targets.push(plane_target(&row, target, camera)?);
    }
    let settings = settings.into_iter().map(|(setting, _)| setting).collect();
    Ok(PlaneTargets {
        input: file.input.clone(),
        has_sigma,
        settings,
    })
}

fn plane_target(
    row: &Row<'_>,
    target: Arc<str>,
    camera: &CameraFile,
) -> Result<PlaneTarget, Failure> {
    let measured = row.image_point(camera)?;
    Ok(PlaneTarget {
        line: row.line,
        target,
        measured_mm: measured.point_mm,
        sigma_mm: measured.sigma_mm,
        plane_m: [row.number("x_m")?, row.number("y_m")?],
    })
}

/// Table of `calibrate grid`.
#[derive(Debug)]
pub struct DistortionTableFile {
    /// The file.
    pub input: InputFile,
    /// `true` if it has σ, which is not read.
    pub has_sigma: bool,
    /// Rows.
    pub observations: Vec<TableObservation>,
}

/// Reads `x_mm,y_mm,dx_um,dy_um[,stage_offset_mm]`, or with `col_px,row_px`.
///
/// # Errors
/// As [`field_points`].
pub fn distortion_table(path: &Path, camera: &CameraFile) -> Result<DistortionTableFile, Failure> {
    let file = NamedColumns::read(path, &["dx_um", "dy_um"])?;
    let has_sigma = file.check_image_columns()?;
    let has_stage = file.has("stage_offset_mm");
    let mut observations = Vec::new();
    for row in file.rows() {
        let stage = has_stage
            .then(|| row.number("stage_offset_mm"))
            .transpose()?;
        observations.push(TableObservation {
            line: row.line,
            measured_mm: row.image_point(camera)?.point_mm,
            distortion_mm: [row.number("dx_um")? / 1e3, row.number("dy_um")? / 1e3],
            stage_offset_mm: stage.unwrap_or(0.0),
        });
    }
    Ok(DistortionTableFile {
        input: file.input,
        has_sigma,
        observations,
    })
}

/// Columns of the angles of a line, and of an area.
const OF_A_LINE: [&str; 2] = ["angle_deg", "l_mm"];
const OF_AN_AREA: [&str; 2] = ["azimuth_deg", "elevation_deg"];

/// Angles of a turntable.
#[derive(Debug)]
pub enum TurntableAngles {
    /// One line of the sensor.
    Line(InputFile, Vec<AngleObservation>),
    /// The area of the sensor.
    Area(FieldDirections),
}

/// Directions of an area camera.
#[derive(Debug)]
pub struct FieldDirections {
    /// The file.
    pub input: InputFile,
    /// `true` if it has σ.
    pub has_sigma: bool,
    /// `true` if it has offsets of the stage.
    pub has_stage: bool,
    /// Directions.
    pub directions: Vec<FieldDirection>,
}

/// Reads `angle_deg,l_mm[,band][,repeat]`, or `azimuth_deg,elevation_deg,x_mm,y_mm` with
/// `sigma_um` and `stage_offset_mm` if they are there; `col_px,row_px,sigma_px` may stand for
/// `x_mm,y_mm,sigma_um`.
///
/// # Errors
/// As [`field_points`], and for columns of both.
pub fn turntable_angles(path: &Path, camera: &CameraFile) -> Result<TurntableAngles, Failure> {
    let file = NamedColumns::read(path, &[])?;
    let has_any = |columns: [&'static str; 2]| columns.into_iter().find(|column| file.has(column));
    match (has_any(OF_A_LINE), has_any(OF_AN_AREA)) {
        (Some(line), Some(area)) => Err(Failure::bad_input(format!(
            "{}, line 1: both {line} and {area} are given",
            file.input.file
        ))
        .with_help(
            "one line of the sensor has angle_deg,l_mm; an area has azimuth_deg,elevation_deg,x_mm,y_mm",
        )),
        (None, Some(_)) => field_directions(file, camera).map(TurntableAngles::Area),
        _ => line_angles(file),
    }
}

fn line_angles(file: NamedColumns) -> Result<TurntableAngles, Failure> {
    file.require(&OF_A_LINE)?;
    let mut observations = Vec::new();
    for row in file.rows() {
        let name = |column: &str| file.has(column).then(|| row.name(column)).transpose();
        observations.push(AngleObservation {
            line: row.line,
            angle_deg: row.number("angle_deg")?,
            l_mm: row.number("l_mm")?,
            band: name("band")?,
            repeat: name("repeat")?,
        });
    }
    Ok(TurntableAngles::Line(file.input, observations))
}

fn field_directions(file: NamedColumns, camera: &CameraFile) -> Result<FieldDirections, Failure> {
    file.require(&OF_AN_AREA)?;
    let has_sigma = file.check_image_columns()?;
    let has_stage = file.has("stage_offset_mm");
    let mut directions = Vec::new();
    for row in file.rows() {
        let measured = row.image_point(camera)?;
        directions.push(FieldDirection {
            line: row.line,
            azimuth_deg: row.number("azimuth_deg")?,
            elevation_deg: row.number("elevation_deg")?,
            measured_mm: measured.point_mm,
            sigma_mm: measured.sigma_mm,
            stage_offset_mm: if has_stage {
                row.number("stage_offset_mm")?
            } else {
                0.0
            },
        });
    }
    Ok(FieldDirections {
        input: file.input,
        has_sigma,
        has_stage,
        directions,
    })
}
