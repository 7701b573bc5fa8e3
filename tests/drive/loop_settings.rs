//! The plant of the velocity loop.

use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::loop_settings::Plant;

#[test]
fn plant_is_taken_if_each_quantity_is_in_its_range_and_refused_by_name_otherwise() {
    assert_eq!(Plant::REFERENCE.checked(), Ok(Plant::REFERENCE));
    let refused = |change: fn(&mut Plant)| {
        let mut plant = Plant::REFERENCE;
        change(&mut plant);
        plant.checked().unwrap_err().quantity.name()
    };
    assert_eq!(refused(|it| it.mass_kg = 0.0), "mass_kg");
    assert_eq!(refused(|it| it.force_n = f32::NAN), "force_n");
    assert_eq!(refused(|it| it.damping_n_s_m = -1.0), "damping_n_s_m");
    assert_eq!(refused(|it| it.friction_n = f32::INFINITY), "friction_n");
}

#[test]
fn kinds_of_drive_have_names() {
    let names = [
        DriveKind::Motor,
        DriveKind::PositionCommand,
        DriveKind::Stepper,
    ]
    .map(DriveKind::name);
    assert_eq!(
        names,
        [
            "a motor with an incremental encoder",
            "a position command with an absolute sensor",
            "a stepper"
        ]
    );
}
