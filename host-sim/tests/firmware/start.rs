//! Why the firmware starts, and how it ends when asked to.

use super::machine::{MACHINES, Machine};

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn one_image_starts_on_both_machines_and_names_board_and_cause() {
    for machine in MACHINES {
        let line = Machine::start(machine).wait_for_log("starts after");
        assert!(line.starts_with("mps2 "), "{machine}: {line}");
        assert!(line.ends_with("starts after power on"), "{machine}: {line}");
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn requested_reset_comes_after_the_answer_and_is_named_as_cause() {
    for machine in MACHINES {
        let mut machine = Machine::start(machine);
        assert_eq!(machine.ask(b"reset\0"), b"reset\0");
        machine.wait_for_log("starts after request");
        assert_eq!(machine.ask(b"again\0"), b"again\0");
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn power_off_ends_qemu_with_success_after_the_answer() {
    for machine in MACHINES {
        let mut machine = Machine::start(machine);
        assert_eq!(machine.ask(b"power off\0"), b"power off\0");
        assert!(machine.wait_for_end().success());
    }
}
