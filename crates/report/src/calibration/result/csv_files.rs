//! Files of a calibration as CSV: residuals, covariances, object points.

use std::io::Write;

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::calibration::result::residual::TestedResidual;

/// Writes `residuals.csv`: a row per observation; image points in µm, others in the unit that the
/// name of their component has.
pub(super) fn residuals(result: &CalibrationResult, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    file.write_record([
        "group",
        "image",
        "point",
        "observation",
        "x_mm",
        "y_mm",
        "residual",
        "sigma",
        "redundancy",
        "test_value",
        "smallest_detectable",
        "rejected",
    ])?;
    let numbers = |tested: &TestedResidual, factor: f64| {
        [
            format!("{:.6}", factor * tested.residual + 0.0),
            format!("{}", factor * tested.sigma),
            format!("{:.6}", tested.redundancy),
            format!("{:.4}", tested.test_value),
            tested
                .smallest_detectable()
                .map_or_else(String::new, |least| format!("{:.6}", factor * least)),
        ]
    };
    for one in &result.image_residuals {
        let [x, y] = one.measured_mm.map(|mm| mm.to_string());
        let components = ["x_um", "y_um"].into_iter().zip(&one.components);
        // A component that was not observed has no σ.
        for (name, tested) in components.filter(|(_, tested)| tested.sigma > 0.0) {
            let [residual, sigma, redundancy, test, least] = numbers(tested, 1e3);
            let rejected = one.is_rejected.to_string();
            file.write_record([
                "image",
                &one.image,
                &one.point,
                name,
                &x,
                &y,
                &residual,
                &sigma,
                &redundancy,
                &test,
                &least,
                &rejected,
            ])?;
        }
    }
    for one in &result.other_residuals {
        let [residual, sigma, redundancy, test, least] = numbers(&one.tested, 1.0);
        let rejected = one.is_rejected.to_string();
        file.write_record([
            one.group,
            one.image.as_deref().unwrap_or_default(),
            one.point.as_deref().unwrap_or_default(),
            one.component,
            "",
            "",
            &residual,
            &sigma,
            &redundancy,
            &test,
            &least,
            &rejected,
        ])?;
    }
    file.flush()?;
    Ok(())
}

/// Writes `covariance.csv`: the covariance matrix of the estimated parameters, multiplied by σ0².
pub(super) fn covariance(result: &CalibrationResult, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    let names: Vec<&str> = result.estimated().map(|one| one.name.as_str()).collect();
    file.write_record(std::iter::once("parameter").chain(names.iter().copied()))?;
    for a in &names {
        let row = names
            .iter()
            .map(|b| format!("{:e}", result.covariance(a, b)));
        file.write_record(std::iter::once((*a).to_owned()).chain(row))?;
    }
    file.flush()?;
    Ok(())
}

/// Writes `points.csv`: the adjusted object points.
pub(super) fn points(result: &CalibrationResult, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    file.write_record([
        "point",
        "x_m",
        "y_m",
        "z_m",
        "sigma_x_m",
        "sigma_y_m",
        "sigma_z_m",
        "role",
        "rays",
        "intersection_deg",
        "dx_m",
        "dy_m",
        "dz_m",
        "test_value",
    ])?;
    let optional = |number: Option<f64>, decimals: usize| {
        number.map_or_else(String::new, |number| format!("{number:.decimals$}"))
    };
    for one in &result.points {
        let mut row = vec![one.point.to_string()];
        row.extend(one.position_m.map(|metres| format!("{metres:.9}")));
        row.extend(one.sigma_m.map(|metres| format!("{metres:.3e}")));
        row.push(one.role.name().to_owned());
        row.push(one.rays.to_string());
        row.push(optional(one.intersection_deg, 3));
        for (index, adjusted) in one.position_m.into_iter().enumerate() {
            let given = one.given_m.and_then(|given| given.get(index).copied());
            row.push(optional(given.map(|given| adjusted - given), 9));
        }
        row.push(optional(one.test_value, 4));
        file.write_record(row)?;
    }
    file.flush()?;
    Ok(())
}
