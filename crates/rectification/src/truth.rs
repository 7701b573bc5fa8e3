//! Places that a camera in motion sees, in double precision, by the strict reference solver:
//! without code of the camera and of the rectification.

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{StrictSolver, Weight};

/// Cells of the grid over the sensor, along each axis, at whose corners the solver is asked.
const CELLS: u32 = 48;

/// Points of the interpolation between corners, along each axis.
const POINTS: usize = 6;

/// Steps to a measured point; each leaves at most half of the error.
const STEPS: usize = 60;

/// A step towards a measured point that is shorter than this is the last.
const LAST_STEP_MM: f64 = 1e-11;

/// The true map between measured and ideal points of one exposure.
#[derive(Debug, Clone)]
pub struct TrueGeometry {
    solver: StrictSolver,
    principal_point_mm: [f64; 2],
    half_mm: [f64; 2],
    /// Mean distortion at the corners of the grid, row by row, from the sensor's lower left corner.
    corners_mm: Vec<[f64; 2]>,
}

impl TrueGeometry {
    /// Returns the map of an exposure of a camera without residual grids.
    #[must_use]
    pub fn new(camera: &CameraFile, request: &ExposureRequest) -> Self {
        Self::with_splines(camera, ResidualSplines::default(), request)
    }

    /// Returns the map of an exposure of a camera with its residual grids.
    #[must_use]
    pub fn with_splines(
        camera: &CameraFile,
        splines: ResidualSplines,
        request: &ExposureRequest,
    ) -> Self {
        let solver = StrictSolver::new(camera, request, Weight::Exposure).with_splines(splines);
        let centroid_mm = solver.path().centroid_mm();
        let [x0, y0] = camera.principal_point_mm;
        let [ex, ey] = camera.fmc.axis.unit();
        let half_mm = camera.half_format_mm();
        let mut corners_mm = Vec::new();
        for row in 0..=CELLS {
            for col in 0..=CELLS {
                let place = [corner(col, half_mm[0]), corner(row, half_mm[1])];
                corners_mm.push(solver.mean(place).distortion_mm);
            }
        }
        Self {
            solver,
            principal_point_mm: [x0 + centroid_mm * ex, y0 + centroid_mm * ey],
            half_mm,
            corners_mm,
        }
    }

    /// Principal point of the frame in the sensor frame, mm: the calibrated one, moved to the
    /// centroid of the exposure.
    #[must_use]
    pub const fn principal_point_mm(&self) -> [f64; 2] {
        self.principal_point_mm
    }

    /// Returns the distortion of a measured point, measured - ideal, mm, by the solver itself.
    #[must_use]
    pub fn strict_distortion_mm(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        self.solver.mean(measured_mm).distortion_mm
    }

    /// Returns the distortion of a measured point, measured - ideal, mm.
    ///
    /// # Accuracy
    /// Interpolated by polynomials of fifth degree between points of the solver: within 1e-5 px of
    /// it on and around the sensor (`tests/rectification/truth.rs`).
    #[must_use]
    pub fn distortion_mm(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        let cell = |place: f64, half: f64| (place + half) / (2.0 * half) * f64::from(CELLS);
        let (first_col, along) = lagrange(cell(measured_mm[0], self.half_mm[0]));
        let (first_row, down) = lagrange(cell(measured_mm[1], self.half_mm[1]));
        let mut sum = [0.0; 2];
        let side = CELLS as usize + 1;
        for (row, down) in (first_row..).zip(down) {
            let corners = self.corners_mm.iter().skip(row * side + first_col);
            for (corner, along) in corners.zip(along) {
                sum[0] += down * along * corner[0];
                sum[1] += down * along * corner[1];
            }
        }
        sum
    }

    /// Returns the ideal point of a measured one, mm of the sensor frame.
    #[must_use]
    pub fn ideal_mm(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.distortion_mm(measured_mm);
        [measured_mm[0] - dx, measured_mm[1] - dy]
    }

    /// Returns the measured point of an ideal one, mm of the sensor frame; it may lie off the
    /// sensor, where it means the less the farther off it is.
    #[must_use]
    pub fn measured_mm(&self, ideal_mm: [f64; 2]) -> [f64; 2] {
        let mut measured = ideal_mm;
        for _ in 0..STEPS {
            let [dx, dy] = self.distortion_mm(measured);
            let [x, y] = [ideal_mm[0] + dx, ideal_mm[1] + dy];
            let step_mm = (x - measured[0]).abs().max((y - measured[1]).abs());
            measured = [x, y];
            if step_mm < LAST_STEP_MM {
                break;
            }
        }
        measured
    }
}

/// Returns the place of a corner of the grid, mm.
fn corner(number: u32, half_mm: f64) -> f64 {
    half_mm * (2.0 * f64::from(number) / f64::from(CELLS) - 1.0)
}

/// Returns the first corner of those about a place, in cells, and their weights.
fn lagrange(place: f64) -> (usize, [f64; POINTS]) {
    let before = POINTS / 2 - 1;
    let last = CELLS as usize + 1 - POINTS;
    let first = whole(place).saturating_sub(before).min(last);
    let mut weights = [1.0; POINTS];
    for (i, weight) in weights.iter_mut().enumerate() {
        for j in (0..POINTS).filter(|j| *j != i) {
            *weight *= (place - number(first + j)) / (number(i) - number(j));
        }
    }
    (first, weights)
}

#[expect(clippy::cast_precision_loss, reason = "a number of corners")]
const fn number(count: usize) -> f64 {
    count as f64
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the corner before a place, or the first one"
)]
fn whole(place: f64) -> usize {
    place.floor().max(0.0) as usize
}
