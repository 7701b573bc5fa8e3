//! Pixels of rectified frames.

use serde_json::Value;

use super::scene::{EXPOSED, SIZE_PX, pattern, place, read, scene};
use crate::command_line::frames::flight::Flight;

/// Largest difference of a grey value, of waves 50 px long and 12,000 high: half a count of
/// rounding in the frame, five of the kernel, and 0.0005 px of what bicubic interpolation moves.
const GREY: f64 = 6.3;

fn rectify(flight: &Flight, more: &[&str]) {
    let mut arguments = vec!["rectify", "--camera", "camera.toml"];
    arguments.extend(["--records", "records.csv", "--out", "out"]);
    arguments.extend(more);
    flight.bench.run(&arguments).ok();
}

fn sidecar(flight: &Flight, sequence: u32) -> Value {
    let text = std::fs::read(flight.bench.path(&format!("out/f{sequence}.json"))).unwrap();
    serde_json::from_slice(&text).unwrap()
}

/// Compares a rectified frame with the pattern about a point of the sensor frame, mm, and returns
/// the number of pixels that are not border.
fn compare(flight: &Flight, sequence: u32, middle: [f64; 2]) -> usize {
    let (samples, size) = read(&flight.bench.path(&format!("out/f{sequence}.tif")));
    let [width, height] = size;
    let pixels = (0..height).flat_map(|row| (0..width).map(move |col| [col, row]));
    let mut compared = 0;
    for (sample, pixel) in samples.iter().zip(pixels) {
        if *sample == 0 {
            continue;
        }
        // At the sensor's edge, up to eight pixels from that of the image, taps take its value.
        let [col, row] = pixel;
        let [right, down] = [width - 1 - col, height - 1 - row];
        if [col, row, right, down].into_iter().any(|from| from < 12) {
            continue;
        }
        let [x, y] = place(pixel, size);
        let expected = pattern([x + middle[0], y + middle[1]]);
        let difference = f64::from(*sample) - expected;
        assert!(difference.abs() < GREY, "{sequence} {pixel:?} {difference}");
        compared += 1;
    }
    compared
}

#[test]
fn every_frame_is_the_pattern_about_its_own_principal_point() {
    let flight = scene();
    let frames: Vec<String> = EXPOSED.map(|sequence| format!("f{sequence}.tif")).to_vec();
    let frames: Vec<&str> = frames.iter().map(String::as_str).collect();
    rectify(&flight, &frames);
    for sequence in EXPOSED {
        let shift = f64::from(flight.centroids_mm[sequence as usize - 1]);
        let compared = compare(&flight, sequence, [0.02, -0.01 + shift]);
        assert!(compared > 50_000, "{compared}");
        let sidecar = sidecar(&flight, sequence);
        let interior = &sidecar["interior_orientation"];
        assert_eq!(
            interior["principal_point_px"],
            serde_json::json!([149.5, 109.5])
        );
        assert_eq!(interior["principal_distance_mm"], 20.0);
        assert_eq!(sidecar["record"]["sequence"], sequence);
        assert!(sidecar["accuracy"]["mesh_bound_px"].as_f64().unwrap() <= 0.001);
    }
    let camera = flight.bench.path("out/rectified-camera.toml");
    let (camera, _) = fmc_camera_file::CameraFile::read(&camera).unwrap();
    let calibration = camera.parameters().calibration;
    assert_eq!([calibration.width_px, calibration.height_px], SIZE_PX);
}

#[test]
fn centre_of_the_frame_leaves_the_principal_point_where_it_was() {
    let flight = scene();
    rectify(&flight, &["--centre", "frame", "f3.tif"]);
    assert!(compare(&flight, 3, [0.0; 2]) > 50_000);
    let interior = &sidecar(&flight, 3)["interior_orientation"];
    let place = |axis: usize| interior["principal_point_mm"][axis].as_f64().unwrap();
    let shift = f64::from(flight.centroids_mm[2]);
    assert!((place(0) - 0.02).abs() < 1e-12 && (place(1) + 0.01 - shift).abs() < 1e-9);
    assert!(!flight.bench.path("out/rectified-camera.toml").exists());
}

#[test]
fn windows_hold_all_pixels_or_no_border() {
    let flight = scene();
    let frames = ["--frames", "frames.csv", "--keep-going"];
    let sizes = ["inside", "full"].map(|window| {
        let mut arguments = vec!["rectify", "--camera", "camera.toml", "--records"];
        arguments.extend(["records.json", "--out", window, "--window", window]);
        arguments.extend(frames);
        let answer = flight.bench.run(&arguments);
        // The fifth trigger was refused.
        assert_eq!(answer.code, 2, "{}", answer.stderr);
        let mut size = [0; 2];
        for sequence in EXPOSED {
            let text = std::fs::read(flight.bench.path(&format!("{window}/f{sequence}.json")));
            let sidecar: Value = serde_json::from_slice(&text.unwrap()).unwrap();
            let output = &sidecar["output"];
            size = ["width_px", "height_px"].map(|side| output[side].as_u64().unwrap());
            let border = output["border_pixels"].as_u64().unwrap();
            assert_eq!(
                border == 0,
                window == "inside",
                "{window} {sequence}: {border}"
            );
        }
        size
    });
    let [[inside_width, inside_height], [full_width, full_height]] = sizes;
    assert!(inside_width < full_width && inside_height < full_height);
}

#[test]
fn one_exposure_without_records_is_rectified() {
    let flight = scene();
    let arguments = "rectify --camera camera.toml --vh 0.1 --exposure 1/200 --out out f1.tif";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    flight.bench.run(&arguments).ok();
    assert_eq!(sidecar(&flight, 1)["record"]["sequence"], Value::Null);
}
