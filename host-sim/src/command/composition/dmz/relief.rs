//! Both ways over relief: rigs and virtual images against truth.

use fmc_composition::image::Plane;
use fmc_composition::radiometry::Correction;
use fmc_composition::rig::{Heights, Rig};
use fmc_composition::scene::{Judgement, Scene, SceneRequest};
use fmc_report::composition::page::Section;

use super::findings::{Check, Findings, LARGEST_PX, LARGEST_STEP_PX, calibrated};
use super::places::Places;
use crate::command::composition::virtual_image::{Choices, Frames, Summary, compose_frames};
use crate::failure::Failure;

/// Relief, standard deviation of the heights, m, and whether virtual images are composed over it.
const RELIEFS_M: [(f64, bool); 5] = [
    (0.0, true),
    (1.0, true),
    (5.0, true),
    (10.0, false),
    (30.0, true),
];
/// Pixels around its place in which a place of the virtual image is searched.
pub(super) const SEARCH_PX: usize = 8;
/// Pixels beyond it, at most, where heights are ignored.
const MOST_FURTHER_PX: u16 = 40;

/// A way: its rig, corrections and kernel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'a> {
    pub(super) heights: Heights,
    pub(super) corrections: &'a [Correction],
    pub(super) choices: Choices,
}

/// Outcome of one way for a relief.
#[derive(Debug)]
struct Outcome {
    rig: Judgement,
    /// Virtual image; `None` where none is composed.
    image: Option<Image>,
}

/// Places of a virtual image and steps at its seams, or why there is none.
type Image = Result<(Places, Option<f64>), String>;

/// Calibrates rigs and composes virtual images over every relief, our way beside that of Zhao et
/// al.
pub(super) fn over_relief(
    request: &SceneRequest,
    [own, published]: [Way; 2],
    findings: &mut Findings,
) -> Result<(), Failure> {
    let (mut of_rigs, mut of_images) = (Vec::new(), Vec::new());
    for (relief_m, with_image) in RELIEFS_M {
        let scene = Scene::new(SceneRequest {
            relief_m,
            ..*request
        });
        let truth = with_image.then(|| scene.true_image(0));
        let truth = truth.as_ref();
        let ours = outcome(&scene, truth, own)?;
        let theirs = outcome(&scene, truth, published);
        check(relief_m, &ours, findings);
        of_rigs.push(rig_row(
            relief_m,
            &ours.rig,
            theirs.as_ref().ok().map(|one| &one.rig),
        ));
        if let Some(ours) = &ours.image {
            let mut row = vec![format!("{relief_m}")];
            row.extend(image_cells(ours));
            row.extend(match &theirs {
                Ok(theirs) => theirs.image.as_ref().map(image_cells).unwrap_or_default(),
                Err(error) => [error.text(), String::new(), String::new()],
            });
            of_images.push(row);
        }
    }
    findings.sections.push(Section {
        heading: "Relief: rig".to_owned(),
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
        rows: of_rigs,
        caption: "Calibrated rig against the true one, root mean square of a coordinate at 30 places of each sub-image; what orientations take up is taken off. Heights used: both exposures; Zhao et al.: one.".to_owned(),
        ..Section::default()
    });
    findings.sections.push(Section {
        heading: "Relief: virtual image".to_owned(),
        columns: [
            "σ of relief, m",
            "heights used, px",
            "places",
            "steps, px",
            "Zhao et al., px",
            "places",
            "steps, px",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: of_images,
        caption: "Composed against true virtual image of the first exposure, matched at 30 places of each sub-image, root mean square of a coordinate after one cubic over the frame; steps: matched in the overlaps. Zhao et al.: template, X, Y of the ground without heights, registered to green, bilinear.".to_owned(),
        ..Section::default()
    });
    Ok(())
}

fn outcome(scene: &Scene, truth: Option<&Plane>, way: Way) -> Result<Outcome, Failure> {
    let exposures: &[usize] = match way.heights {
        Heights::Use => &[0, 1],
        Heights::Ignore => &[0],
    };
    let rig = calibrated(scene, exposures, way.heights)?.rig;
    let judged = scene
        .judge(&rig)
        .ok_or_else(|| Failure::bad_input("the rig has other sub-images than its scene"))?;
    let image = truth.map(|truth| {
        let image = composed(scene, &rig, truth, way);
        image.map_err(|error| error.text())
    });
    Ok(Outcome { rig: judged, image })
}

fn composed(
    scene: &Scene,
    rig: &Rig,
    truth: &Plane,
    way: Way,
) -> Result<(Places, Option<f64>), Failure> {
    let mut subs = Vec::new();
    for (number, correction) in way.corrections.iter().enumerate() {
        let mut plane = scene.sub_image(0, number, &scene.detector(number));
        if !correction.apply(&mut plane) {
            return Err(Failure::bad_input("the radiometry is of another size"));
        }
        subs.push(plane);
    }
    let frames = Frames {
        subs,
        green: scene.green_image(0),
    };
    let composed = compose_frames(rig, &frames, way.choices, "relief")?;
    let search_px = match way.heights {
        Heights::Use => SEARCH_PX,
        Heights::Ignore => wide_search_px(scene.request.relief_m),
    };
    let places = Places::find(rig, &composed.composite.layer.plane, truth, search_px);
    let step = Summary::of(rig, &composed, way.choices, None).seam_step_px;
    Ok((places, step))
}

/// Returns the pixels around its place in which a place is searched where heights are ignored: a
/// metre of relief displaces by some pixels.
pub(super) fn wide_search_px(relief_m: f64) -> usize {
    let further = fmc_composition::grey(1.5 * relief_m);
    SEARCH_PX + usize::from(further.min(MOST_FURTHER_PX))
}

fn check(relief_m: f64, ours: &Outcome, findings: &mut Findings) {
    let places = "at 30 places of each sub-image";
    let mut judge = |what: &str, found: f64, most: f64, complete: bool| {
        findings.checks.push(Check {
            what: format!("relief {relief_m} m: {what}, px rms"),
            found,
            limit: format!("at most {most}"),
            passed: complete && found <= most,
        });
    };
    let of_rig = format!("rig against truth {places}");
    judge(&of_rig, ours.rig.rig_px, LARGEST_PX, true);
    let seams_px = ours.rig.seams_px;
    judge("steps of the rig at seams", seams_px, LARGEST_STEP_PX, true);
    let Some(image) = &ours.image else {
        return;
    };
    let (image_px, complete, step_px) = match image {
        Ok((places, step)) => (places.residual_px(), places.is_complete(), *step),
        Err(_) => (f64::INFINITY, false, None),
    };
    let of_image = format!("virtual image against truth {places}, after one cubic");
    judge(&of_image, image_px, LARGEST_PX, complete);
    let step_px = step_px.unwrap_or(f64::INFINITY);
    let of_steps = "steps of the virtual image at seams";
    judge(of_steps, step_px, LARGEST_STEP_PX, true);
}

fn rig_row(relief_m: f64, ours: &Judgement, theirs: Option<&Judgement>) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or("refused".to_owned(), |px| format!("{px:.2}"));
    vec![
        format!("{relief_m}"),
        number(Some(ours.rig_px)),
        number(Some(ours.after_cubic_px)),
        number(Some(ours.seams_px)),
        number(theirs.map(|one| one.after_cubic_px)),
        number(theirs.map(|one| one.seams_px)),
    ]
}

fn image_cells(image: &Image) -> [String; 3] {
    match image {
        Ok((places, step)) => [
            format!("{:.2}", places.residual_px()),
            format!("{} of {}", places.matched, places.tried),
            step.map_or("none".to_owned(), |step| format!("{step:.2}")),
        ],
        Err(error) => [error.clone(), String::new(), String::new()],
    }
}
