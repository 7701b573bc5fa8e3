//! Correction of one frame with the residual grids of its camera.

use super::camera_grids::CameraGrids;
use super::evaluation_form::Displacement;
use super::exposure_distortion::{ExposureDistortion, sealed::Sealed};
use super::frame_correction::{Corrected, FrameCorrection};
use super::grid::PlacedGrid;
use super::point_kernel::LengthsDiffer;
use super::principal_point::PrincipalPointMotion;
use super::sensor::SensorPoint;

/// Largest error, nm, that the last step of [`GriddedCorrection::distort`] leaves in the
/// displacement because the derivatives omit the grids.
pub const LEFT_BY_GRIDS_NM: f32 = 0.02;

/// The correction of one frame whose camera has residual grids.
///
/// It borrows the coefficients of the grids; a camera without grids has the [`FrameCorrection`]
/// alone and pays nothing.
///
/// # Model
/// `D(p) + L(p) + S(p)`: the polynomial, the grid of the lens at ((x, y) - c̄·e)/(1+κ), and that of
/// the sensor at (x, y), each a uniform cubic B-spline ([`PlacedGrid`]). Grids are continued beyond
/// their cells by the value at the border.
///
/// # Examples
/// ```
/// use fmc_camera::geometry::camera_grids::CameraGrids;
/// use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
/// use fmc_camera::geometry::gridded_correction::GriddedCorrection;
/// use fmc_camera::{Calibration, CalibrationParameters, FrameCorrection, SensorPoint};
///
/// let header = GridHeader {
///     carrier: GridCarrier::Sensor,
///     columns: 4,
///     rows: 4,
///     first_node: SensorPoint::new(-30.0, -30.0),
///     pitch_mm: 20.0,
///     scale_mm: 1e-7,
/// };
/// // Equal coefficients are a constant: 10000 · 0.1 nm to the right, -0.5 µm upwards.
/// let mut file = header.to_bytes().to_vec();
/// for _ in 0..16 {
///     file.extend([10_000_i16.to_le_bytes(), (-5000_i16).to_le_bytes()].concat());
/// }
/// file.extend(GridHeader::checksum(&file).to_le_bytes());
///
/// let calibration = Calibration::new(CalibrationParameters::new(100.0, [2000, 2000], 10.0))?;
/// let grids = CameraGrids::new(&calibration, None, Some(ResidualGrid::parse(&file)?))?;
/// let still = FrameCorrection::without_motion(&calibration);
/// let correction = GriddedCorrection::calibrated(still, &grids);
/// let ideal = correction.correct(SensorPoint::new(3.0, -4.0)).point;
/// assert_eq!(ideal, SensorPoint::new(2.999, -3.9995));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GriddedCorrection<'a> {
    polynomial: FrameCorrection,
    lens: Option<PlacedGrid<'a>>,
    sensor: Option<PlacedGrid<'a>>,
    left_out_nm: f32,
    /// Largest residual from which a step with the polynomial's derivatives may be the last, nm.
    last_residual_nm: f32,
}

impl<'a> GriddedCorrection<'a> {
    /// Returns the correction with the stage at the calibrated position: that of software that does
    /// not know the motion.
    #[must_use]
    pub fn calibrated(polynomial: FrameCorrection, grids: &CameraGrids<'a>) -> Self {
        let lens = grids.lens().map(PlacedGrid::calibrated);
        Self::of(polynomial, grids, lens, 0.0)
    }

    /// Returns the correction of an exposure.
    ///
    /// # Units and frames
    /// `motion` is that of the principal point along [`CameraGrids::axis`]; `enlargement` is κ of
    /// the focus shift.
    ///
    /// # Accuracy
    /// [`Self::left_out_nm`].
    #[must_use]
    pub fn exposed(
        polynomial: FrameCorrection,
        grids: &CameraGrids<'a>,
        motion: &PrincipalPointMotion,
        enlargement: f32,
    ) -> Self {
        let axis = grids.axis();
        let place = |grid| PlacedGrid::new(grid, axis, motion.centroid_mm, enlargement);
        let left_out_mm = grids.lens_bounds().map_or(0.0, |bounds| {
            bounds.left_out_mm(polynomial.sensor(), motion, enlargement)
        });
        Self::of(polynomial, grids, grids.lens().map(place), left_out_mm)
    }

    fn of(
        polynomial: FrameCorrection,
        grids: &CameraGrids<'a>,
        lens: Option<PlacedGrid<'a>>,
        left_out_mm: f32,
    ) -> Self {
        // A step leaves the grids' slope over the scale of the residual before it. Below four units
        // in the last place of the farthest coordinate the residual is rounding.
        let rate = grids.slope() / grids.least_scale();
        let sensor = polynomial.sensor();
        let farthest_mm = sensor.half_width_mm().max(sensor.half_height_mm());
        let rounding_nm = 4e6 * f32::EPSILON * farthest_mm;
        Self {
            polynomial,
            lens,
            sensor: grids.sensor().map(PlacedGrid::calibrated),
            left_out_nm: polynomial.left_out_nm() + 1e6 * left_out_mm,
            last_residual_nm: (LEFT_BY_GRIDS_NM / rate).max(rounding_nm),
        }
    }

    /// The polynomial part of the correction.
    #[must_use]
    pub const fn polynomial(&self) -> &FrameCorrection {
        &self.polynomial
    }

    /// Grid of the lens at its place over the sensor.
    #[must_use]
    pub const fn lens(&self) -> Option<&PlacedGrid<'a>> {
        self.lens.as_ref()
    }

    /// Grid of the sensor.
    #[must_use]
    pub const fn sensor(&self) -> Option<&PlacedGrid<'a>> {
        self.sensor.as_ref()
    }

    /// Upper bound of what the folds, the kernel and the places of the grids leave out of the
    /// model, per axis, nm.
    ///
    /// # Model
    /// That of the polynomial, and that of the grid of the lens, which is evaluated at the centroid
    /// alone ([`LensGridBounds`](super::lens_grid_bounds::LensGridBounds)).
    #[must_use]
    pub const fn left_out_nm(&self) -> f32 {
        self.left_out_nm
    }

    /// Returns the displacement of the grids at a measured point, measured - ideal.
    ///
    /// # Units and frames
    /// Sensor frame, mm.
    #[inline]
    #[must_use]
    pub fn residual(&self, measured: SensorPoint) -> Displacement {
        match (&self.lens, &self.sensor) {
            (None, None) => Displacement::default(),
            (Some(grid), None) | (None, Some(grid)) => grid.displacement(measured),
            (Some(lens), Some(sensor)) => {
                sum(lens.displacement(measured), sensor.displacement(measured))
            }
        }
    }

    /// Returns the distortion at a measured point, measured - ideal, grids included.
    ///
    /// # Units and frames
    /// As [`FrameCorrection::distortion`]; a NaN stays a NaN.
    #[inline]
    #[must_use]
    pub fn distortion(&self, measured: SensorPoint) -> Displacement {
        self.plus_residual(self.polynomial.distortion(measured), measured)
    }

    /// Returns the ideal point of a measured one.
    ///
    /// # Model
    /// As [`FrameCorrection::correct`]: the coordinate is rounded once. Without grids it has the
    /// same bits.
    ///
    /// # Units and frames
    /// Sensor frame, mm.
    ///
    /// # Accuracy
    /// That of [`FrameCorrection::correct`] and of [`PlacedGrid::displacement`], beside
    /// [`Self::left_out_nm`]: within 1.5 nm of the exposure mean of polynomial and splines in
    /// double precision (`tests/geometry/gridded.rs`).
    #[inline]
    #[must_use]
    pub fn correct(&self, measured: SensorPoint) -> Corrected {
        let distortion = self.distortion(measured);
        Corrected {
            point: SensorPoint::new(
                measured.x_mm - distortion.dx_mm,
                measured.y_mm - distortion.dy_mm,
            ),
            distortion,
        }
    }

    /// Replaces every measured point of a slice by its ideal point: [`Self::correct`], bit for bit,
    /// point by point, or [`FrameCorrection::correct_slice`] where there are no grids.
    pub fn correct_slice(&self, points: &mut [SensorPoint]) {
        if self.is_polynomial() {
            return self.polynomial.correct_slice(points);
        }
        for point in points {
            *point = self.correct(*point).point;
        }
    }

    /// Does the same as [`Self::correct_slice`] for separate coordinates: `x_mm` and `y_mm` of the
    /// same points.
    ///
    /// # Errors
    /// [`LengthsDiffer`] unless there are as many x as y; then nothing is replaced.
    pub fn correct_slice_xy(
        &self,
        x_mm: &mut [f32],
        y_mm: &mut [f32],
    ) -> Result<(), LengthsDiffer> {
        if self.is_polynomial() || x_mm.len() != y_mm.len() {
            return self.polynomial.correct_slice_xy(x_mm, y_mm);
        }
        for (x_mm, y_mm) in x_mm.iter_mut().zip(y_mm) {
            let ideal = self.correct(SensorPoint::new(*x_mm, *y_mm)).point;
            (*x_mm, *y_mm) = (ideal.x_mm, ideal.y_mm);
        }
        Ok(())
    }

    /// Returns the distortion of the polynomial with that of the grids.
    #[inline]
    fn plus_residual(&self, polynomial: Displacement, measured: SensorPoint) -> Displacement {
        if self.is_polynomial() {
            polynomial
        } else {
            sum(polynomial, self.residual(measured))
        }
    }
}

impl ExposureDistortion for GriddedCorrection<'_> {
    #[inline]
    fn polynomial(&self) -> &FrameCorrection {
        &self.polynomial
    }

    #[inline]
    fn distortion(&self, measured: SensorPoint) -> Displacement {
        Self::distortion(self, measured)
    }

    #[inline]
    fn full_distortion(&self, measured: SensorPoint) -> Displacement {
        self.plus_residual(self.polynomial.full_distortion(measured), measured)
    }

    #[inline]
    fn correct(&self, measured: SensorPoint) -> Corrected {
        Self::correct(self, measured)
    }

    #[inline]
    fn last_residual_nm(&self, of_polynomial_nm: f32) -> f32 {
        self.last_residual_nm.min(of_polynomial_nm)
    }

    #[inline]
    fn is_polynomial(&self) -> bool {
        self.lens.is_none() && self.sensor.is_none()
    }
}

impl Sealed for GriddedCorrection<'_> {}

/// Correction of a camera without residual grids, with the same bits.
impl From<&FrameCorrection> for GriddedCorrection<'_> {
    fn from(polynomial: &FrameCorrection) -> Self {
        Self {
            polynomial: *polynomial,
            lens: None,
            sensor: None,
            left_out_nm: polynomial.left_out_nm(),
            last_residual_nm: f32::INFINITY,
        }
    }
}

#[inline]
fn sum(a: Displacement, b: Displacement) -> Displacement {
    Displacement {
        dx_mm: a.dx_mm + b.dx_mm,
        dy_mm: a.dy_mm + b.dy_mm,
    }
}
