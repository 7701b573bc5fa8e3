//! Folder of a radiometry: written, and read one sub-image at a time.

use std::path::{Path, PathBuf};

use fmc_composition::image::Plane;
use fmc_composition::radiometry::{
    Correction, DetectorFigures, Falloff, GAIN_UNIT, Method, OFFSET_UNIT, OFFSET_ZERO,
};
use fmc_composition::rig::{Rig, SubImage};
use serde::{Deserialize, Serialize};

use crate::command::composition::files::{read_plane, write_rows};
use crate::failure::Failure;
use crate::formats::named_columns::NamedColumns;
use crate::formats::output::OutputFolder;

/// Name of the file that describes the others.
pub(super) const DESCRIPTION: &str = "radiometry.json";

/// Content of radiometry.json.
#[derive(Debug, Serialize)]
struct Description<'a> {
    method: Method,
    meaning: String,
    offset_unit: f64,
    falloff: Falloff,
    levels_dn: &'a [f64],
    sub: Vec<(&'a str, DetectorFigures)>,
    not_determined: &'a [&'static str],
}

/// Part of it that is read.
#[derive(Debug, Deserialize)]
struct Known {
    method: Method,
    #[serde(default = "usual_unit")]
    offset_unit: f64,
}

const fn usual_unit() -> f64 {
    OFFSET_UNIT
}

/// Content of the files of a radiometry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Content<'a> {
    pub(super) method: Method,
    pub(super) falloff: Falloff,
    pub(super) levels_dn: &'a [f64],
    pub(super) detectors: &'a [(Correction, DetectorFigures)],
    pub(super) not_determined: &'a [&'static str],
}

/// Writes the files of a radiometry, the description last.
pub(super) fn write(rig: &Rig, content: Content, out: &Path) -> Result<(), Failure> {
    let folder = OutputFolder::create(out)?;
    let units = content.detectors.iter().map(|(one, _)| one.offset_unit());
    let offset_unit = units.fold(OFFSET_UNIT, f64::min);
    for (sub, (correction, _)) in rig.sub.iter().zip(content.detectors) {
        let path = |what: &str| folder.path().join(format!("{}_{what}.tif", sub.id));
        write_rows(&path("offset"), sub.size_px(), 16, |row| {
            correction.offset_row(row, offset_unit)
        })?;
        write_rows(&path("gain"), sub.size_px(), 16, |row| {
            correction.gain_row(row)
        })?;
    }
    folder.write("defects.csv", |sink| {
        writeln!(sink, "image,col_px,row_px")?;
        for (sub, (correction, _)) in rig.sub.iter().zip(content.detectors) {
            for [col, row] in &correction.defects {
                writeln!(sink, "{},{col},{row}", sub.id)?;
            }
        }
        Ok(())
    })?;
    let subs = rig.sub.iter().zip(content.detectors);
    folder.write_json(DESCRIPTION, &Description {
        method: content.method,
        meaning: format!(
            "corrected = (DN - offset)/gain; ID_offset.tif holds {offset_unit} x offset + {OFFSET_ZERO}, ID_gain.tif {GAIN_UNIT} x gain"
        ),
        offset_unit,
        falloff: content.falloff,
        levels_dn: content.levels_dn,
        sub: subs.map(|(sub, (_, figures))| (sub.id.as_str(), *figures)).collect(),
        not_determined: content.not_determined,
    })
}

/// A radiometry in files.
#[derive(Debug)]
pub(in crate::command::composition) struct RadiometryFolder {
    path: PathBuf,
    offset_unit: f64,
    defects: Vec<Vec<[usize; 2]>>,
    /// Method of the correction.
    pub(in crate::command::composition) method: Method,
}

impl RadiometryFolder {
    /// Reads the description and the defects.
    pub(in crate::command::composition) fn open(rig: &Rig, folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(DESCRIPTION);
        let text =
            std::fs::read_to_string(&path).map_err(|error| Failure::reading(&path, &error))?;
        let known: Known = serde_json::from_str(&text)
            .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
        if known.offset_unit.is_nan() || known.offset_unit <= 0.0 {
            return Err(Failure::bad_input(format!(
                "{}: offset_unit = {}; allowed: above 0",
                path.display(),
                known.offset_unit
            )));
        }
        Ok(Self {
            path: folder.to_path_buf(),
            offset_unit: known.offset_unit,
            defects: read_defects(rig, &folder.join("defects.csv"))?,
            method: known.method,
        })
    }

    /// Reads the correction of a sub-image, which has a number in the rig.
    pub(in crate::command::composition) fn correction(
        &self,
        number: usize,
        sub: &SubImage,
    ) -> Result<Option<Correction>, Failure> {
        let plane = |what: &str| -> Result<Plane, Failure> {
            let path = self.path.join(format!("{}_{what}.tif", sub.id));
            read_plane(&path, sub.size_px())
        };
        let (offset, gain) = (plane("offset")?, plane("gain")?);
        let defects = self.defects.get(number).cloned().unwrap_or_default();
        Ok(Correction::of_files(
            &offset,
            self.offset_unit,
            &gain,
            defects,
        ))
    }
}

fn read_defects(rig: &Rig, path: &Path) -> Result<Vec<Vec<[usize; 2]>>, Failure> {
    let table = NamedColumns::read(path, &["image", "col_px", "row_px"])?;
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
