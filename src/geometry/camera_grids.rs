//! Residual grids of a camera: shown to cover its sensor and not to fold its image.

use core::fmt;

use super::calibration::{Calibration, Polynomial};
use super::grid::{GridCarrier, GridError, ResidualGrid};
use super::invertibility::MIN_SCALE;
use super::lens_grid_bounds::LensGridBounds;
use super::range::MAX_FOCUS_FRACTION;
use super::sensor::{FmcAxis, SensorPoint};

/// Largest slope of both grids together. What a polynomial leaves of a lens is a thousandth or
/// less; a grid that is steeper is no residual.
pub const MAX_GRID_SLOPE: f32 = 0.05;

/// The residual grids do not fit the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CameraGridsError {
    /// A grid is given as that of one part and says that it is that of the other.
    Carrier {
        /// Part as whose grid it is given.
        given_as: GridCarrier,
    },
    /// The cells of a grid do not reach as far as its part needs.
    Grid {
        /// Part of the grid.
        carrier: GridCarrier,
        /// The two rectangles.
        error: GridError,
    },
    /// The slope of the grids is larger than [`MAX_GRID_SLOPE`], or not a number.
    Steep {
        /// Upper bound of the slope of both grids together.
        slope: f32,
    },
    /// A polynomial folds the image with the slope of the grids, or comes too near to it.
    Folds {
        /// Upper bound of the slope of both grids together.
        slope: f32,
        /// The polynomial that folds.
        polynomial: Polynomial,
        /// Lower bound of the scale `∂(ideal)/∂(measured)`; [`MIN_SCALE`] is required.
        scale: f32,
        /// Place of the smallest scale.
        at: SensorPoint,
    },
}

impl fmt::Display for CameraGridsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Carrier { given_as } => {
                let [given, other] = match given_as {
                    GridCarrier::Lens => ["lens", "sensor"],
                    GridCarrier::Sensor => ["sensor", "lens"],
                };
                write!(
                    f,
                    "the residual grid is given as that of the {given}, and its file says {other}"
                )
            }
            Self::Grid { carrier, error } => {
                let part = match carrier {
                    GridCarrier::Lens => "lens (the sensor enlarged by half the stroke)",
                    GridCarrier::Sensor => "sensor",
                };
                write!(f, "residual grid of the {part}: {error}")
            }
            Self::Steep { slope } => write!(
                f,
                "the residual grids have a slope of up to {slope}; allowed: {MAX_GRID_SLOPE}"
            ),
            Self::Folds {
                slope,
                polynomial,
                scale,
                at,
            } => {
                let which = match polynomial {
                    Polynomial::Static => "the distortion polynomial",
                    Polynomial::Fitted => "the five-coefficient model",
                };
                write!(
                    f,
                    "{which} with residual grids of a slope of up to {slope} may fold the image: \
                     the scale d(ideal)/d(measured) may fall to {scale:.3} near ({:.2}, {:.2}) mm; \
                     at least {MIN_SCALE} is required over the sensor enlarged by half the stroke",
                    at.x_mm, at.y_mm
                )
            }
        }
    }
}

impl core::error::Error for CameraGridsError {}

/// Residual grids of a camera, of the lens, of the sensor, of both or of none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraGrids<'a> {
    lens: Option<ResidualGrid<'a>>,
    sensor: Option<ResidualGrid<'a>>,
    fit: GridsFit,
}

/// Numbers by which the grids fit their camera, found once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GridsFit {
    axis: FmcAxis,
    slope: f32,
    least_scale: f32,
}

impl<'a> CameraGrids<'a> {
    /// Returns the grids if they fit the camera of a calibration.
    ///
    /// # Model
    /// The cells of the sensor's grid must cover the sensor, those of the lens's grid the sensor
    /// enlarged by half the stroke along the FMC axis, both ways. The slope of the grids (that of
    /// the lens's over 1 less the largest focus shift) is added to that of the polynomials in the
    /// proof that the image does not fold
    /// ([`least_scale`](super::invertibility::least_scale)).
    ///
    /// # Errors
    /// [`CameraGridsError`] with the number that is not allowed.
    pub fn new(
        calibration: &Calibration,
        lens: Option<ResidualGrid<'a>>,
        sensor: Option<ResidualGrid<'a>>,
    ) -> Result<Self, CameraGridsError> {
        let parameters = calibration.parameters();
        let sensor_array = calibration.sensor();
        let corner = SensorPoint::new(sensor_array.half_width_mm(), sensor_array.half_height_mm());
        let half_stroke_mm = 0.5 * parameters.stroke_mm;
        let enlarged = if parameters.axis.is_x() {
            SensorPoint::new(corner.x_mm + half_stroke_mm, corner.y_mm)
        } else {
            SensorPoint::new(corner.x_mm, corner.y_mm + half_stroke_mm)
        };
        let lens = lens
            .map(|grid| covering(grid, GridCarrier::Lens, enlarged))
            .transpose()?;
        let sensor = sensor
            .map(|grid| covering(grid, GridCarrier::Sensor, corner))
            .transpose()?;
        let slope_of =
            |grid: &Option<ResidualGrid<'_>>| grid.map_or(0.0, |grid| grid.bounds().slope());
        let slope = slope_of(&lens) / (1.0 - MAX_FOCUS_FRACTION) + slope_of(&sensor);
        // A NaN is not within the limit.
        if !(0.0..=MAX_GRID_SLOPE).contains(&slope) {
            return Err(CameraGridsError::Steep { slope });
        }
        let least_scale =
            calibration
                .least_scale_with(slope)
                .map_err(|folding| CameraGridsError::Folds {
                    slope,
                    polynomial: folding.polynomial,
                    scale: folding.scale,
                    at: folding.at,
                })?;
        let fit = GridsFit {
            axis: parameters.axis,
            slope,
            least_scale,
        };
        Ok(Self { lens, sensor, fit })
    }

    /// Returns grids for which [`Self::new`] has found the numbers before.
    pub(crate) const fn fitting(
        lens: Option<ResidualGrid<'a>>,
        sensor: Option<ResidualGrid<'a>>,
        fit: GridsFit,
    ) -> Self {
        Self { lens, sensor, fit }
    }

    pub(crate) const fn fit(&self) -> &GridsFit {
        &self.fit
    }

    /// Grid of the lens.
    #[must_use]
    pub const fn lens(&self) -> Option<&ResidualGrid<'a>> {
        self.lens.as_ref()
    }

    /// Grid of the sensor.
    #[must_use]
    pub const fn sensor(&self) -> Option<&ResidualGrid<'a>> {
        self.sensor.as_ref()
    }

    /// Bounds of the grid of the lens; `None` without one.
    #[must_use]
    pub fn lens_bounds(&self) -> Option<LensGridBounds> {
        let axis = self.fit.axis;
        self.lens().map(|grid| LensGridBounds::new(grid, axis))
    }

    /// Direction in which the principal point moves, and the grid of the lens with it.
    #[must_use]
    pub const fn axis(&self) -> FmcAxis {
        self.fit.axis
    }

    /// Upper bound of the slope of both grids together.
    #[must_use]
    pub const fn slope(&self) -> f32 {
        self.fit.slope
    }

    /// Lower bound of the scale `∂(ideal)/∂(measured)` over the sensor, with the grids.
    #[must_use]
    pub const fn least_scale(&self) -> f32 {
        self.fit.least_scale
    }
}

/// Returns the grid of a part if it is one and covers the rectangle up to `corner`.
fn covering(
    grid: ResidualGrid<'_>,
    carrier: GridCarrier,
    corner: SensorPoint,
) -> Result<ResidualGrid<'_>, CameraGridsError> {
    if grid.header().carrier != carrier {
        return Err(CameraGridsError::Carrier { given_as: carrier });
    }
    grid.covering(SensorPoint::new(-corner.x_mm, -corner.y_mm), corner)
        .map_err(|error| CameraGridsError::Grid { carrier, error })
}
