//! `calibrate bundle --records`: each image with the principal point and the focus shift of its own
//! exposure, beside the bundle that knows one principal point for all.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::interior::Interior;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::record_tests::{
    LEAST_CONTROL, RecordTests, check_points_along_m, check_points_rms_m, difference_rms_m,
    differences_along_m, is_blind_to_sign, motion_on_ground,
};
use fmc_adjustment::bundle::records::FlightRecords;
use fmc_adjustment::bundle::tables::NetworkTables;
use fmc_report::calibration::record_plot::{BesideEachOther, Series};
use fmc_report::calibration::result::of_method::{Figure, PageTable};
use fmc_report::figure::FigureError;
use serde_json::{Map, Value, json};

/// Range of c̄, mm, below which all exposures count as having one principal point.
const CONSTANT_MM: f64 = 1e-3;

/// A bundle with records, and what it is compared with.
pub(super) struct WithRecords {
    records: FlightRecords,
    /// The same tables with one principal point; an error in words.
    fixed: Result<BundleCalibration, String>,
}

impl WithRecords {
    /// Adjusts the tables with one principal point for all images, which says nothing of a stage.
    pub(super) fn new(
        records: FlightRecords,
        tables: &NetworkTables,
        start: Interior,
        options: &CalibrationOptions,
    ) -> Self {
        let mut options = options.clone();
        let Unknowns { estimated, priors } = &mut options.unknowns;
        estimated.retain(|parameter| !is_of_stage(parameter));
        priors.retain(|(parameter, _)| !is_of_stage(parameter));
        Self {
            records,
            fixed: BundleCalibration::new(tables, start, &options)
                .map_err(|error| error.to_string()),
        }
    }

    /// Returns what the flight cannot show, and the records that are in doubt, as warnings.
    pub(super) fn warnings(&self, calibration: &BundleCalibration) -> Vec<String> {
        let mut warnings = Vec::new();
        let tests = RecordTests::of(calibration, self.records.direction);
        for suspect in tests.suspects() {
            warnings.push(format!(
                "the record of image {} is in doubt: along the motion of its principal point the observed position is off by \
                 {:.3} m, test value {:.1}; look for a fault of encoder or shutter, not of image points",
                suspect.image, suspect.tested.residual, suspect.tested.test_value
            ));
        }
        if tests.all.is_empty() {
            warnings.push(
                "no image has an observed position (sigma_x_m,sigma_y_m,sigma_z_m in --images): no record is tested"
                    .to_owned(),
            );
        }
        if let Some([least, most]) = self.records.offsets_mm()
            && most - least < CONSTANT_MM
        {
            warnings.push(format!(
                "the principal points of all records lie within {:.2} µm: they buy nothing in this flight",
                1e3 * (most - least)
            ));
        } else if is_blind_to_sign(calibration, self.records.direction) {
            warnings.push(format!(
                "no strip crosses another and there are fewer than {LEAST_CONTROL} control points: σ0 would be the same with \
                 records of the wrong sign"
            ));
        }
        if let Err(error) = &self.fixed {
            warnings.push(format!("the static bundle ends in an error: {error}"));
        }
        warnings
    }

    /// Returns the keys of `summary.json`.
    pub(super) fn summary(&self, calibration: &BundleCalibration) -> Map<String, Value> {
        let tests = RecordTests::of(calibration, self.records.direction);
        let suspects: Vec<Value> = tests
            .suspects()
            .into_iter()
            .map(|one| json!({"image": one.image, "test_value": one.tested.test_value}))
            .collect();
        let [least, most] = self.records.offsets_mm().unwrap_or_default();
        let mut summary = Map::new();
        summary.insert("suspect_records".to_owned(), json!(suspects));
        summary.insert(
            "records".to_owned(),
            json!({
                "tested": tests.all.len(),
                "critical_value": tests.critical,
                "least_centroid_offset_mm": least,
                "most_centroid_offset_mm": most,
                "principal_points": "held",
                "largest_principal_point_sigma_mm": self.largest_sigma_mm(),
                "check_points": check_points_rms_m(calibration),
            }),
        );
        summary.insert(
            "static_bundle".to_owned(),
            match &self.fixed {
                Ok(fixed) => json!({
                    "sigma0": fixed.snooped.solution.sigma0(),
                    "redundancy": fixed.snooped.solution.redundancy(),
                    "check_points": check_points_rms_m(fixed),
                    "rms_difference_m": difference_rms_m(calibration, fixed),
                }),
                Err(error) => json!({"error": error}),
            },
        );
        summary
    }

    /// Returns the figures of the page: tests of the records, and object points of both bundles.
    pub(super) fn figures(
        &self,
        calibration: &BundleCalibration,
        camera: &str,
    ) -> Result<Vec<Figure>, FigureError> {
        let direction = self.records.direction;
        let bundles = [
            ("with records", Some(calibration)),
            ("static", self.fixed.as_ref().ok()),
        ];
        let bundles = bundles
            .into_iter()
            .filter_map(|(words, bundle)| Some((words, bundle?)));
        let bundles: Vec<(&'static str, &BundleCalibration)> = bundles.collect();
        let tests = RecordTests::of(calibration, direction);
        let mut figures = Vec::new();
        if !tests.all.is_empty() {
            let values = |bundle: &BundleCalibration| {
                let tests = RecordTests::of(bundle, direction).all.into_iter();
                let tested = tests.map(|test| test.tested);
                tested
                    .map(|one| one.test_value.copysign(one.residual))
                    .collect()
            };
            let drawn = BesideEachOther {
                title: format!("{camera}: observed positions along the motion"),
                numbered: "image, in the order of the image points",
                quantity: "test value τ, with the sign of the residual",
                limit: Some(tests.critical),
                series: series(&bundles, values),
            };
            figures.push(Figure {
                file_name: "record-tests.svg".to_owned(),
                caption: "Test of every record: residual of the observed position along the motion of the principal point. The \
                          lines are the critical value; an image beyond it with records has a record in doubt."
                    .to_owned(),
                svg: drawn.svg()?,
            });
        }
        let motion = motion_on_ground(calibration, direction);
        let checked = series(&bundles, |bundle| check_points_along_m(bundle, motion));
        let has_check = checked.iter().any(|one| !one.values.is_empty());
        let (title, series) = match &self.fixed {
            _ if has_check => ("check points, adjusted less given", checked),
            Ok(fixed) => (
                "object points of the two bundles",
                vec![Series {
                    words: "with records less static",
                    values: differences_along_m(calibration, fixed, motion),
                }],
            ),
            Err(_) => return Ok(figures),
        };
        if series.iter().all(|one| one.values.is_empty()) {
            return Ok(figures);
        }
        let drawn = BesideEachOther {
            title: format!("{camera}: {title}"),
            numbered: "point, in the order of the image points",
            quantity: "along the motion, m",
            limit: None,
            series,
        };
        figures.push(Figure {
            file_name: "static-bundle.svg".to_owned(),
            caption: "Object points with records and in the static bundle, along the motion of the principal point of the first \
                      image."
                .to_owned(),
            svg: drawn.svg()?,
        });
        Ok(figures)
    }

    /// Returns the tables of terminal and page.
    pub(super) fn tables(&self, calibration: &BundleCalibration) -> Vec<PageTable> {
        let mut columns = vec![String::new(), "with records".to_owned()];
        let mut rows = figures(calibration);
        if let Ok(fixed) = &self.fixed {
            columns.push("static".to_owned());
            for (row, other) in rows.iter_mut().zip(figures(fixed)) {
                row.extend(other.into_iter().skip(1));
            }
        }
        let fixed = self.fixed.as_ref().ok();
        let apart = fixed
            .and_then(|fixed| difference_rms_m(calibration, fixed))
            .map_or_else(String::new, |[x, y, z]| {
                format!(
                    " Object points of the two differ by {x:.3}, {y:.3}, {z:.3} m (root mean square)."
                )
            });
        let caption = format!(
            "The principal points of the records are held; their σ is {:.2} µm at most. The static bundle has one principal \
             point for all images.{apart}",
            1e3 * self.largest_sigma_mm()
        );
        vec![PageTable {
            title: "Records of the flight".to_owned(),
            columns,
            rows,
            caption,
        }]
    }

    fn largest_sigma_mm(&self) -> f64 {
        let sigmas = self.records.exposed().map(|row| row.sigma_mm);
        sigmas.fold(0.0, f64::max)
    }
}

/// Returns values of each bundle under its name.
fn series(
    bundles: &[(&'static str, &BundleCalibration)],
    values: impl Fn(&BundleCalibration) -> Vec<f64>,
) -> Vec<Series> {
    let named = bundles.iter();
    named
        .map(|(words, bundle)| Series {
            words,
            values: values(bundle),
        })
        .collect()
}

/// Returns true for an unknown of the stage.
const fn is_of_stage(parameter: &Parameter) -> bool {
    matches!(parameter, Parameter::Stage(_))
}

/// Returns σ0, redundancy and check points of a bundle, each under its name.
fn figures(calibration: &BundleCalibration) -> Vec<Vec<String>> {
    let solution = &calibration.snooped.solution;
    let mut rows = vec![
        vec!["σ0".to_owned(), format!("{:.3}", solution.sigma0())],
        vec!["redundancy".to_owned(), solution.redundancy().to_string()],
    ];
    if let Some([x, y, z]) = check_points_rms_m(calibration) {
        for (axis, rms) in [("x", x), ("y", y), ("z", z)] {
            rows.push(vec![
                format!("check points, {axis}, RMS, m"),
                format!("{rms:.4}"),
            ]);
        }
    }
    rows
}
