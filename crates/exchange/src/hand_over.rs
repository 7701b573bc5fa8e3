//! Adjusted images with corrected image points, for programs that know one camera without
//! distortion.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use fmc_camera_file::InputError;

use crate::calibrated::Calibrated;
use crate::decimal::number;
use crate::pinhole::Pinhole;
use crate::program::colmap::{CAMERAS_HEAD, IMAGES_HEAD, camera_line, points_head};

/// Identifier of the camera.
const CAMERA_ID: u32 = 1;

/// An image point without distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectedPoint {
    /// Number of the object point.
    pub point: usize,
    /// Corrected place in the sensor frame, mm; the principal point is that of the camera.
    pub corrected_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
}

/// An image with its pose at the centroid of its exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjustedImage {
    /// Name.
    pub name: String,
    /// Projection centre, ground frame, m.
    pub position_m: Vector3<f64>,
    /// `ground_from_camera`, the camera looking along -z with y up.
    pub ground_from_camera: Rotation3<f64>,
    /// Pitch, roll, yaw: the same rotation, degrees.
    pub attitude_deg: [f64; 3],
    /// Image points.
    pub points: Vec<CorrectedPoint>,
}

/// An object point.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjustedPoint {
    /// Name.
    pub name: String,
    /// Adjusted coordinates, ground frame, m.
    pub position_m: Vector3<f64>,
}

/// Result of a bundle that any static program can go on with: one camera without distortion, its
/// principal point fixed.
///
/// # Model
/// `x = x0 - f·u1/u3`, `y = y0 - f·u2/u3`, `u = Rᵀ(P - S)`, up to the residuals of the adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct HandOver {
    /// Format, f and principal point; its distortion is not handed over.
    pub camera: Calibrated,
    /// Images.
    pub images: Vec<AdjustedImage>,
    /// Object points.
    pub points: Vec<AdjustedPoint>,
}

/// Names and contents of files.
pub type Files = Vec<(String, Vec<u8>)>;

impl HandOver {
    /// Returns `cameras.txt`, `images.txt` and `points3D.txt` of COLMAP; images and object points
    /// are numbered from 1 in their order.
    ///
    /// # Units and frames
    /// Pixels, first pixel centre at (½, ½); camera axes x right, y down, z forward.
    ///
    /// # Errors
    /// [`InputError`] for a name of an image that COLMAP cannot read.
    pub fn colmap(&self) -> Result<Files, InputError> {
        let pinhole = self.pinhole();
        let camera = camera_line(&self.camera, &pinhole, "PINHOLE", CAMERA_ID);
        let mut images = vec![format!(
            "{IMAGES_HEAD}# Number of images: {}\n",
            self.images.len()
        )];
        // Track, number of rays and sum of the distances from their projections, px.
        let mut tracks: Vec<(Vec<String>, u32, f64)> = vec![Default::default(); self.points.len()];
        for (image, id) in self.images.iter().zip(1..) {
            check_name(&image.name)?;
            let (rotation, translation) = image.colmap_pose();
            let [x, y, z, w] = rotation.coords.into();
            let [tx, ty, tz] = translation.into();
            let pose = [w, x, y, z, tx, ty, tz].map(number).join(" ");
            images.push(format!("{id} {pose} {CAMERA_ID} {}\n", image.name));
            let mut words = Vec::new();
            for (index, observed) in image.points.iter().enumerate() {
                let [col, row] = self.camera.pixel_from_sensor(observed.corrected_mm);
                let number_of = observed.point + 1;
                words.push(format!(
                    "{} {} {number_of}",
                    number(col + 0.5),
                    number(row + 0.5)
                ));
                let Some((point, (track, rays, error_px))) = self
                    .points
                    .get(observed.point)
                    .zip(tracks.get_mut(observed.point))
                else {
                    continue;
                };
                let along = rotation * point.position_m + translation;
                let [x, y] = pinhole.pixel_from_ray([along.x / along.z, along.y / along.z]);
                track.push(format!("{id} {index}"));
                *rays += 1;
                *error_px += (x - col).hypot(y - row);
            }
            images.push(words.join(" ") + "\n");
        }
        let seen = tracks.iter().filter(|(_, rays, _)| *rays > 0).count();
        let mut points = vec![points_head(seen)];
        for ((point, (track, rays, error_px)), id) in self.points.iter().zip(tracks).zip(1..) {
            if rays > 0 {
                let [x, y, z] = <[f64; 3]>::from(point.position_m).map(number);
                let mean = number(error_px / f64::from(rays));
                let track = track.join(" ");
                points.push(format!("{id} {x} {y} {z} 128 128 128 {mean} {track}\n"));
            }
        }
        let cameras = format!("{CAMERAS_HEAD}# Number of cameras: 1\n{camera}");
        Ok(vec![
            ("cameras.txt".to_owned(), cameras.into_bytes()),
            ("images.txt".to_owned(), images.concat().into_bytes()),
            ("points3D.txt".to_owned(), points.concat().into_bytes()),
        ])
    }

    /// Returns lists in mm and m: `corrected_points.csv`, which `calibrate bundle` reads with the
    /// camera of `pinhole.csv`, and `orientations.csv`, which `--images` reads.
    ///
    /// # Errors
    /// [`csv::Error`] of the writer.
    pub fn csv(&self) -> csv::Result<Files> {
        let mut corrected = csv::Writer::from_writer(Vec::new());
        corrected.write_record(["image", "point", "x_mm", "y_mm", "sigma_um"])?;
        let mut poses = csv::Writer::from_writer(Vec::new());
        poses.write_record([
            "image",
            "x_m",
            "y_m",
            "z_m",
            "pitch_deg",
            "roll_deg",
            "yaw_deg",
        ])?;
        for image in &self.images {
            for observed in &image.points {
                let name = self
                    .points
                    .get(observed.point)
                    .map_or("", |point| &point.name);
                let [x, y] = observed.corrected_mm.map(number);
                let sigma = number(1e3 * observed.sigma_mm);
                corrected.write_record([image.name.as_str(), name, &x, &y, &sigma])?;
            }
            let position: [f64; 3] = image.position_m.into();
            let numbers = position.into_iter().chain(image.attitude_deg).map(number);
            poses.write_record(std::iter::once(image.name.clone()).chain(numbers))?;
        }
        let mut camera = csv::Writer::from_writer(Vec::new());
        camera.write_record([
            "camera",
            "width_px",
            "height_px",
            "pixel_um",
            "principal_distance_mm",
            "principal_point_x_mm",
            "principal_point_y_mm",
        ])?;
        let [width, height] = self.camera.size_px;
        let [x0, y0] = self.camera.principal_point_mm;
        camera.write_record([
            self.camera.name.clone(),
            width.to_string(),
            height.to_string(),
            number(1e3 * self.camera.pixel_mm),
            number(self.camera.principal_distance_mm),
            number(x0),
            number(y0),
        ])?;
        let bytes = |writer: csv::Writer<Vec<u8>>| {
            writer
                .into_inner()
                .map_err(|error| csv::Error::from(error.into_error()))
        };
        Ok(vec![
            ("corrected_points.csv".to_owned(), bytes(corrected)?),
            ("orientations.csv".to_owned(), bytes(poses)?),
            ("pinhole.csv".to_owned(), bytes(camera)?),
        ])
    }

    fn pinhole(&self) -> Pinhole {
        let camera = &self.camera;
        Pinhole::ideal(
            camera.principal_distance_mm / camera.pixel_mm,
            camera.pixel_from_sensor(camera.principal_point_mm),
        )
    }
}

impl AdjustedImage {
    /// Returns rotation and translation from ground to COLMAP's camera axes, y down, z forward.
    fn colmap_pose(&self) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let flip = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        let rotation = flip * self.ground_from_camera.matrix().transpose();
        let rotation =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
        (rotation, -(rotation * self.position_m))
    }
}

/// Refuses a name that ends early in COLMAP's text files.
fn check_name(name: &str) -> Result<(), InputError> {
    if name.contains(char::is_whitespace) {
        return Err(InputError::invalid(format!(
            "image {name:?}: COLMAP's text files end a name at a space"
        )));
    }
    Ok(())
}
