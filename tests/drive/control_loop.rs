//! Drive and controller in one round.

use fmc_camera::flight::control_loop::{ControlLoop, Events};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::drive::{FmcDrive, StageReading};
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::{CalibrationParameters, Camera, CameraParameters};

/// Names of the calls to the drive in a round.
#[derive(Debug, Default)]
struct Asked(Vec<&'static str>);

impl FmcDrive for Asked {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.0.push("position");
        Ok(StageReading {
            time: now,
            offset_mm: 0.0,
        })
    }

    fn follow(&mut self, _: Time, _: Setpoint) -> Result<(), Fault> {
        self.0.push("follow");
        Ok(())
    }

    fn release(&mut self) {
        self.0.push("release");
    }
}

#[test]
fn stage_is_read_when_the_round_begins_and_not_after_its_events() {
    let camera = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
    let camera = Camera::new(camera).unwrap();
    let camera = PreparedCamera::new(camera, &FlightSettings::default(), Start::Orderly).unwrap();
    let mut control = ControlLoop::new(camera, Asked::default());
    let mut round = |at_us, event| {
        let now = Time::from_us(at_us);
        control.round(now, &Events::from_iter([(now, event)]));
        core::mem::take(&mut control.drive_mut().0)
    };
    let arm = Event::Command(Command::Arm);
    assert_eq!(round(1000, arm), ["position", "follow"]);
    // The stage is read first, because the handling of an event may take so long that the stage
    // moves meanwhile.
    assert_eq!(round(2000, Event::LimitSwitch), ["position", "release"]);
}
