//! The output image: its size and where its principal point lies.

use fmc_camera::geometry::sensor::{MAX_SIDE_PX, Sensor, SensorPoint};

use crate::form::Form;

/// Rounding, pixels, by which a side may miss a whole number.
const ROUNDING_PX: f64 = 1e-6;

/// Places along an edge of the sensor at which its ideal image is computed, per pixel. How far the
/// edge may bend between two of them is bounded, and taken into account.
const PLACES_PER_PX: f64 = 0.25;

/// Size of the output image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// That of the sensor.
    Same,
    /// The largest image, about the output's centre, whose pixels all lie on the sensor with their
    /// whole area.
    Inside,
    /// The smallest image, about the output's centre, that holds every measured pixel.
    Full,
    /// Width and height, pixels.
    Size([u32; 2]),
}

/// The point that lies in the middle of the output image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Centre {
    /// The frame's principal point.
    PrincipalPoint,
    /// The centre of the sensor frame: the principal point stays where the frame has it.
    Frame,
}

impl Centre {
    /// Returns the point of a frame with this principal point, sensor frame.
    pub(crate) const fn of(self, principal_point: SensorPoint) -> SensorPoint {
        match self {
            Self::PrincipalPoint => principal_point,
            Self::Frame => SensorPoint::new(0.0, 0.0),
        }
    }
}

/// A window that does not make an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WindowError {
    /// A side of no pixels, or of too many.
    #[error("the output image would have {0} x {1} pixels, outside 1 to {MAX_SIDE_PX}", size_px[0], size_px[1])]
    Size {
        /// Width and height.
        size_px: [u64; 2],
    },
}

impl Window {
    /// Returns width and height of the output image about a point of the sensor frame, pixels.
    pub(crate) fn size_px(
        self,
        form: &Form,
        sensor: &Sensor,
        middle: SensorPoint,
    ) -> Result<[u32; 2], WindowError> {
        let size = match self {
            Self::Same => [sensor.width_px(), sensor.height_px()].map(u64::from),
            Self::Size(size_px) => size_px.map(u64::from),
            Self::Inside => IdealEdges::new(form, sensor, middle).inside_px(),
            Self::Full => IdealEdges::new(form, sensor, middle).full_px(),
        };
        let side = |side: u64| {
            let side = u32::try_from(side).ok()?;
            (1..=MAX_SIDE_PX).contains(&side).then_some(side)
        };
        match size.map(side) {
            [Some(width), Some(height)] => Ok([width, height]),
            _ => Err(WindowError::Size { size_px: size }),
        }
    }
}

/// Ideal images of the sensor's four edges, from the middle of the output image.
struct IdealEdges {
    pixel_mm: f64,
    /// Largest distance of an edge from the line between two of its points, mm.
    bend_mm: f64,
    /// Points of the left and the right edge, and of the lower and the upper one.
    edges: [[Vec<[f64; 2]>; 2]; 2],
}

impl IdealEdges {
    fn new(form: &Form, sensor: &Sensor, middle: SensorPoint) -> Self {
        let pixel_mm = f64::from(sensor.pixel_mm());
        let sides_px = [sensor.width_px(), sensor.height_px()].map(f64::from);
        let half = sides_px.map(|side| 0.5 * side * pixel_mm);
        let middle = [middle.x_mm, middle.y_mm].map(f64::from);
        let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let radii = corners.map(|[x, y]| form.centred([x * half[0], y * half[1]]).1.sqrt());
        let radius = radii.into_iter().fold(0.0, f64::max);
        let [second_per_mm, _] = form.largest_derivatives(radius);
        let way_mm = pixel_mm / PLACES_PER_PX;
        let edge = |axis: usize, sign: f64| {
            let along_px = sides_px.into_iter().rev().nth(axis).unwrap_or_default();
            let [half_across, half_along] = if axis == 0 { half } else { [half[1], half[0]] };
            let steps = (along_px * PLACES_PER_PX).ceil().max(1.0);
            let mut points = Vec::new();
            let mut step = 0.0;
            while step <= steps {
                let along = half_along * (2.0 * step / steps - 1.0);
                let across = sign * half_across;
                let [x, y] = form.ideal(if axis == 0 {
                    [across, along]
                } else {
                    [along, across]
                });
                points.push([x - middle[0], y - middle[1]]);
                step += 1.0;
            }
            points
        };
        Self {
            pixel_mm,
            bend_mm: way_mm * way_mm / 8.0 * (second_per_mm + form.residual_bounds().curvature),
            edges: [[edge(0, -1.0), edge(0, 1.0)], [edge(1, -1.0), edge(1, 1.0)]],
        }
    }

    /// Returns the sides of the largest rectangle within the edges.
    ///
    /// # Model
    /// Each side is twice the least distance of its two edges from the middle, of the edges' parts
    /// that lie beside the rectangle: first of the whole edges, then of those within the other
    /// side, until nothing changes. Between two points s apart an edge bends by s²/8 times its
    /// largest second derivative at most; twice that is taken off, since the place where the
    /// rectangle's other side cuts the edge is moved as well.
    fn inside_px(&self) -> [u64; 2] {
        let least = |edges: &[Vec<[f64; 2]>; 2], axis, beside: f64| {
            least(edges, axis, beside + self.bend_mm) - 2.0 * self.bend_mm
        };
        let mut half = [f64::INFINITY; 2];
        for _ in 0..8 {
            let [across_x, across_y] = &self.edges;
            let x = least(across_x, 0, half[1]);
            let y = least(across_y, 1, x);
            if [x.to_bits(), y.to_bits()] == half.map(f64::to_bits) {
                break;
            }
            half = [x, y];
        }
        let [x, y] = half;
        let half = [x.min(least(&self.edges[0], 0, y)), y];
        half.map(|half| whole((2.0 * half / self.pixel_mm + ROUNDING_PX).floor()))
    }

    /// Returns the sides of the smallest rectangle about all edges.
    fn full_px(&self) -> [u64; 2] {
        let mut half = [0.0_f64; 2];
        for point in self.edges.iter().flatten().flatten() {
            for (half, place) in half.iter_mut().zip(point) {
                *half = half.max(place.abs());
            }
        }
        half.map(|half| whole((2.0 * half / self.pixel_mm - ROUNDING_PX).ceil()))
    }
}

/// Returns the least distance along an axis of two edges from the middle, of the parts of the lines
/// between their points that are within `beside` along the other axis; negative where an edge lies
/// beyond the middle.
fn least([low, high]: &[Vec<[f64; 2]>; 2], axis: usize, beside: f64) -> f64 {
    let mut least = f64::INFINITY;
    for (sign, edge) in [(-1.0, low), (1.0, high)] {
        let place = |[x, y]: [f64; 2]| if axis == 0 { [x, y] } else { [y, x] };
        for (from, to) in edge.iter().zip(edge.iter().skip(1)) {
            let ([from, from_along], [to, to_along]) = (place(*from), place(*to));
            let way = to_along - from_along;
            // Shares of the way at which the line is `beside` away, in their order.
            let cut = |along: f64| ((along - from_along) / way).clamp(0.0, 1.0);
            let (first, last) = (cut(-beside), cut(beside));
            let is_beside = |along: f64| along.abs() <= beside;
            if is_beside(from_along) || is_beside(to_along) || first < last {
                for share in [first, last] {
                    least = least.min(sign * (from + (to - from) * share));
                }
            }
        }
    }
    least
}

/// Returns a whole number; 0 for a negative one and for infinity.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number within the limits that are asked for"
)]
fn whole(number: f64) -> u64 {
    if (0.0..=1e15).contains(&number) {
        number as u64
    } else {
        0
    }
}
