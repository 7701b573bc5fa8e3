//! Residuals of measurements from a fit of the five coefficients.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::estimation::parameter::PARAMETERS;

use super::measurement::Measurement;

/// The test of one measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// Observed less fitted distortion, mm.
    pub residual_mm: [f64; 2],
    /// The larger standardised component.
    pub test_value: f64,
    /// `true` if the measurement is part of the fit.
    pub passes: bool,
}

/// Creates the adjustment of measurements that have been checked.
pub(super) fn adjusted<'a>(
    lens: &KnownLens<f64>,
    options: FitOptions,
    measurements: impl IntoIterator<Item = &'a Measurement>,
) -> Adjustment<f64> {
    let mut adjustment = Adjustment::new(*lens, options);
    for measurement in measurements {
        // The measurement was checked when it was read.
        let _ = adjustment.observe(measurement.observation());
    }
    adjustment
}

/// Returns the derivatives of the model with respect to the parameters at a measurement, rows x and
/// y, in powers of mm.
fn derivatives(lens: &KnownLens<f64>, measurement: &Measurement) -> [[f64; PARAMETERS]; 2] {
    let [x0, y0] = lens.principal_point_mm;
    let [x, y] = measurement.row.point_mm;
    let (x, y) = (x - x0, y - y0);
    let sign = f64::from(lens.axis.sign());
    let [ex, ey] = if lens.axis.is_x() {
        [1.0, 0.0]
    } else {
        [0.0, 1.0]
    };
    let r2 = x * x + y * y;
    let along = x * ex + y * ey;
    let s = sign * measurement.regressor_mm;
    let row = |part: f64, e: f64| {
        [
            part,
            part * r2,
            part * r2 * r2,
            s * along * part,
            s * r2 * e,
            r2 * e + 2.0 * along * part,
        ]
    };
    [row(x, ex), row(y, ey)]
}

/// Returns observed less fitted distortion, in units of σ.
pub(super) fn residuals_in_sigma(
    lens: &KnownLens<f64>,
    fit: &Fit<f64>,
    measurement: &Measurement,
) -> [f64; 2] {
    let [x0, y0] = lens.principal_point_mm;
    let [x, y] = measurement.row.point_mm;
    let (x, y) = (x - x0, y - y0);
    let r2 = x * x + y * y;
    let [_, _, _, k3] = lens.k;
    let [p1, p2] = lens.p;
    let [b1, b2] = lens.b;
    // The decentring along the axis is one of the parameters.
    let (p1, p2) = if lens.axis.is_x() {
        (0.0, p2)
    } else {
        (p1, 0.0)
    };
    let held = [
        x * k3 * r2.powi(3) + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y,
        y * k3 * r2.powi(3) + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
    ];
    let mut residuals = measurement.row.distortion_mm;
    for ((residual, held), row) in residuals
        .iter_mut()
        .zip(held)
        .zip(derivatives(lens, measurement))
    {
        let fitted: f64 = row
            .into_iter()
            .zip(fit.values)
            .map(|(derivative, value)| derivative * value)
            .sum();
        *residual = (*residual - held - fitted) / measurement.row.sigma_mm;
    }
    residuals
}

/// Returns h = aᵀQa/σ²: the variance of the fitted distortion as a fraction of that of the observed
/// one.
pub(super) fn residual_variances(
    lens: &KnownLens<f64>,
    fit: &Fit<f64>,
    measurement: &Measurement,
) -> [f64; 2] {
    if fit.sigma0 <= 0.0 {
        return [0.0; 2];
    }
    let scale = 1.0 / (fit.sigma0 * measurement.row.sigma_mm);
    derivatives(lens, measurement).map(|row| {
        let mut weighted = row;
        for (part, deviation) in weighted.iter_mut().zip(fit.standard_deviations) {
            *part *= deviation * scale;
        }
        weighted
            .iter()
            .zip(&fit.correlations)
            .map(|(first, correlations)| {
                let inner: f64 = weighted
                    .iter()
                    .zip(correlations)
                    .map(|(second, correlation)| second * correlation)
                    .sum();
                first * inner
            })
            .sum()
    })
}
