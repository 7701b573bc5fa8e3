//! The firmware in QEMU behind a TCP port, for a client in another language.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use rustix::process::{Pid, kill_process};

use crate::command_line::signals::ctrl_c;

const CAMERA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/cameras/rc30-5324.toml");

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn firmware_that_is_served_answers_host_sim_and_the_client_in_python() {
    let mut server = Command::new(cargo_bin!("host-sim"))
        .args(["serve", "--device", "qemu"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut device = String::new();
    let mut stdout = BufReader::new(server.stdout.take().unwrap());
    stdout.read_line(&mut device).unwrap();
    let device = device.trim_end();
    let frame = |device: &[&str]| {
        let output = Command::new(cargo_bin!("host-sim"))
            .args([
                "frame",
                "--camera",
                CAMERA,
                "--vh",
                "0.1",
                "--exposure",
                "1/300",
            ])
            .args(device)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        String::from_utf8(output.stdout).unwrap()
    };
    let here = frame(&[]);
    assert!(!here.is_empty());
    assert_eq!(frame(&["--device", device]), here);
    let client = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/link_client.py");
    let read = Command::new("python3")
        .arg(client)
        .arg(device.strip_prefix("tcp:").unwrap())
        .output()
        .unwrap();
    let printed = String::from_utf8(read.stdout).unwrap();
    assert!(printed.contains("board mps2"), "{printed}");
    assert!(printed.contains("not prepared"), "{printed}");
    kill_process(Pid::from_child(&server), ctrl_c()).unwrap();
    assert_eq!(server.wait().unwrap().code(), Some(0));
}
