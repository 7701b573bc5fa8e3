//! The fields of a record.

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::frame_record::{ExposedFrame, FrameRecord};
use fmc_camera::flight::interior_orientation::InteriorOrientation;

use super::rows;
use crate::conventions::document::names;

/// Returns the names of all fields; does not compile if one is missing.
macro_rules! fields {
    ($type:ident { $($field:ident),+ $(,)? }) => {{
        let _ = |$type { $($field),+ }: $type| {
            $(let _ = $field;)+
        };
        vec![$(stringify!($field)),+]
    }};
}

/// Returns the names in the first column, in alphabetical order.
fn documented(heading: &str) -> Vec<&'static str> {
    let mut found: Vec<_> = rows(heading)
        .into_iter()
        .flat_map(|row| names(row[0]))
        .collect();
    found.sort_unstable();
    found
}

fn sorted(mut names: Vec<&'static str>) -> Vec<&'static str> {
    names.sort_unstable();
    names
}

#[test]
fn fields_of_a_record_are_those_of_the_code() {
    let record = fields!(FrameRecord {
        sequence,
        trigger,
        outcome,
        faults,
        flags,
        calibration,
        boot,
        flight,
    });
    assert_eq!(documented("field of `FrameRecord`"), sorted(record));
    let calibration = fields!(CalibrationId {
        serial,
        version,
        crc,
        storage,
    });
    assert_eq!(documented("field of `CalibrationId`"), sorted(calibration));
    let exposed = fields!(ExposedFrame {
        opened,
        closed,
        centroid,
        centroid_utc,
        vh,
        planned_opening_mm,
        planned_travel_mm,
        interior,
        principal_point_sigma,
        smear_um,
        smear_px,
    });
    assert_eq!(documented("field of `ExposedFrame`"), sorted(exposed));
    let interior = fields!(InteriorOrientation {
        vh_per_s,
        exposure_s,
        motion,
        principal_point,
        principal_distance_mm,
        focus_shift_mm,
        enlargement,
        model,
        terms,
        left_out_nm,
    });
    assert_eq!(
        documented("field of `InteriorOrientation`"),
        sorted(interior)
    );
}
