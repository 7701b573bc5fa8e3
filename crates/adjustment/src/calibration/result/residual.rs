//! Residuals of a calibration with their tests.

use std::sync::Arc;

/// Non-centrality for which an error is found with a probability of 80 % by a test at 0.1 %
/// (Baarda 1968).
pub const NON_CENTRALITY: f64 = 4.13;

/// Redundancy number below which an observation is not controlled by others.
pub const LEAST_REDUNDANCY_NUMBER: f64 = 1e-9;

/// A residual, its standard deviation and its test, in the unit of the observation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TestedResidual {
    /// v: corrected observation less its value from the adjusted unknowns.
    pub residual: f64,
    /// σ of the observation as given, or the unit σ.
    pub sigma: f64,
    /// r: the share of an error of this observation that its own residual shows; 0 to 1.
    pub redundancy: f64,
    /// |v|/(σ0·σ·√r), Pope's τ; 0 for an observation without control.
    pub test_value: f64,
}

impl TestedResidual {
    /// Creates a residual with its test.
    #[must_use]
    pub fn new(residual: f64, sigma: f64, redundancy: f64, sigma0: f64) -> Self {
        let deviation = sigma0 * sigma * redundancy.max(0.0).sqrt();
        let is_controlled = redundancy > LEAST_REDUNDANCY_NUMBER && deviation > 0.0;
        Self {
            residual,
            sigma,
            redundancy,
            test_value: if is_controlled {
                residual.abs() / deviation
            } else {
                0.0
            },
        }
    }

    /// Smallest error of the observation that its test finds: 4.13·σ/√r, in the unit of the
    /// observation; `None` for an observation without control.
    #[must_use]
    pub fn smallest_detectable(&self) -> Option<f64> {
        (self.redundancy > LEAST_REDUNDANCY_NUMBER)
            .then(|| NON_CENTRALITY * self.sigma / self.redundancy.sqrt())
    }
}

/// Residuals of an image point.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageResidual {
    /// Line in the file of image points.
    pub line: u64,
    /// Image.
    pub image: Arc<str>,
    /// Object point.
    pub point: Arc<str>,
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// x and y in the sensor frame, mm.
    pub components: [TestedResidual; 2],
    /// `true` if it was rejected as a gross error: it is then not part of the adjustment.
    pub is_rejected: bool,
}

impl ImageResidual {
    /// Returns the residual vector in the sensor frame, mm.
    #[must_use]
    pub fn vector_mm(&self) -> [f64; 2] {
        self.components.map(|one| one.residual)
    }

    /// Returns the larger of the test values.
    #[must_use]
    pub fn test_value(&self) -> f64 {
        let [x, y] = self.components;
        x.test_value.max(y.test_value)
    }
}

/// Residual of an observation that is no image point.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationResidual {
    /// Name of its group, such as `control`.
    pub group: &'static str,
    /// Image, if it belongs to one.
    pub image: Option<Arc<str>>,
    /// Object point, if it belongs to one.
    pub point: Option<Arc<str>>,
    /// Component, such as `x_m` or `pitch_deg`: its unit is in the name.
    pub component: &'static str,
    /// The residual.
    pub tested: TestedResidual,
    /// `true` if it was rejected as a gross error.
    pub is_rejected: bool,
}

/// Observations of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationGroup {
    /// Name, such as `image`.
    pub name: &'static str,
    /// Accepted observations.
    pub observations: usize,
    /// Sum of their redundancy numbers.
    pub redundancy: f64,
    /// √(vᵀPv/redundancy) of the group; `None` where its redundancy vanishes.
    pub sigma0: Option<f64>,
    /// Rejected observations.
    pub rejected: usize,
}

impl ObservationGroup {
    /// Collects the group of the image points, two observations each.
    #[must_use]
    pub fn of_image_points(residuals: &[ImageResidual]) -> Self {
        let tested = residuals
            .iter()
            .flat_map(|one| one.components.map(|tested| (tested, one.is_rejected)));
        Self::new("image", tested)
    }

    /// Collects a group from its residuals, each with `true` if it was rejected.
    #[must_use]
    pub fn new(
        name: &'static str,
        residuals: impl IntoIterator<Item = (TestedResidual, bool)>,
    ) -> Self {
        let (mut observations, mut rejected) = (0, 0);
        let (mut redundancy, mut squares) = (0.0, 0.0);
        for (one, is_rejected) in residuals {
            if is_rejected {
                rejected += 1;
                continue;
            }
            observations += 1;
            redundancy += one.redundancy;
            if one.sigma > 0.0 {
                squares += (one.residual / one.sigma).powi(2);
            }
        }
        Self {
            name,
            observations,
            redundancy,
            sigma0: (redundancy > 1e-6).then(|| f64::sqrt(squares / redundancy)),
            rejected,
        }
    }
}
