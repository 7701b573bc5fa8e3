//! Observations made from the five-coefficient model, term by term as it is written, in double
//! precision.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::sensor::FmcAxis;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// Returns a wide-angle lens: 0.6 mm of distortion in the corner, every static term present.
pub(crate) fn lens(axis: FmcAxis) -> KnownLens<f64> {
    KnownLens {
        principal_point_mm: [0.0625, -0.03125],
        k: [1e-4, -1.6e-5, 6.2e-9, -1.3e-12],
        p: [2e-6, -4.5e-6],
        b: [3e-5, -2e-5],
        axis,
        radius_mm: 33.6,
    }
}

/// Returns the lens in single precision.
pub(crate) fn single_lens(axis: FmcAxis) -> KnownLens<f32> {
    let lens = lens(axis);
    KnownLens {
        principal_point_mm: lens.principal_point_mm.map(single),
        k: lens.k.map(single),
        p: lens.p.map(single),
        b: lens.b.map(single),
        axis,
        radius_mm: single(lens.radius_mm),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "the purpose")]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

/// Coefficients that a fit is to find: not the static K0..K2.
pub(crate) const TRUTH: [f64; 5] = [1.8e-4, -1.61e-5, 6.3e-9, 2.4e-5, 1.5e-5];

/// Returns the model's distortion at a point, mm; `k3`, P and B are those of the lens.
pub(crate) fn distortion(
    lens: &KnownLens<f64>,
    [km0, km1, km2, kd1, pm1]: [f64; 5],
    [x, y]: [f64; 2],
    regressor_mm: f64,
) -> [f64; 2] {
    let [x0, y0] = lens.principal_point_mm;
    let (x, y) = (x - x0, y - y0);
    let r2 = x * x + y * y;
    let [p1, p2] = lens.p;
    let [b1, b2] = lens.b;
    let radial = km0 + km1 * r2 + km2 * r2.powi(2) + lens.k[3] * r2.powi(3);
    let mut dx = x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y;
    let mut dy = y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y;
    match lens.axis {
        FmcAxis::PlusY => {
            dx += kd1 * regressor_mm * x * y;
            dy += kd1 * regressor_mm * y * y + pm1 * regressor_mm * r2;
        }
        FmcAxis::MinusY => {
            dx -= kd1 * regressor_mm * x * y;
            dy -= kd1 * regressor_mm * y * y + pm1 * regressor_mm * r2;
        }
        FmcAxis::PlusX => {
            dx += kd1 * regressor_mm * x * x + pm1 * regressor_mm * r2;
            dy += kd1 * regressor_mm * x * y;
        }
        FmcAxis::MinusX => {
            dx -= kd1 * regressor_mm * x * x + pm1 * regressor_mm * r2;
            dy -= kd1 * regressor_mm * x * y;
        }
    }
    [dx, dy]
}

/// Returns travels of 10 V/H and 6 exposure times behind 50 mm, mm.
pub(crate) fn travels() -> Vec<f64> {
    let exposures = [100.0, 175.0, 200.0, 300.0, 500.0, 700.0];
    (0..10)
        .flat_map(|step| {
            let vh = 0.05 + 0.12 * f64::from(step) / 9.0;
            exposures.map(|denominator| 50.0 * vh / denominator)
        })
        .collect()
}

/// Returns `steps` x `steps` points over 53.4 mm x 40 mm, in numbers that single precision holds.
pub(crate) fn grid(steps: i32) -> Vec<[f64; 2]> {
    let place = |index: i32, half: f64| {
        f64::from(single(
            half * (2.0 * f64::from(index) / f64::from(steps - 1) - 1.0),
        ))
    };
    (0..steps)
        .flat_map(|row| (0..steps).map(move |column| [place(column, 26.7), place(row, 20.0)]))
        .collect()
}

/// Returns an observation of every point of a grid at every travel, without noise.
pub(crate) fn observations(
    lens: &KnownLens<f64>,
    coefficients: [f64; 5],
    travels_mm: &[f64],
    steps: i32,
) -> Vec<Observation<f64>> {
    let points = grid(steps);
    travels_mm
        .iter()
        .map(|travel_mm| f64::from(single(*travel_mm)))
        .flat_map(|travel_mm| {
            points.iter().map(move |point| {
                let [dx_mm, dy_mm] = distortion(lens, coefficients, *point, travel_mm);
                Observation {
                    x_mm: point[0],
                    y_mm: point[1],
                    dx_mm,
                    dy_mm,
                    regressor_mm: travel_mm,
                    sigma_mm: 1e-3,
                }
            })
        })
        .collect()
}

pub(crate) fn rounded(observation: &Observation<f64>) -> Observation<f32> {
    Observation {
        x_mm: single(observation.x_mm),
        y_mm: single(observation.y_mm),
        dx_mm: single(observation.dx_mm),
        dy_mm: single(observation.dy_mm),
        regressor_mm: single(observation.regressor_mm),
        sigma_mm: single(observation.sigma_mm),
    }
}

/// Returns an adjustment of observations.
pub(crate) fn adjusted(
    lens: KnownLens<f64>,
    options: FitOptions,
    observations: &[Observation<f64>],
) -> Adjustment<f64> {
    let mut adjustment = Adjustment::new(lens, options);
    for observation in observations {
        adjustment.observe(*observation).unwrap();
    }
    adjustment
}

/// Generator of normally distributed numbers, the same for the same seed.
pub(crate) struct Noise(TestRng);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        Self(TestRng::from_seed(RngAlgorithm::ChaCha, &bytes))
    }

    /// Returns two numbers of standard deviation 1, by Box and Muller.
    pub(crate) fn pair(&mut self) -> [f64; 2] {
        let mut uniform = || (f64::from(self.0.next_u32()) + 0.5) / 4_294_967_296.0;
        let radius = (-2.0 * uniform().ln()).sqrt();
        let (sine, cosine) = (std::f64::consts::TAU * uniform()).sin_cos();
        [radius * cosine, radius * sine]
    }
}
