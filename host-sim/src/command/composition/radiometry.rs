//! `calibrate radiometry`: offset and gain of every pixel from flats and darks.

use std::path::{Path, PathBuf};

use fmc_composition::image::Plane;
use fmc_composition::radiometry::{
    Correction, DetectorFigures, Falloff, Levels, Method, correction, levels, response,
};
use fmc_composition::rig::Rig;
use serde::{Deserialize, Serialize};

use super::files::{OpenImage, read_plane, read_rig, sets, write_rows};
use crate::cli::{RadiometryArgs, RadiometryMethod};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Name of the file that describes the others.
const DESCRIPTION: &str = "radiometry.json";

/// A calibrated radiometry.
#[derive(Debug)]
pub(super) struct Radiometry {
    pub(super) falloff: Falloff,
    pub(super) levels_dn: Vec<f64>,
    pub(super) detectors: Vec<(Correction, DetectorFigures)>,
}

/// Runs `calibrate radiometry`.
pub(in crate::command) fn run(args: &RadiometryArgs) -> Result<(), Failure> {
    let rig = read_rig(&args.rig)?;
    let method = match args.method {
        RadiometryMethod::OffsetAndGain => Method::OffsetAndGain,
        RadiometryMethod::Template => Method::Template,
    };
    let found = calibrate(&rig, &args.frames, method, args.saturation)?;
    write(&rig, &found, method, &args.out)?;
    output::write(None, |sink| {
        writeln!(
            sink,
            "falloff: {:.4}, {:.4}; misfit {:.3} % of the axis",
            found.falloff.even[0],
            found.falloff.even[1],
            100.0 * found.falloff.misfit
        )?;
        writeln!(
            sink,
            "sub-image  gain DN/e-  read noise DN  PRNU %  DSNU DN  defects"
        )?;
        for (sub, (_, figures)) in rig.sub.iter().zip(&found.detectors) {
            writeln!(
                sink,
                "{:>9}  {:>10.4}  {:>13.2}  {:>6.3}  {:>7.2}  {:>7}",
                sub.id,
                figures.gain_dn_per_e,
                figures.read_noise_dn,
                figures.prnu_percent,
                figures.dsnu_dn,
                figures.defects
            )?;
        }
        writeln!(
            sink,
            "A non-uniformity of the source itself is in gain and falloff, unseen: flats with the camera turned by 180° would tell it. Without exposure times no linearity is known."
        )
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
            sets(&folder.join("flats"), &sub.id)?,
            sets(&folder.join("darks"), &sub.id)?,
        ]);
    }
    let open = |list: &[PathBuf], size: [usize; 2]| -> Result<Vec<OpenImage>, Failure> {
        list.iter()
            .map(|path| Ok(OpenImage::open(path, size)?))
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
    let (falloff, detectors) = correction(rig, &responses, method)?;
    Ok(Radiometry {
        falloff,
        levels_dn,
        detectors,
    })
}

/// Content of radiometry.json.
#[derive(Debug, Serialize)]
struct Description<'a> {
    method: Method,
    meaning: &'static str,
    falloff: Falloff,
    levels_dn: &'a [f64],
    sub: Vec<(&'a str, DetectorFigures)>,
    source: &'static str,
}

/// Part of it that is read.
#[derive(Debug, Deserialize)]
struct Known {
    method: Method,
}

/// Writes the files of a radiometry, the description last.
pub(super) fn write(
    rig: &Rig,
    found: &Radiometry,
    method: Method,
    out: &Path,
) -> Result<(), Failure> {
    let folder = OutputFolder::create(out)?;
    for (sub, (correction, _)) in rig.sub.iter().zip(&found.detectors) {
        let path = |what: &str| folder.path().join(format!("{}_{what}.tif", sub.id));
        write_rows(&path("offset"), sub.size_px(), 16, |row| {
            correction.offset_row(row)
        })?;
        write_rows(&path("gain"), sub.size_px(), 16, |row| {
            correction.gain_row(row)
        })?;
    }
    folder.write("defects.csv", |sink| {
        writeln!(sink, "image,col_px,row_px")?;
        for (sub, (correction, _)) in rig.sub.iter().zip(&found.detectors) {
            for [col, row] in &correction.defects {
                writeln!(sink, "{},{col},{row}", sub.id)?;
            }
        }
        Ok(())
    })?;
    let subs = rig.sub.iter().zip(&found.detectors);
    folder.write_json(DESCRIPTION, &Description {
        method,
        meaning: "corrected = (DN - offset)/gain; ID_offset.tif holds 8 x offset + 32768, ID_gain.tif 20000 x gain",
        falloff: found.falloff,
        levels_dn: &found.levels_dn,
        sub: subs.map(|(sub, (_, figures))| (sub.id.as_str(), *figures)).collect(),
        source: "a non-uniformity of the source is in gain and falloff, unseen; linearity needs exposure times",
    })
}

/// Reads the corrections of all sub-images.
pub(super) fn read(rig: &Rig, folder: &Path) -> Result<(Method, Vec<Correction>), Failure> {
    let path = folder.join(DESCRIPTION);
    let text = std::fs::read_to_string(&path).map_err(|error| Failure::reading(&path, &error))?;
    let known: Known = serde_json::from_str(&text)
        .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
    let defects = read_defects(rig, &folder.join("defects.csv"))?;
    let mut corrections = Vec::new();
    for (sub, defects) in rig.sub.iter().zip(defects) {
        let plane = |what: &str| -> Result<Plane, Failure> {
            read_plane(
                &folder.join(format!("{}_{what}.tif", sub.id)),
                sub.size_px(),
            )
        };
        let (offset, gain) = (plane("offset")?, plane("gain")?);
        corrections.extend(Correction::of_files(&offset, &gain, defects));
    }
    Ok((known.method, corrections))
}

fn read_defects(rig: &Rig, path: &Path) -> Result<Vec<Vec<[usize; 2]>>, Failure> {
    let table =
        crate::formats::named_columns::NamedColumns::read(path, &["image", "col_px", "row_px"])?;
    let mut defects = vec![Vec::new(); rig.sub.len()];
    for row in table.rows() {
        let image: String = row.name("image")?;
        let place = |column: &str| -> Result<usize, Failure> {
            let text = row.optional(column).unwrap_or_default();
            let refused = |_| row.failure(format!("{column} = {text} is no pixel"));
            text.parse().map_err(refused)
        };
        let (col, line) = (place("col_px")?, place("row_px")?);
        if let Some(list) = rig
            .number(&image)
            .and_then(|number| defects.get_mut(number))
        {
            list.push([col, line]);
        }
    }
    Ok(defects)
}
