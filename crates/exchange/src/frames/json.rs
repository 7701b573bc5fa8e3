//! Programs with JSON files: `OpenSfM`, OPF and `OpenTrackIO`.

use std::io::{self, Write};
use std::time::Duration;

use serde_json::{Value, json};

use super::cameras::Cameras;
use super::image_camera::ImageCamera;
use super::pose::ImagePose;
use crate::program::{opensfm, opentrackio, opf};
use fmc_frames::time;

/// Returns the key of the camera of a frame in `OpenSfM`'s files.
pub(super) fn opensfm_key(frame: &ImageCamera) -> String {
    format!("frame {}", frame.sequence)
}

/// Writes `camera_models_overrides.json`: a camera per image.
pub(super) fn opensfm_models(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(b"{")?;
    members(cameras, sink, |frame, _| {
        let model = opensfm::model(cameras.camera, &cameras.pinhole(frame));
        (opensfm_key(frame), model)
    })?;
    sink.write_all(b"\n}\n")
}

/// Writes `exif_overrides.json`: the camera of each image, and its time.
pub(super) fn opensfm_exif(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(b"{")?;
    members(cameras, sink, |frame, image| {
        let mut exif = json!({ "camera": opensfm_key(frame) });
        if let Some(utc) = &frame.centroid_utc {
            let unix = Duration::from_micros(utc.unix_us);
            insert(&mut exif, "capture_time", json!(unix.as_secs_f64()));
        }
        if let Some(gps) = cameras.pose(frame).and_then(gps) {
            insert(&mut exif, "gps", gps);
        }
        (image.to_owned(), exif)
    })?;
    sink.write_all(b"\n}\n")
}

/// Returns the prior of `OpenSfM` for a geographic place; its `dop` is σ of the place, m.
fn gps(pose: &ImagePose) -> Option<Value> {
    let place = pose.geographic()?;
    let mut gps = json!({
        "latitude": place.latitude_rad.to_degrees(),
        "longitude": place.longitude_rad.to_degrees(),
        "altitude": place.height_m,
    });
    if let Some(sigma) = &pose.sigma {
        let largest = sigma.position_m.into_iter().fold(0.0, f64::max);
        insert(&mut gps, "dop", json!(largest));
    }
    Some(gps)
}

/// Writes `calibrated_cameras.json`: a sensor per image. The format demands poses: without a
/// trajectory all are at the origin; with one, cameras without a pose are left out.
pub(super) fn opf_cameras(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    write!(
        sink,
        "{{\n\"format\": {},\n\"version\": \"1.0\",\n\"sensors\": [",
        Value::from(opf::FORMAT)
    )?;
    elements(cameras, sink, |frame, _| {
        Some(opf::sensor(&cameras.pinhole(frame), frame.sequence))
    })?;
    sink.write_all(b"\n],\n\"cameras\": [")?;
    elements(cameras, sink, |frame, _| {
        let (position, orientation_deg) = if cameras.poses.is_some() {
            let pose = cameras.pose(frame)?;
            let angles = pose.omega_phi_kappa_rad().map(f64::to_degrees);
            (pose.position_m()?, angles)
        } else {
            ([0.0; 3], [0.0; 3])
        };
        Some(json!({
            "id": frame.sequence,
            "sensor_id": frame.sequence,
            "position": position,
            "orientation_deg": orientation_deg,
        }))
    })?;
    sink.write_all(b"\n]\n}\n")
}

/// Writes `camera_list.json`: the image of each camera.
pub(super) fn opf_list(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(
        b"{\n\"format\": \"application/opf-camera-list+json\",\n\"version\": \"1.0\",\n\
          \"cameras\": [",
    )?;
    elements(cameras, sink, |frame, image| {
        Some(json!({ "id": frame.sequence, "uri": image }))
    })?;
    sink.write_all(b"\n]\n}\n")
}

/// Writes `samples.jsonl`: a sample per line, with its time as PTP counts it (TAI).
pub(super) fn opentrackio_samples(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    cameras.each(|frame, image| {
        let mut sample = opentrackio::sample(cameras.camera, &cameras.correction(frame));
        let mut timing = json!({ "sequenceNumber": frame.sequence });
        let tai = frame.centroid_utc.and_then(|utc| time::tai(utc.unix_us));
        if let Some([seconds, us]) = tai {
            insert(&mut timing, "mode", json!("internal"));
            let timestamp = json!({ "seconds": seconds, "nanoseconds": us * 1000 });
            insert(&mut timing, "sampleTimestamp", timestamp);
        }
        insert(&mut sample, "timing", timing);
        let custom = json!({ "image": image, "centroidCameraClockUs": frame.centroid_us });
        insert(&mut sample, "custom", custom);
        writeln!(sink, "{sample}")
    })
}

fn insert(object: &mut Value, key: &str, value: Value) {
    if let Value::Object(members) = object {
        members.insert(key.to_owned(), value);
    }
}

/// Writes a member per frame, each on a line.
fn members(
    cameras: &Cameras<'_>,
    sink: &mut dyn Write,
    member: impl Fn(&ImageCamera, &str) -> (String, Value),
) -> io::Result<()> {
    let mut separator = "\n";
    cameras.each(|frame, image| {
        let (key, value) = member(frame, image);
        write!(sink, "{separator}{}: {value}", Value::from(key))?;
        separator = ",\n";
        Ok(())
    })
}

/// Writes an element per frame that has one, each on a line.
fn elements(
    cameras: &Cameras<'_>,
    sink: &mut dyn Write,
    element: impl Fn(&ImageCamera, &str) -> Option<Value>,
) -> io::Result<()> {
    let mut separator = "\n";
    cameras.each(|frame, image| {
        let Some(element) = element(frame, image) else {
            return Ok(());
        };
        write!(sink, "{separator}{element}")?;
        separator = ",\n";
        Ok(())
    })
}
