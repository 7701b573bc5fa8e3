//! Tables of exposures.

use fmc_camera::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera_file::InputError;
use fmc_frames::FlightFrame;
use fmc_frames::table::{self, GivenExposure};

use crate::support::camera;

fn read(text: &str, given: &GivenExposure) -> Result<Vec<FlightFrame>, InputError> {
    let (_, camera) = camera();
    let mut frames = Vec::new();
    table::read_from("frames.csv", text.as_bytes(), &camera, given, |frame| {
        frames.push(frame);
        Ok::<(), InputError>(())
    })?;
    Ok(frames)
}

#[test]
fn rows_have_the_bits_of_single_exposures() {
    let (_, camera) = camera();
    let text = "sequence,vh,exposure,opening-offset-mm,focus_shift_um,direction,model,image,\
                principal_point_frame_sigma_mm,centroid_unix_us\n\
                7,0.1,1/200,,5,reverse,,a.tif,2e-5,17\n\
                3,70/700,0.004,-0.04,,,static,,,\n";
    let frames = read(text, &GivenExposure::default()).unwrap();
    let expected = [
        Exposure {
            focus_shift_um: 5.0,
            direction: FlightDirection::Reverse,
            ..Exposure::new(0.1, 0.005)
        },
        Exposure {
            opening_offset_mm: Some(-0.04),
            model: CorrectionModel::Static,
            ..Exposure::new(0.1, 0.004)
        },
    ];
    assert_eq!(frames.len(), 2);
    for (frame, exposure) in frames.iter().zip(&expected) {
        let single = camera.camera().frame(exposure).unwrap();
        let exposed = frame.exposed().unwrap();
        assert_eq!(exposed.interior, single.interior);
        assert_eq!(
            exposed.correction(camera.calibration()),
            Some(single.correction)
        );
    }
    assert_eq!(
        (frames[0].sequence, frames[0].image.as_deref()),
        (7, Some("a.tif"))
    );
    assert_eq!((frames[1].sequence, frames[1].image.as_deref()), (3, None));
    let first = frames[0].exposed().unwrap();
    let sigma = PrincipalPointSigma {
        frame_mm: 2e-5,
        common_mm: 0.0,
    };
    assert_eq!(first.sigma, Some(sigma));
    assert_eq!(first.centroid_utc.unwrap().unix_us, 17);
    assert_eq!(frames[1].exposed().unwrap().centroid_utc, None);
}

#[test]
fn what_a_row_leaves_out_is_given_for_all() {
    let given = GivenExposure {
        exposure_s: Some(0.005),
        focus_shift_um: 3.0,
        ..GivenExposure::default()
    };
    let text = "frame,ground_speed_m_s,height_m,exposure_s\nA-1,70,700,\n12,70,700,0.002\n";
    let frames = read(text, &given).unwrap();
    let (_, camera) = camera();
    for (frame, exposure_s) in frames.iter().zip([0.005, 0.002]) {
        let exposure = Exposure {
            focus_shift_um: 3.0,
            ..Exposure::new(0.1, exposure_s)
        };
        let single = camera.camera().frame(&exposure).unwrap();
        assert_eq!(frame.exposed().unwrap().interior, single.interior);
    }
    assert_eq!(
        (frames[0].sequence, frames[0].image.as_deref()),
        (1, Some("A-1"))
    );
    assert_eq!((frames[1].sequence, frames[1].image.as_deref()), (12, None));
}

#[test]
fn wrong_tables_are_refused_by_line_column_value_and_range() {
    for (text, expected) in [
        ("", "frames.csv: the file is empty"),
        (
            "vh,exposure\n0.1,0.005\n",
            "frames.csv, line 1: column sequence, frame or image is missing",
        ),
        (
            "sequence,vh,speed\n",
            "frames.csv, line 1: column speed is not known",
        ),
        (
            "sequence,vh,vh_per_s\n",
            "frames.csv, line 1: column vh_per_s appears twice",
        ),
        (
            "sequence,ground_speed\n",
            "frames.csv, line 1: column height is missing",
        ),
        (
            "sequence,ground_speed,height,vh\n",
            "frames.csv, line 1: both vh and ground_speed",
        ),
        (
            "sequence,vh,exposure\n",
            "frames.csv: it holds no exposures",
        ),
        (
            "sequence,vh\n1,0.1\n",
            "frames.csv, line 2: exposure is missing",
        ),
        (
            "sequence,exposure\n1,0.005\n",
            "frames.csv, line 2: vh is missing",
        ),
        (
            "image,vh,exposure\n,0.1,0.005\n",
            "frames.csv, line 2: the row has neither",
        ),
        (
            "sequence,vh,exposure\nx,0.1,1/200\n",
            "frames.csv, line 2: sequence = \"x\": must be a whole",
        ),
        (
            "sequence,vh,exposure\n1,0.1,1/200\n1,0.1,1/200\n",
            "frames.csv, line 3: sequence 1 appears twice",
        ),
        (
            "sequence,vh,exposure\n1,nan,1/200\n",
            "frames.csv, line 2: vh = \"nan\": not a finite",
        ),
        (
            "sequence,vh,exposure\n1,0.1,1/0\n",
            "frames.csv, line 2: exposure = \"1/0\": a fraction",
        ),
        (
            "sequence,vh,exposure\n1,9,1/200\n",
            "frames.csv, line 2: vh = 9 is outside ",
        ),
        (
            "sequence,vh_per_s,exposure_s\n1,0.1,9\n",
            "frames.csv, line 2: exposure_s = 9 is outside ",
        ),
        (
            "sequence,vh,exposure,opening_offset_mm\n1,0.1,0.005,8\n",
            "frames.csv, line 2: the exposure moves the principal point from 8.0000 mm",
        ),
        (
            "sequence,vh,exposure,focus_shift_um\n1,0.1,0.005,1e4\n",
            "frames.csv, line 2: focus_shift_um = ",
        ),
        (
            "sequence,vh,exposure,direction\n1,0.1,0.005,back\n",
            "frames.csv, line 2: direction = \"back\": must be forward or reverse",
        ),
        (
            "sequence,ground_speed,height,exposure\n1,70,,0.005\n",
            "frames.csv, line 2: height is empty",
        ),
        (
            "sequence,vh,exposure\n1,0.1\n",
            "frames.csv, line 2: 2 columns where the header has 3",
        ),
    ] {
        let error = read(text, &GivenExposure::default())
            .unwrap_err()
            .to_string();
        assert!(error.starts_with(expected), "{error}\n{expected}");
        let returns = read(&text.replace('\n', "\r\n"), &GivenExposure::default()).unwrap_err();
        assert_eq!(returns.to_string(), error);
    }
}
