//! `camera store` and `camera stored` on a camera without a store, and with wrong input.

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::serial::Port;
use crate::command_line::support::Bench;

const NO_STORE: &str = "it has no store for a calibration";

#[test]
fn camera_without_a_store_says_so() {
    let port = Port::with_camera(FakeCamera::new());
    let (bench, device) = (Bench::new(), port.device());
    let run = |action: &[&str]| bench.run(&[&["camera", "--device", &device], action].concat());
    run(&["stored"]).failed(3, &[NO_STORE]);
    let origin = ["--laboratory", "Test range", "--date", "2026-05-17"];
    run(&[&["store"], &origin[..]].concat()).failed(3, &[NO_STORE]);
    let camera = ["store", "--camera", "camera.toml"];
    run(&[&camera, &origin[..]].concat()).failed(3, &[NO_STORE]);
}

#[test]
fn wrong_input_is_named_before_a_device_is_opened() {
    let bench = Bench::new();
    let device = ["camera", "--device", "serial:/dev/there-is-none"];
    let long = "x".repeat(49);
    for (options, words) in [
        (
            ["--laboratory", "Range", "--date", "17.5.2026"],
            ["--date \"17.5.2026\"", "not a day as 2026-05-17"],
        ),
        (
            ["--laboratory", "Range", "--date", "2026-02-29"],
            ["--date", "not a day"],
        ),
        (
            ["--laboratory", &long, "--date", "2026-05-17"],
            ["--laboratory", "more than 48 bytes"],
        ),
        (
            ["--laboratory", "a\nb", "--date", "2026-05-17"],
            ["--laboratory", "control character"],
        ),
    ] {
        let store = [&device[..], &["store"], &options].concat();
        bench.run(&store).refused(&words);
    }
    let origin = ["--laboratory", "Range", "--date", "2026-05-17"];
    let camera = ["store", "--camera", "there-is-none.toml"];
    let store = [&device, &camera[..], &origin].concat();
    bench.run(&store).refused(&["there-is-none.toml"]);
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
    let origin = ["--laboratory", "Range", "--date", "2026-05-17"];
    let lost = [&["camera", "--device", "qemu", "store"], &origin[..]].concat();
    bench
        .run(&lost)
        .refused(&["--device qemu:an386: its flash is lost", "--flash FILE"]);
    assert_eq!(bench.files(), ["camera.toml", "points.csv"]);
}
