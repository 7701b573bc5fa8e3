//! COLMAP: a camera per image, `CAMERA_ID` = `IMAGE_ID` = sequence number.

use std::io::{self, Write};

use super::cameras::Cameras;
use super::pose::ImagePose;
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

/// Rotation as a quaternion w, x, y, z, and translation.
type Pose = ([f64; 4], [f64; 3]);

/// Calls `each` with every image and its pose: at the origin without a trajectory. With one,
/// images without a pose are left out.
fn each_pose(
    cameras: &Cameras<'_>,
    mut each: impl FnMut(u32, Pose, &str) -> io::Result<()>,
) -> io::Result<()> {
    cameras.each(|frame, image| {
        let pose = if cameras.poses.is_some() {
            cameras.pose(frame).and_then(ImagePose::colmap)
        } else {
            Some(([1.0, 0.0, 0.0, 0.0], [0.0; 3]))
        };
        pose.map_or(Ok(()), |pose| each(frame.sequence, pose, image))
    })
}

pub(super) fn images_text(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    writeln!(sink, "{IMAGES_HEAD}# Number of images: {}", cameras.posed())?;
    each_pose(cameras, |id, (rotation, translation), image| {
        write!(sink, "{id}")?;
        for part in rotation.into_iter().chain(translation) {
            write!(sink, " {part}")?;
        }
        write!(sink, " {id} {image}\n\n")
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
    sink.write_all(&cameras.posed().to_le_bytes())?;
    each_pose(cameras, |id, (rotation, translation), image| {
        let id = id.to_le_bytes();
        sink.write_all(&id)?;
        for part in rotation.into_iter().chain(translation) {
            sink.write_all(&part.to_le_bytes())?;
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
