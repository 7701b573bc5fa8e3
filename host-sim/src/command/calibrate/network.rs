//! `calibrate resection` and `calibrate bundle`: calibration by a network of images.

use std::collections::HashMap;
use std::path::Path;

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions, GrossErrors};
use fmc_adjustment::bundle::error::{BundleCalibrationError, BundleError};
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::tables::{NetworkTables, RowRole};
use fmc_adjustment::calibration::result::InputFile;
use fmc_report::calibration::result::of_method::{OfMethod, PageTable};
use serde_json::{Map, json};

use super::flight_records::WithRecords;
use super::hand_over;
use super::held_grids::HeldGrids;
use super::report::{self, Prepared};
use crate::cli::{BundleArgs, NetworkArgs, ResectionArgs};
use crate::failure::{Failure, note};
use crate::formats::{flight_records as flight_records_file, network_tables};

/// Runs `calibrate resection`.
pub(in crate::command) fn resection(args: &ResectionArgs) -> Result<(), Failure> {
    run("resection", &args.network, None)
}

/// Runs `calibrate bundle`.
pub(in crate::command) fn bundle(args: &BundleArgs) -> Result<(), Failure> {
    run("bundle", &args.network, Some(args))
}

fn run(
    method: &'static str,
    args: &NetworkArgs,
    bundle: Option<&BundleArgs>,
) -> Result<(), Failure> {
    let scale_bars = bundle.and_then(|args| args.scale_bars.as_deref());
    let records_path = bundle.and_then(|args| args.records.as_deref());
    let formats = bundle.map_or(&[][..], |args| &args.export);
    report::check_date(&args.common.files)?;
    let (camera, held) = HeldGrids::read(&args.common.files.camera)?;
    let (image_points, image_file) = network_tables::image_points(&args.image_points, &camera)?;
    let (object_points, object_file) = network_tables::object_points(&args.points)?;
    let mut inputs: Vec<InputFile> = vec![image_file, object_file];
    let images = args
        .images
        .as_deref()
        .map(network_tables::images)
        .transpose()?;
    let bars = scale_bars.map(network_tables::scale_bars).transpose()?;
    inputs.extend(images.iter().map(|(_, file)| file.clone()));
    inputs.extend(bars.iter().map(|(_, file)| file.clone()));
    let records = records_path
        .map(|path| flight_records_file::read(path, &camera, held.splines()))
        .transpose()?;
    inputs.extend(records.iter().map(|(_, file)| file.clone()));
    let mut tables = NetworkTables {
        image_points,
        object_points,
        images: images.map(|(table, _)| table),
        scale_bars: bars.map(|(table, _)| table),
        stages: HashMap::new(),
    }
    .with_grids(held.splines());
    if method == "resection" {
        check_all_known(&tables)?;
    }
    let unknowns = args.unknowns();
    check_priors(&unknowns)?;
    if records_path.is_none() {
        check_no_stage(&unknowns)?;
    }
    let options = CalibrationOptions {
        unknowns,
        datum: args.datum.into(),
        gross_errors: if args.common.keep_all {
            GrossErrors::Keep
        } else {
            GrossErrors::Reject
        },
    };
    let start = Interior::of(&camera);
    let mut with_records = None;
    if let Some((records, _)) = records {
        if bundle.is_some_and(|args| args.positions_at_trigger) {
            tables = records.at_centroids(&tables)?;
        }
        let reduced = records.reduced(&tables)?;
        with_records = Some(WithRecords::new(records, &tables, start, &options));
        tables = reduced;
    }
    let calibration = BundleCalibration::new(&tables, start, &options)?;
    let mut result = calibration.result(method, &camera, inputs);
    if let Some(with_records) = &with_records {
        result.warnings.extend(with_records.warnings(&calibration));
    }
    for warning in &result.warnings {
        note(format_args!("warning: {warning}"));
    }
    let files = [
        Some(args.image_points.as_path()),
        Some(args.points.as_path()),
        args.images.as_deref(),
        scale_bars,
        records_path,
    ];
    let files: Vec<&Path> = files.into_iter().flatten().collect();
    let mut of_method = of_method(&calibration);
    of_method.files = hand_over::files(&calibration, &camera, formats)?;
    if let Some(with_records) = &with_records {
        of_method.summary.extend(with_records.summary(&calibration));
        of_method.tables = with_records.tables(&calibration);
        let figures = with_records.figures(&calibration, &camera.name);
        of_method.figures = figures.map_err(|error| report::failed(error.into()))?;
    }
    let text: Vec<String> = of_method.tables.iter().map(PageTable::text).collect();
    let folder = args.common.files.out.as_deref();
    let common = &args.common.files;
    let prepared = Prepared::of(&mut result, of_method, &held, common, &files, folder)?;
    report::print(&result, &text)?;
    prepared.write()
}

/// Checks that a resection has no object points with unknown coordinates.
fn check_all_known(tables: &NetworkTables) -> Result<(), Failure> {
    let known: std::collections::HashSet<&str> = tables
        .object_points
        .rows
        .iter()
        .filter(|row| row.role != RowRole::Approximate)
        .map(|row| &*row.point)
        .collect();
    let file = &tables.image_points.file;
    match tables
        .image_points
        .rows
        .iter()
        .find(|row| !known.contains(&*row.point))
    {
        Some(row) => Err(Failure::bad_input(format!(
            "{file}, line {}: point {} has no known coordinates in {}; a resection needs them, a bundle finds them",
            row.line, row.point, tables.object_points.file
        ))),
        None => Ok(()),
    }
}

/// Keys of `summary.json` that a network alone has: the adjustment before any rejection.
fn of_method(calibration: &BundleCalibration) -> OfMethod {
    let all = &calibration.unrejected;
    let interior = &all.state.parameters.interior;
    let parameters: Vec<_> = InteriorElement::ALL
        .into_iter()
        .map(|element| json!({"name": element.name(), "value": interior.value(element)}))
        .collect();
    let mut summary = Map::new();
    summary.insert(
        "all_observations".to_owned(),
        json!({
            "sigma0": all.sigma0(),
            "redundancy": all.redundancy(),
            "parameters": parameters,
        }),
    );
    OfMethod {
        summary,
        ..OfMethod::default()
    }
}

/// Checks that all priors are of unknowns: that of a value that is held would say nothing.
fn check_priors(unknowns: &Unknowns) -> Result<(), Failure> {
    let is_held = |(parameter, _): &&(_, _)| !unknowns.estimated.contains(parameter);
    match unknowns.priors.iter().find(is_held) {
        Some((parameter, _)) => Err(Failure::bad_input(format!(
            "--prior: {} is not estimated; name it in --estimate too",
            parameter.name(&[], |_| String::new())
        ))),
        None => Ok(()),
    }
}

/// Checks that no unknown is of the stage, whose place only records tell.
fn check_no_stage(unknowns: &Unknowns) -> Result<(), Failure> {
    let is_of_stage = |parameter: &&Parameter| matches!(parameter, Parameter::Stage(_));
    match unknowns.estimated.iter().find(is_of_stage) {
        Some(parameter) => Err(Failure::bad_input(format!(
            "--estimate: {} needs `calibrate bundle --records records.csv`; without records no image has a place of the stage",
            parameter.name(&[], |_| String::new())
        ))),
        None => Ok(()),
    }
}

impl From<BundleCalibrationError> for Failure {
    fn from(error: BundleCalibrationError) -> Self {
        match error {
            BundleCalibrationError::Input(error) => error.into(),
            BundleCalibrationError::Adjustment(error) => {
                let failure = Self::bad_input(error.to_string());
                match error {
                    BundleError::Inseparable { .. } => failure.with_help(
                        "estimate fewer unknowns (--estimate), or give what tells them apart: rolled and tilted images, a field with \
                         depth, two flying heights, cross strips, other V/H and exposure times, control, or a --prior",
                    ),
                    BundleError::NotConverged => failure.with_help(
                        "check the names of the points, the principal distance of the camera file and the direction of the axes",
                    ),
                    _ => failure,
                }
            }
        }
    }
}
