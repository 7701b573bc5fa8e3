//! `calibrate radiometry`: offset and gain of every pixel from flats and darks.

mod folder;
mod sets;
mod table;

use std::path::{Path, PathBuf};

use fmc_composition::radiometry::{
    Correction, DetectorFigures, Falloff, Levels, Method, correction, levels, response,
};
use fmc_composition::rig::Rig;

use super::files::{OpenImage, flat_sets, read_rig};
use crate::cli::{RadiometryArgs, RadiometryMethod};
use crate::failure::{Failure, note};
use crate::formats::output;

use folder::{Content, DESCRIPTION};

pub(super) use folder::RadiometryFolder;

/// Figures that flats and darks alone do not give.
const UNSEEN: &str = "Not determined: quantum efficiency and responsivity (photons per pixel), dark current (darks of several exposure times), and a non-uniformity of the source, which is in gain and falloff unseen (flats with the camera turned by 180° would tell it).";
const NO_LINEARITY: &str = "Not determined: linearity; flats/levels.csv with set,exposure_s would tell it, of three or more sets from 5 to 95 % of saturation.";

/// A calibrated radiometry.
#[derive(Debug)]
pub(super) struct Radiometry {
    pub(super) falloff: Falloff,
    pub(super) levels_dn: Vec<f64>,
    pub(super) detectors: Vec<(Correction, DetectorFigures)>,
}

impl Radiometry {
    fn is_linearity_known(&self) -> bool {
        let mut figures = self.detectors.iter().map(|(_, figures)| figures);
        figures.all(|one| one.linearity.is_some())
    }
}

/// Runs `calibrate radiometry`.
pub(in crate::command) fn run(args: &RadiometryArgs) -> Result<(), Failure> {
    let rig = read_rig(&args.rig)?;
    let method = match args.method {
        RadiometryMethod::OffsetAndGain => Method::OffsetAndGain,
        RadiometryMethod::Template => Method::Template,
    };
    let found = calibrate(&rig, &args.frames, method, args.saturation)?;
    let not_determined: &[&str] = if found.is_linearity_known() {
        &[UNSEEN]
    } else {
        &[NO_LINEARITY, UNSEEN]
    };
    let content = Content {
        method,
        falloff: found.falloff,
        levels_dn: &found.levels_dn,
        detectors: &found.detectors,
        not_determined,
    };
    folder::write(&rig, content, &args.out)?;
    output::write(None, |sink| {
        writeln!(
            sink,
            "falloff: {:.4}, {:.4}; misfit {:.3} % of the axis",
            found.falloff.even[0],
            found.falloff.even[1],
            100.0 * found.falloff.misfit
        )?;
        table::write(&rig, &found.detectors, sink)?;
        for line in not_determined {
            writeln!(sink, "{line}")?;
        }
        Ok(())
    })?;
    note(format_args!(
        "{}: {DESCRIPTION}, defects.csv, ID_offset.tif, ID_gain.tif of {}",
        args.out.display(),
        rig.ids()
    ));
    Ok(())
}

/// Calibrates all sub-images of a rig from a folder of flats/ and darks/.
pub(super) fn calibrate(
    rig: &Rig,
    folder: &Path,
    method: Method,
    saturation_dn: u16,
) -> Result<Radiometry, Failure> {
    let mut files = Vec::new();
    for sub in &rig.sub {
        files.push([
            flat_sets(&folder.join("flats"), &sub.id)?,
            flat_sets(&folder.join("darks"), &sub.id)?,
        ]);
    }
    sets::check(rig, &files)?;
    let light = match files.first() {
        Some([flats, _]) => sets::light(&folder.join("flats"), flats)?,
        None => None,
    };
    let open = |list: &[(u32, PathBuf)], size: [usize; 2]| -> Result<Vec<OpenImage>, Failure> {
        list.iter()
            .map(|(_, path)| Ok(OpenImage::open(path, size)?))
            .collect()
    };
    let mut of_detectors = Vec::new();
    for (sub, [flats, darks]) in rig.sub.iter().zip(&files) {
        let size = sub.size_px();
        let (mut flats, mut darks) = (open(flats, size)?, open(darks, size)?);
        of_detectors.push(levels(size, &mut flats, &mut darks, saturation_dn)?);
    }
    let levels_dn = Levels::joined(&of_detectors)?;
    let mut responses = Vec::new();
    for (sub, [flats, darks]) in rig.sub.iter().zip(&files) {
        let size = sub.size_px();
        let (mut flats, mut darks) = (open(flats, size)?, open(darks, size)?);
        let (flats, darks) = (&mut flats, &mut darks);
        responses.push(response(rig, sub, &levels_dn, flats, darks, saturation_dn)?);
    }
    let (falloff, mut detectors) = correction(rig, responses, method)?;
    for ((_, figures), levels) in detectors.iter_mut().zip(&of_detectors) {
        let saturation_dn = f64::from(saturation_dn) - figures.dark_dn;
        figures.linearity = light
            .as_deref()
            .and_then(|light| levels.linearity(light, saturation_dn));
    }
    Ok(Radiometry {
        falloff,
        levels_dn,
        detectors,
    })
}
