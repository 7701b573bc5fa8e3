//! `calibrate rig`: polynomials of the sub-images from control and ties.

use std::io::Write;

use fmc_composition::rig::Heights;
use fmc_composition::rig::calibration::{RigCalibration, RigOptions, calibrate};
use fmc_report::composition::residual_vectors::{self, Vector};
use serde::Serialize;

use super::files::{read_measurements, read_rig};
use super::scene::rig_text;
use crate::cli::{HeightsName, RigArgs};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Runs `calibrate rig`.
pub(in crate::command) fn run(args: &RigArgs) -> Result<(), Failure> {
    let rig = read_rig(&args.rig)?;
    let ties = args.ties.as_deref();
    let data = read_measurements(&rig, &args.control, ties, args.exposure.as_deref())?;
    let heights = match args.heights {
        HeightsName::Use => Heights::Use,
        HeightsName::Ignore => Heights::Ignore,
    };
    let found = calibrate(
        &rig,
        &data,
        &RigOptions {
            degree: args.degree.into(),
            heights,
            sigma_px: args.sigma_px,
        },
    )?;
    let out = args.out.join("rig.toml");
    output::check_not_an_input(&out, &args.rig)?;
    let text = rig_text(&found.rig, &args.out)?;
    let figure = figure(&found)?;
    let summary = Summary::of(&found, heights);
    let folder = OutputFolder::create(&args.out)?;
    folder.write("residuals.csv", |sink| residuals(&found, sink))?;
    folder.write("correlations.csv", |sink| correlations(&found, sink))?;
    folder.write("residuals.svg", |sink| sink.write_all(figure.as_bytes()))?;
    folder.write_json("summary.json", &summary)?;
    folder.write("rig.toml", |sink| sink.write_all(text.as_bytes()))?;
    output::write(None, |sink| print(&found, &summary, sink))?;
    note(format_args!(
        "{}: rig.toml, correlations.csv, residuals.csv, residuals.svg, summary.json",
        folder.path().display()
    ));
    Ok(())
}

/// Content of summary.json.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    heights: Heights,
    sigma0: f64,
    redundancy: usize,
    control_rms_px: Option<f64>,
    tie_rms_px: Option<f64>,
    not_separable: Vec<&'static str>,
    exposures: Vec<(String, [f64; 6])>,
    sub: Vec<SubSummary>,
    rejected: Vec<String>,
}

#[derive(Debug, Serialize)]
struct SubSummary {
    id: String,
    control: usize,
    ties: usize,
    largest_sigma_px: f64,
    mean_sigma_px: f64,
    sigma_u_px: Vec<f64>,
    sigma_v_px: Vec<f64>,
    largest_correlation: f64,
    of: [String; 2],
}

impl Summary {
    pub(super) fn of(found: &RigCalibration, heights: Heights) -> Self {
        let subs = found.rig.sub.iter().zip(&found.subs);
        let held = found.movements.iter().filter(|one| one.held);
        Self {
            heights,
            sigma0: found.sigma0,
            redundancy: found.redundancy,
            control_rms_px: found.rms_px(false),
            tie_rms_px: found.rms_px(true),
            not_separable: held.map(|one| one.movement.name()).collect(),
            exposures: match heights {
                Heights::Use => found
                    .exposures
                    .iter()
                    .map(|(name, orientation)| (name.clone(), orientation.elements().into()))
                    .collect(),
                Heights::Ignore => Vec::new(),
            },
            sub: subs
                .map(|(sub, quality)| SubSummary {
                    id: sub.id.clone(),
                    control: quality.control,
                    ties: quality.ties,
                    largest_sigma_px: quality.sigma_px,
                    mean_sigma_px: quality.mean_sigma_px,
                    sigma_u_px: quality.sigma_u.clone(),
                    sigma_v_px: quality.sigma_v.clone(),
                    largest_correlation: quality.largest_correlation().map_or(0.0, |one| one.value),
                    of: quality
                        .largest_correlation()
                        .map(|one| one.names.clone())
                        .unwrap_or_default(),
                })
                .collect(),
            rejected: found
                .rejected()
                .map(|one| {
                    let [right, down] = one.residual_px;
                    format!("{} of {}: {right:.2}, {down:.2} px", one.id, one.exposure)
                })
                .collect(),
        }
    }
}

fn print(found: &RigCalibration, summary: &Summary, sink: &mut dyn Write) -> std::io::Result<()> {
    if summary.heights == Heights::Ignore {
        writeln!(
            sink,
            "Zhao et al. 2013: X, Y of the ground without heights; relief bends the polynomials"
        )?;
    }
    let px = |value: Option<f64>| value.map_or("none".to_owned(), |value| format!("{value:.3} px"));
    writeln!(
        sink,
        "σ0 {:.3}, redundancy {}; residuals of control {}, of ties {} (root mean square)",
        summary.sigma0,
        summary.redundancy,
        px(summary.control_rms_px),
        px(summary.tie_rms_px)
    )?;
    writeln!(
        sink,
        "sub-image  control  ties  σ mean px  σ largest px  largest correlation"
    )?;
    for sub in &summary.sub {
        writeln!(
            sink,
            "{:>9}  {:>7}  {:>4}  {:>9.3}  {:>12.3}  {:>6.3} ({}, {})",
            sub.id,
            sub.control,
            sub.ties,
            sub.mean_sigma_px,
            sub.largest_sigma_px,
            sub.largest_correlation,
            sub.of[0],
            sub.of[1]
        )?;
    }
    for one in found.movements.iter().filter(|one| one.held) {
        let why = if one.movement.is_turn() {
            "one with a turn of the camera"
        } else {
            "not separable from the orientations"
        };
        writeln!(sink, "kept nominal: {}, {why}", one.movement.name())?;
    }
    for one in &summary.rejected {
        writeln!(sink, "rejected as a gross error: {one}")?;
    }
    Ok(())
}

fn residuals(found: &RigCalibration, sink: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        sink,
        "id,exposure,image,kind,u_px,v_px,du_px,dv_px,sigma_px,accepted"
    )?;
    for one in &found.residuals {
        let image = found.rig.sub.get(one.sub).map_or("", |sub| sub.id.as_str());
        let kind = if one.is_tie { "tie" } else { "control" };
        let ([u, v], [right, down]) = (one.place_px, one.residual_px);
        writeln!(
            sink,
            "{},{},{image},{kind},{u:.2},{v:.2},{right:.4},{down:.4},{:.4},{}",
            one.id, one.exposure, one.sigma_px, one.accepted
        )?;
    }
    Ok(())
}

fn correlations(found: &RigCalibration, sink: &mut dyn Write) -> std::io::Result<()> {
    writeln!(sink, "image,first,second,correlation")?;
    for (sub, quality) in found.rig.sub.iter().zip(&found.subs) {
        for one in &quality.correlations {
            let [first, second] = &one.names;
            writeln!(sink, "{},{first},{second},{:.5}", sub.id, one.value)?;
        }
    }
    Ok(())
}

/// Draws the residuals over the virtual image.
pub(super) fn figure(found: &RigCalibration) -> Result<String, Failure> {
    let vectors: Vec<Vector> = found
        .residuals
        .iter()
        .map(|one| Vector {
            place_px: one.place_px,
            way_px: one.residual_px,
            is_tie: one.is_tie,
        })
        .collect();
    let frame = found.rig.frame;
    residual_vectors::svg([frame.width_px, frame.height_px], &vectors)
        .map_err(|error| Failure::device_or_io(format!("figure: {error}")))
}
