//! Computation of the terms over the exposures of a camera.

use fmc_camera::flight::camera::{Camera, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::image_motion::{ImageMotion, ImageMotionError, View};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, MechanismName};
use fmc_reference::exposure::{ExposurePath, ExposureRequest};
use fmc_reference::lens::Lens;
use fmc_reference::strict::{StrictSolver, Weight};
use fmc_reference::verification::grid::{self, GridExposure};

use super::assumptions::{Assumptions, FOCUS_REMAINDER};
use super::result::{Budget, Exposures, Source, Term};
use crate::smear::term::{self, Disturbances, NotBelievable};

/// Reason why a camera with residual grids has no budget.
pub const WITHOUT_GRIDS: &str =
    "its shares are those of the polynomial's terms, and a grid has none among them";

/// Error of a budget.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BudgetError {
    /// The camera's calibration is not valid.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// An assumption is outside its range.
    #[error(transparent)]
    Assumption(#[from] NotBelievable),
    /// Part of the sensor does not see the ground.
    #[error(transparent)]
    ImageMotion(#[from] ImageMotionError),
    /// The camera accepts none of the exposures that its limits allow.
    #[error("none of the exposures that [limits] allow can be taken: {0}")]
    NoExposure(FrameError),
}

/// Computes the budget of a camera.
///
/// # Errors
/// [`BudgetError`] if the camera accepts none of its exposures.
pub fn budget(camera: &CameraFile, assumptions: Assumptions) -> Result<Budget, BudgetError> {
    let checked = Camera::new(camera.parameters())?;
    let strategy = match camera.fmc.mechanism {
        MechanismName::Tdi => None,
        MechanismName::Stage => Some(camera.fmc.strategy.unwrap_or_default()),
    };
    let paper = Set::of(&checked, camera, &grid::of_the_paper(strategy));
    let limits = Set::of(&checked, camera, &grid::over_the_limits(camera, strategy));
    if let (true, Some(error)) = (limits.accepted.is_empty(), limits.refusal) {
        return Err(BudgetError::NoExposure(error));
    }
    let view = View::calibrated(checked.calibration());
    let terms_of = |set: &Set| set.effects(camera, &view, &assumptions);
    let over_limits = terms_of(&limits)?;
    let over_paper = if paper.accepted.is_empty() {
        None
    } else {
        Some(terms_of(&paper)?)
    };
    let mut terms: Vec<Term> = Source::ALL
        .into_iter()
        .filter(|source| source.is_of(camera.fmc.mechanism))
        .map(|source| {
            let of = |effects: &[(Source, f64)]| {
                effects
                    .iter()
                    .filter(|(of, _)| *of == source)
                    .map(|(_, effect)| *effect)
                    .fold(0.0, f64::max)
            };
            Term {
                source,
                paper_mm: over_paper.as_deref().map(of),
                limits_mm: of(&over_limits),
            }
        })
        .collect();
    terms.sort_by(|a, b| b.limits_mm.total_cmp(&a.limits_mm));
    Ok(Budget {
        camera: camera.name.clone(),
        strategy: strategy.map_or("tdi", |strategy| strategy.name()),
        principal_distance_mm: camera.principal_distance_mm,
        pixel_mm: camera.sensor.pixel_um / 1000.0,
        vh_per_s: camera.limits.vh_per_s,
        exposure_s: camera.limits.exposure_s,
        paper: paper.exposures(),
        limits: limits.exposures(),
        assumptions,
        terms,
    })
}

/// A set of exposures, split into those that the camera accepts and those that it refuses.
struct Set {
    accepted: Vec<Accepted>,
    refused: usize,
    refusal: Option<FrameError>,
}

struct Accepted {
    exposure: GridExposure,
    path: ExposurePath,
    run_out_mm: f64,
}

impl Set {
    fn of(checked: &Camera, camera: &CameraFile, exposures: &[GridExposure]) -> Self {
        let mut set = Self {
            accepted: Vec::new(),
            refused: 0,
            refusal: None,
        };
        for exposure in exposures {
            let asked = Exposure::new(single(exposure.vh_per_s), single(exposure.exposure_s));
            match checked.frame(&asked) {
                Ok(frame) => set.accepted.push(Accepted {
                    exposure: *exposure,
                    path: ExposurePath::new(camera, &planned(*exposure)),
                    run_out_mm: f64::from(frame.interior.focus_shift_mm),
                }),
                Err(error) => {
                    set.refused += 1;
                    set.refusal = Some(error);
                }
            }
        }
        set
    }

    fn exposures(&self) -> Exposures {
        let travels = self.accepted.iter().map(|accepted| accepted.path.travel_mm);
        Exposures {
            accepted: self.accepted.len(),
            refused: self.refused,
            longest_travel_mm: travels.fold(0.0, f64::max),
        }
    }

    /// Returns every effect in every exposure, mm.
    fn effects(
        &self,
        camera: &CameraFile,
        view: &View,
        assumed: &Assumptions,
    ) -> Result<Vec<(Source, f64)>, BudgetError> {
        let [half_width, half_height] = camera.half_format_mm();
        let [x0, y0] = camera.principal_point_mm;
        let radius_mm = (half_width + x0.abs()).hypot(half_height + y0.abs());
        let f_mm = camera.principal_distance_mm;
        let mut effects = Vec::new();
        for accepted in &self.accepted {
            let GridExposure {
                vh_per_s,
                exposure_s,
                ..
            } = accepted.exposure;
            let path = &accepted.path;
            let focus_mm = accepted.run_out_mm.abs() + assumed.focus_mm;
            let [first_order, second_order] = distortion_effects(camera, accepted.exposure);
            effects.extend([
                // The pair of exposure means is exact; a pair of other instants is off by the
                // motion between them.
                (
                    Source::OpeningTime,
                    (path.centroid_mm() - path.offset_mm(0.0)).abs(),
                ),
                (Source::CalibratedPoint, path.centroid_mm().abs()),
                (Source::StaticDistortion, first_order),
                (Source::SecondOrder, second_order),
                (
                    Source::RunOut,
                    accepted.run_out_mm.abs() / camera.exit_pupil_mm() * radius_mm,
                ),
                (
                    Source::FocusShift,
                    assumed.focus_mm / camera.exit_pupil_mm() * radius_mm,
                ),
                (Source::RowTransfer, camera.sensor.pixel_um / 1000.0),
                (Source::FocusRemainder, focus_mm * FOCUS_REMAINDER),
                (Source::Encoder, assumed.encoder_mm / 2.0),
                (Source::Timing, f_mm * vh_per_s * assumed.timing_s),
            ]);
            let rate_deg_s = assumed.rate_deg_s;
            for (source, term, value) in [
                (
                    Source::VhError,
                    term::Term::VhError,
                    100.0 * assumed.vh_error,
                ),
                (Source::Relief, term::Term::Relief, 100.0 * assumed.relief),
                (Source::Drift, term::Term::Drift, assumed.drift_deg),
                (Source::TiltRate, term::Term::PitchRate, rate_deg_s),
                (Source::TiltRate, term::Term::RollRate, rate_deg_s),
                (Source::YawRate, term::Term::YawRate, rate_deg_s),
            ] {
                let alone = Disturbances::new([(term, value)])?;
                let motion = ImageMotion::new(view, &alone.flight_state(vh_per_s))?;
                let largest = motion.largest_smear(single(exposure_s)).smear;
                effects.push((source, f64::from(largest.length_um()) / 1000.0));
            }
        }
        Ok(effects)
    }
}

const fn planned(exposure: GridExposure) -> ExposureRequest {
    ExposureRequest::planned(exposure.vh_per_s, exposure.exposure_s)
}

/// Returns the largest length over the sensor, mm, by which the static calibration misses the
/// exposure mean, and that by which the calibration about the centroid's principal point misses it.
fn distortion_effects(camera: &CameraFile, exposure: GridExposure) -> [f64; 2] {
    let mut flat = camera.clone();
    flat.fmc.flatness_um = vec![0.0];
    let solver = StrictSolver::new(&flat, &planned(exposure), Weight::Exposure);
    let centroid_mm = solver.path().centroid_mm();
    let [ex, ey] = camera.fmc.axis.unit();
    let [x0, y0] = camera.principal_point_mm;
    let lens = Lens::of(camera);
    let mut largest = [0.0_f64; 2];
    for SensorPoint { x_mm, y_mm } in grid::points(camera.half_format_mm()).points() {
        let [x, y] = [x_mm, y_mm].map(f64::from);
        let [mean_x, mean_y] = solver.mean([x, y]).distortion_mm;
        let miss = |offset_mm: f64| {
            let [dx, dy] = lens.displacement([x - x0 - offset_mm * ex, y - y0 - offset_mm * ey]);
            (mean_x - dx).hypot(mean_y - dy)
        };
        let [first, second] = &mut largest;
        *first = first.max(miss(0.0));
        *second = second.max(miss(centroid_mm));
    }
    largest
}

#[cfg(test)]
mod tests {
    use fmc_camera_file::Strategy;

    use super::*;

    fn assumptions() -> Assumptions {
        Assumptions {
            height_m: 441.0,
            focus_mm: 0.005,
            vh_error: 0.01,
            relief: 0.1,
            drift_deg: 0.573,
            rate_deg_s: 1.0,
            encoder_mm: 0.001,
            timing_s: 1e-4,
        }
    }

    fn camera(more: &str) -> CameraFile {
        let text = format!(
            "name = \"t\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n[limits]\nvh_per_s = [0.17, 0.17]\nexposure_s = [0.01, 0.01]\n{more}"
        );
        CameraFile::parse("t.toml", &text).unwrap().0
    }

    #[test]
    fn terms_are_those_computed_by_hand() {
        let mut camera = camera("[distortion]\nk1 = 9.2268e-8\n");
        camera.fmc.strategy = Some(Strategy::FromRest);
        let budget = budget(&camera, assumptions()).unwrap();
        let near = |source, expected_um: f64, tolerance_um: f64| {
            let found = 1e3 * budget.effect_mm(source);
            assert!((found - expected_um).abs() <= tolerance_um, "{found}");
        };
        // v = 17 mm/s, δ = 170 µm.
        near(Source::OpeningTime, 85.0, 1e-6);
        // V = 0.17 · 441 = 75 m/s: V·t/2 = 37.5 cm.
        let ground_m = budget.ground_m(budget.effect_mm(Source::OpeningTime));
        assert!((ground_m - 0.375).abs() < 1e-3);
        // 17²/2000 + 17 · 5 ms = 229.5 µm of run-up, and half of δ.
        near(Source::CalibratedPoint, 314.5, 1e-6);
        near(Source::Timing, 1.7, 1e-9);
        near(Source::Encoder, 0.5, 1e-9);
        // 5 µm · 57.02/100.
        near(Source::FocusShift, 2.851, 1e-3);
        near(Source::FocusRemainder, 0.0865, 1e-6);
        // About 3K1·r²·c̄ in the corner.
        near(Source::StaticDistortion, 0.211, 0.003);
        assert!(budget.effect_mm(Source::SecondOrder) < 1e-7);
        near(Source::VhError, 1.7, 1e-3);
        near(Source::Relief, 170.0 / 9.0, 1e-3);
        near(Source::Drift, 1.7, 1e-3);
        // f·ω·t·(1 + y²/f², xy/f²) and r·ω·t in the corner.
        near(Source::TiltRate, 20.49, 0.01);
        near(Source::YawRate, 9.952, 0.01);
        let sorted = budget.terms.is_sorted_by(|a, b| a.limits_mm >= b.limits_mm);
        assert!(sorted);
    }

    #[test]
    fn principal_point_run_out_and_exit_pupil_have_their_part_whatever_their_sign() {
        let camera = camera(
            "[fmc]\nstrategy = \"from-rest\"\nflatness_um = [-3.0]\n[distortion]\nk1 = 9.2268e-8\n",
        );
        let camera = CameraFile {
            exit_pupil_mm: Some(80.0),
            principal_point_mm: [-2.0, 0.0],
            ..camera
        };
        let found = budget(&camera, assumptions()).unwrap();
        let effect_um = |source| 1e3 * found.effect_mm(source);
        // (42.32, 40.32) mm from the principal point; 3 and 5 µm over 80 mm.
        let radius_mm = 42.32_f64.hypot(40.32);
        assert!((effect_um(Source::RunOut) - 3.0 * radius_mm / 80.0).abs() < 1e-3);
        assert!((effect_um(Source::FocusShift) - 5.0 * radius_mm / 80.0).abs() < 1e-3);
        // The run-out does not count among the distortion terms.
        assert!(effect_um(Source::StaticDistortion) < 0.3);
    }

    #[test]
    fn charge_in_rows_has_a_step_and_no_stage() {
        let found = budget(&camera("[fmc]\nmechanism = \"tdi\"\n"), assumptions()).unwrap();
        let sources: Vec<Source> = found.terms.iter().map(|term| term.source).collect();
        assert!(sources.contains(&Source::RowTransfer));
        assert!(!sources.contains(&Source::Encoder) && !sources.contains(&Source::RunOut));
        assert!((1e3 * found.effect_mm(Source::RowTransfer) - 8.75).abs() < 1e-9);
    }

    #[test]
    fn exposures_that_the_stroke_refuses_are_counted() {
        let short = camera("[fmc]\nstroke_mm = 0.3\n");
        assert!(matches!(
            budget(&short, assumptions()),
            Err(BudgetError::NoExposure(FrameError::Stroke(_)))
        ));
        let budget = budget(&camera(""), assumptions()).unwrap();
        assert_eq!(budget.limits.refused, 0);
        // One V/H and one exposure time of the paper's grid lie within the limits.
        assert_eq!(budget.paper.accepted, 1);
    }
}
