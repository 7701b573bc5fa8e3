//! Wrong units and directions of axes, told by the pattern of the residuals.

use std::collections::HashMap;

use fmc_camera_file::InputError;
use nalgebra::Vector3;

use super::interior::Interior;
use super::network::Network;
use super::network_of_tables::Unknowns;
use super::solution::{DatumChoice, Solution};
use super::tables::NetworkTables;
use super::trial;

/// σ0, in units of the σ of an image point, above which other readings of the files are tried.
const DOUBTFUL_SIGMA0: f64 = 10.0;

/// Factor of the principal distance of the camera file, or its inverse, beyond which other readings
/// are tried: heights in feet enlarge it by 3.28.
const DOUBTFUL_DISTANCE: f64 = 1.25;

/// Factor by which another reading must fit better to be named.
const LEAST_IMPROVEMENT: f64 = 8.0;

/// Residual as a fraction of the image's extent that is no measurement.
const MOST_RESIDUAL: f64 = 1e-2;

/// Foot, m.
const FOOT_M: f64 = 0.3048;

/// Relative difference of two scales that are the same.
const SAME_SCALE: f64 = 0.02;

/// Other reading of the files.
#[derive(Debug, Clone, Copy)]
enum Reading {
    YDownwards,
    Radians,
    PointsInFeet,
    HeightsInFeet,
    ImagesInFeet,
    ImageHeightsInFeet,
}

impl Reading {
    const ALL: [Self; 6] = [
        Self::YDownwards,
        Self::Radians,
        Self::PointsInFeet,
        Self::HeightsInFeet,
        Self::ImagesInFeet,
        Self::ImageHeightsInFeet,
    ];

    /// Returns the tables as they should have been; `None` without such a table.
    fn of(self, tables: &NetworkTables) -> Option<NetworkTables> {
        let mut tables = tables.clone();
        match self {
            Self::YDownwards => {
                for row in &mut tables.image_points.rows {
                    let [x, y] = row.measured_mm;
                    row.measured_mm = [x, -y];
                }
            }
            Self::PointsInFeet | Self::HeightsInFeet => {
                for row in &mut tables.object_points.rows {
                    in_metres(&mut row.position_m, matches!(self, Self::HeightsInFeet));
                }
            }
            Self::Radians => {
                for row in &mut tables.images.as_mut()?.rows {
                    row.attitude_deg = row.attitude_deg.map(f64::to_degrees);
                }
            }
            Self::ImagesInFeet | Self::ImageHeightsInFeet => {
                for row in &mut tables.images.as_mut()?.rows {
                    in_metres(
                        &mut row.position_m,
                        matches!(self, Self::ImageHeightsInFeet),
                    );
                }
            }
        }
        Some(tables)
    }

    /// Returns the message, with how much better the reading fits.
    fn message(self, tables: &NetworkTables, better: &str) -> String {
        let images = tables.images.as_ref().map_or("", |table| &table.file);
        let (file, fault) = match self {
            Self::YDownwards => (
                tables.image_points.file.as_str(),
                "with y_mm reversed; y counts upwards in the sensor frame, in an upright positive image",
            ),
            Self::Radians => (
                images,
                "with pitch_deg, roll_deg, yaw_deg as radians; they are to be in degrees",
            ),
            Self::PointsInFeet => (
                tables.object_points.file.as_str(),
                "with x_m, y_m, z_m as feet; they are to be in metres",
            ),
            Self::HeightsInFeet => (
                tables.object_points.file.as_str(),
                "with z_m as feet; it is to be in metres",
            ),
            Self::ImagesInFeet => (
                images,
                "with x_m, y_m, z_m as feet; they are to be in metres",
            ),
            Self::ImageHeightsInFeet => (images, "with z_m as feet; it is to be in metres"),
        };
        format!("{file}: the observations fit {better} {fault}")
    }
}

fn in_metres(position: &mut [f64; 3], height_alone: bool) {
    let [x, y, z] = position;
    *z *= FOOT_M;
    if !height_alone {
        *x *= FOOT_M;
        *y *= FOOT_M;
    }
}

/// Checks that residuals are of the size of measurements, the principal distance near that of the
/// camera file, and the scale of the positions that of the object points.
///
/// # Errors
/// [`InputError`] that names the file and the reading of it that fits.
pub fn check(
    tables: &NetworkTables,
    start: Interior,
    unknowns: &Unknowns,
    choice: DatumChoice,
    (network, solution): (&Network, &Solution),
) -> Result<(), InputError> {
    check_scale(tables, network, solution)?;
    let found = &solution.state.parameters.interior;
    let ratio = found.principal_distance_mm / start.principal_distance_mm;
    let is_near = (1.0 / DOUBTFUL_DISTANCE..=DOUBTFUL_DISTANCE).contains(&ratio);
    if solution.sigma0() < DOUBTFUL_SIGMA0 && is_near {
        return Ok(());
    }
    reading(tables, start, unknowns, choice).map_or(Ok(()), Err)
}

/// Returns the error that names another reading of the files, if it fits far better; of a large
/// block a part is tried.
#[must_use]
pub fn reading(
    tables: &NetworkTables,
    start: Interior,
    unknowns: &Unknowns,
    choice: DatumChoice,
) -> Option<InputError> {
    // One more for the files as they were read.
    let tables = &trial::part_for(tables, Reading::ALL.len() + 1);
    let sigma0 = |tables: &NetworkTables| {
        let (_, solution) = trial::adjusted(tables, start, unknowns, choice, true)?;
        Some(solution.sigma0())
    };
    let as_read = sigma0(tables);
    let (reading, fitting) = Reading::ALL
        .into_iter()
        .filter_map(|reading| Some((reading, sigma0(&reading.of(tables)?)?)))
        .min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let better = if let Some(as_read) = as_read {
        let factor = as_read / fitting.max(f64::MIN_POSITIVE);
        (factor > LEAST_IMPROVEMENT).then(|| format!("{factor:.0} times better"))
    } else {
        (fitting < most_sigma0(tables)).then(|| "only".to_owned())
    }?;
    Some(InputError::invalid(reading.message(tables, &better)))
}

/// σ0 above which a reading fits no more than the one that cannot be adjusted.
fn most_sigma0(tables: &NetworkTables) -> f64 {
    let rows = &tables.image_points.rows;
    let extent_mm = rows
        .iter()
        .map(|row| f64::hypot(row.measured_mm[0], row.measured_mm[1]))
        .fold(0.0, f64::max);
    let sigma_mm = rows
        .iter()
        .map(|row| row.sigma_mm.unwrap_or(crate::observation::UNIT_SIGMA_MM))
        .fold(0.0, f64::max);
    MOST_RESIDUAL * extent_mm / sigma_mm
}

/// Checks that positions of images, also those that are initial values alone, have the scale of the
/// object points.
fn check_scale(
    tables: &NetworkTables,
    network: &Network,
    solution: &Solution,
) -> Result<(), InputError> {
    let Some(table) = &tables.images else {
        return Ok(());
    };
    let poses: HashMap<&str, Vector3<f64>> = network
        .images
        .iter()
        .zip(&solution.state.poses)
        .map(|(image, pose)| (image.name.as_str(), pose.position_m))
        .collect();
    let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = table
        .rows
        .iter()
        .filter_map(|row| Some((*poses.get(&*row.image)?, Vector3::from(row.position_m))))
        .collect();
    let count = f64::from(u32::try_from(pairs.len()).unwrap_or(u32::MAX)).max(1.0);
    let [mut found, mut given] = [Vector3::zeros(); 2];
    for (adjusted, row) in &pairs {
        found += adjusted / count;
        given += row / count;
    }
    let [mut found_square, mut given_square] = [0.0; 2];
    for (adjusted, row) in &pairs {
        found_square += (adjusted - found).norm_squared();
        given_square += (row - given).norm_squared();
    }
    let ratio = (found_square / given_square).sqrt();
    let is_near = |scale: f64| (ratio / scale - 1.0).abs() < SAME_SCALE;
    let in_feet = if is_near(1.0 / FOOT_M) {
        &tables.object_points.file
    } else if is_near(FOOT_M) {
        &table.file
    } else {
        return Ok(());
    };
    Err(InputError::invalid(format!(
        "{in_feet}: coordinates are in feet: the images lie {ratio:.4} times as far apart by {} as by {}; they are to be in metres",
        tables.object_points.file, table.file
    )))
}
