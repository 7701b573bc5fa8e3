//! What must not happen, provoked.

use std::time::Duration;

use super::machine::{MACHINES, Machine};

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn watchdog_resets_a_main_loop_that_stands_still() {
    for machine in MACHINES {
        let mut machine = Machine::start_with_drills(machine);
        machine.wait_for_log("starts after power on");
        machine.provoke(b'h');
        machine.wait_for_log("main loop stands still");
        machine.wait_for_log("starts after watchdog");
        assert_eq!(machine.ask(b"again\0"), b"again\0");
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn firmware_goes_on_after_the_pc_has_slept() {
    let mut machine = Machine::start(MACHINES[0]);
    machine.wait_for_log("starts after power on");
    machine.stop_for(Duration::from_millis(2500));
    assert_eq!(machine.ask(b"reset\0"), b"reset\0");
    let line = machine.wait_for_log("starts after");
    assert!(line.ends_with("starts after request"), "{line}");
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn hard_fault_names_its_address_and_ends_qemu_with_failure() {
    for machine in MACHINES {
        let mut machine = Machine::start_with_drills(machine);
        machine.wait_for_log("starts after power on");
        machine.provoke(b'f');
        machine.wait_for_log("hard fault at 0x0000");
        assert!(!machine.wait_for_end().success());
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn image_as_it_flies_has_no_accidents_on_request() {
    for accident in [b'h', b'f'] {
        let mut machine = Machine::start(MACHINES[0]);
        machine.wait_for_log("starts after power on");
        machine.provoke(accident);
        assert_eq!(machine.ask(b"a while\0"), b"a while\0");
        assert_eq!(machine.ask(b"reset\0"), b"reset\0");
        machine.wait_for_log("starts after request");
    }
}
