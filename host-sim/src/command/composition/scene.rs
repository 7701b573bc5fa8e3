//! `scene dmz`: a synthetic camera of several detectors, with truth.

use std::path::Path;

use fmc_composition::rig::Rig;
use fmc_composition::rig::control::{ControlPoint, Tie};
use fmc_composition::scene::{FULL_SCALE_DN, Scene, SceneRequest};
use serde::Serialize;

use super::files::write_plane;
use crate::cli::{DmzSceneArgs, SceneOptions};
use crate::failure::{Failure, note};
use crate::formats::output::OutputFolder;

/// Exposure time of a flat whose signal on the axis is the full scale, s.
const EXPOSURE_S: f64 = 0.01;

/// Runs `scene dmz`.
pub(in crate::command) fn run(args: &DmzSceneArgs) -> Result<(), Failure> {
    let scene = Scene::new(request(&args.scene));
    let folder = OutputFolder::create(&args.out)?;
    write(&scene, &folder, args.darks.into())?;
    note(format_args!(
        "{}: rig.toml, flats, darks, {}, control.csv, ties.csv, truth",
        folder.path().display(),
        scene
            .exposures
            .iter()
            .map(|one| one.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    ));
    Ok(())
}

/// Returns the request of a scene.
pub(super) fn request(options: &SceneOptions) -> SceneRequest {
    SceneRequest {
        scale: options.scale.into(),
        overlap_px: options.overlap.map(usize::from),
        distortion: options.distortion / 100.0,
        green_distortion: options.green_distortion / 100.0,
        relief_m: options.relief,
        tilt_deg: options.tilt,
        noise_px: options.noise,
        control_sigma_m: options.control_sigma,
        marks: options.marks.into(),
        ties: options.ties.into(),
        seed: options.seed,
    }
}

/// Writes a scene with all its frames.
pub(super) fn write(scene: &Scene, folder: &OutputFolder, darks: usize) -> Result<(), Failure> {
    let sub_folder = |name: &str| OutputFolder::create(&folder.path().join(name));
    let (flats, dark) = (sub_folder("flats")?, sub_folder("darks")?);
    let truth = sub_folder("truth")?;
    let mut exposures = Vec::new();
    for exposure in &scene.exposures {
        exposures.push(sub_folder(&exposure.name)?);
    }
    for (number, sub) in scene.rig.sub.iter().enumerate() {
        let detector = scene.detector(number);
        let file = |set: usize| format!("{}_{set:02}.tif", sub.id);
        for set in 0..scene.flats() {
            if let Some(plane) = scene.flat(set, number, &detector) {
                write_plane(&flats.path().join(file(set)), &plane)?;
            }
        }
        for set in 0..darks {
            write_plane(
                &dark.path().join(file(set)),
                &scene.dark(set, number, &detector),
            )?;
        }
        for (exposure, out) in exposures.iter().enumerate() {
            let plane = scene.sub_image(exposure, number, &detector);
            write_plane(&out.path().join(format!("{}.tif", sub.id)), &plane)?;
        }
    }
    for (exposure, (out, one)) in exposures.iter().zip(&scene.exposures).enumerate() {
        if let Some(green) = scene.green_image(exposure) {
            write_plane(&out.path().join("green.tif"), &green)?;
        }
        let name = format!("virtual_{}.tif", one.name);
        write_plane(&truth.path().join(name), &scene.true_image(exposure))?;
    }
    flats.write("levels.csv", |sink| {
        writeln!(sink, "set,exposure_s")?;
        for set in 0..scene.flats() {
            let signal_dn = scene.flat_signal_dn(set).unwrap_or_default();
            writeln!(sink, "{set},{:.6}", signal_dn * EXPOSURE_S / FULL_SCALE_DN)?;
        }
        Ok(())
    })?;
    write_points(scene, folder)?;
    let text = rig_text(&scene.rig, folder.path())?;
    folder.write("rig.toml", |sink| sink.write_all(text.as_bytes()))?;
    truth.write_json("scene.json", &Truth::of(scene))
}

/// Writes control.csv and ties.csv.
fn write_points(scene: &Scene, folder: &OutputFolder) -> Result<(), Failure> {
    let exposures = 0..scene.exposures.len();
    let control: Vec<ControlPoint> = exposures
        .clone()
        .flat_map(|exposure| scene.control(exposure))
        .collect();
    let ties: Vec<Tie> = exposures
        .flat_map(|exposure| scene.ties(exposure))
        .collect();
    folder.write("control.csv", |sink| {
        write_control(&scene.rig, &control, sink)
    })?;
    folder.write("ties.csv", |sink| write_ties(&scene.rig, &ties, sink))
}

fn id(rig: &Rig, number: usize) -> &str {
    rig.sub.get(number).map_or("", |sub| sub.id.as_str())
}

fn write_control(
    rig: &Rig,
    control: &[ControlPoint],
    sink: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    writeln!(sink, "id,exposure,image,col_px,row_px,x_m,y_m,z_m,sigma_m")?;
    for point in control {
        let [col, row] = point.place.pixel;
        let [x, y, z] = point.ground_m;
        writeln!(
            sink,
            "{},{},{},{col:.4},{row:.4},{x:.4},{y:.4},{z:.4},{}",
            point.id,
            point.exposure,
            id(rig, point.place.sub),
            point.sigma_m
        )?;
    }
    Ok(())
}

/// Writes ties as `calibrate rig` reads them.
pub(super) fn write_ties(
    rig: &Rig,
    ties: &[Tie],
    sink: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    writeln!(sink, "id,exposure,image,col_px,row_px")?;
    for tie in ties {
        for place in &tie.places {
            let [col, row] = place.pixel;
            let image = id(rig, place.sub);
            writeln!(
                sink,
                "{},{},{image},{col:.4},{row:.4}",
                tie.id, tie.exposure
            )?;
        }
    }
    Ok(())
}

/// Returns the text of a rig file.
pub(super) fn rig_text(rig: &Rig, folder: &Path) -> Result<String, Failure> {
    rig.text()
        .map_err(|error| Failure::device_or_io(format!("{}: rig.toml: {error}", folder.display())))
}

/// Content of truth/scene.json.
#[derive(Debug, Serialize)]
struct Truth<'a> {
    scale: usize,
    height_m: f64,
    ground_sample_m: f64,
    relief_m: f64,
    noise_px: f64,
    control_sigma_m: f64,
    distortion: f64,
    seed: u64,
    exposures: Vec<TrueExposure<'a>>,
    marks: Vec<(&'a str, [f64; 3])>,
    /// Corners and centre of each sub-image: pixel, and true place in the virtual image.
    places: Vec<(&'a str, Vec<[[f64; 2]; 2]>)>,
    defects: Vec<(&'a str, Vec<[usize; 2]>)>,
}

#[derive(Debug, Serialize)]
struct TrueExposure<'a> {
    name: &'a str,
    position_m: [f64; 3],
    attitude_rad: [f64; 3],
}

impl<'a> Truth<'a> {
    fn of(scene: &'a Scene) -> Self {
        let request = &scene.request;
        let places = scene.rig.sub.iter().enumerate().map(|(number, sub)| {
            let [col, row] = sub.centre_px();
            let pixels = [
                [0.0, 0.0],
                [2.0 * col, 0.0],
                [col, row],
                [0.0, 2.0 * row],
                [2.0 * col, 2.0 * row],
            ];
            let places = pixels
                .into_iter()
                .filter_map(|pixel| Some([pixel, scene.truth.virtual_px(number, pixel)?]));
            (sub.id.as_str(), places.collect())
        });
        let defects = scene
            .rig
            .sub
            .iter()
            .enumerate()
            .map(|(number, sub)| (sub.id.as_str(), scene.detector(number).defects().to_vec()));
        let exposures = scene.exposures.iter().map(|one| TrueExposure {
            name: &one.name,
            position_m: one.orientation.position_m,
            attitude_rad: one.orientation.attitude,
        });
        Self {
            scale: request.scale,
            height_m: request.height_m(),
            ground_sample_m: scene.ground_sample_m(),
            relief_m: request.relief_m,
            noise_px: request.noise_px,
            control_sigma_m: request.control_sigma_m,
            distortion: request.distortion,
            seed: request.seed,
            exposures: exposures.collect(),
            marks: scene
                .marks
                .iter()
                .map(|mark| (mark.id.as_str(), mark.ground_m))
                .collect(),
            places: places.collect(),
            defects: defects.collect(),
        }
    }
}
