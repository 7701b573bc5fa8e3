//! COLMAP: a camera per image, `CAMERA_ID` = `IMAGE_ID` = sequence number.

use std::io::{self, Write};

use super::cameras::Cameras;
use crate::program::colmap::{CAMERAS_HEAD, IMAGES_HEAD, binary_camera, camera_line, points_head};

pub(super) fn cameras_text(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    writeln!(
        sink,
        "{CAMERAS_HEAD}# Number of cameras: {}",
        cameras.count()
    )?;
    cameras.each(|frame, _| {
        let line = camera_line(
            cameras.camera,
            &cameras.pinhole(frame),
            cameras.model,
            frame.sequence,
        );
        sink.write_all(line.as_bytes())
    })
}

/// Writes the images, each at the origin: their poses are not known.
pub(super) fn images_text(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    writeln!(sink, "{IMAGES_HEAD}# Number of images: {}", cameras.count())?;
    cameras.each(|frame, image| {
        let id = frame.sequence;
        write!(sink, "{id} 1 0 0 0 0 0 0 {id} {image}\n\n")
    })
}

pub(super) fn no_points_text(_: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(points_head(0).as_bytes())
}

pub(super) fn cameras_binary(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(&cameras.count().to_le_bytes())?;
    cameras.each(|frame, _| {
        sink.write_all(&binary_camera(
            cameras.camera,
            &cameras.pinhole(frame),
            cameras.model,
            frame.sequence,
        ))
    })
}

pub(super) fn images_binary(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(&cameras.count().to_le_bytes())?;
    cameras.each(|frame, image| {
        let id = frame.sequence.to_le_bytes();
        sink.write_all(&id)?;
        for component in [1.0_f64, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0] {
            sink.write_all(&component.to_le_bytes())?;
        }
        sink.write_all(&id)?;
        sink.write_all(image.as_bytes())?;
        sink.write_all(&[0])?;
        // No points.
        sink.write_all(&0_u64.to_le_bytes())
    })
}

pub(super) fn no_points_binary(_: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(&0_u64.to_le_bytes())
}
