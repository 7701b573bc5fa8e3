//! Tables: those of `ArcGIS`'s frame cameras, and a plain one.

use std::io::{self, Write};

use serde::Serialize;

use super::cameras::Cameras;
use super::metashape;
use super::pose::ImagePose;
use fmc_frames::time;
use fmc_frames::trajectory::Place;

/// Identifier of the camera in `ArcGIS`'s tables.
const CAMERA_ID: &str = "1";

/// `X_RIGHT_Y_UP`: the sensor frame.
const X_RIGHT_Y_UP: u8 = 1;

/// A row of `cameras.csv`, µm.
#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct ArcGisCamera {
    #[serde(rename = "ObjectID")]
    object_id: u8,
    #[serde(rename = "CameraID")]
    camera_id: &'static str,
    focal_length: f64,
    principal_x: f64,
    principal_y: f64,
    n_rows: u32,
    n_columns: u32,
    pixel_size: f64,
    film_coordinate_system: u8,
}

/// A row of `ArcGIS`'s `frames.csv`, µm.
#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct ArcGisFrame<'a> {
    #[serde(rename = "ObjectID")]
    object_id: u32,
    raster: &'a str,
    #[serde(rename = "CameraID")]
    camera_id: &'static str,
    principal_x: f64,
    principal_y: f64,
    #[serde(rename = "CentroidUTC")]
    centroid_utc: Option<String>,
    perspective_x: Option<f64>,
    perspective_y: Option<f64>,
    perspective_z: Option<f64>,
    omega: Option<f64>,
    phi: Option<f64>,
    kappa: Option<f64>,
}

/// A row of Metashape's table of references: m, or degrees for a geographic place.
#[derive(Serialize)]
struct Reference<'a> {
    label: &'a str,
    x: f64,
    y: f64,
    z: f64,
    x_accuracy: Option<f64>,
    y_accuracy: Option<f64>,
    z_accuracy: Option<f64>,
    omega: f64,
    phi: f64,
    kappa: f64,
    omega_accuracy: Option<f64>,
    phi_accuracy: Option<f64>,
    kappa_accuracy: Option<f64>,
}

/// A row of the plain table. What is not known is empty.
#[derive(Serialize)]
struct PlainFrame<'a> {
    image: &'a str,
    sequence: u32,
    centroid_utc: Option<String>,
    centroid_unix_us: Option<u64>,
    utc_sigma_s: Option<f32>,
    gps_week: Option<u64>,
    gps_seconds_of_week: Option<String>,
    centroid_us: u64,
    principal_point_x_mm: f32,
    principal_point_y_mm: f32,
    principal_point_col_px: f64,
    principal_point_row_px: f64,
    principal_point_corner_x_px: f64,
    principal_point_corner_y_px: f64,
    principal_point_sigma_mm: f32,
    principal_point_frame_sigma_mm: f32,
    principal_point_common_sigma_mm: f32,
    centroid_offset_mm: f32,
    enlargement: f32,
    principal_distance_mm: f64,
    enlarged_distance_mm: f64,
    enlarged_distance_px: f64,
}

/// Returns the cells of three numbers, empty without them.
fn each(values: Option<[f64; 3]>) -> [Option<f64>; 3] {
    values.map_or([None; 3], |all| all.map(Some))
}

/// Writes `cameras.csv` of `ArcGIS`: the camera without distortion.
pub(super) fn arcgis_cameras(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let camera = cameras.camera;
    let [principal_x, principal_y] = camera.principal_point_mm.map(|mm| mm * 1e3);
    let [n_columns, n_rows] = camera.size_px;
    let mut table = csv::Writer::from_writer(sink);
    table.serialize(ArcGisCamera {
        object_id: 1,
        camera_id: CAMERA_ID,
        focal_length: camera.principal_distance_mm * 1e3,
        principal_x,
        principal_y,
        n_rows,
        n_columns,
        pixel_size: camera.pixel_mm * 1e3,
        film_coordinate_system: X_RIGHT_Y_UP,
    })?;
    table.flush()
}

/// Writes `frames.csv` of `ArcGIS`: the principal point of a frame goes before the camera's.
pub(super) fn arcgis_frames(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(sink);
    cameras.each(|frame, image| {
        let [principal_x, principal_y] = frame.principal_point().map(|mm| mm * 1e3);
        let pose = cameras.pose(frame);
        let [perspective_x, perspective_y, perspective_z] =
            each(pose.and_then(ImagePose::position_m));
        let [omega, phi, kappa] =
            each(pose.map(|pose| pose.omega_phi_kappa_rad().map(f64::to_degrees)));
        Ok(table.serialize(ArcGisFrame {
            object_id: frame.sequence,
            raster: image,
            camera_id: CAMERA_ID,
            principal_x,
            principal_y,
            centroid_utc: frame.centroid_utc.and_then(|utc| time::date(utc.unix_us)),
            perspective_x,
            perspective_y,
            perspective_z,
            omega,
            phi,
            kappa,
        })?)
    })?;
    table.flush()
}

/// Writes `reference.csv` of Metashape: place, angles and their accuracies of every frame that has
/// a pose. x, y and z of a geographic place are longitude, latitude and height.
pub(super) fn references(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(sink);
    cameras.each(|frame, image| {
        let Some(pose) = cameras.pose(frame) else {
            return Ok(());
        };
        let [x, y, z] = match pose.place {
            Place::Cartesian(position_m) => position_m,
            Place::Geographic(place) => [
                place.longitude_rad.to_degrees(),
                place.latitude_rad.to_degrees(),
                place.height_m,
            ],
        };
        let [omega, phi, kappa] = pose.omega_phi_kappa_rad().map(f64::to_degrees);
        let [x_accuracy, y_accuracy, z_accuracy] = each(pose.sigma.map(|sigma| sigma.position_m));
        let [omega_accuracy, phi_accuracy, kappa_accuracy] = each(
            pose.sigma
                .map(|sigma| sigma.angles_rad.map(f64::to_degrees)),
        );
        Ok(table.serialize(Reference {
            label: metashape::label(image),
            x,
            y,
            z,
            x_accuracy,
            y_accuracy,
            z_accuracy,
            omega,
            phi,
            kappa,
            omega_accuracy,
            phi_accuracy,
            kappa_accuracy,
        })?)
    })?;
    table.flush()
}

/// Writes `frames.csv`, the plain table.
pub(super) fn plain(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let camera = cameras.camera;
    let mut table = csv::Writer::from_writer(sink);
    cameras.each(|frame, image| {
        let [x_mm, y_mm] = frame.principal_point_mm;
        let [col, row] = camera.pixel_from_sensor(frame.principal_point());
        let utc = frame.centroid_utc;
        let gps = utc.and_then(|utc| time::gps(utc.unix_us));
        let enlarged_mm = camera.principal_distance_without_k0_mm() * frame.scale();
        Ok(table.serialize(PlainFrame {
            image,
            sequence: frame.sequence,
            centroid_utc: utc.and_then(|utc| time::date(utc.unix_us)),
            centroid_unix_us: utc.map(|utc| utc.unix_us),
            utc_sigma_s: utc.map(|utc| utc.sigma_s),
            gps_week: gps.map(|gps| gps.week),
            gps_seconds_of_week: gps.map(|gps| gps.seconds_of_week()),
            centroid_us: frame.centroid_us,
            principal_point_x_mm: x_mm,
            principal_point_y_mm: y_mm,
            principal_point_col_px: col,
            principal_point_row_px: row,
            principal_point_corner_x_px: col + 0.5,
            principal_point_corner_y_px: row + 0.5,
            principal_point_sigma_mm: frame.sigma.total_mm(),
            principal_point_frame_sigma_mm: frame.sigma.frame_mm,
            principal_point_common_sigma_mm: frame.sigma.common_mm,
            centroid_offset_mm: frame.centroid_offset_mm,
            enlargement: frame.enlargement,
            principal_distance_mm: camera.principal_distance_mm,
            enlarged_distance_mm: enlarged_mm,
            enlarged_distance_px: enlarged_mm / camera.pixel_mm,
        })?)
    })?;
    table.flush()
}
