//! The camera as image motion sees it.

use crate::geometry::calibration::Calibration;
use crate::geometry::planar_flow::{Extent, FlightPoint};
use crate::geometry::sensor::{FmcAxis, Sensor, SensorPoint};

/// The properties of the camera on which image motion depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The pixel array.
    pub sensor: Sensor,
    /// f, mm.
    pub principal_distance_mm: f32,
    /// Principal point at the exposure's centroid, mm.
    pub principal_point: SensorPoint,
    /// Direction of flight in the sensor frame.
    pub axis: FmcAxis,
}

impl View {
    /// Returns the view of a calibrated camera whose stage stands at its calibrated position.
    #[must_use]
    pub fn calibrated(calibration: &Calibration) -> Self {
        let parameters = calibration.parameters();
        Self {
            sensor: *calibration.sensor(),
            principal_distance_mm: parameters.principal_distance_mm,
            principal_point: parameters.principal_point,
            axis: parameters.axis,
        }
    }

    /// Converts a point of the sensor frame to one relative to the principal point, along the
    /// camera's axes.
    pub(super) fn flight_from_sensor(&self, point: SensorPoint) -> FlightPoint {
        let x_mm = point.x_mm - self.principal_point.x_mm;
        let y_mm = point.y_mm - self.principal_point.y_mm;
        let sign = self.axis.sign();
        if self.axis.is_x() {
            FlightPoint {
                right_mm: -sign * y_mm,
                forward_mm: sign * x_mm,
            }
        } else {
            FlightPoint {
                right_mm: sign * x_mm,
                forward_mm: sign * y_mm,
            }
        }
    }

    /// Two opposite corners of the sensor.
    pub(super) fn extent(&self) -> Extent {
        let (x, y) = (self.sensor.half_width_mm(), self.sensor.half_height_mm());
        [SensorPoint::new(-x, -y), SensorPoint::new(x, y)]
            .map(|corner| self.flight_from_sensor(corner))
    }
}
