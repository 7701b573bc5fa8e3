//! The camera files against the published table.

use fmc_camera::{CalibrationParameters, CameraParameters};
use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;

use crate::reference::support::published;

#[test]
fn keys_that_are_left_out_have_the_defaults_of_the_library() {
    let text = "name = \"bare\"\nprincipal_distance_mm = 51.3712\n\
                [sensor]\nwidth_px = 14204\nheight_px = 10652\npixel_um = 3.76\n";
    let (file, _) = CameraFile::parse("bare.toml", text).unwrap();
    let calibration = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    assert_eq!(file.parameters(), CameraParameters::new(calibration));
}

#[test]
fn every_camera_file_holds_the_numbers_of_the_published_table() {
    let mut table = csv::Reader::from_reader(include_str!("../../data/cameras.csv").as_bytes());
    let headers = table.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let cameras = published();
    assert_eq!(cameras.len(), rows.len());
    for (camera, row) in cameras.iter().zip(&rows) {
        let text = |column: &str| {
            let place = headers.iter().position(|header| header == column).unwrap();
            row.get(place).unwrap()
        };
        let number = |column: &str| text(column).parse::<f64>().unwrap();
        let same = |found: f64, column: &str| {
            assert!(
                (found - number(column)).abs() <= 1e-12 * number(column).abs(),
                "{} {column}",
                camera.name
            );
        };
        assert_eq!(camera.name, text("name"));
        same(camera.principal_distance_mm, "principal_distance_mm");
        same(camera.principal_point_mm[0], "x0_mm");
        same(camera.principal_point_mm[1], "y0_mm");
        same(2.0 * camera.half_format_mm()[0], "width_mm");
        same(2.0 * camera.half_format_mm()[1], "height_mm");
        if !text("pixel_um").is_empty() {
            same(camera.sensor.pixel_um, "pixel_um");
        }
        let sign = if text("published_sign") == "correction" {
            -1.0
        } else {
            1.0
        };
        let lens = Lens::of(camera);
        for (value, column) in lens.k.into_iter().zip(["K0", "K1", "K2", "K3"]) {
            same(sign * value, column);
        }
        for (value, column) in lens.p.into_iter().zip(["P1", "P2"]) {
            same(sign * value, column);
        }
    }
}
