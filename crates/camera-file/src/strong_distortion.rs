//! Distortion so strong that its coefficients may have another unit than the camera file's.

use crate::camera::CameraFile;

/// Distortion at the sensor's edge, as a fraction of the radius, beyond which a warning is given.
const STRONG: f64 = 0.1;

/// Fraction beyond which a coefficient per mm² is hardly believable.
const UNLIKELY: f64 = 0.5;

/// Smallest dimensionless coefficient that a calibration states.
const LEAST_DIMENSIONLESS: f64 = 1e-3;

/// Section that tells how coefficients of other software are converted.
const CONVERSION: &str = "docs/conventions.md, section 12, tells how coefficients are converted";

/// A term of the polynomial at one point.
#[derive(Debug, Clone, Copy)]
struct Term {
    /// Key in the camera file.
    name: &'static str,
    /// Value in the camera file.
    value: f64,
    /// Unit of the value, and the power of mm in its denominator.
    unit: &'static str,
    power: i32,
    /// Length of the term's distortion over the radius.
    fraction: f64,
}

/// The strongest distortion on the edge of the sensor.
#[derive(Debug, Clone, Copy)]
struct EdgeDistortion {
    radius_mm: f64,
    /// Length of the distortion over the radius.
    fraction: f64,
    largest: Term,
}

impl CameraFile {
    /// Returns a warning if the distortion exceeds 10 % of the radius at the sensor's edge: such
    /// lenses exist, but more often coefficients have another unit. It names the largest term with
    /// its unit and its value in normalised coordinates.
    #[must_use]
    pub fn distortion_warning(&self) -> Option<String> {
        let edge = self.edge_distortion()?;
        if edge.fraction <= STRONG {
            return None;
        }
        let Term {
            name,
            value,
            unit,
            power,
            fraction,
        } = edge.largest;
        let share = format!(
            "[distortion] is {} of the radius at the sensor's edge, {:.1} mm from the principal point; the largest term is {name} = {}{unit} with {}",
            percent(edge.fraction),
            edge.radius_mm,
            plain(value),
            percent(fraction)
        );
        if let Some(advice) = self.dimensionless(&edge, fraction > UNLIKELY) {
            return Some(format!("{share}: {advice}"));
        }
        let normalised = match power {
            0 => String::new(),
            1 => format!(
                " ({name}·f = {} in normalised coordinates)",
                short(value * self.principal_distance_mm)
            ),
            _ => format!(
                " ({name}·f{} = {} in normalised coordinates, as OpenCV and Metashape state it)",
                superscript(power),
                short(value * self.principal_distance_mm.powi(power))
            ),
        };
        Some(format!("{share}{normalised}; {CONVERSION}"))
    }

    /// Returns the advice for a polynomial that folds the image: its largest term may be a
    /// dimensionless coefficient.
    pub(crate) fn folding_advice(&self) -> Option<String> {
        self.dimensionless(&self.edge_distortion()?, true)
    }

    /// Returns the advice for a largest term that is `unlikely` in the file's unit, if it is likely
    /// without one.
    fn dimensionless(&self, edge: &EdgeDistortion, unlikely: bool) -> Option<String> {
        let largest = &edge.largest;
        let (name, scale) = (largest.name, self.principal_distance_mm.powi(largest.power));
        // The terms of Brown that software states in normalised coordinates, with this name.
        let is_radial = largest.power >= 2;
        if !unlikely
            || !is_radial
            || largest.value.abs() < LEAST_DIMENSIONLESS
            || largest.fraction / scale > UNLIKELY
        {
            return None;
        }
        Some(format!(
            "{name} = {} looks like a dimensionless coefficient (OpenCV's or Metashape's {name}): divided by f{} it is {}{}, to leading order; {CONVERSION}",
            plain(largest.value),
            superscript(largest.power),
            short(largest.value / scale),
            largest.unit
        ))
    }

    /// Returns the strongest distortion of the sensor's corners and of the middles of its sides.
    fn edge_distortion(&self) -> Option<EdgeDistortion> {
        let [half_width, half_height] = self.half_format_mm();
        let [x0, y0] = self.principal_point_mm;
        [-1.0, 0.0, 1.0]
            .iter()
            .flat_map(|x| [-1.0, 0.0, 1.0].map(|y| [x * half_width - x0, y * half_height - y0]))
            .filter_map(|place_mm| self.distortion_at(place_mm))
            .max_by(|a, b| a.fraction.total_cmp(&b.fraction))
    }

    /// Returns the distortion at a place from the principal point, mm; `None` at the principal
    /// point itself, and where a coefficient is not a finite number.
    fn distortion_at(&self, [x, y]: [f64; 2]) -> Option<EdgeDistortion> {
        let d = &self.distortion;
        let r = x.hypot(y);
        let r2 = r * r;
        let radial = |k: f64, power: i32| [x, y].map(|coordinate| k * r.powi(power) * coordinate);
        // Brown's terms, in the order of docs/conventions.md, section 3.
        let terms = [
            ("k0", d.k0, "", 0, radial(d.k0, 0)),
            ("k1", d.k1, " mm⁻²", 2, radial(d.k1, 2)),
            ("k2", d.k2, " mm⁻⁴", 4, radial(d.k2, 4)),
            ("k3", d.k3, " mm⁻⁶", 6, radial(d.k3, 6)),
            (
                "p1",
                d.p1,
                " mm⁻¹",
                1,
                [d.p1 * (r2 + 2.0 * x * x), 2.0 * d.p1 * x * y],
            ),
            (
                "p2",
                d.p2,
                " mm⁻¹",
                1,
                [2.0 * d.p2 * x * y, d.p2 * (r2 + 2.0 * y * y)],
            ),
            ("b1", d.b1, "", 0, [d.b1 * x, 0.0]),
            ("b2", d.b2, "", 0, [d.b2 * y, 0.0]),
        ];
        let sum = |axis: usize| -> f64 {
            terms
                .iter()
                .filter_map(|(_, _, _, _, term)| term.get(axis))
                .sum()
        };
        let fraction = sum(0).hypot(sum(1)) / r;
        let largest = terms
            .into_iter()
            .map(|(name, value, unit, power, [dx, dy])| Term {
                name,
                value,
                unit,
                power,
                fraction: dx.hypot(dy) / r,
            })
            .max_by(|a, b| a.fraction.total_cmp(&b.fraction))?;
        fraction.is_finite().then_some(EdgeDistortion {
            radius_mm: r,
            fraction,
            largest,
        })
    }
}

fn percent(fraction: f64) -> String {
    format!("{} %", short(100.0 * fraction))
}

/// Returns a number with three digits.
fn short(number: f64) -> String {
    plain(format!("{number:.2e}").parse().unwrap_or(number))
}

/// Returns a number with all its digits, as a person would write it.
fn plain(number: f64) -> String {
    if (1e-2..1e4).contains(&number.abs()) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// Returns an exponent of the radial terms.
const fn superscript(power: i32) -> &'static str {
    match power {
        2 => "²",
        4 => "⁴",
        6 => "⁶",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A camera of 100 mm with 80 x 60 mm, its corners 50 mm from the centre.
    const TEXT: &str = "name = \"t\"\nprincipal_distance_mm = 100.0\n\
                        [sensor]\nwidth_px = 8000\nheight_px = 6000\npixel_um = 10.0\n\
                        [distortion]\n";

    fn parse(distortion: &str) -> Result<CameraFile, crate::InputError> {
        CameraFile::parse("t.toml", &format!("{TEXT}{distortion}\n")).map(|(file, _)| file)
    }

    fn warning(distortion: &str) -> Option<String> {
        parse(distortion).unwrap().distortion_warning()
    }

    #[test]
    fn ten_per_cent_of_the_radius_at_the_corner_is_where_the_warning_begins() {
        // K1·r² with r = 50 mm.
        for (k1, is_warned) in [
            (0.0, false),
            (-3.9e-5, false),
            (-4.1e-5, true),
            (4.1e-5, true),
        ] {
            let warning = warning(&format!("k1 = {k1:e}"));
            assert_eq!(warning.is_some(), is_warned, "{k1}: {warning:?}");
        }
        // Terms of opposite signs count together.
        assert_eq!(warning("k1 = -8e-5\nk2 = 3.2e-8"), None);
        for (_, text) in crate::published::CAMERA_FILES {
            let (file, _) = CameraFile::parse("p.toml", text).unwrap();
            assert_eq!(file.distortion_warning(), None, "{}", file.name);
        }
    }

    #[test]
    fn warning_names_the_largest_term_its_unit_and_its_normalised_value() {
        let says = |distortion: &str, parts: &[&str]| {
            let warning = warning(distortion).unwrap();
            for part in parts {
                assert!(warning.contains(part), "{part:?} is not in: {warning}");
            }
            assert!(!warning.contains("looks like"), "{warning}");
        };
        says(
            "k1 = -8e-5",
            &[
                "is 20 % of the radius",
                "50.0 mm",
                "k1 = -8e-5 mm⁻² with 20 %",
                "k1·f² = -0.8 ",
            ],
        );
        says(
            "k1 = -1e-5\nk2 = -2e-8",
            &["k2 = -2e-8 mm⁻⁴ with 12.5 %", "k2·f⁴ = -2 "],
        );
        says("p1 = 1.2e-3", &["p1 = 1.2e-3 mm⁻¹", "p1·f = 0.12 "]);
        says("b1 = 0.2", &["b1 = 0.2 with"]);
    }

    #[test]
    fn coefficients_without_a_unit_are_recognised_where_they_fold_the_image() {
        for (distortion, parts) in [
            (
                "k1 = -0.12",
                ["k1 = -0.12 looks like", "divided by f² it is -1.2e-5 mm⁻²"],
            ),
            (
                "sign = \"correction\"\nk1 = 0.05",
                ["k1 = 0.05 looks like", "it is 5e-6 mm⁻²"],
            ),
            (
                "k1 = -0.12\nk2 = -0.06",
                ["k2 = -0.06 looks like", "divided by f⁴ it is -6e-10 mm⁻⁴"],
            ),
        ] {
            let error = parse(distortion).unwrap_err();
            assert!(error.to_string().contains("folds"), "{error}");
            let help = error.help().unwrap();
            for part in parts {
                assert!(help.contains(part), "{part:?} is not in: {help}");
            }
        }
        // A lens that folds with a coefficient per mm², or by its affinity, has no such help.
        for distortion in ["k1 = 2.1e-4", "b1 = 1.5"] {
            let error = parse(distortion).unwrap_err();
            assert!(error.to_string().contains("folds"), "{error}");
            assert_eq!(error.help(), None);
        }
    }

    #[test]
    fn coefficients_without_a_unit_are_recognised_where_the_image_does_not_fold() {
        // 16 x 12 mm, 10 mm to the corner.
        let text = TEXT.replace("pixel_um = 10.0", "pixel_um = 2.0") + "k1 = -8e-3\n";
        let (file, _) = CameraFile::parse("t.toml", &text).unwrap();
        let warning = file.distortion_warning().unwrap();
        for part in [
            "is 80 % of the radius",
            "k1 = -8e-3 looks like",
            "it is -8e-7 mm⁻²",
        ] {
            assert!(warning.contains(part), "{part:?} is not in: {warning}");
        }
    }
}
