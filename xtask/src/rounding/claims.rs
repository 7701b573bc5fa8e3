//! Claims about the rounding: a function, the ranges of its numbers, and one of its results.

use std::{collections::BTreeMap, fs, path::Path};

use anyhow::{Context as _, Result};

use super::{
    expression::Expression,
    function::{Definitions, Reading, read},
    script::{Given, Script, Unit},
    source::Source,
};

/// Cameras over whose sensors the correction is bounded.
const CAMERAS: &str = "host-sim/cameras";

/// Farthest way of the centre from the principal point along either axis, mm.
const CENTRE_MM: f64 = 0.25;

/// Claim with the name of its row in the document.
#[derive(Clone, Debug)]
pub(super) struct Claim {
    pub(super) name: String,
    pub(super) script: Script,
}

/// Returns all claims.
///
/// # Errors
/// An error if a source cannot be read as a computation, or a camera file as one.
pub(super) fn all(root: &Path) -> Result<Vec<Claim>> {
    let mut claims = of_lenses(root)?;
    let ranges = Ranges::read(root)?;
    claims.extend(of_grids(root)?);
    claims.extend(of_travels(root, &ranges)?);
    claims.extend(of_moments(root, &ranges)?);
    claims.extend(of_sigmas(root, &ranges)?);
    Ok(claims)
}

/// Ranges of quantities, from the library's source.
struct Ranges(String);

impl Ranges {
    fn read(root: &Path) -> Result<Self> {
        let path = "src/geometry/range.rs";
        fs::read_to_string(root.join(path)).context(path).map(Self)
    }

    /// Returns the range of a quantity.
    fn of(&self, quantity: &str) -> Result<(f64, f64)> {
        let range = || {
            let start = format!("    {quantity} = ");
            let line = self.0.lines().find_map(|line| line.strip_prefix(&start))?;
            let (_, range) = line.strip_suffix(';')?.split_once("\", ")?;
            let (least, most) = range.split_once(", ")?;
            let number = |text: &str| text.replace('_', "").parse().ok();
            Some((number(least)?, number(most)?))
        };
        range().with_context(|| format!("no range of {quantity}"))
    }

    /// Returns the range of a quantity from another least value on.
    fn from(&self, quantity: &str, least: f64) -> Result<Given> {
        let (_, most) = self.of(quantity)?;
        Ok(Given::Between(least, most))
    }

    /// Returns the range of a quantity in other units.
    fn scaled(&self, quantity: &str, factor: f64) -> Result<Given> {
        let (least, most) = self.of(quantity)?;
        Ok(Given::Between(least * factor, most * factor))
    }
}

/// Correction of every camera, in both forms: the distortion, and the coordinate.
fn of_lenses(root: &Path) -> Result<Vec<Claim>> {
    let mut paths: Vec<_> = fs::read_dir(root.join(CAMERAS))?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<_>>()?;
    paths.sort();
    let brown = Source::read(root, "src/geometry/brown.rs")?;
    let kernel = Source::read(root, "crates/kernel/src/portable.rs")?;
    let form_of_distortion = Source::read(root, "src/geometry/evaluation_form.rs")?;
    let mut claims = Vec::new();
    for path in paths {
        let camera = Camera::read(&path)?;
        for (form, conditions_hold) in [("short", false), ("full", true)] {
            let reading = Reading {
                conditions_hold,
                ..Reading::default()
            };
            let point = |axis: &str| camera.on_sensor(axis, 0.0);
            let centre = |axis: &str| camera.centre(axis);
            let outside = BTreeMap::from([
                ("x".to_owned(), point("x")),
                ("y".to_owned(), point("y")),
                ("form_cx".to_owned(), centre("x")),
                ("form_cy".to_owned(), centre("y")),
            ]);
            let (second, results) = read(&kernel, "ideal", reading, &["0"])?;
            claims.push(Claim {
                name: format!("corrected x, {form}, {}", camera.name),
                script: camera.script(&brown, second, &outside, results, "0", "form_")?,
            });
            let function = if conditions_hold {
                "displacement"
            } else {
                "short_displacement"
            };
            for result in ["dx_mm", "dy_mm"] {
                let from_centre = |axis| camera.on_sensor(axis, CENTRE_MM);
                let outside = BTreeMap::from([
                    ("x".to_owned(), from_centre("x")),
                    ("y".to_owned(), from_centre("y")),
                ]);
                let (second, results) = read(&form_of_distortion, function, reading, &[result])?;
                claims.push(Claim {
                    name: format!("distortion {}, {form}, {}", &result[..2], camera.name),
                    script: camera.script(&brown, second, &outside, results, result, "")?,
                });
            }
        }
    }
    Ok(claims)
}

/// Camera file, as far as the correction needs it.
struct Camera {
    name: String,
    numbers: BTreeMap<String, String>,
    principal_point: [f64; 2],
}

impl Camera {
    fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path)?;
        let mut numbers = BTreeMap::new();
        let mut principal_point = [0.0; 2];
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default();
            let Some((key, value)) = line.split_once('=') else {
                continue;
            };
            let (key, value) = (key.trim(), value.trim());
            if key == "principal_point_mm" {
                let places = value.trim_matches(['[', ']']).split(',');
                for (place, text) in principal_point.iter_mut().zip(places) {
                    *place = text.trim().parse()?;
                }
            }
            numbers.insert(key.to_owned(), value.to_owned());
        }
        let name = path.file_stem().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            numbers,
            principal_point,
        })
    }

    fn number(&self, key: &str) -> Result<f64> {
        let text = self.numbers.get(key);
        let text = text.with_context(|| format!("{}: no {key}", self.name))?;
        text.parse()
            .with_context(|| format!("{}: {key}", self.name))
    }

    fn half_side(&self, axis: &str) -> f64 {
        let side = if axis == "x" { "width_px" } else { "height_px" };
        let product = |side: f64, pixel: f64| 0.5e-3 * side * pixel;
        match (self.number(side), self.number("pixel_um")) {
            (Ok(side), Ok(pixel)) => product(side, pixel),
            _ => f64::NAN,
        }
    }

    /// Returns a place on the sensor, or, from a centre beside the principal point.
    fn on_sensor(&self, axis: &str, centre_mm: f64) -> Given {
        let [x, y] = self.principal_point;
        let shift = if axis == "x" { x } else { y };
        let away = if centre_mm > 0.0 {
            shift.abs() + centre_mm
        } else {
            0.0
        };
        let half = self.half_side(axis) + away;
        Given::Between(-half, half)
    }

    fn centre(&self, axis: &str) -> Given {
        let [x, y] = self.principal_point;
        let middle = if axis == "x" { x } else { y };
        Given::Between(middle - CENTRE_MM, middle + CENTRE_MM)
    }

    /// Returns the script of a computation with this camera's coefficients, which the source of the
    /// polynomial turns into those of the form.
    fn script(
        &self,
        brown: &Source,
        mut second: Definitions,
        outside: &BTreeMap<String, Given>,
        mut results: BTreeMap<String, Expression>,
        result: &str,
        prefix: &str,
    ) -> Result<Script> {
        let wanted: Vec<String> = second.inputs.clone();
        let fields: Vec<_> = wanted
            .iter()
            .filter(|input| !outside.contains_key(*input))
            .filter_map(|input| input.strip_prefix(prefix))
            .collect();
        let (mut all, form) = read(brown, "evaluation_form", Reading::default(), &fields)?;
        let mut given = outside.clone();
        for input in &all.inputs {
            // A coefficient that the file does not have is zero.
            let number = match self.numbers.get(input) {
                Some(text) => text
                    .parse()
                    .with_context(|| format!("{}: {input}", self.name))?,
                None => 0.0,
            };
            given.insert(input.clone(), Given::Is(number));
        }
        // The form's coefficients have the names of the polynomial's, with a line under them.
        for (name, expression) in form {
            all.lines.push((format!("of_{name}"), expression));
        }
        let renamed = |name: &str| {
            let field = name.strip_prefix(prefix)?;
            let is_coefficient = wanted.iter().any(|input| input == name);
            (is_coefficient && !outside.contains_key(name)).then(|| format!("of_{field}"))
        };
        for (_, expression) in &mut second.lines {
            expression.rename(&renamed);
        }
        all.inputs.extend(outside.keys().cloned());
        all.lines.append(&mut second.lines);
        Ok(Script {
            definitions: all,
            given,
            result: results.remove(result).context("no result")?,
            unit: Unit::Nanometres,
        })
    }
}

/// Weights of a residual grid in its cell.
fn of_grids(root: &Path) -> Result<Vec<Claim>> {
    let source = Source::read(root, "src/geometry/grid/placed_grid.rs")?;
    let mut claims = Vec::new();
    for result in ["0", "1", "2", "3"] {
        let (definitions, mut results) = read(&source, "weights", Reading::default(), &[result])?;
        claims.push(Claim {
            name: format!("weight {result} of a grid"),
            script: Script {
                definitions,
                given: BTreeMap::from([("u".to_owned(), Given::Between(0.0, 1.0))]),
                result: results.remove(result).context("no result")?,
                unit: Unit::Own,
            },
        });
    }
    Ok(claims)
}

/// Speed f·V/H of the stage and travel in the exposure.
fn of_travels(root: &Path, ranges: &Ranges) -> Result<Vec<Claim>> {
    let camera = Source::read(root, "src/flight/camera.rs")?;
    let wanted = ["speed_mm_s", "exposure_s"];
    let (mut definitions, mut speed) = read(&camera, "tracking", Reading::default(), &wanted)?;
    let distance = "calibration_parameters_principal_distance_mm";
    let given = BTreeMap::from([
        ("exposure_direction_sign".to_owned(), Given::Is(-1.0)),
        (
            distance.to_owned(),
            ranges.scaled("PrincipalDistanceMm", 1.0)?,
        ),
        (
            "exposure_vh_per_s".to_owned(),
            ranges.from("VhPerS", LEAST_VH_PER_S)?,
        ),
        (
            "exposure_exposure_s".to_owned(),
            ranges.scaled("ExposureS", 1.0)?,
        ),
    ]);
    let motion = Source::read(root, "src/geometry/principal_point.rs")?;
    let (mut second, mut travel) = read(&motion, "from_plan", Reading::default(), &["travel_mm"])?;
    for field in wanted {
        let value = speed.remove(field).context("no speed")?;
        definitions.lines.push((format!("travel_{field}"), value));
    }
    // Other numbers that the plan reads are of other results.
    definitions.lines.append(&mut second.lines);
    Ok(vec![Claim {
        name: "travel f·V/H·t".to_owned(),
        script: Script {
            definitions,
            given,
            result: travel.remove("travel_mm").context("no travel")?,
            unit: Unit::Part,
        },
    }])
}

/// Least V/H for which the relative error of the travel is bounded: below it the travel is nothing.
const LEAST_VH_PER_S: f64 = 1e-6;

/// Least travel for which the relative errors of its moments are bounded, mm.
const LEAST_TRAVEL_MM: f64 = 1e-6;

/// Moments of the travel, from those of the shutter's profile on [0, 1].
fn of_moments(root: &Path, ranges: &Ranges) -> Result<Vec<Claim>> {
    let source = Source::read(root, "src/geometry/moments.rs")?;
    let mut claims = Vec::new();
    for result in ["second", "third", "fourth"] {
        let (definitions, mut results) = read(&source, "scaled", Reading::default(), &[result])?;
        let moment = Given::Between(LEAST_MOMENT, 1.0);
        let given = [
            (result, moment),
            ("scale", ranges.from("TravelMm", LEAST_TRAVEL_MM)?),
        ];
        let named = given.map(|(name, given)| (name.to_owned(), given));
        claims.push(Claim {
            name: format!("{result} moment"),
            script: Script {
                definitions,
                given: BTreeMap::from(named),
                result: results.remove(result).context("no result")?,
                unit: Unit::Part,
            },
        });
    }
    Ok(claims)
}

/// Least moment of a profile for which the relative error is bounded.
const LEAST_MOMENT: f64 = 1e-6;

/// Most readings of an exposure.
const MOST_READINGS: f64 = 1e5;

/// Least parts of σ other than zero, µm, ppm and s.
const LEAST_SIGMA_UM: f64 = 1e-3;
const LEAST_SCALE_PPM: f64 = 1e-3;
const LEAST_AGE_SIGMA_S: f64 = 1e-9;

/// σ of a principal point, from the encoder's readings.
fn of_sigmas(root: &Path, ranges: &Ranges) -> Result<Vec<Claim>> {
    let path = "src/flight/controller/stage/exposure_motion.rs";
    let source = Source::read(root, path)?;
    let timing = Source::read(root, "src/flight/controller/timing.rs")?;
    let stamp = Given::Is(timing.constant("STAMP_SIGMA_S")?);
    let mut claims = Vec::new();
    for result in ["frame_mm", "common_mm"] {
        let reading = Reading {
            given: &["readings"],
            ..Reading::default()
        };
        let (definitions, mut results) = read(&source, "sigma_of_readings", reading, &[result])?;
        let given = [
            (
                "motion_travel_mm",
                ranges.from("TravelMm", LEAST_TRAVEL_MM)?,
            ),
            ("exposure_s", ranges.scaled("ExposureS", 1.0)?),
            ("STAMP_SIGMA_S", stamp),
            ("readings", Given::Between(1.0, MOST_READINGS)),
            (
                "drive_encoder_step_um",
                ranges.scaled("EncoderStepUm", 1.0)?,
            ),
            (
                "drive_zero_sigma_um",
                ranges.from("ZeroSigmaUm", LEAST_SIGMA_UM)?,
            ),
            (
                "drive_encoder_scale_ppm",
                ranges.from("EncoderScalePpm", LEAST_SCALE_PPM)?,
            ),
            (
                "motion_centroid_mm",
                ranges.from("TravelMm", LEAST_TRAVEL_MM)?,
            ),
            (
                "drive_reading_age_sigma_s",
                ranges.from("ReadingAgeSigmaS", LEAST_AGE_SIGMA_S)?,
            ),
            (
                "play_sigma_mm",
                Given::Between(1e-3 * LEAST_SIGMA_UM, 1e-3 * ranges.of("PlayUm")?.1),
            ),
        ];
        let given = given.map(|(name, given)| (name.to_owned(), given));
        claims.push(Claim {
            name: format!(
                "σ of the {}",
                if result == "frame_mm" {
                    "frame"
                } else {
                    "flight"
                }
            ),
            script: Script {
                definitions,
                given: BTreeMap::from(given),
                result: results.remove(result).context("no result")?,
                unit: Unit::Part,
            },
        });
    }
    Ok(claims)
}
