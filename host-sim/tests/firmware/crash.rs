//! Messages of the PC about a crash of the firmware.

use std::env;
use std::io::Write as _;
use std::thread;

use fmc_camera::io::link::message::ResetCause;
use fmc_camera::{CalibrationParameters, CameraParameters, Exposure, SensorPoint};
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice as _, DeviceError, Machine};

use crate::firmware::drills::{LOOK_EVERY, bite_watchdog};

/// Returns a camera that has been exposed, with accidents on request.
fn with_drills(machine: Machine) -> Qemu {
    let options = QemuOptions {
        firmware: Some(env::var_os("FMC_FIRMWARE_WITH_DRILLS").unwrap().into()),
        flash: None,
        print_log: false,
    };
    let mut qemu = Qemu::start(machine, &options).unwrap();
    let lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    qemu.load(&CameraParameters::new(lens)).unwrap();
    qemu.expose(&Exposure::new(0.1, 0.005)).unwrap();
    qemu
}

/// Asks for points until the camera fails; returns the error.
fn error_of(qemu: &mut Qemu) -> DeviceError {
    loop {
        if let Err(error) = qemu.correct(&[SensorPoint::new(1.0, 2.0)]) {
            return error;
        }
        thread::sleep(LOOK_EVERY);
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn hard_fault_is_reported_with_the_end_of_qemu_and_of_the_log() {
    for machine in [Machine::An386, Machine::An500] {
        let mut qemu = with_drills(machine);
        qemu.log_wire().write_all(b"f").unwrap();
        let error = error_of(&mut qemu).to_string();
        for part in [
            "QEMU ended half way: exit status: 1",
            "the end of the firmware's log",
            "starts after power on",
            "hard fault at 0x",
        ] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn restart_by_the_watchdog_is_reported_with_the_log_and_the_camera_can_be_used_again() {
    for machine in [Machine::An386, Machine::An500] {
        // One drill stops the main loop, the other lets it sleep without an event that wakes it.
        for drill in b"hs" {
            let mut qemu = with_drills(machine);
            bite_watchdog(&mut qemu, *drill);
            let error = error_of(&mut qemu).to_string();
            for part in ["the camera has restarted", "starts after watchdog"] {
                assert!(error.contains(part), "{part}: {error}");
            }
            qemu.remote().reconnect().unwrap();
            assert_eq!(qemu.remote().identity().reset_cause, ResetCause::Watchdog);
        }
    }
}
