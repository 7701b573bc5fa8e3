//! The sensor frame, its pixels, and the FMC axis in it.

use super::range::{OutOfRange, Quantity};

/// A point of the sensor frame: upright positive image, origin at the centre of the pixel array,
/// x right, y up, millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct SensorPoint {
    /// To the right of the array's centre, mm.
    pub x_mm: f32,
    /// Above the array's centre, mm.
    pub y_mm: f32,
}

impl SensorPoint {
    /// The point (`x_mm`, `y_mm`).
    #[must_use]
    pub const fn new(x_mm: f32, y_mm: f32) -> Self {
        Self { x_mm, y_mm }
    }
}

/// A point in pixels: column to the right, row downwards, the *centre* of the first pixel is (0,
/// 0).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PixelPoint {
    /// Column, px.
    pub col_px: f32,
    /// Row, px.
    pub row_px: f32,
}

/// Direction in which the principal point moves in the sensor frame while the mechanism
/// compensates: the direction of flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FmcAxis {
    /// Towards larger x.
    PlusX,
    /// Towards smaller x.
    MinusX,
    /// Towards larger y.
    #[default]
    PlusY,
    /// Towards smaller y.
    MinusY,
}

impl FmcAxis {
    /// All four axes, for sweeps.
    pub const ALL: [Self; 4] = [Self::PlusX, Self::MinusX, Self::PlusY, Self::MinusY];

    /// The sign σ of the axis: +1 or -1.
    #[must_use]
    pub const fn sign(self) -> f32 {
        match self {
            Self::PlusX | Self::PlusY => 1.0,
            Self::MinusX | Self::MinusY => -1.0,
        }
    }

    /// Returns true if the axis lies along x, and false if it lies along y.
    #[must_use]
    pub const fn is_x(self) -> bool {
        matches!(self, Self::PlusX | Self::MinusX)
    }

    /// Returns the point of the sensor frame that lies `offset_mm` along the axis from `origin`.
    #[must_use]
    pub fn sensor_from_offset(self, origin: SensorPoint, offset_mm: f32) -> SensorPoint {
        let signed = self.sign() * offset_mm;
        if self.is_x() {
            SensorPoint::new(origin.x_mm + signed, origin.y_mm)
        } else {
            SensorPoint::new(origin.x_mm, origin.y_mm + signed)
        }
    }
}

/// Largest number of pixels along one side.
pub const MAX_SIDE_PX: u32 = 100_000;
/// Largest side of the format, mm (the largest aerial film format was 230 mm by 460 mm).
pub const MAX_SIDE_MM: f32 = 500.0;

/// The pixel array: a rectangle of square pixels centred on the origin of the sensor frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    width_px: u32,
    height_px: u32,
    pixel_um: f32,
    /// The corner up and to the right.
    corner: SensorPoint,
    /// Farthest |x| and |y| that still count as points of the array.
    farthest: SensorPoint,
}

impl Sensor {
    /// Returns an array of `width_px` by `height_px` pixels of `pixel_um` micrometres.
    ///
    /// # Errors
    /// [`OutOfRange`] for a side of no pixels, of more than [`MAX_SIDE_PX`] or of more than
    /// [`MAX_SIDE_MM`], and for a pixel outside 0.5 to 100 µm.
    pub fn new(width_px: u32, height_px: u32, pixel_um: f32) -> Result<Self, OutOfRange> {
        Quantity::PixelUm.check(pixel_um)?;
        let pixel_mm = pixel_um / 1000.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole pixels, up to a million"
        )]
        let longest_px = pixels(((MAX_SIDE_MM / pixel_mm) as u32).min(MAX_SIDE_PX));
        for (quantity, side_px) in [
            (Quantity::WidthPx, width_px),
            (Quantity::HeightPx, height_px),
        ] {
            quantity.check_within(pixels(side_px), 1.0, longest_px)?;
        }
        let half_mm = |side_px: u32| pixels(side_px) * pixel_um / 2000.0;
        let corner = SensorPoint::new(half_mm(width_px), half_mm(height_px));
        // Of a positive number that is far from the largest.
        let two_units_on = |half_mm: f32| f32::from_bits(half_mm.to_bits() + 2);
        Ok(Self {
            width_px,
            height_px,
            pixel_um,
            corner,
            farthest: SensorPoint::new(two_units_on(corner.x_mm), two_units_on(corner.y_mm)),
        })
    }

    /// Pixels along x.
    #[must_use]
    pub const fn width_px(&self) -> u32 {
        self.width_px
    }

    /// Pixels along y.
    #[must_use]
    pub const fn height_px(&self) -> u32 {
        self.height_px
    }

    /// Pixel pitch p, mm.
    #[must_use]
    pub const fn pixel_mm(&self) -> f32 {
        self.pixel_um / 1000.0
    }

    /// Distance from the centre to the left and right edge, mm.
    #[must_use]
    pub const fn half_width_mm(&self) -> f32 {
        self.corner.x_mm
    }

    /// Distance from the centre to the upper and lower edge, mm.
    #[must_use]
    pub const fn half_height_mm(&self) -> f32 {
        self.corner.y_mm
    }

    /// Farthest |x| and |y| that still count as points of the array, mm.
    #[inline]
    pub(super) const fn farthest(&self) -> SensorPoint {
        self.farthest
    }

    /// Returns true if the point lies on the array, edges included; a NaN does not.
    ///
    /// # Accuracy
    /// In single precision the position of an edge is known to two units in the last place; points
    /// within that count as on the edge.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: SensorPoint) -> bool {
        point.x_mm.abs() <= self.farthest.x_mm && point.y_mm.abs() <= self.farthest.y_mm
    }

    /// Returns the sensor-frame point of a pixel coordinate.
    ///
    /// # Model
    /// `x = (col - (W-1)/2)·p`, `y = ((H-1)/2 - row)·p`.
    ///
    /// # Units and frames
    /// Takes pixels (first pixel centre = (0, 0), row downwards), returns mm of the sensor frame.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::sensor::{PixelPoint, Sensor};
    /// let sensor = Sensor::new(9216, 9216, 8.75)?;
    /// let corner = sensor.sensor_from_pixel(PixelPoint { col_px: -0.5, row_px: -0.5 });
    /// assert_eq!((corner.x_mm, corner.y_mm), (-40.32, 40.32));
    /// # Ok::<(), fmc_camera::geometry::range::OutOfRange>(())
    /// ```
    #[must_use]
    pub fn sensor_from_pixel(&self, pixel: PixelPoint) -> SensorPoint {
        let centre = self.centre();
        SensorPoint::new(
            (pixel.col_px - centre.col_px) * self.pixel_mm(),
            (centre.row_px - pixel.row_px) * self.pixel_mm(),
        )
    }

    /// Returns the pixel coordinate of a sensor-frame point: the inverse of
    /// [`Self::sensor_from_pixel`].
    ///
    /// # Model
    /// `col = (W-1)/2 + x/p`, `row = (H-1)/2 - y/p`.
    ///
    /// # Accuracy
    /// Half a unit in the last place of the pixel number, 0.002 px at 18000 px; the sensor frame
    /// resolves more and is the one to measure in.
    #[must_use]
    pub fn pixel_from_sensor(&self, point: SensorPoint) -> PixelPoint {
        let centre = self.centre();
        PixelPoint {
            col_px: centre.col_px + point.x_mm / self.pixel_mm(),
            row_px: centre.row_px - point.y_mm / self.pixel_mm(),
        }
    }

    fn centre(&self) -> PixelPoint {
        PixelPoint {
            col_px: (pixels(self.width_px) - 1.0) * 0.5,
            row_px: (pixels(self.height_px) - 1.0) * 0.5,
        }
    }
}

/// Converts a pixel count, exactly up to 2²⁴.
#[expect(
    clippy::cast_precision_loss,
    reason = "exact: every count that passes validation is at most MAX_SIDE_PX < 2^24"
)]
pub(super) const fn pixels(count: u32) -> f32 {
    count as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_pixel_centre_is_half_a_pixel_inside_the_corner() {
        let sensor = Sensor::new(14204, 10652, 3.76).unwrap();
        let first = sensor.sensor_from_pixel(PixelPoint::default());
        assert!((first.x_mm + sensor.half_width_mm() - 0.00188).abs() < 2e-6);
        assert!((sensor.half_height_mm() - first.y_mm - 0.00188).abs() < 2e-6);
    }

    #[test]
    fn edges_belong_to_the_sensor_and_nan_does_not() {
        let sensor = Sensor::new(18000, 18000, 12.7).unwrap();
        let edge = sensor.half_width_mm();
        assert!(sensor.contains(SensorPoint::new(edge, -edge)));
        // Two units in the last place at 114.3 mm are 15 nm.
        assert!(!sensor.contains(SensorPoint::new(edge + 2.3e-5, 0.0)));
        assert!(!sensor.contains(SensorPoint::new(0.0, -edge - 2.3e-5)));
        assert!(!sensor.contains(SensorPoint::new(0.0, f32::NAN)));
    }

    #[test]
    fn impossible_arrays_are_refused() {
        assert!(Sensor::new(0, 10, 5.0).is_err());
        assert!(Sensor::new(10, MAX_SIDE_PX + 1, 0.5).is_err());
        assert!(
            Sensor::new(60_000, 10, 10.0).is_err(),
            "600 mm is no mapping camera"
        );
        assert!(Sensor::new(10, 10, 0.0).is_err());
    }

    #[test]
    fn every_axis_moves_the_principal_point_its_own_way() {
        let moved = FmcAxis::ALL.map(|axis| axis.sensor_from_offset(SensorPoint::default(), 2.0));
        let expected = [(2.0, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.0, -2.0)];
        assert_eq!(moved.map(|p| (p.x_mm, p.y_mm)), expected);
    }
}
