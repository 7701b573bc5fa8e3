//! Files of other programs, written from a calibrated camera and read back.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

use crate::calibrated::{Calibrated, GRID};
use crate::coefficient::Coefficient;
use crate::comparison;
use crate::fit;
use crate::found::{Formula, Found, Stated};
use crate::import;
use crate::one_to_one::{self, Field};
use crate::pinhole::Pinhole;
use crate::program::model::Model;
use crate::program::{
    Container, Program, australis, colmap, kalibr, metashape, micmac, opencv, opensfm, opentrackio,
    opf, photomodeler, pix4d, ros,
};
use crate::residual::Residual;
use crate::source::Source;

/// Largest residual of a model that is good enough, px: no larger model is tried.
pub const GOOD_ENOUGH_PX: f64 = 0.01;

/// Largest difference of a file that was read back from what was to be written, µm: rounding of the
/// conversions.
pub(crate) const READ_BACK_UM: f64 = 1e-6;

/// Choices of an export.
#[derive(Debug, Clone, Copy, Default)]
pub struct Choices<'a> {
    /// Name of the model; without it the smallest that is good enough.
    pub model: Option<&'a str>,
    /// Container of `OpenCV`'s file; without it, that which is usual.
    pub container: Option<Container>,
    /// `true` for COLMAP's binary files.
    pub is_binary: bool,
    /// Name of the camera in the file, where the program looks for one.
    pub key: Option<&'a str>,
}

/// A choice that a program does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Misfit {
    /// A container, of another program's file than `OpenCV`'s.
    Container,
    /// Binary files, of another program than COLMAP.
    Binary,
    /// A name of the camera, in another program's file than `OpenSfM`'s.
    Key,
    /// A name of the camera where every image has a camera of its own.
    KeyOfFrames,
    /// Frames, for a program that has one camera for all images.
    Frames,
    /// No frames, for a program that takes nothing else.
    NoFrames,
}

impl Choices<'_> {
    /// Checks that a program has these choices, with or without the frames of a flight.
    ///
    /// # Errors
    /// The first [`Misfit`].
    pub fn check(&self, program: Program, has_frames: bool) -> Result<(), Misfit> {
        let misfits = [
            (
                Misfit::Container,
                self.container.is_some() && program != Program::OpenCv,
            ),
            (Misfit::Binary, self.is_binary && program != Program::Colmap),
            (
                Misfit::Key,
                self.key.is_some() && program != Program::OpenSfm,
            ),
            (
                Misfit::Frames,
                has_frames && !Program::WITH_FRAMES.contains(&program),
            ),
            (
                Misfit::NoFrames,
                !has_frames && !Program::WRITTEN.contains(&program),
            ),
            (Misfit::KeyOfFrames, has_frames && self.key.is_some()),
        ];
        let first = misfits.into_iter().find(|(_, is_misfit)| *is_misfit);
        first.map_or(Ok(()), |(misfit, _)| Err(misfit))
    }
}

/// A term of the calibration that the file has no place for.
#[derive(Debug, Clone, PartialEq)]
pub struct NotHeld {
    /// Symbols.
    pub term: &'static str,
    /// Largest effect over the sensor, µm.
    pub size_um: f64,
}

/// Files that were written and read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Name and bytes of each file.
    pub files: Vec<(String, Vec<u8>)>,
    /// Model of the program.
    pub model: &'static str,
    /// Formula as it was read back.
    pub formula: Formula,
    /// Difference over the sensor: of measured points for a formula that distorts rays, of ideal
    /// points for one that corrects.
    pub residual: Residual,
    /// Terms without a place.
    pub not_held: Vec<NotHeld>,
}

/// Writes a camera as a program's files, reads them back and compares.
///
/// # Accuracy
/// Exact for programs that correct measured points, but for [`Exported::not_held`]; for the others
/// the least-squares fit of [`fit::pinhole`], with its residual. No program has a place for
/// residual grids: for all of them, formulas are fitted to polynomial and grids together
/// ([`Calibrated::polynomial`]), and the residual is what is left of both.
///
/// # Errors
/// [`InputError`] for a model that the program does not have, that folds over the sensor enlarged
/// by the run-up or has a pole there, and for a program whose files are only read.
pub fn export(
    camera: &Calibrated,
    program: Program,
    choices: &Choices<'_>,
) -> Result<Exported, InputError> {
    let models = program.models();
    if models.is_empty() {
        return corrected(camera, program, choices);
    }
    let wanted: Vec<&Model> = match choices.model {
        None => models.iter().collect(),
        Some(name) => models.iter().filter(|model| model.name == name).collect(),
    };
    if wanted.is_empty() {
        return Err(unknown_model(program, choices, &names(models)));
    }
    let mut best: Option<(&Model, Pinhole, Residual)> = None;
    let mut refusal = None;
    for model in wanted {
        let free = free(camera, model);
        let pinhole = fit::pinhole(camera, &free);
        if let Err(error) = check(camera, program, model, &pinhole) {
            refusal = Some(error);
            continue;
        }
        let residual = comparison::measured(camera, &pinhole);
        let is_better = best
            .as_ref()
            .is_none_or(|(_, _, other)| residual.largest_um < other.largest_um);
        if is_better {
            best = Some((model, pinhole, residual));
        }
        if residual.largest_um < GOOD_ENOUGH_PX * 1e3 * camera.pixel_mm {
            break;
        }
    }
    let Some((model, pinhole, _)) = best else {
        return Err(refusal.unwrap_or_else(|| unknown_model(program, choices, &names(models))));
    };
    let files = files(camera, program, &pinhole, model, choices);
    let mut read = None;
    for (name, bytes) in &files {
        if has_camera(name) {
            let again = read_back(camera, program, name, bytes)?;
            let Formula::Pinhole(again) = again.formula else {
                return Err(InputError::invalid(format!(
                    "{name}: read back as a correction"
                )));
            };
            if difference_um(camera, &pinhole, &again) > READ_BACK_UM {
                return Err(InputError::invalid(format!(
                    "{name}: reads back differently"
                )));
            }
            read.get_or_insert(again);
        }
    }
    let read = read.unwrap_or(pinhole);
    Ok(Exported {
        files,
        model: model.name,
        formula: Formula::Pinhole(read),
        residual: comparison::measured(camera, &read),
        not_held: not_held(camera, &free(camera, model))
            .into_iter()
            .chain(grids_not_held(camera))
            .collect(),
    })
}

fn names(models: &[Model]) -> String {
    let names: Vec<_> = models.iter().map(|model| model.name).collect();
    names.join(", ")
}

fn unknown_model(program: Program, choices: &Choices<'_>, names: &str) -> InputError {
    let model = choices.model.unwrap_or_default();
    InputError::invalid(format!(
        "--model {model}: {} has no such model",
        program.name()
    ))
    .with_help(format!("its models: {names}"))
}

/// Returns the coefficients that are fitted: those of the affinity only for a camera that has one.
fn free(camera: &Calibrated, model: &Model) -> Vec<Coefficient> {
    let has_affinity = camera.lens.b.iter().any(|b| b.abs() > 0.0);
    let affinity = if has_affinity { model.affinity } else { &[] };
    [model.lens, affinity].concat()
}

/// Checks that the model is one-to-one over the sensor enlarged by the run-up.
fn check(
    camera: &Calibrated,
    program: Program,
    model: &Model,
    pinhole: &Pinhole,
) -> Result<(), InputError> {
    let rays = camera.enlarged_grid_mm(GRID);
    let field = Field::around(
        rays.into_iter()
            .map(|point| camera.ray_from_measured(point)),
    );
    one_to_one::show(pinhole, &field)
        .map_err(|fault| fault.refused(&format!("{} {}", program.name(), model.name)))
}

fn files(
    camera: &Calibrated,
    program: Program,
    pinhole: &Pinhole,
    model: &Model,
    choices: &Choices<'_>,
) -> Vec<(String, Vec<u8>)> {
    let file = |name: &str, text: String| (name.to_owned(), text.into_bytes());
    match program {
        Program::OpenCv => {
            let container = choices.container.unwrap_or_default();
            let text = opencv::write(camera, pinhole, model, container);
            vec![file(container.file(), text)]
        }
        Program::Ros => vec![file(ros::FILE, ros::write(camera, pinhole, model))],
        Program::Kalibr => vec![file(kalibr::FILE, kalibr::write(camera, pinhole))],
        Program::Colmap => colmap::write(camera, pinhole, model, choices.is_binary),
        Program::Metashape => vec![file(metashape::FILE, metashape::write(camera, pinhole))],
        Program::OpenSfm => opensfm::FILES
            .map(|name| file(name, opensfm::write(camera, pinhole, choices.key)))
            .into(),
        Program::Opf => vec![file(opf::FILE, opf::write(pinhole))],
        Program::Pix4d => {
            let [cam, xmp] = pix4d::FILES;
            vec![
                file(cam, pix4d::write_cam(camera, pinhole)),
                file(xmp, pix4d::write_xmp(camera, pinhole)),
            ]
        }
        _ => Vec::new(),
    }
}

/// Returns `false` for the files of a folder that describe no camera.
fn has_camera(name: &str) -> bool {
    !["images", "points3D"]
        .iter()
        .any(|other| name.starts_with(other))
}

fn read_back(
    camera: &Calibrated,
    program: Program,
    name: &str,
    bytes: &[u8],
) -> Result<Found, InputError> {
    read_back_as(camera, program, name, bytes, None)
}

/// Reads one camera of a file that was written.
pub(crate) fn read_back_as(
    camera: &Calibrated,
    program: Program,
    name: &str,
    bytes: &[u8],
    id: Option<&str>,
) -> Result<Found, InputError> {
    let stated = Stated {
        id,
        pixel_mm: Some(camera.pixel_mm),
        size_px: Some(camera.size_px),
        ..Stated::default()
    };
    import::read(program, &Source { file: name, bytes }, &stated)
}

/// Returns the largest difference of two formulas over the sensor, µm.
pub(crate) fn difference_um(camera: &Calibrated, one: &Pinhole, other: &Pinhole) -> f64 {
    let points = camera.grid_mm(GRID).into_iter();
    Residual::of(points.map(|point| {
        let ray = camera.ray_from_measured(point);
        let [[ax, ay], [bx, by]] = [one, other].map(|formula| formula.pixel_from_ray(ray));
        (
            point,
            [(ax - bx) * camera.pixel_mm, (ay - by) * camera.pixel_mm],
        )
    }))
    .largest_um
}

/// Writes the camera of a program that corrects measured points.
fn corrected(
    with_grids: &Calibrated,
    program: Program,
    choices: &Choices<'_>,
) -> Result<Exported, InputError> {
    let camera = &with_grids.polynomial();
    let (name, text, model) = match program {
        Program::OpenTrackIo => (
            opentrackio::FILE.to_owned(),
            opentrackio::write(camera),
            "Brown-Conrady D-U",
        ),
        Program::MicMac => (micmac::file(camera), micmac::write(camera), "DistC2M"),
        Program::Australis => (
            australis::FILE.to_owned(),
            australis::write(camera)?,
            "Brown",
        ),
        Program::PhotoModeler => (
            photomodeler::FILE.to_owned(),
            photomodeler::write(camera),
            "Brown",
        ),
        _ => {
            return Err(InputError::invalid(format!(
                "files of {} are only read",
                program.name()
            )));
        }
    };
    if choices.model.is_some_and(|wanted| wanted != model) {
        return Err(unknown_model(program, choices, model));
    }
    let found = read_back(camera, program, &name, text.as_bytes())?;
    let Formula::Correction(correction) = found.formula else {
        return Err(InputError::invalid(format!(
            "{name}: read back as a distortion"
        )));
    };
    let has_affinity = program == Program::MicMac;
    let mut not_held = not_held(
        camera,
        &[Coefficient::Radial(0), Coefficient::Decentring(0)],
    );
    not_held.retain(|_| !has_affinity);
    let residual = comparison::ideal(camera, &correction);
    let explained: f64 = not_held.iter().map(|term| term.size_um).sum();
    if residual.largest_um > explained + READ_BACK_UM {
        return Err(InputError::invalid(format!(
            "{name}: reads back differently"
        )));
    }
    not_held.extend(grids_not_held(with_grids));
    Ok(Exported {
        files: vec![(name, text.into_bytes())],
        model,
        formula: Formula::Correction(correction),
        residual: comparison::ideal(with_grids, &correction),
        not_held,
    })
}

/// Returns the terms of the camera that have no place among the coefficients.
fn not_held(camera: &Calibrated, held: &[Coefficient]) -> Vec<NotHeld> {
    let [b1, b2] = camera.lens.b;
    let none = Lens {
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    };
    let [_, k1, k2, k3] = camera.lens.k;
    let has = |is_it: fn(&Coefficient) -> bool| held.iter().any(is_it);
    [
        (
            "K1, K2, K3",
            has(|one| matches!(one, Coefficient::Radial(_))),
            Lens {
                k: [0.0, k1, k2, k3],
                ..none
            },
        ),
        (
            "P1, P2",
            has(|one| matches!(one, Coefficient::Decentring(_))),
            Lens {
                p: camera.lens.p,
                ..none
            },
        ),
        (
            "B1",
            has(|one| matches!(one, Coefficient::FocalX)),
            Lens {
                b: [b1, 0.0],
                ..none
            },
        ),
        (
            "B2",
            has(|one| matches!(one, Coefficient::Skew)),
            Lens {
                b: [0.0, b2],
                ..none
            },
        ),
    ]
    .into_iter()
    .filter(|(_, is_held, _)| !is_held)
    .map(|(term, _, lens)| NotHeld {
        term,
        size_um: largest_um(camera, &lens),
    })
    .filter(|term| term.size_um > 0.0)
    .collect()
}

/// Returns the residual grids of a camera that has some, with what they add at most.
fn grids_not_held(camera: &Calibrated) -> Option<NotHeld> {
    let points = camera.grid_mm(GRID).into_iter();
    (!camera.residual.is_empty()).then(|| NotHeld {
        term: "residual grids",
        size_um: Residual::of(points.map(|point| (point, camera.residual_mm(point)))).largest_um,
    })
}

/// Returns the largest displacement over the sensor, µm along one axis.
fn largest_um(camera: &Calibrated, lens: &Lens) -> f64 {
    let [x0, y0] = camera.principal_point_mm;
    let points = camera.grid_mm(GRID).into_iter();
    let displacements = points.map(|[x, y]| {
        let displacement = lens.displacement([x - x0, y - y0]);
        ([x, y], displacement.map(|mm| mm / camera.gauge()))
    });
    Residual::of(displacements).largest_um
}
