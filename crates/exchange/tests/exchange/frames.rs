//! Cameras of single frames against the strict solver.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::CameraFile;
use fmc_camera_file::published::CAMERA_FILES;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::frames::Frame;
use fmc_exchange::program::Program;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::strict::{StrictSolver, Weight};

use crate::support::{pinhole, written};

#[test]
fn experiment() {
    for (name, text) in CAMERA_FILES {
        for offset in [0.145, 0.35] {
            for axis in ["+x", "-x", "+y", "-y"] {
                let text = format!("{text}\n[fmc]\naxis = \"{axis}\"\nstrategy = \"from-rest\"\n");
                let (file, camera) = CameraFile::parse(name, &text).unwrap();
                let at_rest = Calibrated::of(&file);
                let mut exposure = Exposure::new(0.17, 0.01);
                exposure.focus_shift_um = 10.0;
                exposure.opening_offset_mm = Some(offset as f32);
                let interior = camera.frame(&exposure).unwrap().interior;
                let frame = Frame::of(1, &interior, file.exit_pupil_mm());
                let mut request = ExposureRequest::planned(0.17, 0.01);
                request.focus_shift_mm = 0.01;
                request.opening_offset_mm = Some(offset);
                let solver = StrictSolver::new(&file, &request, Weight::Exposure);
                let [x0, y0] = at_rest.principal_point_mm;
                let [ex, ey] = file.fmc.axis.unit();
                let c = solver.path().centroid_mm();
                let mut line = format!("{name} {axis} c {c:.4} d {:.4}:", solver.path().travel_mm);
                for (program, model) in [
                    (Program::Colmap, "OPENCV"),
                    (Program::Colmap, "FULL_OPENCV"),
                    (Program::OpenSfm, "brown"),
                    (Program::Metashape, "frame"),
                ] {
                    for wide in [false, true] {
                        let exported = written(
                            &if wide {
                                at_rest.seen_by([frame.principal_point()])
                            } else {
                                at_rest.clone()
                            },
                            program,
                            model,
                        );
                        let moved = frame.pinhole(&at_rest, &pinhole(&exported));
                        let (mut largest, mut squares) = (0.0_f64, 0.0);
                        let points = at_rest.grid_mm(21);
                        for [x, y] in &points {
                            let [dx, dy] = solver.mean([*x, *y]).distortion_mm;
                            let [ix, iy] = [x - dx - x0 - c * ex, y - dy - y0 - c * ey];
                            let f = file.principal_distance_mm;
                            let [px, py] =
                                at_rest.sensor_from_pixel(moved.pixel_from_ray([ix / f, -iy / f]));
                            let off = [(px - x).abs(), (py - y).abs()];
                            largest = largest.max(off[0]).max(off[1]);
                            squares += off[0] * off[0] + off[1] * off[1];
                        }
                        let rms = (squares / (2.0 * points.len() as f64)).sqrt() * 1e3;
                        line += &format!(
                            "  {model} {:.4}/{:.4} -> {:.4}/{rms:.4}",
                            exported.residual.largest_um,
                            exported.residual.rms_um,
                            largest * 1e3
                        );
                    }
                }
                println!("{line}");
            }
        }
    }
}
