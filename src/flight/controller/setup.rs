//! The camera and its settings for one flight.

use super::error::ControllerError;
use super::timing::{EXERCISE_REACH, LEAD_S, TICK_S};
use crate::flight::camera::{self, Camera, FrameError};
use crate::flight::drive::kind::DriveKind;
use crate::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use crate::flight::index_watch::IndexSides;
use crate::flight::interior_orientation::InteriorOrientation;
use crate::flight::settings::{FINE_STEP_UM, FOLLOWING_STEPS, FlightSettings};
use crate::flight::slope::SLOPE_STEPS;
use crate::flight::smear_prediction::{
    AircraftMotion, Compensation, PredictedSmear, SmearPrediction,
};
use crate::flight::stage::{PlanError, Setpoint, Travel};
use crate::flight::stage_tolerance::StageTolerance;
use crate::flight::vh::{VhEstimate, VhSource};
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use crate::geometry::range::Quantity;

/// Results of the preparation of a flight, for one camera.
#[derive(Debug, Clone)]
pub(in crate::flight) struct Preparation {
    settings: FlightSettings,
    smear: SmearPrediction,
}

impl Preparation {
    /// Returns the preparation of a camera with settings that are [`checked`].
    #[inline(never)]
    pub(in crate::flight) fn new(camera: &Camera, settings: &FlightSettings) -> Self {
        Self {
            smear: SmearPrediction::new(camera.calibration(), settings.direction),
            settings: *settings,
        }
    }

    /// Returns the setup of a flight with this camera.
    pub(in crate::flight) const fn of<'a>(&'a self, camera: &'a Camera) -> Setup<'a> {
        Setup {
            camera,
            settings: &self.settings,
            smear: &self.smear,
        }
    }

    pub(in crate::flight) const fn settings(&self) -> &FlightSettings {
        &self.settings
    }

    /// Prepares another camera for the same flight.
    pub(in crate::flight) fn exchange(&mut self, camera: &Camera) {
        self.smear = SmearPrediction::new(camera.calibration(), self.settings.direction);
    }
}

/// The camera and its settings, which stay in flight; the controller borrows them with every event.
#[derive(Debug, Clone, Copy)]
pub(in crate::flight) struct Setup<'a> {
    pub(super) camera: &'a Camera,
    pub(super) settings: &'a FlightSettings,
    pub(super) smear: &'a SmearPrediction,
}

impl Setup<'_> {
    /// The exposure that a V/H asks for, 1/s, with an exposure time, s.
    pub(super) fn exposure(&self, vh_per_s: f32, exposure_s: f32) -> Exposure {
        exposure(self.settings, vh_per_s, exposure_s)
    }

    /// Time for which the stage stays at speed beyond the exposure, s.
    pub(super) fn margin_s(&self) -> f32 {
        margin_s(self.settings)
    }

    /// Tolerances of the stage.
    pub(super) fn stage_tolerance(&self) -> StageTolerance {
        let acceleration_mm_s2 = self.camera.stage().acceleration_mm_s2();
        self.settings.stage_tolerance(acceleration_mm_s2)
    }

    /// Half of the stage's stroke, mm.
    pub(super) fn half_stroke_mm(&self) -> f32 {
        0.5 * self.camera.calibration().parameters().stroke_mm
    }

    /// Returns the ends of the ways to and fro at arming, which cross the index mark.
    pub(super) fn exercise_ends(&self) -> IndexSides {
        let reach_mm = EXERCISE_REACH * self.camera.calibration().parameters().stroke_mm;
        let sides = self.settings.index_sides();
        IndexSides {
            low_mm: sides.map_or(-reach_mm, |sides| sides.low_mm.min(-reach_mm)),
            high_mm: sides.map_or(reach_mm, |sides| sides.high_mm.max(reach_mm)),
        }
    }

    /// Returns where the last way to a waiting place begins, mm, if the way there from a place does
    /// not take up the play as the run-up does.
    pub(super) fn approach(&self, from_mm: f32, waiting_mm: f32) -> Option<f32> {
        approach(self.camera, self.settings, from_mm, waiting_mm)
    }

    /// Returns the frame of a stage of which nothing is known: it counts as standing at its
    /// calibrated position.
    pub(super) fn standing_frame(&self, exposure: &Exposure) -> Option<camera::Frame> {
        let still = UniformTravel {
            opening_offset_mm: 0.0,
            speed_mm_s: 0.0,
            exposure_s: exposure.exposure_s,
        };
        let motion = PrincipalPointMotion::from_plan(still, self.camera.shutter());
        let exposure = Exposure {
            model: CorrectionModel::Static,
            ..*exposure
        };
        self.camera.frame_of(&exposure, &motion).ok()
    }

    /// Predicts the residual smear of an exposure. Without V/H, the largest V/H of the camera's
    /// limits bounds it.
    pub(super) fn predict_smear(
        &self,
        vh: Option<VhEstimate>,
        direction: FlightDirection,
        interior: &InteriorOrientation,
        wander_mm: f32,
        aircraft: &AircraftMotion,
    ) -> PredictedSmear {
        let vh = vh.unwrap_or_else(|| VhEstimate {
            vh_per_s: self.camera.limits().vh_per_s[1],
            sigma_per_s: 0.0,
            age_s: 0.0,
            source: VhSource::Direct,
            extrapolated: true,
        });
        let compensation = Compensation {
            exposure_s: interior.exposure_s,
            travel_mm: direction.sign() * interior.motion.travel_mm,
            wander_mm,
            // Two readings, each rounded to a step of the encoder.
            travel_sigma_mm: 1e-3 * self.settings.drive.coarseness_um()
                / fmc_camera_kernel::sqrt(6.0),
            principal_point: interior.principal_point,
        };
        self.smear.of(&vh, aircraft, &compensation)
    }

    /// Returns the largest change of the following error, as its slope shows it, in an exposure
    /// with a travel, mm: the speed is right to within its tolerance or the smear budget, and the
    /// slope to within what the encoder's steps make of it.
    pub(super) fn allowed_change_mm(&self, travel_mm: f32, exposure_s: f32) -> f32 {
        let pixel_mm = self.camera.calibration().sensor().pixel_mm();
        let of_speed = 0.01 * self.settings.speed_tolerance_percent * libm::fabsf(travel_mm);
        let step_mm = 1e-3 * self.settings.drive.coarseness_um();
        let of_steps = step_mm * SLOPE_STEPS * exposure_s / TICK_S;
        of_speed.max(self.settings.smear_budget_px * pixel_mm) + of_steps
    }

    /// Returns the position at which the stage waits for the next trigger, mm: that for the present
    /// V/H or, without V/H, for the largest of the camera's limits.
    pub(super) fn waiting_place_mm(
        &self,
        vh: Option<VhEstimate>,
        exposure_s: f32,
    ) -> Result<f32, FrameError> {
        let [_, most] = self.camera.limits().vh_per_s;
        let at = |vh_per_s| {
            self.camera
                .waiting_place_mm(&self.exposure(vh_per_s, exposure_s), self.margin_s())
        };
        match vh {
            Some(vh) => at(vh.vh_per_s).or_else(|_| at(most)),
            None => at(most),
        }
    }
}

/// Returns the settings, if the camera can be flown with them. It is not inlined, as the
/// preparation is not, so that a flight that is made in its place has their variables on the stack
/// one after the other.
#[inline(never)]
pub(in crate::flight) fn checked(
    camera: &Camera,
    settings: &FlightSettings,
) -> Result<FlightSettings, ControllerError> {
    let settings = settings.checked().map_err(ControllerError::Settings)?;
    check_camera(camera, &settings, settings.exposure_s)?;
    Ok(settings)
}

/// Checks that a camera can be flown with settings that are checked, and with an exposure time, s.
pub(super) fn check_camera(
    camera: &Camera,
    settings: &FlightSettings,
    exposure_s: f32,
) -> Result<(), ControllerError> {
    if settings.fitted_model && camera.calibration().parameters().fitted.is_none() {
        return Err(ControllerError::Travel(FrameError::NotFitted));
    }
    camera
        .check_exposure_time(exposure_s)
        .map_err(|error| ControllerError::Travel(error.into()))?;
    check_encoder(camera, settings)?;
    check_index(camera, settings)?;
    check_reach(camera, settings)?;
    check_step_rate(camera, settings)?;
    check_interval(camera, settings, exposure_s)
}

/// Checks that the encoder shows where in its stroke the stage is: a stage that may be off its set
/// point by all of it, for the coarseness of the encoder, without a fault is not watched.
fn check_encoder(camera: &Camera, settings: &FlightSettings) -> Result<(), ControllerError> {
    if !camera.has_stage() {
        return Ok(());
    }
    let stroke_mm = camera.calibration().parameters().stroke_mm;
    let beyond_tolerance_um = (1e3 * stroke_mm - settings.following_tolerance_um).max(0.0);
    let most_um = (1e3 * stroke_mm / FOLLOWING_STEPS)
        .min(FINE_STEP_UM + beyond_tolerance_um / FOLLOWING_STEPS);
    let checked =
        Quantity::EncoderStepUm.check_within(settings.drive.encoder_step_um, 0.0, most_um);
    checked.map(|_| ()).map_err(ControllerError::Settings)
}

/// Checks that the stage can be moved across its index mark.
fn check_index(camera: &Camera, settings: &FlightSettings) -> Result<(), ControllerError> {
    let (Some(index_mm), Some(sides)) = (settings.drive.index_mm, settings.index_sides()) else {
        return Ok(());
    };
    if !camera.has_stage() {
        return Ok(());
    }
    let stroke_mm = camera.calibration().parameters().stroke_mm;
    let most_mm = (0.5 * stroke_mm - (sides.high_mm - index_mm)).max(0.0);
    let checked = Quantity::IndexMm.check_within(index_mm, -most_mm, most_mm);
    checked.map(|_| ()).map_err(ControllerError::Settings)
}

/// Checks that a position command and its sensor reach both ends of the stroke.
fn check_reach(camera: &Camera, settings: &FlightSettings) -> Result<(), ControllerError> {
    let drive = &settings.drive;
    if !camera.has_stage() || drive.kind != DriveKind::PositionCommand {
        return Ok(());
    }
    let half_stroke_um = 500.0 * camera.calibration().parameters().stroke_mm;
    let checked = drive
        .position_command
        .check_reach(half_stroke_um, drive.encoder_step_um);
    checked.map_err(ControllerError::Settings)
}

/// Checks that a stepper makes the largest speed of the stage, which has to be stated: steps that
/// come too late are a stall.
fn check_step_rate(camera: &Camera, settings: &FlightSettings) -> Result<(), ControllerError> {
    let drive = &settings.drive;
    if !camera.has_stage() || !drive.is_stepped() {
        return Ok(());
    }
    let fastest_mm_s = drive.stepper.max_step_rate_hz / drive.stepper.steps_per_mm;
    let (least_mm_s, _) = Quantity::MaxSpeedMmS.range();
    let most_mm_s = camera.stage().max_speed_mm_s();
    let checked = Quantity::MaxSpeedMmS.check_within(most_mm_s, least_mm_s, fastest_mm_s);
    checked.map(|_| ()).map_err(ControllerError::Settings)
}

/// Checks that the mechanism is back before the next trigger, at the largest V/H of the camera's
/// limits.
fn check_interval(
    camera: &Camera,
    settings: &FlightSettings,
    exposure_s: f32,
) -> Result<(), ControllerError> {
    let available_s = settings.trigger_interval_s;
    if available_s == 0.0 || !camera.has_stage() {
        return Ok(());
    }
    let [least, most] = camera.limits().vh_per_s;
    let needed_s = |vh_per_s| {
        needed_s(camera, settings, vh_per_s, exposure_s).map_err(ControllerError::Travel)
    };
    let mut longest_s = needed_s(most)?;
    if settings.drive.index_mm.is_some() {
        // A short cycle may need ways of its own across the index mark.
        longest_s = longest_s.max(needed_s(least)?);
    }
    let needed_s = longest_s;
    if needed_s <= available_s {
        Ok(())
    } else {
        Err(ControllerError::Travel(
            PlanError::Time {
                needed_s,
                available_s,
            }
            .into(),
        ))
    }
}

/// Returns the time from a trigger until the stage waits for the next one, at a V/H, s, with an
/// exposure time, s.
pub(super) fn needed_s(
    camera: &Camera,
    settings: &FlightSettings,
    vh_per_s: f32,
    exposure_s: f32,
) -> Result<f32, FrameError> {
    let exposure = exposure(settings, vh_per_s, exposure_s);
    let margin_s = margin_s(settings);
    let place_mm = camera.waiting_place_mm(&exposure, margin_s)?;
    let travel = camera.travel(place_mm, &exposure, margin_s)?;
    let cycle_s = cycle_s(camera, settings, &travel, place_mm)?;
    let before_s = TICK_S + (settings.shutter_latency_s + LEAD_S - travel.opening_s).max(0.0);
    Ok(before_s + cycle_s)
}

/// Returns where the last way to a waiting place begins, mm, if the way there from a place does not
/// take up the play as the run-up does. The stroke may end before.
fn approach(
    camera: &Camera,
    settings: &FlightSettings,
    from_mm: f32,
    waiting_mm: f32,
) -> Option<f32> {
    let approach_mm = settings.approach_mm();
    let half_stroke_mm = 0.5 * camera.calibration().parameters().stroke_mm;
    let begin_mm = limited(waiting_mm - approach_mm, half_stroke_mm);
    let is_long_enough = if approach_mm < 0.0 {
        from_mm >= begin_mm
    } else {
        from_mm <= begin_mm
    };
    (!is_long_enough).then_some(begin_mm)
}

/// Returns a place, or the end of the stroke before it, mm.
fn limited(place_mm: f32, half_stroke_mm: f32) -> f32 {
    place_mm.max(-half_stroke_mm).min(half_stroke_mm)
}

/// Returns the time from a trigger until the stage waits again, s, with the ways across the index
/// mark if the cycle itself does not cross it, and the way by which it takes up the play.
fn cycle_s(
    camera: &Camera,
    settings: &FlightSettings,
    travel: &Travel,
    waiting_mm: f32,
) -> Result<f32, FrameError> {
    let end = travel.profile.end();
    let from_mm = end.offset_mm;
    let (mut cycle_s, mut from) = (travel.stop_s, end);
    let mut go_to = |to_mm: f32| {
        cycle_s += camera.stage().reposition(from, to_mm)?.duration_s();
        from = Setpoint {
            offset_mm: to_mm,
            ..Setpoint::default()
        };
        Ok::<f32, FrameError>(to_mm)
    };
    let mut last_mm = from_mm;
    let sides = settings
        .index_sides()
        .filter(|sides| !sides.are_between(from_mm, waiting_mm));
    if let Some(sides) = sides {
        if from_mm > sides.low_mm {
            go_to(sides.low_mm)?;
        }
        last_mm = go_to(sides.high_mm)?;
    }
    if let Some(begin_mm) = approach(camera, settings, last_mm, waiting_mm) {
        go_to(begin_mm)?;
    }
    go_to(waiting_mm)?;
    Ok(cycle_s)
}

pub(super) fn exposure(settings: &FlightSettings, vh_per_s: f32, exposure_s: f32) -> Exposure {
    Exposure {
        direction: settings.direction,
        model: if settings.fitted_model {
            CorrectionModel::Fitted
        } else {
            CorrectionModel::Exact
        },
        ..Exposure::new(vh_per_s, exposure_s)
    }
}

fn margin_s(settings: &FlightSettings) -> f32 {
    2.0 * settings.shutter_tolerance_s + TICK_S
}
