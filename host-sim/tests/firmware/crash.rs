//! Messages of the PC about a crash of the firmware.

use std::env;
use std::io::Write as _;
use std::thread;

use fmc_camera::{CalibrationParameters, CameraParameters, Exposure, SensorPoint};
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice as _, DeviceError, Machine};

use crate::firmware::drills::{Drill, LOOK_EVERY, OVERFLOW, WATCHDOG, restart_by};

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
        for drill in &WATCHDOG {
            is_reported_and_the_camera_can_be_used_again(machine, drill);
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn overflow_of_the_stack_is_reported_and_the_camera_can_be_used_again() {
    for machine in [Machine::An386, Machine::An500] {
        for drill in &OVERFLOW {
            let log = is_reported_and_the_camera_can_be_used_again(machine, drill);
            let named = |line: &String| line.contains("stack overflow at 0x");
            assert_eq!(log.iter().filter(|line| named(line)).count(), 1, "{log:?}");
        }
    }
}

/// Checks the message about a restart and what the camera says of it; returns the log.
fn is_reported_and_the_camera_can_be_used_again(machine: Machine, drill: &Drill) -> Vec<String> {
    let mut qemu = with_drills(machine);
    restart_by(&mut qemu, drill);
    let error = error_of(&mut qemu).to_string();
    for part in ["the camera has restarted", drill.start] {
        assert!(error.contains(part), "{part}: {error}");
    }
    qemu.remote().reconnect().unwrap();
    assert_eq!(qemu.remote().identity().reset_cause, drill.cause);
    qemu.log()
}
