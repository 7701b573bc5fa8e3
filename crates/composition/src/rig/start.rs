//! Orientations of exposures from control, with the nominal rig, in spite of wrong points.

use fmc_adjustment::collinearity::projection;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_camera_file::InputError;
use nalgebra::{Matrix4, Matrix6, Vector2, Vector4, Vector6};

use super::control::{ControlPoint, Measurements};
use super::description::Rig;
use super::polynomial::normalised;
use crate::number::{median, real};

/// Least number of control points of an exposure.
pub(super) const LEAST_CONTROL: usize = 4;
/// Rounds of weights by residuals.
const ROUNDS: usize = 40;
/// Distance from its place, px, that no point of a nominal rig has: detectors are mounted within.
const WRONG_PX: f64 = 60.0;
/// The same in median distances.
const WRONG_MEDIANS: f64 = 20.0;

/// A similarity from px about the principal point, x right and y up, to the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Similarity {
    /// m/px, cosine and sine.
    pub(super) along: f64,
    pub(super) across: f64,
    pub(super) shift_m: [f64; 2],
}

impl Similarity {
    /// Metres of a pixel.
    pub(super) fn scale(&self) -> f64 {
        self.along.hypot(self.across)
    }

    /// Returns the place, px about the principal point, of a ground point whose height does not
    /// count.
    pub(super) fn place_px(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = [x - self.shift_m[0], y - self.shift_m[1]];
        let square = self.scale().powi(2);
        [
            (self.along * x + self.across * y) / square,
            (self.along * y - self.across * x) / square,
        ]
    }
}

/// Start of an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    pub(super) orientation: ExteriorOrientation,
    pub(super) similarity: Similarity,
}

/// Returns the start of an exposure.
///
/// # Errors
/// [`InputError`] for fewer than four points, for points on a line, and for one that is far from
/// its place: a coordinate that is wrong by a decimal.
pub(super) fn start(
    rig: &Rig,
    measurements: &Measurements,
    exposure: &str,
) -> Result<Start, InputError> {
    let file = &measurements.control_file;
    let mut distinct: Vec<&ControlPoint> = Vec::new();
    let of_exposure = measurements
        .control
        .iter()
        .filter(|point| point.exposure == exposure);
    let control: Vec<&ControlPoint> = of_exposure.collect();
    for point in &control {
        if distinct.iter().all(|other| other.id != point.id) {
            distinct.push(point);
        }
    }
    if distinct.len() < LEAST_CONTROL {
        return Err(InputError::invalid(format!(
            "{file}: {} control points in exposure {exposure}; its orientation needs at least {LEAST_CONTROL}",
            distinct.len()
        )));
    }
    let places: Vec<[f64; 2]> = control
        .iter()
        .filter_map(|point| nominal(rig, point))
        .collect();
    let failed = || {
        InputError::invalid(format!(
            "{file}: the control points of exposure {exposure} determine no orientation: they lie on a line, or most of them are wrong"
        ))
    };
    let grounds_m: Vec<[f64; 3]> = control.iter().map(|point| point.ground_m).collect();
    let similarity = similarity(&places, &grounds_m).ok_or_else(failed)?;
    let orientation = orientation(rig, &control, &places, similarity).ok_or_else(failed)?;
    check_places(rig, file, &control, &places, &orientation)?;
    Ok(Start {
        orientation,
        similarity,
    })
}

/// Returns the nominal place of a control point, px about the principal point, x right and y up.
fn nominal(rig: &Rig, point: &ControlPoint) -> Option<[f64; 2]> {
    let sub = rig.sub.get(point.place.sub)?;
    let place = sub
        .nominal(rig.frame)
        .value(normalised(sub.size_px(), point.place.pixel));
    let [u, v] = rig.frame.centre_px();
    Some([place[0] - u, v - place[1]])
}

/// Fits a similarity from places, px about the principal point, to X, Y of the ground, with weights
/// that fall with the residual; `None` where the points do not determine it.
pub(crate) fn similarity(places: &[[f64; 2]], grounds_m: &[[f64; 3]]) -> Option<Similarity> {
    let mut weights = vec![1.0; places.len()];
    let mut found = None;
    for _ in 0..ROUNDS {
        let (mut normals, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for ((ground_m, [x, y]), weight) in grounds_m.iter().zip(places).zip(&weights) {
            let rows = [
                Vector4::new(*x, -y, 1.0, 0.0),
                Vector4::new(*y, *x, 0.0, 1.0),
            ];
            for (row, ground) in rows.into_iter().zip(ground_m) {
                normals += *weight * row * row.transpose();
                right += *weight * *ground * row;
            }
        }
        let solution = normals.try_inverse().map(|inverse| inverse * right)?;
        let [[along, across, x0, y0]] = solution.data.0;
        let fit = Similarity {
            along,
            across,
            shift_m: [x0, y0],
        };
        if fit.scale() <= 0.0 || !fit.scale().is_finite() {
            return None;
        }
        for ((ground_m, [x, y]), weight) in grounds_m.iter().zip(places).zip(&mut weights) {
            let [ground_x, ground_y, _] = *ground_m;
            let [at_x, at_y] = fit.place_px([ground_x, ground_y]);
            *weight = 1.0 / (at_x - x).hypot(at_y - y).max(1.0);
        }
        found = Some(fit);
    }
    found
}

impl Similarity {
    /// Returns the orientation of a camera that looks straight down on ground of a height.
    pub(crate) fn level(&self, f_px: f64, height_m: f64) -> ExteriorOrientation {
        ExteriorOrientation {
            position_m: [
                self.shift_m[0],
                self.shift_m[1],
                height_m + self.scale() * f_px,
            ],
            attitude: [0.0, 0.0, self.across.atan2(self.along)],
        }
    }
}

/// Resects an exposure with weights that fall with the residual.
fn orientation(
    rig: &Rig,
    control: &[&ControlPoint],
    places: &[[f64; 2]],
    similarity: Similarity,
) -> Option<ExteriorOrientation> {
    let f_px = rig.principal_distance_px();
    let heights = control.iter().map(|point| point.ground_m[2]).collect();
    let mut orientation = similarity.level(f_px, median(heights)?);
    for _ in 0..ROUNDS {
        let (mut normals, mut right) = (Matrix6::zeros(), Vector6::zeros());
        for (point, place) in control.iter().zip(places) {
            let Some(seen) = projection(&orientation, f_px, point.ground_m) else {
                continue;
            };
            let residual = Vector2::from(*place) - seen.image_mm;
            let weight = 1.0 / residual.norm().max(1.0);
            normals += weight * seen.by_orientation.transpose() * seen.by_orientation;
            right += weight * seen.by_orientation.transpose() * residual;
        }
        // Metres and radians differ by the height.
        let inverse = normals
            .diagonal()
            .map(|value| 1.0 / value.max(f64::MIN_POSITIVE).sqrt());
        let scaled = normals.component_mul(&(inverse * inverse.transpose()));
        let way = scaled
            .cholesky()?
            .solve(&right.component_mul(&inverse))
            .component_mul(&inverse);
        orientation = ExteriorOrientation::from_elements(&(orientation.elements() + way));
    }
    orientation
        .elements()
        .iter()
        .all(|value| value.is_finite())
        .then_some(orientation)
}

fn check_places(
    rig: &Rig,
    file: &str,
    control: &[&ControlPoint],
    places: &[[f64; 2]],
    orientation: &ExteriorOrientation,
) -> Result<(), InputError> {
    let f_px = rig.principal_distance_px();
    let distances: Vec<f64> = control
        .iter()
        .zip(places)
        .map(|(point, place)| {
            projection(orientation, f_px, point.ground_m).map_or(f64::INFINITY, |seen| {
                (Vector2::from(*place) - seen.image_mm).norm()
            })
        })
        .collect();
    let allowed = WRONG_PX.max(WRONG_MEDIANS * median(distances.clone()).unwrap_or(0.0));
    let worst = control
        .iter()
        .zip(&distances)
        .max_by(|a, b| a.1.total_cmp(b.1));
    let Some((point, distance)) = worst.filter(|(_, distance)| **distance > allowed) else {
        return Ok(());
    };
    let [x, y, z] = point.ground_m;
    let wrong = distances
        .iter()
        .filter(|distance| **distance > allowed)
        .count();
    Err(InputError::invalid(format!(
        "{file}, line {}: point {} lies {distance:.0} px from where the other {} control points have it; allowed: {allowed:.0} px",
        point.line,
        point.id,
        control.len() - wrong
    ))
    .with_help(format!(
        "one of x_m,y_m,z_m = {x}, {y}, {z} or of its image coordinates may be wrong by a decimal, or the point is another one; {:.0} points are as far off",
        real(wrong)
    )))
}
