//! Results of resampling kernels on frames whose answer is known.

use serde::Serialize;

use crate::terminal::{self, numbers, words};

/// Stands for the name of a camera.
pub const ALL_CAMERAS: &str = "all cameras";

/// Result of a kernel on the frames of a camera, or of all cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KernelResult {
    /// Name of the camera, or [`ALL_CAMERAS`].
    pub camera: String,
    /// Name of the kernel.
    pub kernel: &'static str,
    /// Blocks whose shift was found.
    pub blocks: u64,
    /// Root of the mean square shift, pixels.
    pub shift_rms_px: f64,
    /// Longest shift, pixels.
    pub shift_largest_px: f64,
    /// Largest RMS that passes, of all cameras together: that of one depends on the fractions of a
    /// pixel that its frames happen to have.
    pub limit_rms_px: Option<f64>,
    /// Longest shift that passes.
    pub limit_largest_px: f64,
    /// Bound of the places' error by the mesh, pixels.
    pub mesh_bound_px: f64,
    /// Largest difference of a grey value, counts.
    pub grey_largest: f64,
}

impl KernelResult {
    /// Returns true if there was something to judge, and all of it is within the limits.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.blocks > 0
            && self
                .limit_rms_px
                .is_none_or(|limit| self.shift_rms_px <= limit)
            && self.shift_largest_px <= self.limit_largest_px
    }
}

/// Returns results as a table; shifts are in pixels.
#[must_use]
pub fn table(results: &[KernelResult]) -> String {
    let columns = [
        words("camera"),
        words("kernel"),
        numbers("blocks"),
        numbers("longest"),
        numbers("limit"),
        numbers("RMS"),
        numbers("limit"),
        words(""),
    ];
    let rows = results.iter().map(|result| {
        [
            result.camera.clone(),
            result.kernel.to_owned(),
            result.blocks.to_string(),
            format!("{:.5}", result.shift_largest_px),
            format!("{:.4}", result.limit_largest_px),
            format!("{:.5}", result.shift_rms_px),
            result
                .limit_rms_px
                .map_or(String::new(), |limit| format!("{limit:.4}")),
            if result.passed() { "passed" } else { "FAILED" }.to_owned(),
        ]
    });
    terminal::table(columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result() -> KernelResult {
        KernelResult {
            camera: "A".to_owned(),
            kernel: "bicubic",
            blocks: 10,
            shift_rms_px: 0.001,
            shift_largest_px: 0.003,
            limit_rms_px: Some(0.0025),
            limit_largest_px: 0.004,
            mesh_bound_px: 0.001,
            grey_largest: 5.0,
        }
    }

    #[test]
    fn kernel_passes_within_both_limits_and_never_over_nothing() {
        assert!(result().passed());
        let change = |change: fn(&mut KernelResult)| {
            let mut result = result();
            change(&mut result);
            result.passed()
        };
        assert!(!change(|result| result.blocks = 0));
        assert!(!change(|result| result.shift_rms_px = 0.003));
        assert!(change(|result| {
            (result.shift_rms_px, result.limit_rms_px) = (0.003, None);
        }));
        assert!(!change(|result| result.shift_largest_px = 0.005));
        assert!(!change(|result| result.shift_largest_px = f64::NAN));
        assert!(table(&[result()]).contains("passed"));
    }
}
