//! `camera store` and `camera stored` on a camera without a store, and with wrong input.

use std::fs;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::sign::signed;
use crate::command_line::support::Bench;

const NO_STORE: &str = "it has no store for a calibration";

#[test]
fn camera_without_a_store_says_so() {
    let port = Port::with_camera(FakeCamera::new());
    let (bench, device) = (Bench::new(), port.device());
    let run = |action: &[&str]| bench.run(&[&["camera", "--device", &device], action].concat());
    run(&["stored"]).failed(3, &[NO_STORE]);
    signed(&bench);
    let signature = ["--signature", "my.json"];
    run(&[&["store"], &signature[..]].concat()).failed(3, &[NO_STORE]);
    let camera = ["store", "--camera", "signed.toml"];
    run(&[&camera, &signature[..]].concat()).failed(3, &[NO_STORE]);
}

#[test]
fn wrong_input_is_named_before_a_device_is_opened() {
    let bench = Bench::new();
    signed(&bench);
    let run = |action: &[&str]| {
        let device = ["camera", "--device", "serial:/dev/there-is-none", "store"];
        bench.run(&[&device, action].concat())
    };
    run(&["--camera", "signed.toml"]).refused(&["--signature"]);
    run(&["--signature", "none.json"]).refused(&["none.json"]);
    run(&["--signature", "camera.toml"]).refused(&[
        "camera.toml: no signature of a calibration",
        "host-sim sign",
    ]);
    let camera = |camera, signature| run(&["--camera", camera, "--signature", signature]);
    camera("none.toml", "my.json").refused(&["none.toml"]);
    // The camera file was changed after it had been signed; or the signature was.
    camera("camera.toml", "my.json").refused(&["my.json: the signature is of another calibration"]);
    let text = fs::read_to_string(bench.path("my.json")).unwrap();
    let changed = text.replace("\"date\": \"\"", "\"date\": \"2026-05-17\"");
    fs::write(bench.path("changed.json"), changed).unwrap();
    camera("signed.toml", "changed.json").refused(&["changed.json: the signature is not that of"]);
}

#[test]
fn store_needs_a_camera_that_keeps_something_and_a_flash_is_for_qemu() {
    let bench = Bench::new();
    bench
        .run(&["camera", "stored"])
        .refused(&["a camera with a store is needed"]);
    bench
        .run(&["camera", "--device", "sil", "stored"])
        .refused(&["--device sil: a camera with a store is needed"]);
    let flash = [
        "camera",
        "--device",
        "sil",
        "--flash",
        "flash.bin",
        "stored",
    ];
    bench.run(&flash).refused(&["--flash", "--device qemu"]);
    let lost = [
        "camera",
        "--device",
        "qemu",
        "store",
        "--signature",
        "my.json",
    ];
    signed(&bench);
    bench
        .run(&lost)
        .refused(&["--device qemu:an386: its flash is lost", "--flash FILE"]);
    let files = ["camera.toml", "my.json", "points.csv", "signed.toml"];
    assert_eq!(bench.files(), files);
}
