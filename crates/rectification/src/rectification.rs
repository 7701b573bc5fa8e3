//! A frame's rectification: rows of the output image from rows of the source image.

use std::ops::Range;

use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_kernel::host::Level;
use fmc_camera_kernel::resampling::{Band, Kernel, Resampler, Sample};

use crate::form::Form;
use crate::mesh::{Mesh, MeshError};
use crate::vertices::Layout;
use crate::window::{Centre, Window, WindowError};

/// Choices for the rectification of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// Size of the output image.
    pub window: Window,
    /// The point in its middle.
    pub centre: Centre,
    /// Kernel of resampling.
    pub resampling: Kernel,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            window: Window::Same,
            centre: Centre::PrincipalPoint,
            resampling: Kernel::Bicubic,
        }
    }
}

/// A frame that cannot be rectified.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RectificationError {
    /// The output image has no size.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// The places cannot be stated as a mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A row that cannot be resampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RowError {
    /// The row is not one of the output image.
    #[error("row {row_px} is not in the output image of {height_px} rows")]
    OffImage {
        /// The row.
        row_px: u32,
        /// Rows of the output image.
        height_px: u32,
    },
    /// The source image does not have the sensor's size.
    #[error("the source image has {found_px:?} pixels, the sensor {sensor_px:?}")]
    Size {
        /// Width and height of the image.
        found_px: [u32; 2],
        /// Width and height of the sensor.
        sensor_px: [u32; 2],
    },
    /// Rows of the source image are missing.
    #[error("rows {needed_px:?} of the source image are needed, rows {present_px:?} are there")]
    Source {
        /// First row, and the one behind the last.
        needed_px: [u32; 2],
        /// First row that is there, and the one behind the last.
        present_px: [u32; 2],
    },
    /// The slices of the output do not have its width.
    #[error(
        "the row has {samples} samples and {mask} mask pixels instead of {width_px} x bands and {width_px}"
    )]
    Length {
        /// Samples of the output slice.
        samples: usize,
        /// Pixels of the mask.
        mask: usize,
        /// Width of the output image.
        width_px: u32,
    },
}

/// The rectification of one frame: its rows are independent and may be resampled in several
/// threads.
#[derive(Debug, Clone)]
pub struct Rectification {
    mesh: Mesh,
    sensor_px: [u32; 2],
    resampler: Resampler,
}

impl Rectification {
    /// Prepares the rectification of a frame with this correction, that of the polynomial or with
    /// residual grids, and this principal point at the middle of its exposure.
    ///
    /// # Errors
    /// [`RectificationError`] for an output image without pixels, and for a lens whose map from
    /// ideal to measured points cannot be bounded around the sensor.
    pub fn new<'a>(
        correction: impl Into<GriddedCorrection<'a>>,
        principal_point: SensorPoint,
        request: &Request,
    ) -> Result<Self, RectificationError> {
        let correction = &correction.into();
        let form = Form::new(correction);
        let sensor = correction.polynomial().sensor();
        let middle = request.centre.of(principal_point);
        let mesh = Mesh::new(&Layout {
            correction,
            form: &form,
            middle,
            size_px: request.window.size_px(&form, sensor, middle)?,
        })?;
        Ok(Self {
            mesh,
            sensor_px: [sensor.width_px(), sensor.height_px()],
            resampler: Resampler::new(request.resampling),
        })
    }

    /// Returns width and height of the output image that [`new`](Self::new) would prepare.
    ///
    /// # Errors
    /// [`WindowError`] for an image without pixels.
    pub fn size_px<'a>(
        correction: impl Into<GriddedCorrection<'a>>,
        principal_point: SensorPoint,
        request: &Request,
    ) -> Result<[u32; 2], WindowError> {
        let correction = &correction.into();
        let form = Form::new(correction);
        let middle = request.centre.of(principal_point);
        let sensor = correction.polynomial().sensor();
        request.window.size_px(&form, sensor, middle)
    }

    /// Selects other vectors than the widest of this machine; the result is the same.
    #[must_use]
    pub fn at(mut self, level: Level) -> Self {
        self.resampler = self.resampler.at(level);
        self
    }

    /// Width and height of the output image.
    #[must_use]
    pub const fn output_size_px(&self) -> [u32; 2] {
        self.mesh.size_px()
    }

    /// Width and height of the source image.
    #[must_use]
    pub const fn sensor_px(&self) -> [u32; 2] {
        self.sensor_px
    }

    /// Places of the output pixels.
    #[must_use]
    pub const fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Distance of the mesh's vertices, pixels.
    #[must_use]
    pub const fn mesh_spacing_px(&self) -> u32 {
        self.mesh.spacing_px()
    }

    /// Upper bound of the error of a place by the mesh, pixels.
    #[must_use]
    pub const fn mesh_bound_px(&self) -> f64 {
        self.mesh.bound_px()
    }

    /// Kernel of resampling.
    #[must_use]
    pub const fn resampling(&self) -> Kernel {
        self.resampler.kernel()
    }

    /// Returns the rows of the source image that output rows need, with those of the taps; an empty
    /// range if all of their pixels are border.
    #[must_use]
    pub fn source_rows(&self, rows: Range<u32>) -> Range<u32> {
        let [_, height] = self.sensor_px;
        let Some([low, high]) = self.mesh.places_of_rows(rows) else {
            return 0..0;
        };
        if high < -0.5 || low > f64::from(height) - 0.5 {
            return 0..0;
        }
        let half = f64::from(self.resampler.kernel().half_taps());
        let first = (low.floor() - (half - 1.0).max(0.0)).max(0.0);
        let last = high.floor() + half.max(1.0);
        row(first).min(height - 1)..row(last.max(0.0) + 1.0).min(height)
    }

    /// Resamples a row of the output image into a slice of interleaved samples and a mask, 1 or 0
    /// for border, and returns the number of border pixels.
    ///
    /// # Errors
    /// [`RowError`] if a slice has another length than the row, or if a source row is missing.
    pub fn row<S: Sample>(
        &self,
        row_px: u32,
        source: &Band<'_, S>,
        out: &mut [S],
        mask: &mut [u8],
    ) -> Result<u32, RowError> {
        let [width_px, height_px] = self.output_size_px();
        if row_px >= height_px {
            return Err(RowError::OffImage { row_px, height_px });
        }
        if source.size_px() != self.sensor_px {
            return Err(RowError::Size {
                found_px: source.size_px(),
                sensor_px: self.sensor_px,
            });
        }
        let width = width_px as usize;
        if out.len() != width * source.bands() || mask.len() != width {
            return Err(RowError::Length {
                samples: out.len(),
                mask: mask.len(),
                width_px,
            });
        }
        let needed = self.source_rows(row_px..row_px + 1);
        let present = source.rows_px();
        if !needed.is_empty() && (needed.start < present.start || needed.end > present.end) {
            return Err(RowError::Source {
                needed_px: [needed.start, needed.end],
                present_px: [present.start, present.end],
            });
        }
        let mut runs = Vec::with_capacity(width / 16 + 4);
        self.mesh.runs(row_px, &mut runs);
        Ok(self.resampler.row(source, &runs, out, mask))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a row of an image, not negative"
)]
const fn row(whole: f64) -> u32 {
    whole as u32
}
