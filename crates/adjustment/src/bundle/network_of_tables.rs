//! Network from its tables, with the checks that need no adjustment.

use std::collections::HashMap;

use fmc_camera_file::InputError;
use nalgebra::Vector3;

use crate::exterior_orientation::ExteriorOrientation;
use crate::observation::UNIT_SIGMA_MM;

use super::image::{NetworkImage, ObservedPose};
use super::interior::Interior;
use super::network::{ImagePoint, Network, ObjectPoint, PointRole, ScaleBar};
use super::orientation::network_orientation::KnownValues;
use super::parameters::{Parameter, Prior, SharedValues};
use super::pose::Pose;
use super::tables::{ImageRow, NetworkTables, RowRole};

/// Unknowns that a calibration estimates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Unknowns {
    /// Shared unknowns; a shift stands for those of all strips and axes.
    pub estimated: Vec<Parameter>,
    /// σ of the initial values of shared unknowns.
    pub priors: Vec<(Parameter, f64)>,
}

/// A network with what is known of it before the adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct TabledNetwork {
    /// The network.
    pub network: Network,
    /// Images and points with initial values.
    pub known: KnownValues,
    /// Line in the file of each image point, in the order of the network.
    pub lines: Vec<u64>,
    /// `true` if all image points came with σ.
    pub has_sigma: bool,
}

impl NetworkTables {
    /// Creates the network; image points without σ get one of 1 µm.
    ///
    /// # Errors
    /// [`InputError`] that names file, line and value: names twice or unknown, σ that are no σ.
    pub fn network(
        &self,
        interior: Interior,
        unknowns: &Unknowns,
    ) -> Result<TabledNetwork, InputError> {
        let mut images = Names::default();
        let mut points = Names::default();
        let mut observed: HashMap<(usize, usize), u64> = HashMap::new();
        let mut image_points = Vec::with_capacity(self.image_points.rows.len());
        let file = &self.image_points.file;
        for row in &self.image_points.rows {
            let (image, point) = (images.number(&row.image), points.number(&row.point));
            if let Some(first) = observed.insert((image, point), row.line) {
                return Err(InputError::invalid(format!(
                    "{file}, lines {first} and {}: image {} shows point {} twice; a point has one image in each",
                    row.line, row.image, row.point
                )));
            }
            let sigma_mm = row.sigma_mm.unwrap_or(UNIT_SIGMA_MM);
            if !(sigma_mm > 0.0 && sigma_mm.is_finite()) {
                return Err(InputError::invalid(format!(
                    "{file}, line {}: sigma of image {}, point {} is {} µm; it must be greater than 0",
                    row.line,
                    row.image,
                    row.point,
                    1e3 * sigma_mm
                )));
            }
            image_points.push((
                ImagePoint {
                    image,
                    point,
                    measured_mm: row.measured_mm,
                    by_grids_mm: row.by_grids_mm,
                    sigma_mm,
                    additional: None,
                    accepted: true,
                },
                row.line,
            ));
        }
        image_points.sort_by_key(|(observed, _)| (observed.point, observed.image));
        let (image_points, lines): (Vec<_>, Vec<_>) = image_points.into_iter().unzip();
        let (objects, known_points) = self.objects(&points)?;
        let (images, strips, known_images) = self.images(&images)?;
        let parameters = SharedValues::new(interior, strips.list.len());
        let estimated = expanded(&unknowns.estimated, strips.list.len());
        let mut priors = Vec::new();
        for (parameter, sigma) in &unknowns.priors {
            for parameter in expanded(&[*parameter], strips.list.len()) {
                priors.push(Prior {
                    parameter,
                    value: parameters.value(parameter),
                    sigma: *sigma,
                });
            }
        }
        Ok(TabledNetwork {
            network: Network {
                images,
                points: objects,
                image_points,
                additional: Vec::new(),
                scale_bars: self.bars(&points)?,
                strips: strips.list,
                parameters,
                estimated,
                priors,
            },
            known: KnownValues {
                images: known_images,
                points: known_points,
            },
            lines,
            has_sigma: self
                .image_points
                .rows
                .iter()
                .all(|row| row.sigma_mm.is_some()),
        })
    }

    fn objects(&self, names: &Names) -> Result<(Vec<ObjectPoint>, Vec<bool>), InputError> {
        let file = &self.object_points.file;
        let mut objects: Vec<ObjectPoint> = names
            .list
            .iter()
            .map(|name| ObjectPoint {
                name: name.clone(),
                given_m: Vector3::zeros(),
                sigmas_m: [None; 3],
                role: PointRole::Tie,
            })
            .collect();
        let mut known = vec![false; objects.len()];
        let mut lines: HashMap<&str, u64> = HashMap::new();
        let mut places: HashMap<[u64; 3], &str> = HashMap::new();
        for row in &self.object_points.rows {
            let place = row.position_m.map(|metres| (metres + 0.0).to_bits());
            if row.role == RowRole::Control
                && let Some(other) = places.insert(place, &row.point)
                && *other != *row.point
            {
                return Err(InputError::invalid(format!(
                    "{file}, line {}: control points {other} and {} have the same coordinates",
                    row.line, row.point
                )));
            }
            if let Some(first) = lines.insert(&row.point, row.line) {
                return Err(InputError::invalid(format!(
                    "{file}, lines {first} and {}: point {} appears twice",
                    row.line, row.point
                )));
            }
            for (sigma, axis) in row.sigmas_m.into_iter().zip(super::parameters::AXES) {
                if !(sigma >= 0.0 && sigma.is_finite()) {
                    return Err(InputError::invalid(format!(
                        "{file}, line {}: sigma_{axis}_m = {sigma} of point {} must be 0 (held) or greater",
                        row.line, row.point
                    )));
                }
            }
            let Some(number) = names.find(&row.point) else {
                continue;
            };
            if let (Some(object), Some(flag)) = (objects.get_mut(number), known.get_mut(number)) {
                object.given_m = Vector3::from(row.position_m);
                object.role = match row.role {
                    RowRole::Control => PointRole::Control,
                    RowRole::Check => PointRole::Check,
                    RowRole::Approximate => PointRole::Tie,
                };
                object.sigmas_m = row.sigmas_m.map(Some);
                *flag = true;
            }
        }
        Ok((objects, known))
    }

    fn images(&self, names: &Names) -> Result<(Vec<NetworkImage>, Names, Vec<bool>), InputError> {
        let mut strips = Names::default();
        let mut images: Vec<NetworkImage> = names
            .list
            .iter()
            .map(|name| NetworkImage {
                name: name.clone(),
                pose: Pose::from(ExteriorOrientation {
                    position_m: [0.0; 3],
                    attitude: [0.0; 3],
                }),
                observed: None,
                stage: self.stages.get(name.as_str()).copied(),
            })
            .collect();
        let mut known = vec![false; images.len()];
        let Some(table) = &self.images else {
            return Ok((images, strips, known));
        };
        let mut lines: HashMap<&str, u64> = HashMap::new();
        for row in &table.rows {
            if let Some(first) = lines.insert(&row.image, row.line) {
                return Err(InputError::invalid(format!(
                    "{}, lines {first} and {}: image {} appears twice",
                    table.file, row.line, row.image
                )));
            }
            let Some(number) = names.find(&row.image) else {
                continue;
            };
            check_sigmas(&table.file, row)?;
            let strip = row.strip.as_ref().map(|strip| strips.number(strip));
            if let (Some(image), Some(flag)) = (images.get_mut(number), known.get_mut(number)) {
                image.pose = Pose::from(ExteriorOrientation {
                    position_m: row.position_m,
                    attitude: row.attitude_deg.map(f64::to_radians),
                });
                image.observed = row
                    .sigmas
                    .iter()
                    .any(Option::is_some)
                    .then(|| ObservedPose {
                        pose: image.pose,
                        sigmas: in_radians(row.sigmas),
                        velocity_m_s: row.velocity_m_s.map(Vector3::from),
                        strip,
                    });
                *flag = true;
            }
        }
        Ok((images, strips, known))
    }

    fn bars(&self, names: &Names) -> Result<Vec<ScaleBar>, InputError> {
        let Some(table) = &self.scale_bars else {
            return Ok(Vec::new());
        };
        let mut bars = Vec::new();
        for row in &table.rows {
            let place = format!("{}, line {}", table.file, row.line);
            if !(row.sigma_m > 0.0 && row.sigma_m.is_finite() && row.length_m > 0.0) {
                return Err(InputError::invalid(format!(
                    "{place}: length_m = {} and sigma_m = {} must be greater than 0",
                    row.length_m, row.sigma_m
                )));
            }
            let find = |name: &str| {
                names.find(name).ok_or_else(|| {
                    InputError::invalid(format!("{place}: point {name} is in no image"))
                })
            };
            let [a, b] = &row.ends;
            if a == b {
                return Err(InputError::invalid(format!(
                    "{place}: both ends of the scale bar are point {a}"
                )));
            }
            bars.push(ScaleBar {
                ends: [find(a)?, find(b)?],
                length_m: row.length_m,
                sigma_m: row.sigma_m,
            });
        }
        Ok(bars)
    }
}

fn in_radians([x, y, z, pitch, roll, yaw]: [Option<f64>; 6]) -> [Option<f64>; 6] {
    let radians = |sigma: Option<f64>| sigma.map(f64::to_radians);
    [x, y, z, radians(pitch), radians(roll), radians(yaw)]
}

fn check_sigmas(file: &str, row: &ImageRow) -> Result<(), InputError> {
    for sigma in row.sigmas.into_iter().flatten() {
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(InputError::invalid(format!(
                "{file}, line {}: sigma = {sigma} of image {} must be greater than 0; leave it out for an initial value",
                row.line, row.image
            )));
        }
    }
    Ok(())
}

/// Returns the unknowns with a shift for every strip and axis.
fn expanded(estimated: &[Parameter], strips: usize) -> Vec<Parameter> {
    estimated
        .iter()
        .flat_map(|parameter| match parameter {
            Parameter::Shift { .. } => (0..strips)
                .flat_map(|strip| (0..3).map(move |axis| Parameter::Shift { strip, axis }))
                .collect(),
            other => vec![*other],
        })
        .collect()
}

/// Names in the order of their first appearance.
#[derive(Debug, Clone, Default)]
struct Names {
    list: Vec<String>,
    numbers: HashMap<Box<str>, usize>,
}

impl Names {
    fn number(&mut self, name: &str) -> usize {
        if let Some(number) = self.find(name) {
            return number;
        }
        let number = self.list.len();
        self.list.push(name.to_owned());
        self.numbers.insert(name.into(), number);
        number
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.numbers.get(name).copied()
    }
}
