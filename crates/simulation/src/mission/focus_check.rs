//! Check of the focus shift that records state.

use fmc_camera::flight::frame_record::{Flag, Outcome};

use super::check::Check;
use super::flown::{Flown, FlownFrame};
use super::lens::Lens;
use super::scenario::MissionScenario;
use crate::wording;

/// Error of the focus shift of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FocusError {
    /// Reported less true Δz, µm.
    pub error_um: f64,
    /// By which a point in the corner of the sensor is displaced, px.
    pub corner_px: f64,
    /// `true` if the record says that the temperature is not known or outside the table.
    pub is_flagged: bool,
}

/// Returns the errors of the focus shift, frame by frame; `None` if no light passed or no exposure
/// was recorded.
#[must_use]
pub fn focus_errors(scenario: &MissionScenario, flown: &Flown) -> Vec<Option<FocusError>> {
    let lens = Lens::of(scenario);
    let of = |frame: &FlownFrame| {
        let Outcome::Exposed(exposed) = &frame.record.outcome else {
            return None;
        };
        let truth = frame.truth.as_ref()?;
        let true_mm = lens.focus_shift_mm(truth.centroid_s, truth.centroid_offset_mm);
        let error_mm = f64::from(exposed.interior.focus_shift_mm) - true_mm;
        let camera = &scenario.camera;
        let [half_width_mm, half_height_mm] = camera.half_format_mm();
        let enlargement = error_mm / camera.exit_pupil_mm();
        let corner_mm = enlargement * half_width_mm.hypot(half_height_mm);
        let flags = frame.record.flags;
        Some(FocusError {
            error_um: 1000.0 * error_mm,
            corner_px: corner_mm / (camera.sensor.pixel_um / 1000.0),
            is_flagged: flags.contains(Flag::TemperatureUnknown)
                || flags.contains(Flag::TemperatureOutside),
        })
    };
    flown.frames.iter().map(of).collect()
}

/// Checks the focus shift of a lens whose focus follows its temperature; `None` for one that keeps
/// it.
pub(super) fn check(scenario: &MissionScenario, flown: &Flown) -> Option<Check> {
    let limit_um = scenario.written.temperature.as_ref()?.limit_um;
    let errors = focus_errors(scenario, flown);
    let told = || errors.iter().flatten().filter(|error| !error.is_flagged);
    let worst = |of: fn(&FocusError) -> f64| told().map(|it| of(it).abs()).fold(0.0, f64::max);
    let worst_um = worst(|error| error.error_um);
    Some(Check::over(
        (told().count(), "frame"),
        format!(
            "focus shift within {limit_um} µm of the truth in all frames without a flag of the temperature"
        ),
        format!(
            "{}, largest error {worst_um:.3} µm, {:.4} px in the corner",
            wording::counted(told().count(), "frame"),
            worst(|error| error.corner_px)
        ),
        worst_um <= limit_um,
    ))
}
