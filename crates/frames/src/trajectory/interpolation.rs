//! Place and attitude between samples.

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use map_3d::Ellipsoid;
use nalgebra::{UnitQuaternion, Vector3};

use super::heading::Coordinates;
use super::image_orientation::{GeographicPlace, ImageOrientation, Place};
use super::rotation::{attitude, ground_from_body};
use super::sample::{OrientationSigma, Sample, each};

/// Samples to either side of an instant through which the polynomial goes.
const NEAR: usize = 2;

/// Samples to either side that it and its σ are found from.
pub(super) const FAR: usize = 3;

/// Step with which rates of angles are formed, s.
const STEP_S: f64 = 1e-4;

/// Returns the orientation at `time_s` between samples `before` and `before + 1` of a stretch
/// without gaps; `None` if it has fewer than three samples.
///
/// # Model
/// The cubic through the four nearest samples: of the places, as metres east, north and up of the
/// sample before, and of the attitudes, as rotation vectors from the sample before, so that no
/// angle turns over. Its σ is its distance from the polynomials through one sample more, before and
/// after: their quadratic mean. At the ends of a stretch the samples are those that there are.
///
/// A centroid time with `time_sigma_s` adds velocity and rate times that σ.
pub(super) fn at(
    samples: &[Sample],
    before: usize,
    coordinates: Coordinates,
    time_s: f64,
    time_sigma_s: f64,
) -> Option<ImageOrientation> {
    let base = samples.get(before)?;
    let near = match around(samples.len(), before) {
        // All there are: its error is that of a straight line.
        near if near.len() == samples.len() => before..before + 2,
        near => near,
    };
    let more = [
        near.start
            .checked_sub(1)
            .and_then(|start| samples.get(start..near.end)),
        samples.get(near.start..near.end + 1),
    ];
    let through = |samples| Curve::through(samples, base, coordinates, time_s);
    let near = through(samples.get(near)?);
    let more: Vec<Curve> = more.into_iter().flatten().map(through).collect();
    if more.is_empty() {
        return None;
    }
    let turned = |rotation: Vector3<f64>| {
        attitude(&(ground_from_body(&base.attitude) * UnitQuaternion::from_scaled_axis(rotation)))
    };
    let angles = turned(near.rotation);
    let change = |other: Vector3<f64>| turned(other).angles_from(&angles);
    let rates = change(near.rotation + near.rotation_rate * STEP_S).map(|angle| angle / STEP_S);
    let by_time = |rate: [f64; 3]| rate.map(|rate| rate.abs() * time_sigma_s);
    let velocity_m_s = near.velocity.into();
    Some(ImageOrientation {
        place: place(base, coordinates, near.offset.into()),
        attitude: angles,
        velocity_m_s,
        trajectory_sigma: sigma(samples, before, time_s),
        time_sigma: OrientationSigma {
            position_m: by_time(velocity_m_s),
            angles_rad: by_time(rates),
        },
        interpolation_sigma: OrientationSigma {
            position_m: mean_of(&more, |more| (more.offset - near.offset).into()),
            angles_rad: mean_of(&more, |more| change(more.rotation)),
        },
    })
}

/// Returns the places of up to [`NEAR`] samples to either side of the interval after `before`.
fn around(length: usize, before: usize) -> Range<usize> {
    (before + 1).saturating_sub(NEAR)..(before + 1 + NEAR).min(length)
}

/// Returns the quadratic means of changes.
fn mean_of(curves: &[Curve], change: impl Fn(&Curve) -> [f64; 3]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for curve in curves {
        sums = each(sums, change(curve), f64::hypot);
    }
    let scale = if curves.len() > 1 { FRAC_1_SQRT_2 } else { 1.0 };
    sums.map(|sum| sum * scale)
}

/// Value and slope of a polynomial through samples.
struct Curve {
    offset: Vector3<f64>,
    velocity: Vector3<f64>,
    rotation: Vector3<f64>,
    rotation_rate: Vector3<f64>,
}

impl Curve {
    fn through(samples: &[Sample], base: &Sample, coordinates: Coordinates, time_s: f64) -> Self {
        let mut curve = Self {
            offset: Vector3::zeros(),
            velocity: Vector3::zeros(),
            rotation: Vector3::zeros(),
            rotation_rate: Vector3::zeros(),
        };
        let body_from_ground = ground_from_body(&base.attitude).inverse();
        for (index, sample) in samples.iter().enumerate() {
            let [value, slope] = weight(samples, index, time_s);
            let offset = Vector3::from(offset(base, sample, coordinates));
            let rotation = body_from_ground * ground_from_body(&sample.attitude);
            let rotation = rotation.scaled_axis();
            curve.offset += offset * value;
            curve.velocity += offset * slope;
            curve.rotation += rotation * value;
            curve.rotation_rate += rotation * slope;
        }
        curve
    }
}

/// Returns the weight of a sample in Lagrange's polynomial, and in its derivative, 1/s.
fn weight(samples: &[Sample], index: usize, time_s: f64) -> [f64; 2] {
    let own = samples.get(index).map_or(0.0, |sample| sample.time_s);
    let others = samples
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != index);
    others.fold([1.0, 0.0], |[value, slope], (_, other)| {
        let scale = 1.0 / (own - other.time_s);
        let factor = (time_s - other.time_s) * scale;
        [value * factor, slope * factor + value * scale]
    })
}

/// Returns the place of a sample from that of another, m: east, north and up, or x, y and z.
fn offset(base: &Sample, sample: &Sample, coordinates: Coordinates) -> [f64; 3] {
    match coordinates {
        Coordinates::Cartesian => each(sample.place, base.place, |a, b| a - b),
        Coordinates::Geographic => {
            let ([latitude, longitude, height], [latitude0, longitude0, height0]) =
                (sample.place, base.place);
            let (east, north, up) = map_3d::geodetic2enu(
                latitude,
                longitude,
                height,
                latitude0,
                longitude0,
                height0,
                Ellipsoid::WGS84,
            );
            [east, north, up]
        }
    }
}

/// Returns the place at an offset from that of a sample.
fn place(base: &Sample, coordinates: Coordinates, offset: [f64; 3]) -> Place {
    match coordinates {
        Coordinates::Cartesian => Place::Cartesian(each(base.place, offset, |a, b| a + b)),
        Coordinates::Geographic => {
            let ([east, north, up], [latitude0, longitude0, height0]) = (offset, base.place);
            let (latitude_rad, longitude_rad, height_m) = map_3d::enu2geodetic(
                east,
                north,
                up,
                latitude0,
                longitude0,
                height0,
                Ellipsoid::WGS84,
            );
            Place::Geographic(GeographicPlace {
                latitude_rad,
                longitude_rad,
                height_m,
            })
        }
    }
}

/// Returns σ of the trajectory between two samples: they err alike, so that it is no smaller
/// between them.
fn sigma(samples: &[Sample], before: usize, time_s: f64) -> Option<OrientationSigma> {
    let (first, second) = (samples.get(before)?, samples.get(before + 1)?);
    let share = (time_s - first.time_s) / (second.time_s - first.time_s);
    Some(first.sigma?.towards(&second.sigma?, share))
}
