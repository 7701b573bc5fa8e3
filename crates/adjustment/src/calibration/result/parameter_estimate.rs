//! Parameters of a calibration with the values they started from.

/// A parameter of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterEstimate {
    /// Name: `principal_distance_mm`, `x0_mm`, `y0_mm`, `k1` … `b2` as in the camera file, or that
    /// of another parameter.
    pub name: String,
    /// Unit as it is printed; empty for a number.
    pub unit: &'static str,
    /// Value from which the adjustment started; `None` if it needed none.
    pub start: Option<f64>,
    /// Value found, or held.
    pub value: f64,
    /// σ with which the start was an observation; `None` without.
    pub prior_sigma: Option<f64>,
    /// `true` if it was estimated: it then has a row of the cofactor matrix.
    pub is_estimated: bool,
}

impl ParameterEstimate {
    /// Creates a parameter that was estimated.
    #[must_use]
    pub fn estimated(name: impl Into<String>, start: Option<f64>, value: f64) -> Self {
        let name = name.into();
        Self {
            unit: unit(&name),
            name,
            start,
            value,
            prior_sigma: None,
            is_estimated: true,
        }
    }

    /// Returns the parameter with the σ of its start.
    #[must_use]
    pub fn with_prior(self, sigma: Option<f64>) -> Self {
        Self {
            prior_sigma: sigma,
            ..self
        }
    }

    /// Creates a parameter that was held at its value.
    #[must_use]
    pub fn held(name: impl Into<String>, value: f64) -> Self {
        Self {
            is_estimated: false,
            ..Self::estimated(name, Some(value), value)
        }
    }
}

/// Returns the unit of a parameter from its name, as it is printed; empty for a number.
#[must_use]
pub fn unit(name: &str) -> &'static str {
    match name {
        "k1" | "km1" | "kd1" | "pm1" => "mm⁻²",
        "k2" | "km2" => "mm⁻⁴",
        "k3" => "mm⁻⁶",
        "p1" | "p2" => "mm⁻¹",
        _ if name.ends_with("_mm_per_mm2") => "mm⁻¹",
        _ if name.ends_with("_mm_per_mm") => "",
        _ if name.ends_with("_rad") => "rad",
        _ if name.ends_with("_deg") => "°",
        _ if name.ends_with("_mm") => "mm",
        _ if name.ends_with("_m") => "m",
        _ if name.ends_with("_s") => "s",
        _ => "",
    }
}
