//! The camera: calibration, mechanism, shutter and limits, and the frame they predict.

mod frame_error;
mod travel;

pub use self::frame_error::FrameError;
use super::calibration_id::{CalibrationId, SerialNumber, Storage};
use super::exposure::{CorrectionModel, Exposure, Limits};
use super::interior_orientation::InteriorOrientation;
use super::stage::{MechanismLimits, RunUp, Stage, StagePlan, Tracking};
use crate::geometry::calibration::{Calibration, CalibrationError, CalibrationParameters};
use crate::geometry::camera_grids::CameraGrids;
use crate::geometry::focus_table::FocusTable;
use crate::geometry::frame_correction::{Fold, FrameCorrection};
use crate::geometry::grid::GridChecksums;
use crate::geometry::interval::lesser;
use crate::geometry::lens_grid_bounds::LensGridBounds;
use crate::geometry::principal_distance::FocusShift;
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use crate::geometry::range::{MAX_FOCUS_FRACTION, OutOfRange, Quantity};
use crate::geometry::shutter::{Shutter, ShutterProfile};

/// Mechanism that holds the image still.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mechanism {
    /// A stage moves the detector.
    Stage {
        /// Acceleration, mm/s².
        acceleration_mm_s2: f32,
        /// Settling time between run-up and exposure, ms.
        settling_ms: f32,
        /// Position of the exposure relative to the calibrated position.
        run_up: RunUp,
        /// Largest change of the acceleration, mm/s³; `None` is unlimited.
        jerk_mm_s3: Option<f32>,
        /// Largest speed, mm/s; `None` is unlimited.
        max_speed_mm_s: Option<f32>,
    },
    /// The charge moves in rows. The row labels fix the opening offset: Δδ = 0 unless given.
    Tdi {
        /// φ: first transfer after opening, row periods.
        first_transfer: f32,
    },
}

/// Everything that describes one camera, not yet validated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CameraParameters {
    /// Lens, sensor and FMC axis.
    pub calibration: CalibrationParameters,
    /// Mechanism that holds the image still.
    pub mechanism: Mechanism,
    /// Transmission over the exposure.
    pub shutter: ShutterProfile,
    /// Exposures that the camera accepts.
    pub limits: Limits,
    /// Serial number of the camera, as its certificate states it; empty where none is given.
    pub serial: SerialNumber,
    /// Version of the calibration; 0 where none is given.
    pub version: u32,
    /// Residual grids without which the camera must not correct. They are no part of the serialised
    /// fields: the link carries them behind the others ([`crate::io::link::loading`]), so that a
    /// camera without grids keeps the identity that it has had.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub grids: GridChecksums,
    /// Focus shift over temperature. The link carries it behind the grids' checksums, so that a
    /// camera without a table keeps the identity that it has had.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub focus: FocusTable,
}

impl CameraParameters {
    /// Returns a camera of this calibration, without serial number and version, with the defaults
    /// of a camera file for mechanism, shutter and limits: a stage with 1000 mm/s², without limit
    /// of jerk and speed, 5 ms of settling, centred run-up, uniform shutter, and
    /// [`Limits::DEFAULT`].
    #[must_use]
    pub const fn new(calibration: CalibrationParameters) -> Self {
        Self {
            calibration,
            mechanism: Mechanism::Stage {
                acceleration_mm_s2: 1000.0,
                settling_ms: 5.0,
                run_up: RunUp::Centred,
                jerk_mm_s3: None,
                max_speed_mm_s: None,
            },
            shutter: ShutterProfile::Uniform,
            limits: Limits::DEFAULT,
            serial: SerialNumber::EMPTY,
            version: 0,
            grids: GridChecksums::NONE,
            focus: FocusTable::NONE,
        }
    }
}

/// A validated camera.
///
/// It is not [`Copy`]: its users borrow it from its owner.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    id: Option<CalibrationId>,
    calibration: Calibration,
    mechanism: Mechanism,
    stage: Stage,
    shutter: Shutter,
    limits: Limits,
    grids: GridChecksums,
    focus: FocusTable,
    /// `None` also until the grids are there.
    lens_grid: Option<LensGridBounds>,
}

/// One frame: its interior orientation, and the correction of its points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Interior orientation, as it is reported.
    pub interior: InteriorOrientation,
    /// Correction of its coordinates.
    pub correction: FrameCorrection,
}

impl Camera {
    /// Validates a parameters.
    ///
    /// # Errors
    /// [`CalibrationError`] naming the quantity, its value and the allowed range.
    pub fn new(parameters: CameraParameters) -> Result<Self, CalibrationError> {
        let mut made = Self::validated(&parameters, None)?;
        made.take_focus(&parameters.focus)?;
        Ok(made)
    }

    /// Gives the camera its focus table: every row, with the largest run-out of the stage, is
    /// within [`MAX_FOCUS_FRACTION`].
    fn take_focus(&mut self, table: &FocusTable) -> Result<(), CalibrationError> {
        table.check(self.largest_focus_shift_um())?;
        self.focus = *table;
        Ok(())
    }

    fn validated(
        parameters: &CameraParameters,
        id: Option<CalibrationId>,
    ) -> Result<Self, CalibrationError> {
        let stroke_mm = parameters.calibration.stroke_mm;
        let limits = match parameters.mechanism {
            Mechanism::Stage {
                acceleration_mm_s2,
                settling_ms,
                run_up: _,
                jerk_mm_s3,
                max_speed_mm_s,
            } => MechanismLimits {
                acceleration_mm_s2,
                jerk_mm_s3,
                max_speed_mm_s,
                settling_ms,
                stroke_mm,
            },
            Mechanism::Tdi { first_transfer } => {
                Quantity::FirstTransfer.check(first_transfer)?;
                let (_, most) = Quantity::AccelerationMmS2.range();
                MechanismLimits {
                    acceleration_mm_s2: most,
                    jerk_mm_s3: None,
                    max_speed_mm_s: None,
                    settling_ms: 0.0,
                    stroke_mm,
                }
            }
        };
        let stage = Stage::new(limits)?;
        let shutter = Shutter::new(parameters.shutter)?;
        let limits = parameters.limits.checked()?;
        Ok(Self {
            id,
            calibration: Calibration::new(parameters.calibration)?,
            mechanism: parameters.mechanism,
            stage,
            shutter,
            limits,
            grids: parameters.grids,
            focus: FocusTable::NONE,
            lens_grid: None,
        })
    }

    /// Validates a parameters whose CRC-32 is known, and gives the camera its identity.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[expect(
        clippy::inline_always,
        reason = "a program whose cameras have no focus table is without its code"
    )]
    #[inline(always)]
    pub fn identified(
        parameters: &CameraParameters,
        crc: u32,
        storage: Storage,
    ) -> Result<Self, CalibrationError> {
        let id = CalibrationId {
            serial: parameters.serial,
            version: parameters.version,
            crc,
            storage,
        };
        let made = Self::validated(parameters, Some(id));
        if parameters.focus.is_empty() {
            // Nothing is moved.
            return made;
        }
        let mut made = made?;
        made.take_focus(&parameters.focus)?;
        Ok(made)
    }

    /// Identity of the calibration; `None` if none was given.
    #[must_use]
    pub const fn id(&self) -> Option<CalibrationId> {
        self.id
    }

    /// The validated calibration.
    #[must_use]
    pub const fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Returns the camera with the bounds of its residual grids, so that its frames and records
    /// state what they leave out. The grids themselves are borrowed by a
    /// [`GriddedFrame`](super::gridded_frame::GriddedFrame).
    #[must_use]
    pub fn bounded_by(mut self, grids: &CameraGrids<'_>) -> Self {
        self.lens_grid = grids.lens_bounds();
        self
    }

    /// Residual grids that the camera has beside its polynomial: the correction of [`Self::frame`]
    /// does not know them, that of a [`GriddedFrame`](super::gridded_frame::GriddedFrame) does.
    #[must_use]
    pub const fn grid_checksums(&self) -> GridChecksums {
        self.grids
    }

    /// Focus shift over temperature; empty for a camera without a table. [`Self::frame`] does not
    /// use it: the controller adds it to the focus shift of each exposure.
    #[must_use]
    pub const fn focus_table(&self) -> &FocusTable {
        &self.focus
    }

    /// The validated shutter.
    #[must_use]
    pub const fn shutter(&self) -> &Shutter {
        &self.shutter
    }

    /// The planner of the stage's motion. For a TDI sensor it plans the path of the charge, which
    /// needs no run-up.
    #[must_use]
    pub const fn stage(&self) -> &Stage {
        &self.stage
    }

    /// Position of the exposure relative to the calibrated position; `None` without a stage.
    #[must_use]
    pub const fn run_up(&self) -> Option<RunUp> {
        match self.mechanism {
            Mechanism::Stage { run_up, .. } => Some(run_up),
            Mechanism::Tdi { .. } => None,
        }
    }

    /// Returns the motion that the stage has to track in an exposure, without margin for a late
    /// shutter.
    ///
    /// # Model
    /// v = f·η (Yuan et al. 2012, eq. 8), negative where the camera flies against the FMC axis.
    #[must_use]
    pub(crate) fn tracking(&self, exposure: &Exposure) -> Tracking {
        let speed = self.calibration.parameters().principal_distance_mm * exposure.vh_per_s;
        Tracking {
            speed_mm_s: exposure.direction.sign() * speed,
            exposure_s: exposure.exposure_s,
            centroid_time_s: exposure.exposure_s * self.shutter.centroid(),
            margin_s: 0.0,
        }
    }

    /// The stage's travel for an exposure.
    ///
    /// # Errors
    /// [`FrameError`] for an exposure outside the limits, a speed beyond the stage's or a travel
    /// outside the stroke.
    pub fn plan(&self, exposure: &Exposure) -> Result<StagePlan, FrameError> {
        self.limits.check(exposure)?;
        let tracking = self.tracking(exposure);
        let plan = match (exposure.opening_offset_mm, self.mechanism) {
            (Some(offset_mm), _) => {
                let offset_mm = Quantity::OpeningOffsetMm.check(offset_mm)?;
                self.stage.opening_at(offset_mm, tracking)?
            }
            (None, Mechanism::Tdi { .. }) => self.stage.opening_at(0.0, tracking)?,
            (None, Mechanism::Stage { run_up, .. }) => self.stage.plan(run_up, tracking)?,
        };
        Ok(plan)
    }

    /// The motion of the principal point predicted for an exposure.
    ///
    /// # Model
    /// v = ±f·η, δ = v·t (Yuan et al. 2012, eq. 8), Δδ from the stage's plan.
    ///
    /// # Errors
    /// As [`Self::plan`]; also for more TDI rows than
    /// [`MAX_ROWS`](crate::geometry::range::MAX_ROWS).
    pub fn motion(&self, exposure: &Exposure) -> Result<PrincipalPointMotion, FrameError> {
        let travel = UniformTravel {
            opening_offset_mm: self.plan(exposure)?.opening_mm,
            speed_mm_s: self.tracking(exposure).speed_mm_s,
            exposure_s: exposure.exposure_s,
        };
        let mut motion = PrincipalPointMotion::from_plan(travel, &self.shutter);
        if let Mechanism::Tdi { first_transfer } = self.mechanism {
            let pixel_mm = self.calibration.sensor().pixel_mm();
            motion = motion.in_rows(pixel_mm, first_transfer, &self.shutter)?;
        }
        Ok(motion)
    }

    /// The frame predicted for an exposure.
    ///
    /// # Errors
    /// As [`Self::motion`] and [`Self::frame_of`].
    pub fn frame(&self, exposure: &Exposure) -> Result<Frame, FrameError> {
        self.frame_of(exposure, &self.motion(exposure)?)
    }

    /// The frame of a given motion, planned or measured.
    ///
    /// # Errors
    /// [`FrameError`] for a focus shift beyond [`MAX_FOCUS_FRACTION`], for a motion that leaves the
    /// stroke, and for the fitted model of a camera that has none.
    pub fn frame_of(
        &self,
        exposure: &Exposure,
        motion: &PrincipalPointMotion,
    ) -> Result<Frame, FrameError> {
        let parameters = self.calibration.parameters();
        within_stroke(motion, parameters.stroke_mm)?;
        let focus = self.focus_shift(exposure, motion)?;
        let (fold, enlargement, lens_grid) = match exposure.model {
            CorrectionModel::Exact => (
                Fold::exact(&self.calibration, motion, &focus),
                focus.enlargement(),
                self.lens_grid.as_ref(),
            ),
            CorrectionModel::Fitted => (
                Fold::five_coefficient(&self.calibration, motion).ok_or(FrameError::NotFitted)?,
                0.0,
                self.lens_grid.as_ref(),
            ),
            CorrectionModel::Static => (Fold::without_motion(&self.calibration), 0.0, None),
        };
        let correction = FrameCorrection::folded(&self.calibration, &fold);
        let left_out_by_grid_mm = lens_grid.map_or(0.0, |grid| {
            grid.left_out_mm(correction.sensor(), motion, enlargement)
        });
        Ok(Frame {
            interior: InteriorOrientation {
                vh_per_s: exposure.vh_per_s,
                exposure_s: exposure.exposure_s,
                motion: *motion,
                principal_point: parameters
                    .axis
                    .sensor_from_offset(parameters.principal_point, motion.centroid_mm),
                principal_distance_mm: parameters.principal_distance_mm,
                focus_shift_mm: focus.shift_mm,
                enlargement,
                model: exposure.model,
                terms: correction.terms(),
                left_out_nm: correction.left_out_nm() + 1e6 * left_out_by_grid_mm,
            },
            correction,
        })
    }

    /// Checks a focus shift that is told for frames to come, µm: with the largest run-out of the
    /// stage, too, it is within [`MAX_FOCUS_FRACTION`].
    ///
    /// # Errors
    /// [`FrameError::OutOfRange`] with the range.
    pub(crate) fn check_focus_shift(&self, shift_um: f32) -> Result<(), FrameError> {
        let most_um = self.largest_focus_shift_um();
        Quantity::FocusShiftUm.check_within(shift_um, -most_um, most_um)?;
        Ok(())
    }

    /// Returns the largest focus shift beside the run-out of the stage, either way, µm.
    fn largest_focus_shift_um(&self) -> f32 {
        let parameters = self.calibration.parameters();
        let run_out_mm = parameters.flatness.largest_mm(0.5 * parameters.stroke_mm);
        let nearer_mm = lesser(parameters.exit_pupil_mm, parameters.principal_distance_mm);
        // No shift is always in range.
        1000.0 * (MAX_FOCUS_FRACTION * nearer_mm - run_out_mm).max(0.0)
    }

    /// Returns Δz of a frame: the exposure mean of the run-out plus the exposure's own focus shift.
    fn focus_shift(
        &self,
        exposure: &Exposure,
        motion: &PrincipalPointMotion,
    ) -> Result<FocusShift, OutOfRange> {
        let parameters = self.calibration.parameters();
        let added_um = Quantity::FocusShiftUm.check(exposure.focus_shift_um)?;
        let run_out_mm = parameters.flatness.mean_shift_mm(motion);
        let shift = FocusShift {
            shift_mm: run_out_mm + added_um / 1000.0,
            principal_distance_mm: parameters.principal_distance_mm,
            exit_pupil_mm: parameters.exit_pupil_mm,
            sign: exposure.focus_sign,
        };
        let nearer_mm = lesser(parameters.exit_pupil_mm, parameters.principal_distance_mm);
        let largest_um = 1000.0 * MAX_FOCUS_FRACTION * nearer_mm;
        Quantity::FocusShiftUm.check_within(shift.shift_mm * 1000.0, -largest_um, largest_um)?;
        Ok(shift)
    }
}

/// Checks that the motion stays where the calibration has been shown to be one-to-one.
fn within_stroke(motion: &PrincipalPointMotion, stroke_mm: f32) -> Result<(), OutOfRange> {
    let half_mm = 0.5 * stroke_mm;
    let opening_mm =
        Quantity::OpeningOffsetMm.check_within(motion.opening_offset_mm, -half_mm, half_mm)?;
    // Rounding of the sum may exceed the stroke by a unit in the last place.
    let slack_mm = stroke_mm * f32::EPSILON;
    Quantity::TravelMm.check_within(
        motion.travel_mm,
        -half_mm - opening_mm - slack_mm,
        half_mm - opening_mm + slack_mm,
    )?;
    Quantity::CentroidOffsetMm.check_within(
        motion.centroid_mm,
        -half_mm - slack_mm,
        half_mm + slack_mm,
    )?;
    // The variance of a path within the stroke is at most a quarter of the stroke's square; the
    // root is taken only for a path that may be beyond.
    let variance = motion.moments.second;
    if !(0.0..=half_mm * half_mm).contains(&variance) {
        let deviation_mm = fmc_camera_kernel::sqrt(variance);
        Quantity::TravelMm.check_within(deviation_mm, 0.0, half_mm + slack_mm)?;
    }
    Ok(())
}
