//! Corrections of the frames of a flight, each folded when it is first used, and kept.

use std::sync::OnceLock;

use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera_kernel::host::Run;
use fmc_camera_kernel::{Coefficients, Terms};
use fmc_frames::FrameTable;

/// A correction, once it is folded; `None` for a refused trigger.
type Kept = OnceLock<Option<FrameCorrection>>;

/// Corrections of the frames of a table, by their places.
///
/// The first use of the frames takes their memory, about 100 bytes each; the first use of one
/// of them folds its correction.
#[derive(Debug, Default)]
pub struct FrameCorrections(OnceLock<Box<[Kept]>>);

impl FrameCorrections {
    /// Returns the correction of the frame at a place; `None` for a refused trigger.
    pub(crate) fn correction(
        &self,
        calibration: &Calibration,
        table: &FrameTable,
        place: usize,
    ) -> Option<&FrameCorrection> {
        let rows = table.rows();
        let all = self
            .0
            .get_or_init(|| rows.iter().map(|_| OnceLock::new()).collect());
        let fold = || rows.get(place)?.correction(calibration);
        all.get(place)?.get_or_init(fold).as_ref()
    }
}

/// Returns the points of a frame as the kernel takes them; those of a refused trigger become NaN.
pub(crate) fn run(correction: Option<&FrameCorrection>, points: usize) -> Run {
    let (form, terms) = correction.map_or_else(
        || {
            let nowhere = Coefficients {
                cx: f32::NAN,
                ..Coefficients::default()
            };
            (nowhere, Terms::Short)
        },
        |correction| (correction.coefficients(), correction.terms()),
    );
    Run {
        form,
        terms,
        points,
    }
}

// The lock of a cell has 4 bytes on Linux and 8 elsewhere.
const _: () = assert!(size_of::<Kept>() <= 104);
