//! The verification as a self-contained page: `report.html`.

use askama::Template;
use fmc_reference::verification::result::{CameraResult, Verification};

use super::comparison::Comparison;
use super::distortion_field;
use super::error_plot;
use super::run_up::{self, RunUp};
use super::verdict::{self, Verdict};
use crate::figure::FigureError;
use crate::page::{PageError, inline};
use crate::{length, wording};

/// Content of the page.
#[derive(Template)]
#[template(path = "report.html")]
struct Page {
    passed: bool,
    headline: String,
    failures: Vec<String>,
    worst: Option<String>,
    place: String,
    is_stand_in: bool,
    evidence: String,
    limits: String,
    comparison: Comparison,
    run_ups: Vec<RunUp>,
    longest_travel: Option<String>,
    cameras: Vec<Section>,
    solver_error: String,
}

/// Section of one camera.
struct Section {
    name: String,
    principal_distance_mm: String,
    format: String,
    pixel_um: String,
    axis: &'static str,
    points: String,
    exposures: usize,
    distortion: String,
    dynamic: String,
    error: String,
}

/// Writes the whole verification as one HTML page, with the figures in it.
///
/// # Errors
/// [`PageError`] if a figure cannot be drawn.
pub fn page(verification: &Verification) -> Result<String, PageError> {
    let verdict = Verdict::of(verification);
    let cameras = verification
        .cameras
        .iter()
        .map(Section::of)
        .collect::<Result<_, _>>()?;
    let solver_error_mm = verification
        .cameras
        .iter()
        .map(CameraResult::solver_error_mm)
        .fold(0.0, f64::max);
    let page = Page {
        passed: verdict.passed,
        headline: verdict.headline,
        failures: verdict.failures,
        worst: verdict.worst,
        place: verification.place(),
        is_stand_in: verification.not_in_qemu.is_some(),
        evidence: wording::evidence(&verification.evidence),
        limits: verdict::limits(),
        comparison: Comparison::of(verification),
        run_ups: run_up::all(verification),
        longest_travel: longest_travel(verification),
        cameras,
        solver_error: length::text(solver_error_mm),
    };
    Ok(page.render()?)
}

/// Returns δ of the exposure with the largest.
fn longest_travel(verification: &Verification) -> Option<String> {
    verification
        .cameras
        .iter()
        .map(|camera| camera.travel_mm()[1])
        .max_by(f64::total_cmp)
        .map(length::text)
}

impl Section {
    fn of(camera: &CameraResult) -> Result<Self, FigureError> {
        let [width, height] = camera.format_mm;
        Ok(Self {
            name: camera.name.clone(),
            principal_distance_mm: wording::decimals(camera.principal_distance_mm, 4),
            format: format!("{width:.1} x {height:.1}"),
            pixel_um: wording::decimals(camera.pixel_um, 2),
            axis: camera.axis,
            points: wording::count(camera.points),
            exposures: camera.frames.len(),
            distortion: inline(distortion_field::distortion(camera)?),
            dynamic: inline(distortion_field::dynamic(camera)?),
            error: inline(error_plot::error_against_travel(camera)?),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::assert_stands_alone;
    use crate::verification::fixture;

    #[test]
    fn page_stands_alone_and_shows_every_camera_with_three_figures() {
        let page = page(&fixture::passing()).unwrap();
        assert!(page.contains(">Alpha<") && page.contains(">Beta<"));
        // The page has a schematic in two parts and three figures for each camera.
        assert_stands_alone(&page, 2 + 2 * 3);
        assert!(page.contains("class=\"verdict passed\""));
    }

    #[test]
    fn failing_page_says_so_and_names_the_camera() {
        let page = page(&fixture::failing()).unwrap();
        assert!(page.contains("class=\"verdict failed\""));
        assert!(page.contains("Beta: error of dx or dy 2.00 nm exceeds 1.5 nm"));
        assert!(page.contains("class=\"fail\""));
    }

    #[test]
    fn page_says_first_and_last_where_it_ran() {
        let mut verification = fixture::passing();
        let place = "Computed by: mock camera";
        assert_eq!(page(&verification).unwrap().matches(place).count(), 2);
        verification.not_in_qemu = Some("no QEMU: no network".to_owned());
        let place = "Computed by: mock camera, NOT in QEMU: no QEMU: no network";
        let page = page(&verification).unwrap();
        assert_eq!(page.matches(place).count(), 2);
        assert_eq!(page.matches("<p class=\"stand-in\">").count(), 2);
    }

    #[test]
    fn names_are_text_and_not_markup() {
        let mut verification = fixture::passing();
        verification.cameras[0].name = "<script>alert(1)</script>".to_owned();
        let page = page(&verification).unwrap();
        assert!(!page.contains("<script>"));
    }
}
