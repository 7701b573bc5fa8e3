//! Bundle adjustment of a pair.

use fmc_adjustment::bundle::image::NetworkImage;
use fmc_adjustment::bundle::interior::Interior;
use fmc_adjustment::bundle::network::{ImagePoint, Network, ObjectPoint, PointRole};
use fmc_adjustment::bundle::parameters::SharedValues;
use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::solution::{self, DatumChoice};
use fmc_adjustment::bundle::state::State;
use fmc_adjustment::collinearity::ground_at_height;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_camera_file::InputError;
use nalgebra::Vector3;

use super::layout::Layout;
use crate::number::{median, rms};
use crate::rig::start::similarity;

/// Least number of control points.
const LEAST_CONTROL: usize = 4;

/// A point in both images.
#[derive(Debug, Clone, PartialEq)]
pub struct StereoPoint {
    /// Name.
    pub id: String,
    /// Places in the first and the second image, px from the principal point, x right and y up.
    pub places_px: [[f64; 2]; 2],
    /// Ground coordinates of a mark, m; `None` of a tie.
    pub ground_m: Option<[f64; 3]>,
}

/// Choices of an adjustment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoRequest {
    /// Principal distance of the virtual images, px.
    pub principal_distance_px: f64,
    /// σ of an image coordinate, px.
    pub sigma_px: f64,
    /// σ of a coordinate of control, m.
    pub control_sigma_m: f64,
    /// Choice of the marks that are control.
    pub layout: Layout,
}

/// An adjusted pair.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct StereoResult {
    /// Control points.
    pub control: usize,
    /// Check points.
    pub check: usize,
    /// Ties.
    pub ties: usize,
    /// Root mean square at control, X, Y, Z, m: a residual, no accuracy.
    pub control_m: [f64; 3],
    /// Root mean square at check points, X, Y, Z, m; `None` without any.
    pub check_m: Option<[f64; 3]>,
    /// σ0.
    pub sigma0: f64,
    /// Base over height.
    pub base_over_height: f64,
}

impl StereoResult {
    /// Root mean square at check points in the plane, m: √(X² + Y²).
    #[must_use]
    pub fn check_plane_m(&self) -> Option<f64> {
        self.check_m.map(|[x, y, _]| x.hypot(y))
    }
}

/// Adjusts a pair of virtual images, whose interior orientation is held.
///
/// # Errors
/// [`InputError`] for fewer than four control points, for a datum that they do not determine, and
/// for an adjustment that does not converge.
pub fn adjust(points: &[StereoPoint], request: &StereoRequest) -> Result<StereoResult, InputError> {
    let marks: Vec<&StereoPoint> = points
        .iter()
        .filter(|point| point.ground_m.is_some())
        .collect();
    let grounds_m: Vec<[f64; 3]> = marks.iter().filter_map(|mark| mark.ground_m).collect();
    let is_control = request.layout.control(
        &grounds_m
            .iter()
            .map(|[x, y, _]| [*x, *y])
            .collect::<Vec<_>>(),
    );
    let control = is_control.iter().filter(|control| **control).count();
    if control < LEAST_CONTROL {
        return Err(InputError::invalid(format!(
            "stereo: {control} marks are seen in both images; at least {LEAST_CONTROL} control points are needed"
        )));
    }
    let network = network(points, &grounds_m, &is_control, request)?;
    let state = State::initial(&network);
    let solved = solution::adjust(&network, DatumChoice::Held, &state)
        .map_err(|error| InputError::invalid(format!("stereo: {error}")))?;
    let mut of_kind = [
        [Vec::new(), Vec::new(), Vec::new()],
        [Vec::new(), Vec::new(), Vec::new()],
    ];
    for ((object, found), of_control) in network
        .points
        .iter()
        .zip(&solved.state.points_m)
        .zip(&is_control)
    {
        let [control, check] = &mut of_kind;
        let lists = if *of_control { control } else { check };
        for (list, way) in lists.iter_mut().zip((found - object.given_m).iter()) {
            list.push(*way);
        }
    }
    let [control_ways, check_ways] = of_kind;
    let roots = |ways: [Vec<f64>; 3]| ways.map(|list| rms(list).unwrap_or(0.0));
    let check = is_control.len() - control;
    let poses = &solved.state.poses;
    let base = match poses.as_slice() {
        [first, second] => (first.position_m - second.position_m).norm(),
        _ => 0.0,
    };
    let ground = median(grounds_m.iter().map(|ground| ground[2]).collect()).unwrap_or(0.0);
    let height = poses.first().map_or(1.0, |pose| pose.position_m.z - ground);
    Ok(StereoResult {
        control,
        check,
        ties: points.len() - marks.len(),
        control_m: roots(control_ways),
        check_m: (check > 0).then(|| roots(check_ways)),
        sigma0: solved.sigma0(),
        base_over_height: base / height,
    })
}

/// Makes the network: marks first, then ties.
fn network(
    points: &[StereoPoint],
    grounds_m: &[[f64; 3]],
    is_control: &[bool],
    request: &StereoRequest,
) -> Result<Network, InputError> {
    let f_px = request.principal_distance_px;
    let ground = median(grounds_m.iter().map(|ground| ground[2]).collect()).unwrap_or(0.0);
    let marks: Vec<&StereoPoint> = points
        .iter()
        .filter(|point| point.ground_m.is_some())
        .collect();
    let mut images = Vec::new();
    let mut first_orientation: Option<ExteriorOrientation> = None;
    for number in 0..2 {
        let places: Vec<[f64; 2]> = marks
            .iter()
            .filter_map(|mark| mark.places_px.get(number).copied())
            .collect();
        let start = similarity(&places, grounds_m).ok_or_else(|| {
            InputError::invalid("stereo: the marks determine no orientation: they lie on a line")
        })?;
        let orientation = start.level(f_px, ground);
        first_orientation.get_or_insert(orientation);
        images.push(NetworkImage {
            name: format!("image {}", number + 1),
            pose: Pose::from(orientation),
            observed: None,
            stage: None,
        });
    }
    let ties = points.iter().filter(|point| point.ground_m.is_none());
    let mut objects = Vec::new();
    for (mark, control) in marks.iter().zip(is_control) {
        objects.push(ObjectPoint {
            name: mark.id.clone(),
            given_m: Vector3::from(mark.ground_m.unwrap_or_default()),
            sigmas_m: [Some(request.control_sigma_m); 3],
            role: if *control {
                PointRole::Control
            } else {
                PointRole::Check
            },
        });
    }
    for tie in ties.clone() {
        let [place, _] = tie.places_px;
        let at = first_orientation
            .and_then(|orientation| ground_at_height(&orientation, f_px, place, ground));
        let [x, y] = at.unwrap_or_default();
        objects.push(ObjectPoint {
            name: tie.id.clone(),
            given_m: Vector3::new(x, y, ground),
            sigmas_m: [None; 3],
            role: PointRole::Tie,
        });
    }
    let mut image_points = Vec::new();
    for (point, of) in marks.iter().copied().chain(ties).enumerate() {
        for (image, place) in of.places_px.into_iter().enumerate() {
            image_points.push(ImagePoint {
                image,
                point,
                measured_mm: place,
                by_grids_mm: [0.0; 2],
                sigma_mm: request.sigma_px,
                additional: None,
                accepted: true,
            });
        }
    }
    // A pixel takes the part of a millimetre: the equations know ratios only.
    let interior = Interior {
        principal_distance_mm: f_px,
        principal_point_mm: [0.0; 2],
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    };
    Ok(Network {
        images,
        points: objects,
        image_points,
        additional: Vec::new(),
        scale_bars: Vec::new(),
        strips: Vec::new(),
        parameters: SharedValues::new(interior, 0),
        estimated: Vec::new(),
        priors: Vec::new(),
    })
}
