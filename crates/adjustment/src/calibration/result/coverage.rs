//! Part of the format that image points cover.

/// Cells along the longer side in which points are counted.
const CELLS: f64 = 10.0;

/// Share of the format radius that points should reach.
pub const LEAST_RADIUS_SHARE: f64 = 0.8;

/// Part of the format with image points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Number of points.
    pub points: usize,
    /// Largest distance of a point from the principal point, mm.
    pub radius_mm: f64,
    /// Distance of the principal point to the farthest corner of the format, mm.
    pub format_radius_mm: f64,
    /// Smallest and largest x, mm in the sensor frame.
    pub x_mm: [f64; 2],
    /// Smallest and largest y, mm in the sensor frame.
    pub y_mm: [f64; 2],
    /// Share of the cells of the format (10 along its longer side) that hold a point.
    pub cells: f64,
}

impl Coverage {
    /// Returns the coverage by these points, mm in the sensor frame.
    pub fn new(
        [x0, y0]: [f64; 2],
        [half_x, half_y]: [f64; 2],
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let size = 2.0 * half_x.max(half_y) / CELLS;
        let cells = [half_x, half_y].map(|half| (2.0 * half / size).round().max(1.0));
        let mut occupied = std::collections::BTreeSet::new();
        let mut coverage = Self {
            points: 0,
            radius_mm: 0.0,
            format_radius_mm: (half_x + x0.abs()).hypot(half_y + y0.abs()),
            x_mm: none,
            y_mm: none,
            cells: 0.0,
        };
        for [x, y] in points {
            coverage.points += 1;
            coverage.radius_mm = coverage.radius_mm.max((x - x0).hypot(y - y0));
            for (range, value) in [(&mut coverage.x_mm, x), (&mut coverage.y_mm, y)] {
                let [least, most] = *range;
                *range = [least.min(value), most.max(value)];
            }
            let [columns, rows] = cells;
            let cell = |value: f64, half: f64, count: f64| {
                (f64::midpoint(value / half, 1.0) * count)
                    .floor()
                    .clamp(0.0, count - 1.0)
                    .to_bits()
            };
            occupied.insert([cell(x, half_x, columns), cell(y, half_y, rows)]);
        }
        let [columns, rows] = cells;
        coverage.cells = super::super::snooping::count(occupied.len()) / (columns * rows);
        coverage
    }

    /// Share of the format radius that the points reach.
    #[must_use]
    pub fn radius_share(&self) -> f64 {
        self.radius_mm / self.format_radius_mm
    }

    /// Returns a warning if the points reach less than [`LEAST_RADIUS_SHARE`] of the format radius.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        (self.radius_share() < LEAST_RADIUS_SHARE).then(|| {
            format!(
                "image points reach {:.1} mm, {:.0} % of the format radius of {:.1} mm; beyond, the distortion is extrapolated",
                self.radius_mm,
                100.0 * self.radius_share(),
                self.format_radius_mm
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_counts_cells_and_radius() {
        let half = [20.0, 10.0];
        let corners = [[-20.0, -10.0], [20.0, -10.0], [20.0, 10.0], [-20.0, 10.0]];
        let coverage = Coverage::new([0.0, 0.0], half, corners);
        assert!((coverage.cells - 4.0 / 50.0).abs() < 1e-12);
        assert!((coverage.radius_share() - 1.0).abs() < 1e-12);
        assert_eq!(coverage.warning(), None);
        let centre = Coverage::new([0.0, 0.0], half, [[5.0, 0.0], [0.0, 5.0]]);
        assert!(centre.warning().is_some_and(|text| text.contains("22 %")));
    }
}
