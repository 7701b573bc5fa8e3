//! Where an ideal point is really recorded.

use crate::reference::strict::StrictSolver;

/// Largest number of steps of the inversion; real lenses contract by 0.03 a step.
const MOST_STEPS: usize = 100;

/// The inversion stops where the measured point leads back to the ideal one within this, mm.
const CLOSE_ENOUGH_MM: f64 = 1e-11;

/// The distortion that the flight is simulated with, as a function of the measured point.
///
/// Anything that distorts can take this place: the strict solver, a model with known coefficients.
pub trait ImageTruth {
    /// Measured - ideal at a measured point of the sensor frame, mm.
    fn distortion(&self, measured_mm: [f64; 2]) -> [f64; 2];

    /// The measured point that leads back to the ideal one, sensor frame, mm; `None` where
    /// the distortion does not let the search converge.
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
}

/// The exposure mean of the lens about its moving principal point, with its focus shift.
impl ImageTruth for StrictSolver {
    fn distortion(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        self.mean(measured_mm).distortion_mm
    }
}
