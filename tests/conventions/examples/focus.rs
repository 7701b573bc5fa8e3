//! Section 6: focus shift.

use super::{Example, Given, Results};
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::principal_distance::{FocusShift, FocusSign};

pub(super) const EXAMPLES: &[Example] = &[
    ("detector too far from the lens", physical),
    ("the same with the printed sign", printed),
];

fn shift(given: &Given, sign: FocusSign) -> FocusShift {
    FocusShift {
        shift_mm: given.number::<f32>("Δz", "µm") / 1000.0,
        principal_distance_mm: given.number("f", "mm"),
        exit_pupil_mm: given.number("L", "mm"),
        sign,
    }
}

fn distortion_um(given: &Given, shift: &FocusShift) -> f64 {
    let distortion = shift.distortion_at_fixed_distance(&Brown::default());
    let displacement = distortion.displacement(given.number("r", "mm"), 0.0);
    f64::from(displacement.dx_mm) * 1000.0
}

fn physical(given: &Given) -> Results {
    let shift = shift(given, FocusSign::Physical);
    let (changed_mm, _) = shift.distortion_at_changed_distance(&Brown::default());
    vec![
        ("κ", "", shift.enlargement().into()),
        ("distortion", "µm", distortion_um(given, &shift)),
        ("f(1+κ)", "mm", changed_mm.into()),
    ]
}

fn printed(given: &Given) -> Results {
    let shift = shift(given, FocusSign::Printed);
    vec![
        ("k0'", "", shift.enlargement().into()),
        ("distortion", "µm", distortion_um(given, &shift)),
    ]
}
