//! True image of a ground point.

use fmc_adjustment::collinearity::image_point;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_adjustment::interior_orientation::InteriorOrientation;
use fmc_reference::strict::StrictSolver;

/// Largest number of steps of the inversion; real lenses contract by 0.03 per step.
const MOST_STEPS: usize = 100;

/// Step at which the inversion stops, mm.
const CLOSE_ENOUGH_MM: f64 = 1e-11;

/// Distance from the centre, in half formats, beyond which a point is not looked for, because a
/// polynomial is meaningless there.
const FARTHEST: f64 = 1.5;

/// Source of the true image points of a simulated strip.
///
/// Any distortion can implement this trait: the strict solver, or a model with known coefficients.
/// A simulation that knows better than collinearity where a ground point is recorded replaces
/// [`Self::recorded`].
pub trait ImageTruth {
    /// Returns measured - ideal at a measured point of the sensor frame, mm.
    fn distortion(&self, measured_mm: [f64; 2]) -> [f64; 2];

    /// Returns the measured point of an ideal one, sensor frame, mm; `None` if the search does not
    /// converge with this distortion.
    fn measured(&self, ideal_mm: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = ideal_mm;
        let mut measured = ideal_mm;
        for _ in 0..MOST_STEPS {
            let [dx, dy] = self.distortion(measured);
            let next = [x + dx, y + dy];
            let [step_x, step_y] = [next[0] - measured[0], next[1] - measured[1]];
            measured = next;
            if step_x.hypot(step_y) <= CLOSE_ENOUGH_MM {
                return Some(measured);
            }
        }
        None
    }

    /// Returns the recorded image of a ground point, sensor frame, mm; `None` for one that is far
    /// off the sensor or not below the lens.
    ///
    /// # Model
    /// Collinearity with the pair of exposure means, principal point and time, then the distortion.
    fn recorded(
        &self,
        interior: &InteriorOrientation,
        orientation: &ExteriorOrientation,
        ground_m: [f64; 3],
    ) -> Option<[f64; 2]> {
        let [x, y] = image_point(orientation, interior.principal_distance_mm, ground_m)?;
        let [cx, cy] = interior.centroid_point_mm;
        let [half_x, half_y] = interior.half_format_mm;
        if x.abs() > FARTHEST * half_x || y.abs() > FARTHEST * half_y {
            return None;
        }
        self.measured([x + cx, y + cy])
    }
}

/// The exposure mean of the lens about its moving principal point, with its focus shift.
impl ImageTruth for StrictSolver {
    fn distortion(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        self.mean(measured_mm).distortion_mm
    }
}
