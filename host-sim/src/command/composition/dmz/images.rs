//! Both exposures of the scene composed, in either way, against truth.

use fmc_composition::image::Plane;
use fmc_composition::radiometry::{Method, SATURATION_DN};
use fmc_composition::rig::{Heights, Rig};
use fmc_composition::scene::Scene;
use fmc_rectification::Resampling;
use fmc_report::composition::page::Section;

use super::findings::{Check, Findings, LARGEST_PX, LARGEST_STEP_PX, calibrated};
use super::places::Places;
use super::relief::{SEARCH_PX, Way, wide_search_px};
use super::{figure, uniformity};
use crate::cli::OrderName;
use crate::command::composition::virtual_image::{
    self, Choices, Composed, Corrections, Frames, Summary, compose_frames, read_frames,
};
use crate::command::composition::{preview, radiometry, rig as rig_command};
use crate::failure::Failure;
use crate::formats::output::OutputFolder;

/// Corrections and choices of both ways, with the virtual images of ours.
#[derive(Debug)]
pub(super) struct Ways {
    pub(super) rig: Rig,
    pub(super) planes: [Plane; 2],
    corrections: [Vec<fmc_composition::radiometry::Correction>; 2],
    choices: [Choices; 2],
}

impl Ways {
    /// Our way, then that of Zhao et al.
    pub(super) fn both(&self) -> [Way<'_>; 2] {
        let [own, published] = &self.corrections;
        [
            Way {
                heights: Heights::Use,
                corrections: own,
                choices: self.choices[0],
            },
            Way {
                heights: Heights::Ignore,
                corrections: published,
                choices: self.choices[1],
            },
        ]
    }
}

/// Calibrates radiometry and rig, composes both exposures, ours and the publication's way.
pub(super) fn compose(
    scene: &Scene,
    of_scene: &OutputFolder,
    folder: &OutputFolder,
    findings: &mut Findings,
) -> Result<Ways, Failure> {
    let nominal = &scene.rig;
    let calibrated_by =
        |method| radiometry::calibrate(nominal, of_scene.path(), method, SATURATION_DN);
    let radiometries = [
        calibrated_by(Method::OffsetAndGain)?,
        calibrated_by(Method::Template)?,
    ];
    uniformity::judge(scene, [&radiometries[0], &radiometries[1]], findings);
    let corrections = radiometries.map(|one| {
        let detectors = one.detectors.into_iter();
        detectors
            .map(|(correction, _)| correction)
            .collect::<Vec<_>>()
    });
    let own = Choices {
        order: OrderName::RectifyFirst,
        kernel: Resampling::Bicubic,
        feather_px: 5,
    };
    let published = Choices {
        kernel: Resampling::Bilinear,
        ..own
    };
    let found = calibrated(scene, &[0, 1], Heights::Use)?;
    let held = found.movements.iter().filter(|one| one.held);
    findings.sections.push(Section {
        heading: "Calibration of the rig".to_owned(),
        caption: format!(
            "Residuals of {} points of both exposures; σ0 {:.3}. Kept nominal: {}.",
            found.residuals.len(),
            found.sigma0,
            held.map(|one| one.movement.name())
                .collect::<Vec<_>>()
                .join(", ")
        ),
        figure: Some(rig_command::figure(&found)?),
        ..Section::default()
    });
    let mut planes = Vec::new();
    for (exposure, one) in scene.exposures.iter().enumerate() {
        let path = of_scene.path().join(&one.name);
        let frames = read_frames(nominal, &path, Corrections::Known(&corrections[0]))?;
        let composed = compose_frames(&found.rig, &frames, own, &one.name)?;
        let out = OutputFolder::create(&folder.path().join(format!("virtual_{}", one.name)))?;
        virtual_image::write(&found.rig, &composed, &out)?;
        let truth = scene.true_image(exposure);
        let plane = &composed.composite.layer.plane;
        let places = Places::find(&found.rig, plane, &truth, SEARCH_PX);
        let summary = Summary::of(&found.rig, &composed, own, Some(Method::OffsetAndGain));
        check(&one.name, &places, summary.seam_step_px, findings);
        if exposure == 0 {
            findings.sections.push(summary.section());
            findings.sections.push(preview::images(&composed)?);
            mosaic_first(&found.rig, &frames, own, findings)?;
            let ours = figure::Composed {
                plane,
                places: &places,
            };
            let recorded = read_frames(nominal, &path, Corrections::Without)?;
            let theirs = read_frames(nominal, &path, Corrections::Known(&corrections[1]))?;
            let theirs = publication(scene, &truth, &theirs, published, findings)?;
            let theirs = theirs.as_ref().map(|(composed, places)| figure::Composed {
                plane: &composed.composite.layer.plane,
                places,
            });
            let svg = figure::svg(scene, &recorded, ours, theirs)?;
            folder.write("figure.svg", |sink| sink.write_all(svg.as_bytes()))?;
            findings.sections.push(Section {
                heading: "Before, after, and the difference from truth".to_owned(),
                caption: figure::CAPTION.to_owned(),
                figure: Some(svg),
                ..Section::default()
            });
        }
        planes.push(composed.composite.layer.plane);
    }
    let planes = planes
        .try_into()
        .map_err(|_| Failure::bad_input("the scene has other exposures than two"))?;
    Ok(Ways {
        rig: found.rig,
        planes,
        corrections,
        choices: [own, published],
    })
}

/// Judges the virtual image of an exposure.
fn check(name: &str, places: &Places, step_px: Option<f64>, findings: &mut Findings) {
    let found = places.residual_px();
    findings.checks.push(Check {
        what: format!(
            "{name}: virtual image against truth, {} of {} places matched, after one cubic, px rms",
            places.matched, places.tried
        ),
        found,
        limit: format!("at most {LARGEST_PX}, of 9 in 10 places"),
        passed: found <= LARGEST_PX && places.is_complete(),
    });
    let step = step_px.unwrap_or(f64::INFINITY);
    findings.checks.push(Check {
        what: format!("{name}: step at the seams by matching, px"),
        found: step,
        limit: format!("at most {LARGEST_STEP_PX}"),
        passed: step <= LARGEST_STEP_PX,
    });
}

/// Steps at the seams where a mosaic of shifts comes first.
fn mosaic_first(
    rig: &Rig,
    frames: &Frames,
    choices: Choices,
    findings: &mut Findings,
) -> Result<(), Failure> {
    let choices = Choices {
        order: OrderName::MosaicFirst,
        ..choices
    };
    let composed = compose_frames(rig, frames, choices, "mosaic")?;
    let step = step_text(Summary::of(rig, &composed, choices, None).seam_step_px);
    let line = format!("Mosaic first, shown: steps at the seams {step}.");
    findings.lines.push(line);
    Ok(())
}

/// The publication's way: template, polynomials of the ground without heights, registration to
/// green, bilinear.
fn publication(
    scene: &Scene,
    truth: &Plane,
    frames: &Frames,
    choices: Choices,
    findings: &mut Findings,
) -> Result<Option<(Composed, Places)>, Failure> {
    let found = calibrated(scene, &[0], Heights::Ignore)?;
    match compose_frames(&found.rig, frames, choices, "publication") {
        Ok(composed) => {
            let plane = &composed.composite.layer.plane;
            let places = Places::find(
                &found.rig,
                plane,
                truth,
                wide_search_px(scene.request.relief_m),
            );
            let summary = Summary::of(&found.rig, &composed, choices, Some(Method::Template));
            findings.lines.push(format!(
                "The publication's way, shown: virtual image against truth {:.2} px after one cubic, {} of {} places matched, steps at the seams {}.",
                places.residual_px(),
                places.matched,
                places.tried,
                step_text(summary.seam_step_px)
            ));
            Ok(Some((composed, places)))
        }
        Err(error) => {
            let line = format!("The publication's way ends: {}.", error.text());
            findings.lines.push(line);
            Ok(None)
        }
    }
}

fn step_text(step_px: Option<f64>) -> String {
    step_px.map_or("no match".to_owned(), |step| format!("{step:.2} px"))
}
