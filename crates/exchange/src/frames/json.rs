//! Programs with JSON files: `OpenSfM`, OPF and `OpenTrackIO`.

use std::io::{self, Write};
use std::time::Duration;

use serde_json::{Value, json};

use super::cameras::Cameras;
use super::image_camera::ImageCamera;
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
        (image.to_owned(), exif)
    })?;
    sink.write_all(b"\n}\n")
}

/// Writes `calibrated_cameras.json`: a sensor per image. The format demands poses: all are at the
/// origin.
pub(super) fn opf_cameras(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    write!(
        sink,
        "{{\n\"format\": {},\n\"version\": \"1.0\",\n\"sensors\": [",
        Value::from(opf::FORMAT)
    )?;
    elements(cameras, sink, |frame, _| {
        opf::sensor(&cameras.pinhole(frame), frame.sequence)
    })?;
    sink.write_all(b"\n],\n\"cameras\": [")?;
    elements(cameras, sink, |frame, _| {
        json!({
            "id": frame.sequence,
            "sensor_id": frame.sequence,
            "position": [0.0, 0.0, 0.0],
            "orientation_deg": [0.0, 0.0, 0.0],
        })
    })?;
    sink.write_all(b"\n]\n}\n")
}

/// Writes `camera_list.json`: the image of each camera.
pub(super) fn opf_list(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(
        b"{\n\"format\": \"application/opf-camera-list+json\",\n\"version\": \"1.0\",\n\
          \"cameras\": [",
    )?;
    elements(
        cameras,
        sink,
        |frame, image| json!({ "id": frame.sequence, "uri": image }),
    )?;
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

/// Writes an element per frame, each on a line.
fn elements(
    cameras: &Cameras<'_>,
    sink: &mut dyn Write,
    element: impl Fn(&ImageCamera, &str) -> Value,
) -> io::Result<()> {
    let mut separator = "\n";
    cameras.each(|frame, image| {
        write!(sink, "{separator}{}", element(frame, image))?;
        separator = ",\n";
        Ok(())
    })
}
