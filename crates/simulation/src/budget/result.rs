//! Terms of an error budget.

use fmc_camera_file::MechanismName;

use super::assumptions::Assumptions;

/// Kind of effect that a term has on the image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The coordinates are wrong by the term.
    Position,
    /// The image is smeared over the length of the term; its coordinates are right.
    Smear,
}

impl Kind {
    /// Returns the name that reports use.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Smear => "smear",
        }
    }
}

/// A source of error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Time stamp at the opening of the shutter instead of the centroid time.
    OpeningTime,
    /// Calibrated principal point instead of the one at the centroid.
    CalibratedPoint,
    /// Static calibration instead of the exposure mean.
    StaticDistortion,
    /// Calibration about the moved principal point, without the moments of its motion.
    SecondOrder,
    /// Run-out of the stage that is not corrected.
    RunOut,
    /// Focus shift that was not measured.
    FocusShift,
    /// Part of a measured focus shift that its correction leaves.
    FocusRemainder,
    /// Resolution of the encoder.
    Encoder,
    /// Error of the time stamp.
    Timing,
    /// Error of V/H.
    VhError,
    /// Relief of the terrain.
    Relief,
    /// Drift of the aircraft.
    Drift,
    /// Roll or pitch rate.
    TiltRate,
    /// Yaw rate.
    YawRate,
    /// Charge transfer in whole rows under an image that moves evenly.
    RowTransfer,
}

impl Source {
    /// All sources.
    pub const ALL: [Self; 15] = [
        Self::OpeningTime,
        Self::CalibratedPoint,
        Self::StaticDistortion,
        Self::SecondOrder,
        Self::RunOut,
        Self::FocusShift,
        Self::FocusRemainder,
        Self::Encoder,
        Self::Timing,
        Self::VhError,
        Self::Relief,
        Self::Drift,
        Self::TiltRate,
        Self::YawRate,
        Self::RowTransfer,
    ];

    /// Returns true if a camera with this mechanism has this source of error.
    #[must_use]
    pub fn is_of(self, mechanism: MechanismName) -> bool {
        match self {
            Self::RunOut | Self::Encoder => mechanism == MechanismName::Stage,
            Self::RowTransfer => mechanism == MechanismName::Tdi,
            _ => true,
        }
    }

    /// Returns the key used in `summary.json`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::OpeningTime => "opening-time",
            Self::CalibratedPoint => "calibrated-principal-point",
            Self::StaticDistortion => "static-distortion",
            Self::SecondOrder => "second-order",
            Self::RunOut => "run-out",
            Self::FocusShift => "focus-shift",
            Self::FocusRemainder => "focus-remainder",
            Self::Encoder => "encoder",
            Self::Timing => "timing",
            Self::VhError => "vh-error",
            Self::Relief => "relief",
            Self::Drift => "drift",
            Self::TiltRate => "tilt-rate",
            Self::YawRate => "yaw-rate",
            Self::RowTransfer => "row-transfer",
        }
    }

    /// Returns the label used in reports.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::OpeningTime => "time of opening, not of the centroid",
            Self::CalibratedPoint => "calibrated principal point, not the centroid's",
            Self::StaticDistortion => "static distortion, not the exposure mean",
            Self::SecondOrder => "second order of the motion (μ2)",
            Self::RunOut => "run-out of the stage, not corrected",
            Self::FocusShift => "focus shift that nobody measured",
            Self::FocusRemainder => "focus shift corrected: what a real lens leaves",
            Self::Encoder => "encoder, half a step",
            Self::Timing => "time stamp",
            Self::VhError => "error of V/H",
            Self::Relief => "relief",
            Self::Drift => "drift",
            Self::TiltRate => "roll or pitch rate",
            Self::YawRate => "yaw rate",
            Self::RowTransfer => "row transfer: 1 px",
        }
    }

    /// Returns the kind of effect on the image.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::VhError
            | Self::Relief
            | Self::Drift
            | Self::TiltRate
            | Self::YawRate
            | Self::RowTransfer => Kind::Smear,
            _ => Kind::Position,
        }
    }

    /// Returns true if the frame record and the correction of this project remove the error.
    #[must_use]
    pub const fn is_removed(self) -> bool {
        matches!(
            self,
            Self::OpeningTime
                | Self::CalibratedPoint
                | Self::StaticDistortion
                | Self::SecondOrder
                | Self::RunOut
        )
    }
}

/// A term: the largest effect of a source over a set of exposures, anywhere on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Source of the error.
    pub source: Source,
    /// Effect over the exposures of the paper that the camera accepts, mm; `None` if it accepts
    /// none.
    pub paper_mm: Option<f64>,
    /// Effect over the exposures that the camera's limits allow, mm.
    pub limits_mm: f64,
}

/// A set of exposures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exposures {
    /// Number of exposures that the camera accepts.
    pub accepted: usize,
    /// Number of exposures that it refuses.
    pub refused: usize,
    /// Longest travel of the accepted exposures, mm.
    pub longest_travel_mm: f64,
}

/// All terms of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// Name of the camera.
    pub camera: String,
    /// Run-up strategy of the stage, or `tdi`.
    pub strategy: &'static str,
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Pixel pitch, mm.
    pub pixel_mm: f64,
    /// Smallest and largest V/H, 1/s.
    pub vh_per_s: [f64; 2],
    /// Shortest and longest exposure, s.
    pub exposure_s: [f64; 2],
    /// Exposures of the paper.
    pub paper: Exposures,
    /// Exposures that the limits allow.
    pub limits: Exposures,
    /// Assumptions of the budget.
    pub assumptions: Assumptions,
    /// Terms, the largest first.
    pub terms: Vec<Term>,
}

impl Budget {
    /// Converts a length on the sensor into one on the ground, m.
    #[must_use]
    pub fn ground_m(&self, length_mm: f64) -> f64 {
        length_mm * self.assumptions.height_m / self.principal_distance_mm
    }

    /// Converts a length on the sensor into pixels.
    #[must_use]
    pub fn pixels(&self, length_mm: f64) -> f64 {
        length_mm / self.pixel_mm
    }

    /// Returns the effect of a source over the exposures that the limits allow, mm.
    #[must_use]
    pub fn effect_mm(&self, source: Source) -> f64 {
        self.terms
            .iter()
            .find(|term| term.source == source)
            .map_or(0.0, |term| term.limits_mm)
    }
}
