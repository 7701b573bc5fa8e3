//! A calibration for a terminal or a pipe.

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::calibration::result::network::PointRole;

use super::profile::Profile;
use crate::terminal::{self, numbers, words};
use crate::wording;

/// Columns of the names before and after the tables.
const NAMES: u16 = 14;

/// Number of images, points and rejected observations that are printed; the files of `--out` have
/// all.
const MOST: usize = 30;

/// Writes parameters with σ, σ0 by group, correlations, profile, orientation, check points,
/// rejected observations, warnings and notes.
#[must_use]
pub fn text(result: &CalibrationResult) -> String {
    let mut blocks = vec![terminal::pairs(NAMES, head(result)), parameters(result)];
    if result.groups.len() > 1 {
        blocks.push(groups(result));
    }
    let correlations = correlations(result);
    if !correlations.is_empty() {
        blocks.push(correlations);
    }
    blocks.push(profile(result));
    if !result.images.is_empty() {
        blocks.push(images(result));
    }
    if result.points.iter().any(|one| one.role == PointRole::Check) {
        blocks.push(check_points(result));
    }
    blocks.extend(rejected(result));
    let lines = result.warnings.iter().map(|text| ("warning", text.clone()));
    let notes = result.notes.iter().map(|text| ("note", text.clone()));
    let said: Vec<_> = lines.chain(notes).collect();
    if !said.is_empty() {
        blocks.push(terminal::pairs(NAMES, said));
    }
    blocks.join("\n") + "\n"
}

fn head(result: &CalibrationResult) -> Vec<(&'static str, String)> {
    let constraints = match result.constraints {
        0 => String::new(),
        count => format!(", {}", wording::counted(count, "constraint")),
    };
    let mut head = vec![
        ("camera", result.camera.name.clone()),
        ("method", result.method.to_owned()),
        ("datum", result.datum.clone()),
        (
            "observations",
            format!(
                "{}, {}{constraints}, redundancy {}",
                wording::counted(result.observations, "observation"),
                wording::counted(result.unknowns, "unknown"),
                result.redundancy()
            ),
        ),
        ("σ0", sigma0(result)),
    ];
    if let Some((rms, largest)) = result.residual_size_mm() {
        let point_px = rms * 2.0_f64.sqrt() * 1e3 / result.camera.sensor.pixel_um;
        head.push((
            "residuals",
            format!(
                "rms {:.4} µm, largest {:.4} µm along an axis; rms per point {point_px:.4} px",
                1e3 * rms,
                1e3 * largest
            ),
        ));
    }
    let coverage = result.coverage();
    if coverage.points > 0 {
        head.push((
            "coverage",
            format!(
                "{:.1} mm, {:.0} % of the format radius; {:.0} % of the cells",
                coverage.radius_mm,
                100.0 * coverage.radius_share(),
                100.0 * coverage.cells
            ),
        ));
    }
    if result.iterations > 0 {
        head.push(("iterations", result.iterations.to_string()));
    }
    head
}

fn sigma0(result: &CalibrationResult) -> String {
    if result.redundancy() == 0 {
        return "none: no redundancy; σ are those of the given σ of the observations".to_owned();
    }
    if result.has_sigma {
        format!("{:.4} times the given σ", result.sigma0)
    } else {
        format!(
            "{:.4} µm, {:.5} px",
            result.sigma0,
            result.sigma0 / result.camera.sensor.pixel_um
        )
    }
}

fn parameters(result: &CalibrationResult) -> String {
    let columns = [
        words(""),
        numbers("value"),
        numbers("σ"),
        numbers("change"),
        numbers("|value|/σ"),
        words("unit"),
    ];
    let rows = result.parameters.iter().map(|one| {
        let is_length = one.unit == "mm";
        let number = |value: f64| {
            if is_length {
                format!("{value:.6}")
            } else {
                format!("{value:.6e}")
            }
        };
        let sigma = result.sigma(&one.name);
        [
            one.name.clone(),
            number(one.value),
            match sigma {
                Some(sigma) => format!("{sigma:.2e}"),
                None => "held".to_owned(),
            },
            match one.start {
                Some(start) if one.is_estimated => format!("{:+.3e}", one.value - start),
                _ => String::new(),
            },
            match sigma {
                Some(sigma) if sigma > 0.0 => format!("{:.1}", one.value.abs() / sigma),
                _ => String::new(),
            },
            one.unit.to_owned(),
        ]
    });
    terminal::table(columns, rows)
}

fn groups(result: &CalibrationResult) -> String {
    let columns = [
        words("group"),
        numbers("observations"),
        numbers("redundancy"),
        numbers("σ0"),
        numbers("rejected"),
    ];
    let rows = result.groups.iter().map(|group| {
        [
            group.name.to_owned(),
            group.observations.to_string(),
            format!("{:.2}", group.redundancy),
            group
                .sigma0
                .map_or_else(String::new, |sigma0| format!("{sigma0:.4}")),
            group.rejected.to_string(),
        ]
    });
    terminal::table(columns, rows)
}

/// Parameters whose correlations fit into 80 columns.
const WIDEST_MATRIX: usize = 10;

/// Short names, so that the matrix of [`WIDEST_MATRIX`] parameters fits into 80 columns.
fn short(name: &str) -> &str {
    match name {
        "principal_distance_mm" => "f",
        "stage_axis_angle_rad" => "α",
        "stage_scale" => "s",
        "run_out_mm_per_mm" => "z1",
        "run_out_mm_per_mm2" => "z2",
        _ => name.strip_suffix("_mm").unwrap_or(name),
    }
}

/// Lower triangle of the correlations, in as many parts as 80 columns need.
fn correlations(result: &CalibrationResult) -> String {
    let names: Vec<&str> = result.estimated().map(|one| one.name.as_str()).collect();
    if names.len() < 2 {
        return String::new();
    }
    let parts = (0..names.len()).step_by(WIDEST_MATRIX);
    let parts: Vec<String> = parts
        .map(|first| correlations_from(result, &names, first))
        .collect();
    parts.join("\n")
}

/// Columns of the correlations from one parameter on, with the rows that have any.
fn correlations_from(result: &CalibrationResult, names: &[&str], first: usize) -> String {
    let part: Vec<&str> = names
        .iter()
        .copied()
        .skip(first)
        .take(WIDEST_MATRIX)
        .collect();
    let columns = std::iter::once(words("ρ")).chain(part.iter().map(|name| numbers(short(name))));
    let rows = names.iter().enumerate().skip(first).map(|(index, a)| {
        let cells = (first..).zip(&part).map(|(column, b)| {
            if column >= index {
                return String::new();
            }
            result
                .correlation(a, b)
                .map_or_else(String::new, |value| format!("{value:+.2}"))
        });
        std::iter::once(short(a).to_owned()).chain(cells).collect()
    });
    terminal::lines(columns, rows)
}

fn profile(result: &CalibrationResult) -> String {
    let profile = Profile::of(result);
    let columns = [
        words("angle, °"),
        numbers("r, mm"),
        numbers("radial, µm"),
        numbers("σ"),
        numbers("balanced"),
        numbers("decentring"),
        numbers("σ"),
    ];
    let rows = profile.rows.iter().map(|row| {
        [
            format!("{:.2}", row.angle_deg),
            format!("{:.3}", row.radius_mm),
            format!("{:.3}", row.gaussian_um),
            format!("{:.3}", row.sigma_um),
            format!("{:.3}", row.balanced_um),
            format!("{:.3}", row.decentring_um),
            format!("{:.3}", row.decentring_sigma_um),
        ]
    });
    let table = terminal::table(columns, rows);
    format!(
        "{table}\nbalanced about a principal distance of {:.6} mm",
        profile.balanced_distance_mm
    )
}

fn images(result: &CalibrationResult) -> String {
    let columns = [
        words("image"),
        numbers("x, m"),
        numbers("y, m"),
        numbers("z, m"),
        numbers("pitch, °"),
        numbers("roll, °"),
        numbers("yaw, °"),
        numbers("points"),
        numbers("rms, µm"),
    ];
    let rows = result.images.iter().take(MOST).map(|one| {
        let mut row = vec![one.image.to_string()];
        row.extend(one.position_m.map(|metres| format!("{metres:.4}")));
        row.extend(one.attitude_deg.map(|degrees| format!("{degrees:.4}")));
        row.push(one.points.to_string());
        row.push(format!("{:.3}", 1e3 * one.residual_rms_mm));
        row
    });
    let mut text = terminal::lines(columns, rows);
    if let [only] = result.images.as_slice()
        && let (Some(metres), Some(degrees)) = (only.position_sigma_m, only.attitude_sigma_deg)
    {
        let list = |numbers: [f64; 3]| numbers.map(|one| format!("{one:.2e}")).join(", ");
        let sigmas = [
            ("σ of x, y, z", format!("{} m", list(metres))),
            ("σ of angles", format!("{}°", list(degrees))),
        ];
        text += "\n";
        text += &terminal::pairs(NAMES, sigmas);
    }
    text + &more(result.images.len(), "images", "summary.json")
}

fn check_points(result: &CalibrationResult) -> String {
    let columns = [
        words("check point"),
        numbers("dx, m"),
        numbers("dy, m"),
        numbers("dz, m"),
        numbers("rays"),
        numbers("largest over σ"),
    ];
    let checks: Vec<_> = result
        .points
        .iter()
        .filter(|one| one.role == PointRole::Check)
        .collect();
    let rows = checks.iter().take(MOST).map(|one| {
        let mut row = vec![one.point.to_string()];
        let given = one.given_m.unwrap_or(one.position_m);
        let differences = one.position_m.into_iter().zip(given);
        row.extend(differences.map(|(adjusted, given)| format!("{:+.4}", adjusted - given)));
        row.push(one.rays.to_string());
        row.push(
            one.test_value
                .map_or_else(String::new, |value| format!("{value:.1}")),
        );
        row
    });
    terminal::lines(columns, rows) + &more(checks.len(), "check points", "points.csv")
}

fn rejected(result: &CalibrationResult) -> Vec<String> {
    let limit = result
        .critical_value
        .map_or_else(String::new, |limit| format!(" > {limit:.2}"));
    let of_images = result.image_residuals.iter().filter(|one| one.is_rejected);
    let of_images = of_images.map(|one| {
        let [x, y] = one.vector_mm().map(|mm| 1e3 * mm);
        format!(
            "rejected      image {}, point {}: residual x {x:.3} µm, y {y:.3} µm; test value {:.1}{limit}",
            one.image,
            one.point,
            one.test_value()
        )
    });
    let others = result.other_residuals.iter().filter(|one| one.is_rejected);
    let others = others.map(|one| {
        let name = one.point.as_ref().or(one.image.as_ref());
        format!(
            "rejected      {} {} {}: residual {:.4}; test value {:.1}{limit}",
            one.group,
            name.map_or("", |name| name),
            one.component,
            one.tested.residual,
            one.tested.test_value
        )
    });
    let all: Vec<String> = of_images.chain(others).collect();
    let more = more(all.len(), "rejected", "residuals.csv");
    let mut lines: Vec<String> = all.into_iter().take(MOST).collect();
    lines.extend((!more.is_empty()).then(|| more.trim_start().to_owned()));
    lines
}

fn more(count: usize, what: &str, file: &str) -> String {
    let more = count.saturating_sub(MOST);
    if more == 0 {
        return String::new();
    }
    format!("\n{more} more {what}: {file} of --out has all")
}
