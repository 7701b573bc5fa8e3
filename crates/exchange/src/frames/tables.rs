//! Tables: those of `ArcGIS`'s frame cameras, and a plain one.

use std::io::{self, Write};

use super::{Frames, time};
use crate::decimal::number;

/// Identifier of the camera in `ArcGIS`'s tables.
const CAMERA_ID: &str = "1";

/// Columns of the plain table.
const COLUMNS: [&str; 22] = [
    "image",
    "sequence",
    "centroid_utc",
    "centroid_unix_us",
    "utc_sigma_s",
    "gps_week",
    "gps_seconds_of_week",
    "centroid_us",
    "principal_point_x_mm",
    "principal_point_y_mm",
    "principal_point_col_px",
    "principal_point_row_px",
    "principal_point_corner_x_px",
    "principal_point_corner_y_px",
    "principal_point_sigma_mm",
    "principal_point_frame_sigma_mm",
    "principal_point_common_sigma_mm",
    "centroid_offset_mm",
    "enlargement",
    "principal_distance_mm",
    "enlarged_distance_mm",
    "enlarged_distance_px",
];

/// Writes `cameras.csv` of `ArcGIS`: the camera without distortion.
pub(super) fn arcgis_cameras(frames: &Frames<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let camera = frames.camera;
    let [x0, y0] = camera.principal_point_mm;
    let [width, height] = camera.size_px;
    let mut table = csv::Writer::from_writer(sink);
    table.write_record([
        "ObjectID",
        "CameraID",
        "FocalLength",
        "PrincipalX",
        "PrincipalY",
        "NRows",
        "NColumns",
        "PixelSize",
        "FilmCoordinateSystem",
    ])?;
    table.write_record([
        "1",
        CAMERA_ID,
        &number(camera.principal_distance_mm * 1e3),
        &number(x0 * 1e3),
        &number(y0 * 1e3),
        &height.to_string(),
        &width.to_string(),
        &number(camera.pixel_mm * 1e3),
        "1",
    ])?;
    table.flush()
}

/// Writes `frames.csv` of `ArcGIS`: the principal point of a frame goes before the camera's.
pub(super) fn arcgis_frames(frames: &Frames<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(sink);
    table.write_record([
        "ObjectID",
        "Raster",
        "CameraID",
        "PrincipalX",
        "PrincipalY",
        "CentroidUTC",
    ])?;
    frames.each(|frame, image| {
        let [x, y] = frame.principal_point().map(|mm| number(mm * 1e3));
        let utc = frame.centroid_utc.and_then(|utc| time::date(utc.unix_us));
        let row = [
            &frame.sequence.to_string(),
            image,
            CAMERA_ID,
            &x,
            &y,
            utc.as_deref().unwrap_or_default(),
        ];
        Ok(table.write_record(row)?)
    })?;
    table.flush()
}

/// Writes `frames.csv`, the plain table. What is not known is empty.
pub(super) fn plain(frames: &Frames<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let camera = frames.camera;
    let mut table = csv::Writer::from_writer(sink);
    table.write_record(COLUMNS)?;
    frames.each(|frame, image| {
        let [x_mm, y_mm] = frame.principal_point_mm;
        let [col, row] = camera.pixel_from_sensor(frame.principal_point());
        let utc = frame.centroid_utc;
        let gps = utc.and_then(|utc| time::gps(utc.unix_us));
        let enlarged_mm = camera.principal_distance_without_k0_mm() * frame.scale();
        let or_empty = |text: Option<String>| text.unwrap_or_default();
        let cells: [String; COLUMNS.len()] = [
            image.to_owned(),
            frame.sequence.to_string(),
            or_empty(utc.and_then(|utc| time::date(utc.unix_us))),
            or_empty(utc.map(|utc| utc.unix_us.to_string())),
            or_empty(utc.map(|utc| utc.sigma_s.to_string())),
            or_empty(gps.map(|gps| gps.week.to_string())),
            or_empty(gps.map(|gps| gps.seconds_of_week())),
            frame.centroid_us.to_string(),
            x_mm.to_string(),
            y_mm.to_string(),
            number(col),
            number(row),
            number(col + 0.5),
            number(row + 0.5),
            frame.sigma.total_mm().to_string(),
            frame.sigma.frame_mm.to_string(),
            frame.sigma.common_mm.to_string(),
            frame.centroid_offset_mm.to_string(),
            frame.enlargement.to_string(),
            number(camera.principal_distance_mm),
            number(enlarged_mm),
            number(enlarged_mm / camera.pixel_mm),
        ];
        Ok(table.write_record(&cells)?)
    })?;
    table.flush()
}
