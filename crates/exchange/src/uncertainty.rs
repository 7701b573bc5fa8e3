//! Standard deviations and correlations that a file states of its parameters.

use serde::Serialize;

/// Uncertainty of the parameters of a program's camera, in its own symbols and units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// Symbols, as the program has them.
    pub parameters: Vec<String>,
    /// Standard deviation of each, in the unit of the program's file.
    pub sigma: Vec<f64>,
    /// Correlations, row by row; none if the file has standard deviations alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlations: Option<Vec<Vec<f64>>>,
}

impl Uncertainty {
    /// Returns the uncertainty of a covariance matrix, row by row; `None` if it is not square, or
    /// has a variance that is not positive or a number that is not finite.
    pub(crate) fn of_covariance(parameters: Vec<String>, covariance: &[f64]) -> Option<Self> {
        let count = parameters.len();
        if count == 0 || covariance.len() != count * count {
            return None;
        }
        let rows: Vec<&[f64]> = covariance.chunks(count).collect();
        let sigma: Vec<f64> = rows
            .iter()
            .enumerate()
            .filter_map(|(index, row)| row.get(index).map(|variance| variance.sqrt()))
            .collect();
        let correlations: Vec<Vec<f64>> = rows
            .iter()
            .zip(&sigma)
            .map(|(row, own)| {
                let cells = row.iter().zip(&sigma);
                cells.map(|(cell, other)| cell / (own * other)).collect()
            })
            .collect();
        let is_finite = correlations.iter().flatten().all(|cell| cell.is_finite());
        is_finite.then_some(Self {
            parameters,
            sigma,
            correlations: Some(correlations),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covariance_becomes_deviations_and_correlations() {
        let names = ["f", "cx"].map(str::to_owned).to_vec();
        let found = Uncertainty::of_covariance(names.clone(), &[4.0, 3.0, 3.0, 9.0]).unwrap();
        assert!((found.sigma[0] - 2.0).abs() < 1e-15 && (found.sigma[1] - 3.0).abs() < 1e-15);
        let correlations = found.correlations.unwrap();
        assert!((correlations[0][1] - 0.5).abs() < 1e-15);
        assert!((correlations[1][1] - 1.0).abs() < 1e-15);
        for wrong in [
            &[4.0, 3.0, 3.0][..],
            &[0.0, 0.0, 0.0, 1.0],
            &[-1.0, 0.0, 0.0, 1.0],
        ] {
            assert_eq!(Uncertainty::of_covariance(names.clone(), wrong), None);
        }
    }
}
