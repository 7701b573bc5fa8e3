//! Cameras of single frames against the strict solver.

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_camera_file::published::CAMERA_FILES;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{Choices, export};
use fmc_exchange::found::{Formula, Stated};
use fmc_exchange::frames::{Flight, FlightExport, ImageCamera, ImageNames, PATTERN, Pattern};
use fmc_exchange::import;
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;
use fmc_frames::{Exposed, ImageMap, Outcome};
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::strict::{StrictSolver, Weight};

use crate::document::rows;
use crate::support::{ALL_TERMS, IXM};

/// An exposure of the test.
#[derive(Debug, Clone, Copy)]
struct Shot {
    vh_per_s: f64,
    exposure_s: f64,
    opening_offset_mm: Option<f64>,
    focus_shift_um: f64,
}

/// From rest and with a focus shift: as planned, further out, and on the other side.
const SHOTS: [Shot; 3] = [
    Shot {
        vh_per_s: 0.17,
        exposure_s: 0.01,
        opening_offset_mm: None,
        focus_shift_um: 10.0,
    },
    Shot {
        vh_per_s: 0.17,
        exposure_s: 0.01,
        opening_offset_mm: Some(0.145),
        focus_shift_um: -10.0,
    },
    Shot {
        vh_per_s: 0.08,
        exposure_s: 0.005,
        opening_offset_mm: Some(-0.2),
        focus_shift_um: 3.0,
    },
];

impl Shot {
    /// Returns the record of the shot.
    fn record(&self, camera: &Camera, sequence: u32) -> fmc_frames::FlightFrame {
        let mut exposure = Exposure::new(single(self.vh_per_s), single(self.exposure_s));
        exposure.opening_offset_mm = self.opening_offset_mm.map(single);
        exposure.focus_shift_um = single(self.focus_shift_um);
        record(sequence, camera, &exposure)
    }

    fn solver(&self, file: &CameraFile) -> StrictSolver {
        let mut request = ExposureRequest::planned(self.vh_per_s, self.exposure_s);
        request.opening_offset_mm = self.opening_offset_mm;
        request.focus_shift_mm = self.focus_shift_um / 1000.0;
        StrictSolver::new(file, &request, Weight::Exposure)
    }
}

fn record(sequence: u32, camera: &Camera, exposure: &Exposure) -> fmc_frames::FlightFrame {
    fmc_frames::FlightFrame {
        sequence,
        image: None,
        trigger: None,
        outcome: Outcome::Exposed(Exposed {
            interior: camera.frame(exposure).unwrap().interior,
            focus_sign: exposure.focus_sign,
            opened: None,
            closed: None,
            centroid: None,
            centroid_utc: None,
            sigma: None,
        }),
        faults: String::new(),
        flags: String::new(),
        calibration_crc: None,
    }
}

fn names() -> ImageNames {
    ImageNames::Pattern(Pattern::parse(PATTERN).unwrap())
}

/// Returns the text of a file of an export.
fn text(export: &FlightExport<'_>, file: &str) -> String {
    let mut bytes = Vec::new();
    export.write(file, &mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// Returns the largest difference of a file's camera of one frame from the strict solver, µm on the
/// sensor of the frame.
fn largest_um(file: &CameraFile, solver: &StrictSolver, formula: &Formula) -> f64 {
    let camera = Calibrated::of(file);
    let [x0, y0] = camera.principal_point_mm;
    let [ex, ey] = file.fmc.axis.unit();
    let offset = solver.path().centroid_mm();
    let f = file.principal_distance_mm;
    let mut largest = 0.0_f64;
    for [x, y] in camera.grid_mm(41) {
        let [dx, dy] = solver.mean([x, y]).distortion_mm;
        let ray = [
            (x - dx - x0 - offset * ex) / f,
            -(y - dy - y0 - offset * ey) / f,
        ];
        let difference = match formula {
            Formula::Pinhole(pinhole) => {
                let [px, py] = camera.sensor_from_pixel(pinhole.pixel_from_ray(ray));
                [px - x, py - y]
            }
            Formula::Correction(correction) => {
                let [rx, ry] = correction.ray_from_measured([x, y]);
                let [sx, sy] = ray;
                [(rx - sx) * f, (ry - sy) * f]
            }
        };
        largest = difference.into_iter().map(f64::abs).fold(largest, f64::max);
    }
    1e3 * largest
}

/// Returns the camera of each frame as the program's file has it.
fn read(export: &FlightExport<'_>, program: Program, camera: &Calibrated) -> Vec<Formula> {
    let file = export.files()[0];
    let text = text(export, file);
    let lines: Vec<&str> = text.lines().collect();
    (0..SHOTS.len())
        .map(|index| {
            let sequence = index + 1;
            let key = match program {
                Program::OpenSfm => format!("frame {sequence}"),
                _ => sequence.to_string(),
            };
            let stated = Stated {
                pixel_mm: Some(camera.pixel_mm),
                size_px: Some(camera.size_px),
                id: (program != Program::OpenTrackIo).then_some(key.as_str()),
                ..Stated::default()
            };
            let bytes = match program {
                Program::OpenTrackIo => lines[index].as_bytes(),
                _ => text.as_bytes(),
            };
            let source = Source { file, bytes };
            import::read(program, &source, &stated).unwrap().formula
        })
        .collect()
}

/// Checks every frame of the shots in the files of some programs.
fn check(name: &str, text: &str, programs: &[Program]) {
    let (file, camera) = CameraFile::parse(name, text).unwrap();
    let calibrated = Calibrated::of(&file);
    let mut flight = Flight::default();
    for (shot, sequence) in SHOTS.iter().zip(1..) {
        let record = shot.record(&camera, sequence);
        flight.push(&record, file.exit_pupil_mm()).unwrap();
    }
    let (choices, images) = (Choices::default(), names());
    for program in programs {
        let at_rest = export(&calibrated, *program, &choices).unwrap();
        let frames = FlightExport::new(&calibrated, &flight, &images, *program, &choices).unwrap();
        assert_eq!(frames.at_rest.model, at_rest.model);
        let formulas = read(&frames, *program, &calibrated);
        let largest = SHOTS
            .iter()
            .zip(&formulas)
            .map(|(shot, formula)| largest_um(&file, &shot.solver(&file), formula))
            .fold(0.0, f64::max);
        let what = format!("{name}, {}: {largest} µm", program.name());
        assert!(largest <= at_rest.residual.largest_um + 5e-3, "{what}");
        // The statement leaves out the motion during the exposure and the single precision of the
        // records.
        let stated = frames.at_rest.residual.largest_um;
        let unstated = 1e-3 * frames.left_out_nm + 3e-4;
        assert!((largest - stated).abs() <= unstated, "{what}, not {stated}");
    }
}

const AXES: [&str; 4] = ["+x", "-x", "+y", "-y"];

#[test]
fn frames_are_as_good_as_the_calibrated_camera_within_5_nm() {
    for (name, text) in CAMERA_FILES {
        for axis in AXES {
            let fmc = format!("[fmc]\naxis = \"{axis}\"\nstrategy = \"from-rest\"\n");
            check(
                name,
                &format!("{text}\n{fmc}"),
                &[
                    Program::Colmap,
                    Program::Metashape,
                    Program::OpenSfm,
                    Program::Opf,
                    Program::OpenTrackIo,
                ],
            );
        }
    }
}

#[test]
fn affinity_and_k0_move_with_the_frame() {
    for axis in AXES {
        let fmc = format!("[fmc]\naxis = \"{axis}\"\nstrategy = \"from-rest\"\n");
        check(
            "all terms",
            &format!("{ALL_TERMS}{fmc}"),
            &[Program::Metashape],
        );
    }
}

#[test]
fn principal_point_and_distance_of_a_known_frame() {
    let (file, camera) = CameraFile::parse("ixm.toml", IXM).unwrap();
    let calibrated = Calibrated::of(&file);
    let mut exposure = Exposure::new(0.17, 0.01);
    exposure.opening_offset_mm = Some(0.145);
    exposure.focus_shift_um = 10.0;
    let mut flight = Flight::default();
    let frame = record(7, &camera, &exposure);
    flight.push(&frame, file.exit_pupil_mm()).unwrap();
    let images = names();
    let choices = Choices {
        model: Some("FULL_OPENCV"),
        ..Choices::default()
    };
    let export =
        FlightExport::new(&calibrated, &flight, &images, Program::Colmap, &choices).unwrap();
    let cameras = text(&export, "cameras.txt");
    let line = cameras.lines().last().unwrap();
    let words: Vec<&str> = line.split(' ').collect();
    assert_eq!(words[..4], ["7", "FULL_OPENCV", "14204", "10652"]);
    let number = |index: usize| words[index].parse::<f64>().unwrap();
    // The corner is half a pixel from the centre of the first one.
    assert!((number(6) - 7_117.531_915).abs() < 1e-5, "{line}");
    assert!((number(7) - 5282.1794).abs() < 1e-4, "{line}");
    assert!((number(4) / 13_662.553_191 - 1.0 - 1.9466e-4).abs() < 1e-8);
    // docs/formats.md has it in words.
    assert!(
        (export.left_out_nm - 0.364).abs() < 1e-3,
        "{}",
        export.left_out_nm
    );
    let cost = flight.one_camera(&calibrated);
    assert!((cost.offset_mm - 0.188_665_5).abs() < 1e-7);
    assert_eq!(cost.sequence, 7);
    // 50.2 px of the offset, and 1.4 px of the enlargement at the edge.
    assert!(
        (cost.cost_px - 51.57).abs() < 0.05 && !cost.is_advised(),
        "{cost:?}"
    );
}

#[test]
fn frame_takes_64_bytes() {
    assert_eq!(size_of::<ImageCamera>(), 64);
}

#[test]
fn enlargement_does_not_depend_on_the_model_of_the_record() {
    let (file, camera) = CameraFile::parse("ixm.toml", IXM).unwrap();
    let mut exposure = Exposure::new(0.17, 0.01);
    exposure.focus_shift_um = 10.0;
    let mut flight = Flight::default();
    for model in [CorrectionModel::Exact, CorrectionModel::Static] {
        exposure.model = model;
        let frame = record(1, &camera, &exposure);
        flight.push(&frame, file.exit_pupil_mm()).unwrap();
    }
    assert_eq!(flight.frames[0], flight.frames[1]);
    exposure.model = CorrectionModel::Exact;
    exposure.focus_sign = FocusSign::Printed;
    let printed = record(9, &camera, &exposure);
    let error = flight.push(&printed, file.exit_pupil_mm()).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("sequence 9") && message.contains("printed"),
        "{message}"
    );
}

#[test]
fn images_that_a_program_cannot_tell_apart_are_refused() {
    let (file, camera) = CameraFile::parse("ixm.toml", IXM).unwrap();
    let calibrated = Calibrated::of(&file);
    let mut flight = Flight::default();
    for sequence in [1, 2] {
        let frame = record(sequence, &camera, &Exposure::new(0.17, 0.01));
        flight.push(&frame, file.exit_pupil_mm()).unwrap();
    }
    let map =
        |text: &str| ImageNames::Map(ImageMap::read_from("map.csv", text.as_bytes()).unwrap());
    let refused = |images: &ImageNames, program: Program, choices: &Choices<'_>| {
        let export = FlightExport::new(&calibrated, &flight, images, program, choices);
        export.map(|_| ()).map_err(|error| error.to_string())
    };
    let folders = map("sequence,image\n1,a/1.tif\n2,b/1.jpg\n");
    let text = Choices::default();
    let error = refused(&folders, Program::Metashape, &text).unwrap_err();
    assert!(
        error.contains("b/1.jpg") && error.contains("sequence 1"),
        "{error}"
    );
    assert_eq!(refused(&folders, Program::Colmap, &text), Ok(()));
    let pattern = ImageNames::Pattern(Pattern::parse("{sequence}/IMG.tif").unwrap());
    let error = refused(&pattern, Program::Metashape, &text).unwrap_err();
    assert!(error.contains("label \"IMG\""), "{error}");
    assert_eq!(refused(&names(), Program::Metashape, &text), Ok(()));
    let spaces = map("sequence,image\n1,strip 1/1.tif\n2,2.tif\n");
    let error = refused(&spaces, Program::Colmap, &text).unwrap_err();
    assert!(
        error.contains("strip 1/1.tif") && error.contains("space"),
        "{error}"
    );
    let binary = Choices {
        is_binary: true,
        ..text
    };
    assert_eq!(refused(&spaces, Program::Colmap, &binary), Ok(()));
    for program in Program::WRITTEN {
        let found = refused(&folders, program, &text);
        if !Program::WITH_FRAMES.contains(&program) {
            assert!(found.unwrap_err().contains("no camera per image"));
        }
    }
}

#[test]
fn documented_files_and_columns_are_those_of_the_export() {
    let (file, camera) = CameraFile::parse("ixm.toml", IXM).unwrap();
    let calibrated = Calibrated::of(&file);
    let mut flight = Flight::default();
    let frame = record(1, &camera, &Exposure::new(0.17, 0.01));
    flight.push(&frame, file.exit_pupil_mm()).unwrap();
    let (images, choices) = (names(), Choices::default());
    let documented = rows("| format of frames |");
    assert_eq!(documented.len(), Program::WITH_FRAMES.len());
    for (row, program) in documented.iter().zip(Program::WITH_FRAMES) {
        assert_eq!(row[0], format!("`{}`", program.name()));
        let export = FlightExport::new(&calibrated, &flight, &images, program, &choices).unwrap();
        for name in export.files() {
            let stem = name.split('.').next().unwrap();
            assert!(row[1].contains(stem), "{name}: {}", row[1]);
        }
        if program == Program::Frames {
            let table = text(&export, "frames.csv");
            let columns: Vec<String> = rows("| column |")
                .iter()
                .flat_map(|row| row[0].split(", "))
                .map(|name| name.trim_matches('`').to_owned())
                .collect();
            assert_eq!(table.lines().next().unwrap(), columns.join(","));
        }
    }
}
