//! The stereo check over many repetitions with other errors.

use fmc_adjustment::collinearity::image_point;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_camera_file::InputError;
use fmc_simulation::noise::Noise;

use super::adjustment::{StereoPoint, StereoRequest, StereoResult, adjust};
use crate::number::real;
use crate::rig::Rig;

/// Part of the format by which the images of a pair overlap.
const OVERLAP: f64 = 0.6;
/// Marks along the shorter and the longer side of the overlap.
const MARKS: [usize; 2] = [5, 8];
/// Ties along either side.
const TIES: [usize; 2] = [10, 12];
/// Part of the overlap that the points leave free at each edge.
const EDGE: f64 = 0.05;
/// Tilt of the exposures (standard deviation), rad, and of the heights, m per m of height.
const TILT_RAD: f64 = 0.01;
const RELIEF: f64 = 0.003;
/// Quantile of the normal distribution for an interval of 95 %.
const NORMAL_95: f64 = 1.96;

/// Side of the format along which the base lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseAlong {
    /// Rows: the longer side of the DMZ camera, B/H 0.40.
    Height,
    /// Columns: B/H 0.34.
    Width,
}

/// Results of many repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct Repetitions {
    /// One result each.
    pub results: Vec<StereoResult>,
}

impl Repetitions {
    /// Root mean square, and half of its interval of 95 %, of a number of each repetition; `None`
    /// where one has none, or with fewer than two.
    #[must_use]
    pub fn root_mean_square(
        &self,
        number: impl Fn(&StereoResult) -> Option<f64>,
    ) -> Option<[f64; 2]> {
        let squares: Vec<f64> = self
            .results
            .iter()
            .map(|result| number(result).map(|value| value * value))
            .collect::<Option<_>>()?;
        if squares.len() < 2 {
            return None;
        }
        let count = real(squares.len());
        let mean = squares.iter().sum::<f64>() / count;
        let sum: f64 = squares.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (sum / (count - 1.0)).sqrt();
        let root = mean.sqrt();
        // The derivative of a root is half of its inverse.
        let half = NORMAL_95 * deviation / count.sqrt() / (2.0 * root.max(f64::MIN_POSITIVE));
        Some([root, half])
    }
}

/// Adjusts so many pairs of a rig's virtual images at a height above ground: 40 marks on 5 x 8, 120
/// ties, with errors of image points and control of their own each.
///
/// # Errors
/// That of an adjustment.
pub fn repeated(
    rig: &Rig,
    height_m: f64,
    base: BaseAlong,
    request: &StereoRequest,
    repetitions: usize,
    seed: u64,
) -> Result<Repetitions, InputError> {
    let results = (0..repetitions).map(|number| {
        let points = points(rig, height_m, base, request, seed, number as u64);
        adjust(&points, request)
    });
    Ok(Repetitions {
        results: results.collect::<Result<_, _>>()?,
    })
}

fn points(
    rig: &Rig,
    height_m: f64,
    base: BaseAlong,
    request: &StereoRequest,
    seed: u64,
    stream: u64,
) -> Vec<StereoPoint> {
    let mut noise = Noise::new(seed, stream);
    let f_px = request.principal_distance_px;
    let format_m =
        [rig.frame.width_px, rig.frame.height_px].map(|side| real(side) * height_m / f_px);
    let axis = match base {
        BaseAlong::Width => 0,
        BaseAlong::Height => 1,
    };
    let pick = |pair: [f64; 2], axis: usize| pair.get(axis).copied().unwrap_or_default();
    let base_m = (1.0 - OVERLAP) * pick(format_m, axis);
    let orientations = [-0.5, 0.5].map(|part| {
        let mut position_m = [0.0, 0.0, height_m];
        if let Some(slot) = position_m.get_mut(axis) {
            *slot = part * base_m;
        }
        ExteriorOrientation {
            position_m,
            attitude: noise.next([TILT_RAD; 3]),
        }
    });
    // Sides of the overlap, and of the grids over it: more points along the longer side.
    let mut sides = format_m;
    if let Some(side) = sides.get_mut(axis) {
        *side *= OVERLAP;
    }
    let grid = |counts: [usize; 2]| {
        if sides[0] > sides[1] {
            [counts[1], counts[0]]
        } else {
            counts
        }
    };
    let mut points = Vec::new();
    for (counts, is_mark) in [(grid(MARKS), true), (grid(TIES), false)] {
        for index in 0..counts[0] * counts[1] {
            let part = |number: usize, count: usize| {
                (EDGE + (1.0 - 2.0 * EDGE) * real(number) / real(count - 1)) - 0.5
            };
            let [z] = noise.next([RELIEF * height_m]);
            let ground = [
                part(index % counts[0], counts[0]) * sides[0],
                part(index / counts[0], counts[1]) * sides[1],
                z,
            ];
            let error_m = noise.next([request.control_sigma_m; 3]);
            let mut places_px = [[0.0; 2]; 2];
            let mut seen = true;
            for (place, orientation) in places_px.iter_mut().zip(&orientations) {
                let error = noise.next([request.sigma_px; 2]);
                match image_point(orientation, f_px, ground) {
                    Some([x, y]) => *place = [x + error[0], y + error[1]],
                    None => seen = false,
                }
            }
            if seen {
                points.push(StereoPoint {
                    id: format!("{}{index}", if is_mark { "M" } else { "T" }),
                    places_px,
                    ground_m: is_mark.then_some([
                        ground[0] + error_m[0],
                        ground[1] + error_m[1],
                        ground[2] + error_m[2],
                    ]),
                });
            }
        }
    }
    points
}
