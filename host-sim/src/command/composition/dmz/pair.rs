//! Stereo check of `dmz`: repeated in the publication's format, and of the composed pair.

use fmc_composition::image::Plane;
use fmc_composition::rig::Rig;
use fmc_composition::rig::polynomial::normalised;
use fmc_composition::scene::{Scene, SceneRequest};
use fmc_composition::stereo::{
    BaseAlong, Layout, StereoPoint, StereoRequest, StereoResult, adjust, repeated,
};
use fmc_report::composition::page::Section;

use super::findings::{Check, Findings};
use crate::command::composition::stereo::with_ties;
use crate::failure::Failure;

/// Repetitions of the stereo check, and σ of its image points, px.
const REPETITIONS: usize = 40;
const STEREO_PX: f64 = 0.3;
const CONTROL_M: f64 = 0.05;
/// Ranges of the error of check points in the plane and in height, m.
const PLANE_M: [f64; 2] = [0.15, 0.20];
const HEIGHT_M: [f64; 2] = [0.32, 0.41];
/// The stereo check, repeated, and of the composed pair.
pub(super) fn stereo(
    scene: &Scene,
    rig: &Rig,
    planes: &[Plane; 2],
    findings: &mut Findings,
) -> Result<(), Failure> {
    let mut rows = Vec::new();
    let request = |layout| StereoRequest {
        principal_distance_px: rig.principal_distance_px(),
        sigma_px: STEREO_PX,
        control_sigma_m: CONTROL_M,
        layout,
    };
    let (marks, ties) = with_ties(rig, planes, marks(scene, rig));
    // The repetitions are those of the publication's format, whatever the scale of the images.
    let full = SceneRequest {
        scale: 1,
        overlap_px: None,
        ..scene.request
    };
    let format = full.rig();
    for layout in Layout::ALL {
        let pair = adjust(&marks, &request(layout))?;
        for (base, ratio) in [(BaseAlong::Height, "0.40"), (BaseAlong::Width, "0.34")] {
            let seed = scene.request.seed;
            let of_format = StereoRequest {
                principal_distance_px: format.principal_distance_px(),
                ..request(layout)
            };
            let height_m = full.height_m();
            let found = repeated(&format, height_m, base, &of_format, REPETITIONS, seed)?;
            let plane = found.root_mean_square(StereoResult::check_plane_m);
            let height = found.root_mean_square(|one| one.check_m.map(|[_, _, z]| z));
            let text = |value: Option<[f64; 2]>| {
                value.map_or("no check".to_owned(), |[mean, half]| {
                    format!("{mean:.3} ± {half:.3}")
                })
            };
            let mut row = vec![
                layout.name().to_owned(),
                ratio.to_owned(),
                text(plane),
                text(height),
            ];
            if base == BaseAlong::Height {
                let number =
                    |value: Option<f64>| value.map_or("no check".to_owned(), |m| format!("{m:.3}"));
                row.push(number(pair.check_plane_m()));
                row.push(number(pair.check_m.map(|[_, _, z]| z)));
            } else {
                row.extend([String::new(), String::new()]);
            }
            rows.push(row);
            for (what, value, [least, most]) in
                [("plane", plane, PLANE_M), ("height", height, HEIGHT_M)]
            {
                if let Some([mean, half]) = value {
                    findings.checks.push(Check {
                        what: format!(
                            "stereo {} at B/H {ratio}, check points, {what}, m",
                            layout.name()
                        ),
                        found: mean,
                        limit: format!(
                            "{least} to {most}, ± {half:.3} of {REPETITIONS} repetitions"
                        ),
                        passed: mean + half >= least && mean - half <= most,
                    });
                }
            }
        }
    }
    findings.sections.push(Section {
        heading: "Stereo check".to_owned(),
        columns: ["layout", "B/H", "plane, m", "height, m", "composed pair: plane, m", "height, m"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        caption: format!(
            "Check points, image points of σ {STEREO_PX} px, 40 marks on 5 x 8, control of 5 cm, 120 ties, full format at 3900 m, root mean square of {REPETITIONS} repetitions with its interval of 95 %. With 40 control points there is no check: what they leave is a residual. The composed pair has the errors of its rig besides, {} marks and {ties} matched ties.",
            marks.len() - ties
        ),
        ..Section::default()
    });
    Ok(())
}

/// Marks of the composed pair: measured in sub-images, led to the virtual images by the rig.
fn marks(scene: &Scene, rig: &Rig) -> Vec<StereoPoint> {
    let [u, v] = rig.frame.centre_px();
    let of = |exposure: usize| -> Vec<(String, [f64; 2], [f64; 3])> {
        let control = scene.control(exposure).into_iter();
        let places = control.filter_map(|point| {
            let sub = rig.sub.get(point.place.sub)?;
            let place = rig
                .polynomial(sub)
                .value(normalised(sub.size_px(), point.place.pixel));
            Some((point.id, [place[0] - u, v - place[1]], point.ground_m))
        });
        places.collect()
    };
    let (first, second) = (of(0), of(1));
    let mut marks: Vec<StereoPoint> = Vec::new();
    for (id, place, ground_m) in first {
        let other = second.iter().find(|(one, _, _)| *one == id);
        if let Some((_, other, _)) = other
            && marks.iter().all(|mark| mark.id != id)
        {
            marks.push(StereoPoint {
                id,
                places_px: [place, *other],
                ground_m: Some(ground_m),
            });
        }
    }
    marks
}
