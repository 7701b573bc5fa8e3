//! Exposure mean of the distortion, by adaptive quadrature.

use fmc_camera_file::CameraFile;
use quadrature::double_exponential;

use super::exposure::{ExposurePath, ExposureRequest, FocusFormula};
use super::lens::Lens;
use super::residual_splines::ResidualSplines;

/// Weight of the mean over the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// Transmission: the mean that the sensor records.
    Exposure,
    /// Arc length of the distortion hodograph, as printed in Yuan et al. 2012, eqs. 10-11.
    ArcLength,
}

/// Reading of eqs. 12-13 of Yuan et al. 2012.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// As changes: static + (D(Δδ) - static) + (mean - D(Δδ)) = mean.
    Consistent,
    /// As the totals that eqs. 9-11 give: D(Δδ) + mean, which counts the static distortion twice.
    Literal,
}

/// Length of the hodograph, mm, below which the arc-length mean is replaced by the plain mean: the
/// two then differ by at most this length, 0.01 nm. (The arc-length mean is 0/0 where the
/// distortion does not change.)
pub const SHORTEST_ARC_MM: f64 = 1e-8;

/// Largest allowed error estimate of the strict solver itself, nm.
pub const MAX_SOLVER_ERROR_NM: f64 = 0.01;

/// Largest absolute error of the quadrature, mm.
const QUADRATURE_TARGET_MM: f64 = 1e-12;

/// A mean with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrictMean {
    /// Exposure mean of measured - ideal, mm.
    pub distortion_mm: [f64; 2],
    /// Estimate of the quadrature's error, mm.
    pub error_mm: f64,
}

/// The strict reference solver for one exposure.
#[derive(Debug, Clone)]
pub struct StrictSolver {
    lens: Lens,
    path: ExposurePath,
    axis: [f64; 2],
    principal_point_mm: [f64; 2],
    principal_distance_mm: f64,
    exit_pupil_mm: f64,
    flatness_um: Vec<f64>,
    focus_shift_mm: f64,
    focus_formula: FocusFormula,
    weight: Weight,
    splines: ResidualSplines,
}

impl StrictSolver {
    /// Creates the solver for one exposure of a camera.
    #[must_use]
    pub fn new(camera: &CameraFile, request: &ExposureRequest, weight: Weight) -> Self {
        Self {
            lens: Lens::of(camera),
            path: ExposurePath::new(camera, request),
            axis: camera.fmc.axis.unit(),
            principal_point_mm: camera.principal_point_mm,
            principal_distance_mm: camera.principal_distance_mm,
            exit_pupil_mm: camera.exit_pupil_mm(),
            flatness_um: camera.fmc.flatness_um.clone(),
            focus_shift_mm: request.focus_shift_mm,
            focus_formula: request.focus_formula,
            weight,
            splines: ResidualSplines::default(),
        }
    }

    /// Adds the residual grids of the camera: that of the lens at ((x, y) - c·e)/(1+κ) of every
    /// instant, that of the sensor at (x, y).
    #[must_use]
    pub fn with_splines(self, splines: ResidualSplines) -> Self {
        Self { splines, ..self }
    }

    /// Path of the principal point.
    #[must_use]
    pub const fn path(&self) -> &ExposurePath {
        &self.path
    }

    /// Returns the distortion of a measured point, averaged over the exposure.
    ///
    /// # Model
    /// `∫ D(x̄, ȳ - c) w(c) dc / ∫ w(c) dc` over c in [Δδ, Δδ+δ] (Yuan et al. 2012, eqs. 9-13 in
    /// the consistent reading), with the focus shift of every instant.
    ///
    /// # Units and frames
    /// Sensor frame, mm; measured - ideal.
    ///
    /// # Accuracy
    /// [`StrictMean::error_mm`], at most 0.01 nm over the published cameras
    /// ([`MAX_SOLVER_ERROR_NM`]).
    #[must_use]
    pub fn mean(&self, point_mm: [f64; 2]) -> StrictMean {
        let moving = match self.weight {
            Weight::Exposure => self.exposure_mean(point_mm),
            Weight::ArcLength => self.arc_length_mean(point_mm),
        };
        StrictMean {
            distortion_mm: sum(moving.distortion_mm, self.splines.of_sensor(point_mm)),
            ..moving
        }
    }

    /// Returns the total distortion in the given reading of eqs. 12-13.
    #[must_use]
    pub fn total(&self, point_mm: [f64; 2], reading: Reading) -> StrictMean {
        let mean = self.mean(point_mm);
        match reading {
            Reading::Consistent => mean,
            Reading::Literal => {
                let opening = self.distortion(point_mm, 0.0);
                StrictMean {
                    distortion_mm: sum(opening, mean.distortion_mm),
                    ..mean
                }
            }
        }
    }

    /// Returns the distortion at the fraction `u` of the exposure, mm.
    #[must_use]
    pub fn distortion(&self, point_mm: [f64; 2], u: f64) -> [f64; 2] {
        sum(
            self.moving_distortion(point_mm, u),
            self.splines.of_sensor(point_mm),
        )
    }

    /// Returns the part of [`Self::distortion`] that moves with the principal point.
    fn moving_distortion(&self, point_mm: [f64; 2], u: f64) -> [f64; 2] {
        let (lens, kappa) = self.lens_at(u);
        let [x, y] = self.about_principal_point(point_mm, u);
        let shrink = 1.0 / (1.0 + kappa);
        let [dx, dy] = lens.displacement([x * shrink, y * shrink]);
        sum(
            [kappa * x * shrink + dx, kappa * y * shrink + dy],
            self.splines.of_lens(self.in_lens_frame(point_mm, u)),
        )
    }

    /// Returns the place of a measured point in the frame of the lens's grid at the fraction `u`.
    fn in_lens_frame(&self, [x, y]: [f64; 2], u: f64) -> [f64; 2] {
        let [ex, ey] = self.axis;
        let offset = self.path.offset_mm(u);
        let shift_mm = self.focus_shift_mm + self.run_out_mm(offset);
        let kappa = match self.focus_formula {
            FocusFormula::Physical => shift_mm / self.exit_pupil_mm,
            FocusFormula::Printed => -shift_mm / self.principal_distance_mm,
        };
        [
            (x - offset * ex) / (1.0 + kappa),
            (y - offset * ey) / (1.0 + kappa),
        ]
    }

    fn about_principal_point(&self, [x, y]: [f64; 2], u: f64) -> [f64; 2] {
        let [x0, y0] = self.principal_point_mm;
        let [ex, ey] = self.axis;
        let offset = self.path.offset_mm(u);
        [x - x0 - offset * ex, y - y0 - offset * ey]
    }

    /// Returns the lens at the focus of the fraction `u`, and the physical enlargement κ beside it.
    fn lens_at(&self, u: f64) -> (Lens, f64) {
        let shift_mm = self.focus_shift_mm + self.run_out_mm(self.path.offset_mm(u));
        match self.focus_formula {
            FocusFormula::Physical => (self.lens, shift_mm / self.exit_pupil_mm),
            FocusFormula::Printed => {
                let relative = shift_mm / self.principal_distance_mm;
                let [k0, k1, k2, k3] = self.lens.k.map(|k| k * (1.0 + relative));
                let lens = Lens {
                    k: [k0 - relative, k1, k2, k3],
                    ..self.lens
                };
                (lens, 0.0)
            }
        }
    }

    fn run_out_mm(&self, position_mm: f64) -> f64 {
        let polynomial_um = self
            .flatness_um
            .iter()
            .rev()
            .fold(0.0, |sum, coefficient| sum * position_mm + coefficient);
        polynomial_um / 1000.0
    }

    /// Returns the mean weighted by the transmission. It averages the difference from the
    /// distortion in the middle of the exposure, which is small, so that little is lost to
    /// rounding.
    fn exposure_mean(&self, point_mm: [f64; 2]) -> StrictMean {
        let middle = self.moving_distortion(point_mm, 0.5);
        let light = self.integral(|u| self.path.transmission(u));
        let part = |component: fn([f64; 2]) -> f64| {
            self.integral(|u| {
                let change = component(self.moving_distortion(point_mm, u)) - component(middle);
                change * self.path.transmission(u)
            })
        };
        mean_about(middle, [part(first), part(second)], light)
    }

    fn arc_length_mean(&self, point_mm: [f64; 2]) -> StrictMean {
        let arc = self.integral(|u| self.hodograph_speed(point_mm, u));
        if arc.value < SHORTEST_ARC_MM {
            let plain = self.exposure_mean(point_mm);
            return StrictMean {
                error_mm: plain.error_mm + arc.value,
                ..plain
            };
        }
        let middle = self.moving_distortion(point_mm, 0.5);
        let length = Integral {
            value: 1.0,
            error: arc.error / arc.value,
        };
        let part = |component: fn([f64; 2]) -> f64| {
            self.integral(|u| {
                let change = component(self.moving_distortion(point_mm, u)) - component(middle);
                change * self.hodograph_speed(point_mm, u) / arc.value
            })
        };
        mean_about(middle, [part(first), part(second)], length)
    }

    /// Returns `|dD/du|`, mm: the speed along the distortion hodograph, from the motion of the
    /// principal point and from the run-out.
    fn hodograph_speed(&self, point_mm: [f64; 2], u: f64) -> f64 {
        let (lens, kappa) = self.lens_at(u);
        let [x, y] = self.about_principal_point(point_mm, u);
        let [ex, ey] = self.axis;
        let shrink = 1.0 / (1.0 + kappa);
        let at = [x * shrink, y * shrink];
        let [along_x, along_y] = lens.derivative(at, self.axis);
        let by_motion = [
            -shrink * (kappa * ex + along_x) * self.path.travel_mm,
            -shrink * (kappa * ey + along_y) * self.path.travel_mm,
        ];
        let slope = self.run_out_slope(self.path.offset_mm(u)) * self.path.travel_mm;
        let by_run_out = match self.focus_formula {
            FocusFormula::Physical => {
                let [radial_x, radial_y] = lens.derivative(at, [x, y]);
                let enlarging = slope / self.exit_pupil_mm * shrink * shrink;
                [enlarging * (x - radial_x), enlarging * (y - radial_y)]
            }
            FocusFormula::Printed => {
                let radial = Lens {
                    p: [0.0, 0.0],
                    b: [0.0, 0.0],
                    ..self.lens
                };
                let [radial_x, radial_y] = radial.displacement([x, y]);
                let relative = slope / self.principal_distance_mm;
                [relative * (radial_x - x), relative * (radial_y - y)]
            }
        };
        let [dx, dy] = sum(sum(by_motion, by_run_out), self.spline_speed(point_mm, u));
        dx.hypot(dy)
    }

    /// Returns the speed of the lens's grid along the exposure, mm, by a central difference: exact
    /// for a cubic but for a third derivative of the step's square.
    fn spline_speed(&self, point_mm: [f64; 2], u: f64) -> [f64; 2] {
        const STEP: f64 = 1e-4;
        let at = |u| self.splines.of_lens(self.in_lens_frame(point_mm, u));
        let ([x0, y0], [x1, y1]) = (at(u - STEP), at(u + STEP));
        [(x1 - x0) / (2.0 * STEP), (y1 - y0) / (2.0 * STEP)]
    }

    /// Returns dz/ds of the run-out, mm per mm.
    fn run_out_slope(&self, position_mm: f64) -> f64 {
        let mut power = 0.0;
        let mut slope_um = 0.0;
        let mut position_to_power = 1.0;
        for coefficient in self.flatness_um.iter().skip(1) {
            power += 1.0;
            slope_um += power * coefficient * position_to_power;
            position_to_power *= position_mm;
        }
        slope_um / 1000.0
    }

    /// Returns the integral over the exposure, stretch by stretch.
    fn integral(&self, integrand: impl Fn(f64) -> f64) -> Integral {
        let [a, b, c, d] = self.path.nodes();
        let mut integral = Integral {
            value: 0.0,
            error: 0.0,
        };
        for (from, to) in [(a, b), (b, c), (c, d)] {
            if to > from {
                let found =
                    double_exponential::integrate(&integrand, from, to, QUADRATURE_TARGET_MM);
                integral.value += found.integral;
                integral.error += found.error_estimate;
            }
        }
        integral
    }
}

/// An integral with the estimate of its error.
#[derive(Debug, Clone, Copy)]
struct Integral {
    value: f64,
    error: f64,
}

/// Returns `middle + parts/weight` with the propagated error.
fn mean_about(middle: [f64; 2], parts: [Integral; 2], weight: Integral) -> StrictMean {
    let [x, y] = parts.map(|part| part.value / weight.value);
    let [error_x, error_y] = parts
        .map(|part| (part.error + (part.value / weight.value).abs() * weight.error) / weight.value);
    StrictMean {
        distortion_mm: sum(middle, [x, y]),
        error_mm: error_x.max(error_y),
    }
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

const fn first([x, _]: [f64; 2]) -> f64 {
    x
}

const fn second([_, y]: [f64; 2]) -> f64 {
    y
}
