//! The calibrated camera at rest, with the rays of its points in double precision.

use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;

use crate::least_squares::linear;

/// Points along each side of the grid, edges of the sensor included.
pub const GRID: u32 = 41;

/// A static interior orientation: the strict model of a camera file without its motion.
///
/// Lengths are in mm in the sensor frame (y up), distortion is measured - ideal. Rays are those of
/// other programs: z = 1, y down.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// Name of the camera.
    pub name: String,
    /// Columns and rows of the array, px.
    pub size_px: [u32; 2],
    /// Pixel pitch, mm.
    pub pixel_mm: f64,
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Principal point (x0, y0), mm.
    pub principal_point_mm: [f64; 2],
    /// Distortion, measured - ideal.
    pub lens: Lens,
    /// Half of the travel of the stage along x and along y, mm: points that far beyond the edge are
    /// still recorded.
    pub margin_mm: [f64; 2],
    /// Distance beyond the sensor, to the left and right and to the bottom and top, mm, over which
    /// models are fitted and judged too: 0, or as far as frames of a flight see more of the lens.
    pub beyond_mm: [[f64; 2]; 2],
    /// Residual grids, which no formula of a program has a place for.
    pub residual: ResidualSplines,
}

impl Calibrated {
    /// Returns the static interior orientation of a camera file that has been validated.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        let half_stroke = camera.fmc.stroke_mm / 2.0;
        Self {
            name: camera.name.clone(),
            size_px: [camera.sensor.width_px, camera.sensor.height_px]
                .map(|side| u32::try_from(side).unwrap_or(0)),
            pixel_mm: camera.sensor.pixel_um / 1000.0,
            principal_distance_mm: camera.principal_distance_mm,
            principal_point_mm: camera.principal_point_mm,
            lens: Lens::of(camera),
            margin_mm: camera
                .fmc
                .axis
                .unit()
                .map(|component| component.abs() * half_stroke),
            beyond_mm: [[0.0; 2]; 2],
            residual: ResidualSplines::default(),
        }
    }

    /// Returns the same camera with its residual grids: a formula is fitted to polynomial and grids
    /// together, and judged against both.
    #[must_use]
    pub fn with_residual(self, residual: ResidualSplines) -> Self {
        Self { residual, ..self }
    }

    /// Returns the same camera, to be judged over the sensors of frames with these principal points
    /// too.
    ///
    /// # Model
    /// The lens moves over the sensor with the principal point: a frame sees of it what the
    /// calibrated camera would see on a sensor that is moved by as much the other way.
    #[must_use]
    pub fn seen_by(&self, principal_points_mm: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let [x0, y0] = self.principal_point_mm;
        let [mut along_x, mut along_y] = self.beyond_mm;
        for [x, y] in principal_points_mm {
            for ([below, above], moved) in [(&mut along_x, x - x0), (&mut along_y, y - y0)] {
                *below = below.max(moved);
                *above = above.max(-moved);
            }
        }
        Self {
            beyond_mm: [along_x, along_y],
            ..self.clone()
        }
    }

    /// Half of width and height, mm.
    #[must_use]
    pub fn half_format_mm(&self) -> [f64; 2] {
        self.size_px
            .map(|side| f64::from(side) * self.pixel_mm / 2.0)
    }

    /// Place of the middle of the array, px, with the first pixel centre at (0, 0).
    #[must_use]
    pub fn middle_px(&self) -> [f64; 2] {
        self.size_px.map(|side| (f64::from(side) - 1.0) / 2.0)
    }

    /// Converts a point of the sensor frame, mm, into a pixel coordinate (column, row), with the
    /// first pixel centre at (0, 0).
    #[must_use]
    pub fn pixel_from_sensor(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [col, row] = self.middle_px();
        [col + x / self.pixel_mm, row - y / self.pixel_mm]
    }

    /// Converts a pixel coordinate into a point of the sensor frame, mm.
    #[must_use]
    pub fn sensor_from_pixel(&self, [col, row]: [f64; 2]) -> [f64; 2] {
        let [middle_col, middle_row] = self.middle_px();
        [
            (col - middle_col) * self.pixel_mm,
            (middle_row - row) * self.pixel_mm,
        ]
    }

    /// Returns the factor 1 - K0, by which other programs' numbers are divided, as they have no K0:
    /// f/(1 - K0), `Ki/(1 - K0)`, `Pi/(1 - K0)` and `Bi/(1 - K0)` have the same rays.
    #[must_use]
    pub fn gauge(&self) -> f64 {
        let [k0, ..] = self.lens.k;
        1.0 - k0
    }

    /// Principal distance F = f/(1 - K0) of a camera without K0, mm.
    #[must_use]
    pub fn principal_distance_without_k0_mm(&self) -> f64 {
        self.principal_distance_mm / self.gauge()
    }

    /// Principal distance F, px.
    #[must_use]
    pub fn principal_distance_px(&self) -> f64 {
        self.principal_distance_without_k0_mm() / self.pixel_mm
    }

    /// Principal point, px, with the first pixel centre at (0, 0).
    #[must_use]
    pub fn principal_point_px(&self) -> [f64; 2] {
        self.pixel_from_sensor(self.principal_point_mm)
    }

    /// Returns the same camera with K0 = 0 and all else divided by 1 - K0, for a camera without
    /// residual grids.
    #[must_use]
    pub fn without_k0(&self) -> Self {
        let gauge = self.gauge();
        let [_, k1, k2, k3] = self.lens.k;
        Self {
            principal_distance_mm: self.principal_distance_without_k0_mm(),
            lens: Lens {
                k: [0.0, k1 / gauge, k2 / gauge, k3 / gauge],
                p: self.lens.p.map(|p| p / gauge),
                b: self.lens.b.map(|b| b / gauge),
            },
            ..self.clone()
        }
    }

    /// Returns the corrected point about the principal point, mm: `x̄ - D(x̄, ȳ)`, residual grids
    /// included.
    #[must_use]
    pub fn ideal_from_measured(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let ([x, y], [x0, y0]) = (point_mm, self.principal_point_mm);
        let [x, y] = [x - x0, y - y0];
        let [dx, dy] = self.lens.displacement([x, y]);
        let [more_x, more_y] = self.residual_mm(point_mm);
        [x - dx - more_x, y - dy - more_y]
    }

    /// Returns a camera without residual grids: its polynomial comes nearest to that of this camera
    /// with its grids, by least squares over the sensor.
    ///
    /// # Model
    /// K0..K3, P1 and P2 take up what they can of the grids; f, principal point and affinity stay.
    #[must_use]
    pub fn polynomial(&self) -> Self {
        let mut found = self.clone();
        if self.residual.is_empty() {
            return found;
        }
        found.residual = ResidualSplines::default();
        let [x0, y0] = self.principal_point_mm;
        let mut rows = Vec::new();
        for point_mm in self.grid_mm(GRID) {
            let [x, y] = [point_mm[0] - x0, point_mm[1] - y0];
            let columns = UNIT_LENSES.map(|lens| lens.displacement([x, y]));
            let [dx, dy] = self.residual_mm(point_mm);
            rows.push((columns.map(|[x, _]| x), dx));
            rows.push((columns.map(|[_, y]| y), dy));
        }
        if let Some([k0, k1, k2, k3, p1, p2]) = linear(&rows) {
            let lens = &mut found.lens;
            for (value, change) in lens.k.iter_mut().zip([k0, k1, k2, k3]) {
                *value += change;
            }
            for (value, change) in lens.p.iter_mut().zip([p1, p2]) {
                *value += change;
            }
        }
        found
    }

    /// Returns the ray of a point of a frame, z = 1, y down: of the point where the calibrated
    /// camera has it, and that of the sensor with its own grid, which does not move; `scale` is
    /// 1 + κ.
    pub(crate) fn ray_of_frame(
        &self,
        at_rest: [f64; 2],
        on_sensor: [f64; 2],
        scale: f64,
    ) -> [f64; 2] {
        let [x0, y0] = self.principal_point_mm;
        let [x, y] = [at_rest[0] - x0, at_rest[1] - y0];
        let [dx, dy] = self.lens.displacement([x, y]);
        let [lx, ly] = self.residual.of_lens(at_rest);
        let [sx, sy] = self.residual.of_sensor(on_sensor);
        let [x, y] = [x - dx - (lx + sx) / scale, y - dy - (ly + sy) / scale];
        [
            x / self.principal_distance_mm,
            -y / self.principal_distance_mm,
        ]
    }

    /// Returns what the residual grids add to the distortion of a measured point, mm.
    #[must_use]
    pub fn residual_mm(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.residual.calibrated(point_mm)
    }

    /// Returns the ray of a measured point, z = 1, y down.
    ///
    /// # Units and frames
    /// The point in mm in the sensor frame, which is y up.
    #[must_use]
    pub fn ray_from_measured(&self, point_mm: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.ideal_from_measured(point_mm);
        [
            x / self.principal_distance_mm,
            -y / self.principal_distance_mm,
        ]
    }

    /// Returns `count` x `count` points over the sensor and [`beyond_mm`](Self::beyond_mm), edges
    /// included, mm.
    #[must_use]
    pub fn grid_mm(&self, count: u32) -> Vec<[f64; 2]> {
        self.grid_beyond(self.beyond_mm, count)
    }

    /// Returns points over the sensor enlarged by the run-up, edges included, mm.
    pub(crate) fn enlarged_grid_mm(&self, count: u32) -> Vec<[f64; 2]> {
        self.grid_beyond(self.margin_mm.map(|margin| [margin; 2]), count)
    }

    fn grid_beyond(&self, beyond_mm: [[f64; 2]; 2], count: u32) -> Vec<[f64; 2]> {
        let [half_width, half_height] = self.half_format_mm();
        let [[left, right], [below, above]] = beyond_mm;
        grid(
            [
                [-half_width - left, half_width + right],
                [-half_height - below, half_height + above],
            ],
            count,
        )
    }
}

/// Lenses each with one coefficient of 1: K0..K3, P1, P2.
const UNIT_LENSES: [Lens; 6] = {
    const NONE: Lens = Lens {
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    };
    const fn radial(k: [f64; 4]) -> Lens {
        Lens { k, ..NONE }
    }
    const fn decentring(p: [f64; 2]) -> Lens {
        Lens { p, ..NONE }
    }
    [
        radial([1.0, 0.0, 0.0, 0.0]),
        radial([0.0, 1.0, 0.0, 0.0]),
        radial([0.0, 0.0, 1.0, 0.0]),
        radial([0.0, 0.0, 0.0, 1.0]),
        decentring([1.0, 0.0]),
        decentring([0.0, 1.0]),
    ]
};

/// Returns `count` x `count` points of a rectangle, edges included.
fn grid([[left, right], [bottom, top]]: [[f64; 2]; 2], count: u32) -> Vec<[f64; 2]> {
    let steps = f64::from(count.max(2) - 1);
    // About the middle, so that a sensor about the origin has points that are mirrored exactly.
    let place = |[least, most]: [f64; 2], index: u32| {
        let half = (most - least) / 2.0;
        f64::midpoint(least, most) + half * (2.0 * f64::from(index) / steps - 1.0)
    };
    (0..count.max(2))
        .flat_map(|row| {
            (0..count.max(2))
                .map(move |column| [place([left, right], column), place([bottom, top], row)])
        })
        .collect()
}
