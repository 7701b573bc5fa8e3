//! Image motion over flat ground as a function of the image point: two quadratic polynomials.

/// A point of the image relative to the principal point, along the camera's axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlightPoint {
    pub(super) right_mm: f32,
    pub(super) forward_mm: f32,
}

/// Two opposite corners of the sensor.
pub(super) type Extent = [FlightPoint; 2];

/// s: the scale of the ground's image by its scale below the camera, linear over the image.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroundScale {
    pub(super) centre: f32,
    pub(super) along_right: f32,
    pub(super) along_forward: f32,
}

impl GroundScale {
    /// Returns the least scale in the extent: a linear function is least in a corner.
    pub(super) fn least_in(&self, [one, other]: &Extent) -> f32 {
        let least = |slope: f32, from: f32, to: f32| (slope * from).min(slope * to);
        self.centre
            + least(self.along_right, one.right_mm, other.right_mm)
            + least(self.along_forward, one.forward_mm, other.forward_mm)
    }
}

/// A velocity component, mm/s, as a function of the image point; x is right, y forward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Quadratic {
    pub(super) constant: f32,
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) xx: f32,
    pub(super) xy: f32,
    pub(super) yy: f32,
}

impl Quadratic {
    pub(super) fn at(&self, point: FlightPoint) -> f32 {
        let (x, y) = (point.right_mm, point.forward_mm);
        self.constant + x * (self.x + self.xx * x + self.xy * y) + y * (self.y + self.yy * y)
    }

    /// Returns the polar form: a Bernstein coefficient over the extent if the arguments are its
    /// ends.
    pub(super) fn control_point(
        &self,
        [one, other]: &Extent,
        (x1, x2): (f32, f32),
        (y1, y2): (f32, f32),
    ) -> f32 {
        let x = |share: f32| one.right_mm + share * (other.right_mm - one.right_mm);
        let y = |share: f32| one.forward_mm + share * (other.forward_mm - one.forward_mm);
        let (x1, x2, y1, y2) = (x(x1), x(x2), y(y1), y(y2));
        let (mean_x, mean_y) = (0.5 * (x1 + x2), 0.5 * (y1 + y2));
        self.constant
            + self.x * mean_x
            + self.y * mean_y
            + self.xx * x1 * x2
            + self.xy * mean_x * mean_y
            + self.yy * y1 * y2
    }
}
