//! Records that are whole.

use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera_file::InputError;
use fmc_frames::{Outcome, records};

use crate::support::{camera, csv, flight, json, read};

#[test]
fn correction_of_a_record_has_the_bits_of_the_one_that_the_camera_computed() {
    let (_, camera) = camera();
    let (written, flown) = flight(camera.camera(), camera.crc());
    for text in [csv(&written), json(&written)] {
        let frames = read(&text, &camera).unwrap();
        assert_eq!(frames.len(), 201);
        for (frame, flown) in frames.iter().zip(&flown) {
            let exposed = frame.exposed().unwrap();
            assert_eq!(exposed.interior, flown.interior);
            let correction = exposed.correction(camera.calibration()).unwrap();
            assert_eq!(correction, flown.correction, "{}", frame.sequence);
        }
    }
}

#[test]
fn times_sigma_names_and_reasons_are_those_of_the_record() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    for text in [csv(&written), json(&written)] {
        let frames = read(&text, &camera).unwrap();
        let first = frames[0].exposed().unwrap();
        assert_eq!(first.centroid_utc, None);
        let second = frames[1].exposed().unwrap();
        assert_eq!(second.centroid, Some(Time::from_us(4_032_000)));
        assert_eq!(second.opened, Some(Time::from_us(4_030_000)));
        assert_eq!(second.closed, Some(Time::from_us(4_034_000)));
        let utc = second.centroid_utc.unwrap();
        assert_eq!((utc.unix_us, utc.sigma_s), (1_790_000_000_000_002, 2e-6));
        let sigma = PrincipalPointSigma {
            frame_mm: 6e-5,
            common_mm: 8e-5,
        };
        assert_eq!(second.sigma, Some(sigma));
        assert_eq!(frames[1].flags, "last good V/H; off centre");
        assert_eq!(frames[1].calibration_crc, Some(camera.crc()));
        let refused = &frames[200];
        assert_eq!(refused.outcome, Outcome::Refused("stall".to_owned()));
        assert_eq!((refused.sequence, refused.faults.as_str()), (201, "stall"));
        assert_eq!(refused.trigger, Some(Time::from_us(500_000_000)));
        assert_eq!(refused.exposed(), None);
    }
}

#[test]
fn columns_in_any_order_and_files_of_editors_are_read() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    let text = csv(&written);
    let expected = read(&text, &camera).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut writer = csv::Writer::from_writer(b"\xef\xbb\xbf".to_vec());
    let backwards = |row: &csv::StringRecord| row.iter().rev().collect::<csv::StringRecord>();
    writer
        .write_record(&backwards(reader.headers().unwrap()))
        .unwrap();
    for row in reader.records() {
        writer.write_record(&backwards(&row.unwrap())).unwrap();
    }
    let turned = String::from_utf8(writer.into_inner().unwrap()).unwrap();
    assert_eq!(read(&turned, &camera).unwrap(), expected);
    let carriage_returns = text.replace('\n', "\r\n");
    assert_eq!(
        read(carriage_returns.trim_end(), &camera).unwrap(),
        expected
    );
    let indented = format!("\u{feff}\n  {}", json(&written));
    assert_eq!(read(&indented, &camera).unwrap(), expected);
}

#[test]
fn records_from_before_the_last_columns_have_the_sum_of_both_sigma() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    let text = csv(&written[..2]);
    let old: Vec<String> = text
        .lines()
        .map(|line| line.split(',').take(41).collect::<Vec<_>>().join(","))
        .collect();
    let frames = read(&old.join("\n"), &camera).unwrap();
    let sigma = frames[0].exposed().unwrap().sigma.unwrap();
    assert!((sigma.frame_mm - 1e-4).abs() < 1e-10);
    assert!(sigma.common_mm.abs() < 1e-10);
}

#[test]
fn error_of_the_reader_of_frames_ends_the_reading() {
    let (_, camera) = camera();
    let (written, _) = flight(camera.camera(), camera.crc());
    for text in [csv(&written), json(&written)] {
        let mut count = 0;
        let error = records::read_from("records", text.as_bytes(), &camera, |_| {
            count += 1;
            Err(InputError::invalid("enough"))
        });
        assert_eq!(error.unwrap_err().to_string(), "enough");
        assert_eq!(count, 1);
    }
}
