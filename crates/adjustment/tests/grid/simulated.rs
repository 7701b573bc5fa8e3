//! Distortion table of a camera whose lens has structure that no polynomial follows, with a stage
//! that leaves its plane.

use fmc_adjustment::calibration::result::InputFile;
use fmc_adjustment::grid::calibration::{GridCalibration, grid_calibration};
use fmc_adjustment::grid::polynomial::COEFFICIENTS;
use fmc_adjustment::grid::request::GridCalibrationRequest;
use fmc_adjustment::grid::table::TableObservation;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::{CameraFile, InputError};

pub(crate) const LENS: [GridCarrier; 1] = [GridCarrier::Lens];
pub(crate) const BOTH: [GridCarrier; 2] = [GridCarrier::Lens, GridCarrier::Sensor];

/// Coefficients that the command estimates unless told otherwise.
const ESTIMATED: [bool; COEFFICIENTS] = [true, true, true, true, true, true, false, false];

/// Distance of the exit pupil, mm, and run-out, µm per power of mm from the lowest on.
const EXIT_PUPIL_MM: f64 = 80.0;
pub(crate) const RUN_OUT_UM: [f64; 3] = [0.0, 2.0, -0.5];

/// Camera of 40 mm x 40 mm, e along -y.
pub(crate) fn camera() -> CameraFile {
    camera_with(&RUN_OUT_UM)
}

/// Returns the camera with another run-out.
pub(crate) fn camera_with(run_out_um: &[f64]) -> CameraFile {
    let text = format!(
        "name = \"A\"\nprincipal_distance_mm = 100.0\nexit_pupil_mm = {EXIT_PUPIL_MM}\n\
         principal_point_mm = [0.2, -0.1]\n\
         [sensor]\nwidth_px = 4000\nheight_px = 4000\npixel_um = 10.0\n\
         [distortion]\nk1 = -2.1e-6\n\
         [fmc]\naxis = \"-y\"\nstroke_mm = 2.0\nflatness_um = {run_out_um:?}\n"
    );
    CameraFile::parse("camera.toml", &text).unwrap().0
}

/// Displacement of the lens at a point of its own image, mm from the principal point.
fn of_lens([x, y]: [f64; 2]) -> [f64; 2] {
    let r2 = x * x + y * y;
    let radial = -2e-6 * r2 + 1e-10 * r2 * r2;
    let wave = |angle: f64, phase: f64| {
        let along = x * angle.cos() + y * angle.sin();
        1.5e-3 * (std::f64::consts::TAU * along / 20.0 + phase).sin()
    };
    [
        x * radial + wave(1.1, 0.4) + wave(2.5, 2.0),
        y * radial + wave(0.2, 1.0) + wave(1.9, 3.0),
    ]
}

/// Returns the enlargement of the image at an offset of the stage, term by term.
pub(crate) fn enlargement(run_out_um: &[f64], offset_mm: f64) -> f64 {
    let mut shift_um = 0.0;
    for (power, um) in (0..).zip(run_out_um) {
        shift_um += um * offset_mm.powi(power);
    }
    shift_um / (1e3 * EXIT_PUPIL_MM)
}

/// Returns the measured point and the distortion at a point of the lens's image, with the stage at
/// an offset: the image grows from the exit pupil and moves by c·e.
pub(crate) fn seen(from_pp_mm: [f64; 2], offset_mm: f64, run_out_um: &[f64]) -> [[f64; 2]; 2] {
    let larger = 1.0 + enlargement(run_out_um, offset_mm);
    let principal_point = [0.2, -0.1 - offset_mm];
    let displacement = of_lens(from_pp_mm);
    let measured = [0, 1].map(|axis| principal_point[axis] + larger * from_pp_mm[axis]);
    let ideal = [0, 1].map(|axis| principal_point[axis] + from_pp_mm[axis] - displacement[axis]);
    [measured, [0, 1].map(|axis| measured[axis] - ideal[axis])]
}

/// Returns a table of 37 x 37 points over the sensor at each of the stage's offsets.
pub(crate) fn table(offsets_mm: &[f64]) -> Vec<TableObservation> {
    table_with(offsets_mm, &RUN_OUT_UM)
}

/// Returns the table of a stage with another run-out.
pub(crate) fn table_with(offsets_mm: &[f64], run_out_um: &[f64]) -> Vec<TableObservation> {
    let side = || (0..37_u8).map(|index| 1.04 * (f64::from(index) - 18.0));
    let mut rows = Vec::new();
    for offset in offsets_mm {
        for [x, y] in side().flat_map(|y| side().map(move |x| [x, y])) {
            let [measured_mm, distortion_mm] = seen([x, y + offset], *offset, run_out_um);
            rows.push(TableObservation {
                line: 0,
                measured_mm,
                distortion_mm,
                stage_offset_mm: *offset,
            });
        }
    }
    for (line, row) in (2..).zip(&mut rows) {
        row.line = line;
    }
    rows
}

pub(crate) fn calibrated(
    rows: &[TableObservation],
    camera: &CameraFile,
    carriers: &[GridCarrier],
) -> Result<GridCalibration, InputError> {
    at_pitch(rows, camera, carriers, 2.0)
}

pub(crate) fn at_pitch(
    rows: &[TableObservation],
    camera: &CameraFile,
    carriers: &[GridCarrier],
    pitch_mm: f64,
) -> Result<GridCalibration, InputError> {
    grid_calibration(&GridCalibrationRequest {
        input: InputFile {
            file: "table.csv".to_owned(),
            crc32: 0,
        },
        observations: rows,
        camera,
        carriers,
        pitch_mm,
        is_estimated: ESTIMATED,
    })
}
