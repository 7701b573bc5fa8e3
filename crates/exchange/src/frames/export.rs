//! Files with a camera per image, written from the frames of a flight and read back.

use std::io::{self, Write};

use fmc_camera_file::InputError;

use super::cameras::Cameras;
use super::flight::Flight;
use super::image_camera::ImageCamera;
use super::image_names::ImageNames;
use super::{colmap, json, metashape, tables};
use crate::calibrated::{Calibrated, GRID};
use crate::correction::Correction;
use crate::export::{self, Choices, Exported, READ_BACK_UM, difference_um, read_back_as};
use crate::found::Formula;
use crate::pinhole::Pinhole;
use crate::program::Program;
use crate::residual::Residual;

/// Residual of the frames above that of the calibrated camera with which its coefficients are kept,
/// µm.
const TOLERANCE_UM: f64 = 2e-3;

/// Factors by which the lens that the frames see beyond the sensor is enlarged for a fit. Least
/// squares leave most at the edges: a wider fit leaves less at those of the frames.
const WIDENING: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];

type Writer = fn(&Cameras<'_>, &mut dyn Write) -> io::Result<()>;

/// Returns the files of a program with their writers; none for a program that takes no camera per
/// image.
const fn files(
    program: Program,
    is_binary: bool,
    has_poses: bool,
) -> &'static [(&'static str, Writer)] {
    match (program, is_binary) {
        (Program::Metashape, _) if has_poses => &[
            ("cameras.xml", metashape::cameras),
            ("frames.py", metashape::script),
            ("reference.csv", tables::references),
        ],
        (Program::Colmap, false) => &[
            ("cameras.txt", colmap::cameras_text),
            ("images.txt", colmap::images_text),
            ("points3D.txt", colmap::no_points_text),
        ],
        (Program::Colmap, true) => &[
            ("cameras.bin", colmap::cameras_binary),
            ("images.bin", colmap::images_binary),
            ("points3D.bin", colmap::no_points_binary),
        ],
        (Program::Metashape, _) => &[
            ("cameras.xml", metashape::cameras),
            ("frames.py", metashape::script),
        ],
        (Program::OpenSfm, _) => &[
            ("camera_models_overrides.json", json::opensfm_models),
            ("exif_overrides.json", json::opensfm_exif),
        ],
        (Program::Opf, _) => &[
            ("calibrated_cameras.json", json::opf_cameras),
            ("camera_list.json", json::opf_list),
        ],
        (Program::OpenTrackIo, _) => &[("samples.jsonl", json::opentrackio_samples)],
        (Program::ArcGis, _) => &[
            ("cameras.csv", tables::arcgis_cameras),
            ("frames.csv", tables::arcgis_frames),
        ],
        (Program::Frames, _) => &[("frames.csv", tables::plain)],
        _ => &[],
    }
}

/// Cameras of all frames of a flight for a program: fitted, compared with the strict camera, read
/// back, and ready to be written.
#[derive(Debug)]
pub struct FlightExport<'a> {
    frames: Cameras<'a>,
    program: Program,
    is_binary: bool,
    /// Export of the calibrated camera, whose coefficients all frames have; its residual is the
    /// largest of the frames'. It has no files.
    pub at_rest: Exported,
    /// Largest effect of the terms of μ₂, which the files do not hold, nm.
    pub left_out_nm: f64,
}

impl<'a> FlightExport<'a> {
    /// Fits the cameras of a flight's frames, and reads back those that differ most.
    ///
    /// # Accuracy
    /// The coefficients are those of the calibrated camera, fitted over the sensor, if they leave
    /// as little on the frames as on the calibrated camera. Frames see the lens beyond the
    /// sensor: where the fit is worse there, it is repeated over as much more of the lens, and over
    /// two to sixteen times as much, until it leaves as little; or else the best of these is taken.
    /// Files with the frames that differ most from the calibrated camera are read back and
    /// compared; the other frames differ from them in principal point and κ alone.
    ///
    /// # Errors
    /// [`InputError`] for a program that takes no camera per image, for images that it could not
    /// tell apart, for a table of images that does not fit the flight, and as
    /// [`export`](export::export) has it.
    pub fn new(
        camera: &'a Calibrated,
        flight: &'a Flight,
        images: &'a ImageNames,
        program: Program,
        choices: &Choices<'_>,
    ) -> Result<Self, InputError> {
        images.check(flight)?;
        check_names(program, choices, flight, images)?;
        let extremes = flight.extremes();
        let at_rest = at_rest(camera, &extremes, program, choices)?;
        let pinhole = match at_rest.formula {
            Formula::Pinhole(pinhole) => pinhole,
            Formula::Correction(_) => Pinhole::ideal(0.0, [0.0; 2]),
        };
        let frames = Cameras {
            camera,
            model: at_rest.model,
            frames: &flight.frames,
            images,
            poses: flight.poses.as_deref(),
            at_rest: pinhole,
            without_k0: held(camera),
        };
        let bend = largest_bend(camera);
        let export = Self {
            frames,
            program,
            is_binary: choices.is_binary,
            at_rest,
            left_out_nm: flight
                .frames
                .iter()
                .map(|frame| 1e6 * frame.left_out_mm(bend))
                .fold(0.0, f64::max),
        };
        export.check_read_back(&extremes)?;
        Ok(export)
    }

    fn writers(&self) -> &'static [(&'static str, Writer)] {
        files(self.program, self.is_binary, self.frames.poses.is_some())
    }

    /// Names of the files.
    #[must_use]
    pub fn files(&self) -> Vec<&'static str> {
        self.writers().iter().map(|(name, _)| *name).collect()
    }

    /// Writes one of the files, a frame after the other.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write(&self, file: &str, sink: &mut dyn Write) -> io::Result<()> {
        self.writers()
            .iter()
            .filter(|(name, _)| *name == file)
            .try_for_each(|(_, write)| write(&self.frames, sink))
    }

    /// Writes some of the frames, and reads them back.
    fn check_read_back(&self, some: &[ImageCamera]) -> Result<(), InputError> {
        let frames = Cameras {
            frames: some,
            // The cameras alone are compared.
            poses: None,
            ..self.frames
        };
        let Some((name, write)) = self.writers().first() else {
            return Err(InputError::invalid(format!(
                "{}: no camera per image",
                self.program.name()
            )));
        };
        if matches!(self.program, Program::ArcGis | Program::Frames) {
            return Ok(());
        }
        let mut bytes = Vec::new();
        write(&frames, &mut bytes)
            .map_err(|error| InputError::invalid(format!("{name}: {error}")))?;
        let mut lines = bytes.split(|byte| *byte == b'\n');
        for frame in some {
            let (id, bytes) = match self.program {
                Program::OpenTrackIo => (String::new(), lines.next().unwrap_or_default()),
                Program::OpenSfm => (json::opensfm_key(frame), bytes.as_slice()),
                _ => (frame.sequence.to_string(), bytes.as_slice()),
            };
            let id = (!id.is_empty()).then_some(id.as_str());
            let camera = self.frames.camera;
            let is_same = match read_back_as(camera, self.program, name, bytes, id)?.formula {
                Formula::Pinhole(read) => {
                    difference_um(camera, &frames.pinhole(frame), &read) <= READ_BACK_UM
                }
                Formula::Correction(read) => {
                    let written = frames.correction(frame);
                    let rays = camera.grid_mm(GRID).into_iter().map(|point| {
                        let [ax, ay] = written.ray_from_measured(point);
                        let [bx, by] = read.ray_from_measured(point);
                        let distance = written.principal_distance_mm;
                        (point, [(ax - bx) * distance, (ay - by) * distance])
                    });
                    Residual::of(rays).largest_um <= READ_BACK_UM
                }
            };
            if !is_same {
                return Err(InputError::invalid(format!(
                    "{name}: sequence {} reads back differently",
                    frame.sequence
                )));
            }
        }
        Ok(())
    }
}

/// Returns the formula of measured points that a program with a camera per image holds: that of
/// `OpenTrackIO`, without K0 and affinity.
fn held(camera: &Calibrated) -> Correction {
    let mut held = Correction::of(&camera.polynomial().without_k0());
    held.lens.b = [0.0; 2];
    held
}

/// Returns the export of the calibrated camera, with the residual of the frames.
fn at_rest(
    camera: &Calibrated,
    extremes: &[ImageCamera],
    program: Program,
    choices: &Choices<'_>,
) -> Result<Exported, InputError> {
    if matches!(program, Program::ArcGis | Program::Frames) {
        if let Some(model) = choices.model {
            return Err(InputError::invalid(format!(
                "--model {model}: {} has no coefficients, and so no models",
                program.name()
            )));
        }
        return Ok(Exported {
            files: Vec::new(),
            model: "interior orientation",
            formula: Formula::Correction(Correction::of(camera)),
            residual: Residual::default(),
            not_held: Vec::new(),
        });
    }
    let over_sensor = export::export(camera, program, choices)?;
    let most_um = over_sensor.residual.largest_um + TOLERANCE_UM;
    let seen = camera.seen_by(extremes.iter().map(ImageCamera::principal_point));
    let same_model = Choices {
        model: Some(over_sensor.model),
        ..*choices
    };
    let of_frames = |exported: Exported| Exported {
        files: Vec::new(),
        residual: residual(camera, extremes, &exported),
        ..exported
    };
    let mut best = of_frames(over_sensor);
    for factor in WIDENING {
        if best.residual.largest_um <= most_um {
            break;
        }
        let wider = Calibrated {
            beyond_mm: seen.beyond_mm.map(|side| side.map(|mm| mm * factor)),
            ..camera.clone()
        };
        // A model that folds further out is none.
        if let Ok(exported) = export::export(&wider, program, &same_model).map(of_frames)
            && exported.residual.largest_um < best.residual.largest_um
        {
            best = exported;
        }
    }
    Ok(best)
}

/// Returns the largest residual of frames.
fn residual(camera: &Calibrated, frames: &[ImageCamera], exported: &Exported) -> Residual {
    if camera.residual.is_empty() && matches!(exported.formula, Formula::Correction(_)) {
        return exported.residual;
    }
    frames
        .iter()
        .map(|frame| match &exported.formula {
            Formula::Pinhole(pinhole) => {
                let moved = frame.pinhole(camera, pinhole);
                frame_residual(camera, frame, |point, ray| {
                    let [x, y] = camera.sensor_from_pixel(moved.pixel_from_ray(ray));
                    [x - point[0], y - point[1]]
                })
            }
            Formula::Correction(correction) => {
                let moved = frame.correction(correction);
                let distance = moved.principal_distance_mm;
                frame_residual(camera, frame, |point, [x, y]| {
                    let [program_x, program_y] = moved.ray_from_measured(point);
                    [(program_x - x) * distance, (y - program_y) * distance]
                })
            }
        })
        .max_by(|a, b| a.largest_um.total_cmp(&b.largest_um))
        .unwrap_or_default()
}

/// Returns the difference of points on the sensor of a frame, program's - camera's, which
/// `difference` gives for a point and its strict ray.
///
/// # Model
/// A point of the frame is seen where the calibrated camera has its distance from the principal
/// point divided by 1 + κ, with the residual grid of the lens; that of the sensor stays. The terms
/// of μ₂ are left out.
fn frame_residual(
    camera: &Calibrated,
    frame: &ImageCamera,
    difference: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
) -> Residual {
    let [x0, y0] = camera.principal_point_mm;
    let [moved_x, moved_y] = frame.principal_point();
    Residual::of(camera.grid_mm(GRID).into_iter().map(|point| {
        let [at_x, at_y] = point;
        let scale = frame.scale();
        let at_rest = [x0 + (at_x - moved_x) / scale, y0 + (at_y - moved_y) / scale];
        let ray = camera.ray_of_frame(at_rest, point, scale);
        (point, difference(point, ray))
    }))
}

/// Returns the largest second derivative of the distortion along either axis of the sensor, 1/mm.
fn largest_bend(camera: &Calibrated) -> f64 {
    const STEP_MM: f64 = 1e-3;
    let [x0, y0] = camera.principal_point_mm;
    let mut largest = 0.0_f64;
    for [x, y] in camera.grid_mm(GRID) {
        let at = [x - x0, y - y0];
        for [ex, ey] in [[1.0, 0.0], [0.0, 1.0]] {
            let slope = |step: f64| {
                let [x, y] = at;
                camera
                    .lens
                    .derivative([x + step * ex, y + step * ey], [ex, ey])
            };
            let ([ax, ay], [bx, by]) = (slope(-STEP_MM), slope(STEP_MM));
            largest = largest.max((bx - ax).abs()).max((by - ay).abs());
        }
    }
    largest / (2.0 * STEP_MM) + lens_grid_bend(camera)
}

/// Returns the same of the residual grid of the lens, which moves with it, 1/mm.
fn lens_grid_bend(camera: &Calibrated) -> f64 {
    const STEP_MM: f64 = 0.01;
    let mut largest = 0.0_f64;
    for [x, y] in camera.grid_mm(GRID) {
        for [ex, ey] in [[STEP_MM, 0.0], [0.0, STEP_MM]] {
            let at = |steps: f64| {
                let place = [x + steps * ex, y + steps * ey];
                camera.residual.of_lens(place)
            };
            for ((before, here), after) in at(-1.0).into_iter().zip(at(0.0)).zip(at(1.0)) {
                largest = largest.max((before - 2.0 * here + after).abs());
            }
        }
    }
    largest / (STEP_MM * STEP_MM)
}

/// Checks that the program can read the names of the images, and tell them apart.
fn check_names(
    program: Program,
    choices: &Choices<'_>,
    flight: &Flight,
    images: &ImageNames,
) -> Result<(), InputError> {
    if program == Program::Metashape {
        return images
            .check_distinct(flight, metashape::label)
            .map_err(|error| {
                error.with_help("Metashape knows an image by its name without folder and extension")
            });
    }
    if program != Program::Colmap || choices.is_binary {
        return Ok(());
    }
    let mut fault = None;
    // The walk ends at the first fault.
    let _ = images.each(&flight.frames, |frame, image| {
        if !image.contains(char::is_whitespace) {
            return Ok(());
        }
        fault = Some(format!(
            "image {image:?} of sequence {}: COLMAP's text files end a name at a space",
            frame.sequence
        ));
        Err(io::Error::other("a space"))
    });
    fault.map_or(Ok(()), |text| {
        Err(InputError::invalid(text).with_help("--binary"))
    })
}
