//! Camera that a program's file describes.

use fmc_camera_file::InputError;
use fmc_camera_file::number::clipped;

use crate::correction::Correction;
use crate::pinhole::Pinhole;
use crate::source::Source;
use crate::uncertainty::Uncertainty;

/// Numbers and signs that the user states because the file does not.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stated<'a> {
    /// Pixel pitch, mm.
    pub pixel_mm: Option<f64>,
    /// Option or file that states the pitch, for messages.
    pub pixel_from: Option<&'a str>,
    /// Columns and rows, px.
    pub size_px: Option<[u32; 2]>,
    /// Option or file that states columns and rows, for messages.
    pub size_from: Option<&'a str>,
    /// Name of one camera of several.
    pub id: Option<&'a str>,
    /// Sign of the coefficients, for files in which it is not known: `true` for a correction, which
    /// is to be added to the measured point.
    pub is_correction: Option<bool>,
}

impl Stated<'_> {
    /// Returns the words for what states the pitch.
    pub(crate) fn pixel_stated_by(&self) -> &str {
        self.pixel_from.unwrap_or("the stated ones are")
    }

    /// Returns the words for what states columns and rows.
    pub(crate) fn size_stated_by(&self) -> &str {
        self.size_from.unwrap_or("the stated one is")
    }
}

/// A camera as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// Name that the file gives it.
    pub name: String,
    /// Columns and rows, px, if the file has them.
    pub size_px: Option<[u32; 2]>,
    /// Pixel pitch, mm, if the file has it.
    pub pixel_mm: Option<f64>,
    /// Formula with its numbers.
    pub formula: Formula,
    /// Remarks for the user.
    pub notes: Vec<String>,
    /// Uncertainty of the parameters, if the file states it.
    pub uncertainty: Option<Uncertainty>,
}

/// Formula of a program, of one of the two directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Formula {
    /// Ideal ray -> measured point, px.
    Pinhole(Pinhole),
    /// Measured point -> ideal point, mm.
    Correction(Correction),
}

impl Formula {
    /// Returns the direction in words.
    #[must_use]
    pub const fn direction(&self) -> &'static str {
        match self {
            Self::Pinhole(_) => "ideal -> measured",
            Self::Correction(_) => "measured -> ideal",
        }
    }

    fn is_finite(&self) -> bool {
        match self {
            Self::Pinhole(pinhole) => pinhole.is_finite(),
            Self::Correction(correction) => correction.is_finite(),
        }
    }
}

impl Found {
    /// Returns a camera of which the file has nothing but the formula.
    pub(crate) fn new(name: impl Into<String>, formula: Formula) -> Self {
        Self {
            name: name.into(),
            size_px: None,
            pixel_mm: None,
            formula,
            notes: Vec::new(),
            uncertainty: None,
        }
    }

    /// Returns the camera with the size of its array.
    pub(crate) fn sized(self, size_px: [u32; 2]) -> Self {
        Self {
            size_px: Some(size_px),
            ..self
        }
    }

    /// Returns the camera, if its numbers are finite and its principal distance is positive.
    pub(crate) fn checked(self, source: &Source<'_>) -> Result<Self, InputError> {
        let is_positive = match &self.formula {
            Formula::Pinhole(pinhole) => pinhole.focal_px.iter().all(|focal| *focal > 0.0),
            Formula::Correction(correction) => correction.principal_distance_mm > 0.0,
        };
        if !self.formula.is_finite() {
            Err(source.invalid("a number of the camera is not finite"))
        } else if !is_positive {
            Err(source.invalid("the principal distance is not positive"))
        } else {
            Ok(self)
        }
    }
}

/// Returns one of several cameras: the only one, or the one with the name that was asked for.
pub(crate) fn chosen<T>(
    source: &Source<'_>,
    cameras: Vec<(String, T)>,
    id: Option<&str>,
) -> Result<(String, T), InputError> {
    const SHOWN: usize = 10;
    let names: Vec<String> = cameras.iter().map(|(name, _)| clipped(name)).collect();
    let list = || {
        let shown: Vec<_> = names.iter().take(SHOWN).map(String::as_str).collect();
        let more = names.len().saturating_sub(SHOWN);
        let rest = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        format!("{}{rest}", shown.join(", "))
    };
    let count = cameras.len();
    match id {
        Some(id) => cameras
            .into_iter()
            .find(|(name, _)| name == id)
            .ok_or_else(|| {
                source
                    .invalid(format!("no camera {}", clipped(id)))
                    .with_help(format!("the file has: {}", list()))
            }),
        None if count > 1 => Err(source
            .invalid(format!("{count} cameras, and --id does not name one"))
            .with_help(format!("the file has: {}", list()))),
        None => cameras
            .into_iter()
            .next()
            .ok_or_else(|| source.invalid("the file has no camera")),
    }
}

/// Creates the error of a model that is not one of a central projection with these terms.
pub(crate) fn unsupported(source: &Source<'_>, model: &str, supported: &str) -> InputError {
    source
        .invalid(format!("camera model {} is not read", clipped(model)))
        .with_help(format!("supported: {supported}"))
}
