//! `dmz`: the publication repeated, its way beside ours, against truth.

mod pair;

use fmc_composition::image::Plane;
use fmc_composition::image::matching::{MatchOptions, find};
use fmc_composition::mosaic::registration::{Pair, Registration};
use fmc_composition::radiometry::{Method, SATURATION_DN};
use fmc_composition::rig::calibration::{RigCalibration, RigOptions, calibrate};
use fmc_composition::rig::control::Measurements;
use fmc_composition::rig::polynomial::normalised;
use fmc_composition::rig::{Heights, Rig};
use fmc_composition::scene::{Scene, SceneRequest};
use fmc_rectification::Resampling;
use fmc_report::composition::page::{CompositionPage, Section};
use serde::Serialize;

use super::virtual_image::{self, Choices, Composed, Summary, compose_frames, read_frames};
use super::{preview, radiometry, rig as rig_command, scene as scene_command};
use crate::cli::{DmzArgs, OrderName};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Levels at which the radiometry is judged, with what may be left, percent.
const LEVELS: [(f64, f64); 4] = [(0.1, 0.4), (0.3, 0.2), (0.6, 0.2), (0.9, 0.2)];
/// Relief of the scenes in which rigs are judged, m.
const RELIEFS_M: [f64; 5] = [0.0, 1.0, 5.0, 10.0, 30.0];
/// Largest root mean square of a place, and of a step at a seam, px.
const LARGEST_PX: f64 = 0.25;
const LARGEST_STEP_PX: f64 = 0.2;
/// σ of measured image points, px.
const SIGMA_PX: f64 = 0.25;

/// A number with its limit.
#[derive(Debug, Serialize)]
struct Check {
    what: String,
    found: f64,
    limit: String,
    passed: bool,
}

/// Findings along the way.
#[derive(Debug, Default)]
struct Findings {
    checks: Vec<Check>,
    sections: Vec<Section>,
    lines: Vec<String>,
}

/// Runs `dmz`.
pub(in crate::command) fn run(args: &DmzArgs) -> Result<(), Failure> {
    let scene = Scene::new(scene_command::request(&args.scene));
    let folder = OutputFolder::create(&args.out)?;
    let of_scene = OutputFolder::create(&folder.path().join("scene"))?;
    scene_command::write(&scene, &of_scene, 4)?;
    let mut findings = Findings::default();
    let own = images_and_radiometry(&scene, &of_scene, &folder, &mut findings)?;
    over_relief(&scene.request, &mut findings)?;
    pair::stereo(&scene, &own, &mut findings)?;
    let passed = findings.checks.iter().all(|check| check.passed);
    let failed: Vec<&str> = findings
        .checks
        .iter()
        .filter(|check| !check.passed)
        .map(|check| check.what.as_str())
        .collect();
    let page = CompositionPage {
        title: format!("{}: Zhao et al. 2013, and beside it", scene.rig.name),
        findings: findings.lines.clone(),
        sections: std::iter::once(checks_section(&findings.checks))
            .chain(findings.sections)
            .collect(),
        passed: Some(passed),
    };
    let html = page
        .html()
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    folder.write("report.html", |sink| sink.write_all(html.as_bytes()))?;
    folder.write_json("summary.json", &findings.checks)?;
    output::write(None, |sink| {
        for line in &findings.lines {
            writeln!(sink, "{line}")?;
        }
        for check in &findings.checks {
            let verdict = if check.passed { "passed" } else { "FAILED" };
            writeln!(
                sink,
                "{verdict}: {}: {:.3}; {}",
                check.what, check.found, check.limit
            )?;
        }
        Ok(())
    })?;
    note(format_args!(
        "{}: report.html, summary.json, scene, virtual_8_10, virtual_8_11",
        folder.path().display()
    ));
    if passed {
        Ok(())
    } else {
        Err(Failure::check(format!(
            "beyond its limit: {}",
            failed.join("; ")
        )))
    }
}

/// Calibrates radiometry and rig, composes both exposures, ours and the publication's way.
fn images_and_radiometry(
    scene: &Scene,
    of_scene: &OutputFolder,
    folder: &OutputFolder,
    findings: &mut Findings,
) -> Result<(Rig, [Plane; 2]), Failure> {
    let nominal = &scene.rig;
    let own = radiometry::calibrate(
        nominal,
        of_scene.path(),
        Method::OffsetAndGain,
        SATURATION_DN,
    )?;
    let template =
        radiometry::calibrate(nominal, of_scene.path(), Method::Template, SATURATION_DN)?;
    uniformity(scene, [&own, &template], findings);
    let choices = Choices {
        order: OrderName::RectifyFirst,
        kernel: Resampling::Bicubic,
        feather_px: 5,
    };
    let found = calibrated(scene, &[0, 1], Heights::Use)?;
    findings.sections.push(Section {
        heading: "Calibration of the rig".to_owned(),
        caption: format!(
            "Residuals of {} points of both exposures; σ0 {:.3}. Kept nominal: {}.",
            found.residuals.len(),
            found.sigma0,
            found
                .movements
                .iter()
                .filter(|one| one.held)
                .map(|one| one.movement.name())
                .collect::<Vec<_>>()
                .join(", ")
        ),
        figure: Some(rig_command::figure(&found)?),
        ..Section::default()
    });
    let corrections: Vec<_> = own
        .detectors
        .into_iter()
        .map(|(correction, _)| correction)
        .collect();
    let mut planes = Vec::new();
    for (exposure, one) in scene.exposures.iter().enumerate() {
        let frames = read_frames(nominal, &of_scene.path().join(&one.name), &corrections)?;
        let composed = compose_frames(&found.rig, &frames, choices, &one.name)?;
        let out = OutputFolder::create(&folder.path().join(format!("virtual_{}", one.name)))?;
        virtual_image::write(&found.rig, &composed, &out)?;
        let truth = scene.true_image(exposure);
        let places = places(&found.rig, &composed.composite.layer.plane, &truth);
        judge_places(
            &one.name,
            "",
            &found.rig,
            &places,
            Some(LARGEST_PX),
            findings,
        );
        let summary = Summary::of(&found.rig, &composed, choices, Some(Method::OffsetAndGain));
        let step = summary.seam_step_px.unwrap_or(f64::INFINITY);
        findings.checks.push(Check {
            what: format!("{}: step at the seams by matching, px", one.name),
            found: step,
            limit: format!("at most {LARGEST_STEP_PX}"),
            passed: step <= LARGEST_STEP_PX,
        });
        if exposure == 0 {
            findings.sections.push(summary.section());
            findings.sections.push(preview::images(&composed)?);
            findings.sections.push(differences(&composed, &truth)?);
            let choices = Choices {
                order: OrderName::MosaicFirst,
                ..choices
            };
            let composed = compose_frames(&found.rig, &frames, choices, &one.name)?;
            let step = Summary::of(&found.rig, &composed, choices, None).seam_step_px;
            let step = step.map_or("no match".to_owned(), |step| format!("{step:.2} px"));
            findings
                .lines
                .push(format!("Mosaic first, shown: steps at the seams {step}."));
        }
        planes.push(composed.composite.layer.plane);
    }
    publication(scene, of_scene, template, choices, findings)?;
    let planes: [Plane; 2] = planes
        .try_into()
        .map_err(|_| Failure::bad_input("the scene has other exposures than two"))?;
    Ok((found.rig, planes))
}

/// The publication's way: template, polynomials of the ground without heights, registration to
/// green, bilinear.
fn publication(
    scene: &Scene,
    of_scene: &OutputFolder,
    template: radiometry::Radiometry,
    choices: Choices,
    findings: &mut Findings,
) -> Result<(), Failure> {
    let found = calibrated(scene, &[0], Heights::Ignore)?;
    let corrections: Vec<_> = template
        .detectors
        .into_iter()
        .map(|(correction, _)| correction)
        .collect();
    let choices = Choices {
        kernel: Resampling::Bilinear,
        ..choices
    };
    let Some(one) = scene.exposures.first() else {
        return Ok(());
    };
    let frames = read_frames(&scene.rig, &of_scene.path().join(&one.name), &corrections)?;
    match compose_frames(&found.rig, &frames, choices, &one.name) {
        Ok(composed) => {
            let places = places(
                &found.rig,
                &composed.composite.layer.plane,
                &scene.true_image(0),
            );
            judge_places(
                &one.name,
                "the publication's way, ",
                &found.rig,
                &places,
                None,
                findings,
            );
            let summary = Summary::of(&found.rig, &composed, choices, Some(Method::Template));
            let step = summary.seam_step_px;
            let step = step.map_or("no match".to_owned(), |step| format!("{step:.2} px"));
            findings.lines.push(format!(
                "The publication's way, shown: steps at the seams {step}."
            ));
        }
        Err(error) => findings
            .lines
            .push(format!("The publication's way ends: {}.", error.text())),
    }
    Ok(())
}

fn calibrated(
    scene: &Scene,
    exposures: &[usize],
    heights: Heights,
) -> Result<RigCalibration, Failure> {
    let mut data = Measurements {
        control_file: "control.csv".to_owned(),
        ..Measurements::default()
    };
    for exposure in exposures {
        data.control.extend(scene.control(*exposure));
        data.ties.extend(scene.ties(*exposure));
    }
    let options = RigOptions {
        degree: 3,
        heights,
        sigma_px: SIGMA_PX,
    };
    Ok(calibrate(&scene.rig, &data, &options)?)
}

/// Table of what the corrections leave of flats.
fn uniformity(scene: &Scene, methods: [&radiometry::Radiometry; 2], findings: &mut Findings) {
    let mut rows = Vec::new();
    for (level, limit) in LEVELS {
        let worst = methods.map(|method| {
            let each =
                method
                    .detectors
                    .iter()
                    .enumerate()
                    .filter_map(|(number, (correction, _))| {
                        let detector = scene.detector(number);
                        scene.uniformity(number, &detector, correction, level)
                    });
            100.0 * each.fold(0.0, f64::max)
        });
        let [own, template] = worst;
        rows.push(vec![
            format!("{:.0} %", 100.0 * level),
            format!("{own:.3}"),
            format!("{template:.2}"),
        ]);
        findings.checks.push(Check {
            what: format!(
                "radiometry at {:.0} % of full scale, worst detector, % rms",
                100.0 * level
            ),
            found: own,
            limit: format!("at most {limit}"),
            passed: own > 0.0 && own <= limit,
        });
    }
    findings.sections.push(Section {
        heading: "Radiometry".to_owned(),
        columns: ["level", "offset and gain, % rms", "template of Zhao et al., % rms"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        caption: "What is left of a flat without noise, worst of six detectors. A template that is subtracted is right at the mean level of its flats.".to_owned(),
        ..Section::default()
    });
}

/// Pairs of the composed and of the true image at 30 places of each sub-image.
fn places(rig: &Rig, composed: &Plane, truth: &Plane) -> (usize, Vec<Pair>) {
    let options = MatchOptions {
        half_px: [16, 16],
        search_px: 8,
        affine: true,
        least_correlation: 0.8,
    };
    let mut pairs = Vec::new();
    let mut tried = 0;
    for sub in &rig.sub {
        for number in 0..30_u32 {
            let part = |number: u32, count: u32| (f64::from(number) + 0.5) / f64::from(count);
            let [centre_col, centre_row] = sub.centre_px();
            let pixel = [
                2.0 * centre_col * part(number % 5, 5),
                2.0 * centre_row * part(number / 5, 6),
            ];
            let place = sub
                .nominal(rig.frame)
                .value(normalised(sub.size_px(), pixel));
            let [Some(col), Some(row)] = place.map(pixel_of) else {
                continue;
            };
            tried += 1;
            let middle = [f64::from(col), f64::from(row)];
            let near = [col as usize, row as usize];
            if let Some(found) = find(composed, near, truth, middle, &options) {
                pairs.push(Pair {
                    from_px: middle,
                    to_px: found.place_px,
                });
            }
        }
    }
    (tried, pairs)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place of an image"
)]
fn pixel_of(at: f64) -> Option<u32> {
    (0.0..1e6).contains(&at).then_some(at as u32)
}

/// Judges places after one cubic over the frame, as registration would take it off.
fn judge_places(
    name: &str,
    way: &str,
    rig: &Rig,
    (tried, pairs): &(usize, Vec<Pair>),
    limit: Option<f64>,
    findings: &mut Findings,
) {
    let size = [rig.frame.width_px, rig.frame.height_px];
    let fitted = Registration::unweighted(size, 3, pairs);
    let found = fitted.map_or(f64::INFINITY, |one| one.residual_px);
    let text = format!(
        "{name}: {way}virtual image against truth, {} of {tried} places matched, after one cubic, px rms",
        pairs.len()
    );
    match limit {
        Some(limit) => findings.checks.push(Check {
            what: text,
            found,
            limit: format!("at most {limit}, of 9 in 10 places"),
            passed: found <= limit && 10 * pairs.len() >= 9 * tried,
        }),
        None => findings.lines.push(format!("{text}, shown: {found:.2}.")),
    }
}

/// Rigs over relief: with heights and without.
fn over_relief(request: &SceneRequest, findings: &mut Findings) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for relief_m in RELIEFS_M {
        let scene = Scene::new(SceneRequest {
            relief_m,
            ..*request
        });
        let own = calibrated(&scene, &[0, 1], Heights::Use)?;
        let own = scene.judge(&own.rig);
        let ignored = calibrated(&scene, &[0], Heights::Ignore)
            .ok()
            .and_then(|found| scene.judge(&found.rig));
        let number =
            |value: Option<f64>| value.map_or("refused".to_owned(), |px| format!("{px:.2}"));
        rows.push(vec![
            format!("{relief_m}"),
            number(own.map(|one| one.rig_px)),
            number(own.map(|one| one.after_cubic_px)),
            number(own.map(|one| one.seams_px)),
            number(ignored.map(|one| one.after_cubic_px)),
            number(ignored.map(|one| one.seams_px)),
        ]);
        let (place, seams) = own.map_or((f64::INFINITY, f64::INFINITY), |one| {
            (one.rig_px, one.seams_px)
        });
        findings.checks.push(Check {
            what: format!(
                "rig against truth at 30 places of each sub-image, relief {relief_m} m, px rms"
            ),
            found: place,
            limit: format!("at most {LARGEST_PX}"),
            passed: place <= LARGEST_PX,
        });
        findings.checks.push(Check {
            what: format!("steps at seams, relief {relief_m} m, px rms"),
            found: seams,
            limit: format!("at most {LARGEST_STEP_PX}"),
            passed: seams <= LARGEST_STEP_PX,
        });
    }
    findings.sections.push(Section {
        heading: "Relief".to_owned(),
        columns: [
            "σ of relief, m",
            "heights used, px",
            "after one cubic, px",
            "seams, px",
            "Zhao et al. after one cubic, px",
            "seams, px",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        caption: "Calibrated rig against the true one, root mean square of a coordinate at 30 places of each sub-image; what orientations take up is taken off. Heights used: both exposures; Zhao et al.: one.".to_owned(),
        ..Section::default()
    });
    Ok(())
}

/// Before, after, and the difference from truth enlarged.
fn differences(composed: &Composed, truth: &Plane) -> Result<Section, Failure> {
    let plane = &composed.composite.layer.plane;
    let shade = |value: u16| u8::try_from(value.min(16_383) / 65).unwrap_or(255);
    let difference = |col: usize, row: usize| {
        let pair = plane.at(col, row).zip(truth.at(col, row));
        let (a, b) = pair.map_or((0, 0), |(a, b)| (i32::from(a), i32::from(b)));
        let value = if a == 0 { 0 } else { 128 + (a - b) * 100 / 65 };
        u8::try_from(value.clamp(0, 255)).unwrap_or(0)
    };
    Ok(Section {
        heading: "Against truth".to_owned(),
        caption: "Left the true image, in the middle the composed one, right their difference x 100; orientations and what they take up are in it.".to_owned(),
        images: vec![
            ("truth".to_owned(), preview::link(truth, |col, row| truth.at(col, row).map_or(0, shade))?),
            ("composed".to_owned(), preview::link(plane, |col, row| plane.at(col, row).map_or(0, shade))?),
            ("difference x 100".to_owned(), preview::link(plane, difference)?),
        ],
        ..Section::default()
    })
}

fn checks_section(checks: &[Check]) -> Section {
    let rows = checks.iter().map(|check| {
        let verdict = if check.passed { "passed" } else { "FAILED" };
        vec![
            check.what.clone(),
            format!("{:.3}", check.found),
            check.limit.clone(),
            verdict.to_owned(),
        ]
    });
    Section {
        heading: "Numbers and their limits".to_owned(),
        columns: ["what", "found", "limit", ""].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        ..Section::default()
    }
}
