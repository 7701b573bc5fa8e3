//! Files of a rig: images, measured points.

use std::path::{Path, PathBuf};

use fmc_camera_file::InputError;
use fmc_composition::image::Plane;
use fmc_composition::radiometry::SampleRows;
use fmc_composition::rig::Rig;
use fmc_composition::rig::control::{ControlPoint, Measurements, Place, Tie};
use fmc_raster::{FrameReader, ReadError};

use crate::command::images::written::{self, Format};
use crate::failure::Failure;
use crate::formats::named_columns::{NamedColumns, Row};

/// Exposure of points whose file does not name one.
const ONE_EXPOSURE: &str = "exposure";

/// Reads a rig file.
pub(in crate::command) fn read_rig(path: &Path) -> Result<Rig, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::reading(path, &error))?;
    Ok(Rig::parse(&path.display().to_string(), &text)?)
}

/// An image of one band, opened and checked.
#[derive(Debug)]
pub(super) struct OpenImage {
    path: PathBuf,
    name: String,
    reader: FrameReader,
}

impl OpenImage {
    /// Opens an image that must have a size.
    pub(super) fn open(path: &Path, [width, height]: [usize; 2]) -> Result<Self, InputError> {
        let reader = FrameReader::open(path).map_err(|error| refused(path, error))?;
        let header = reader.header();
        let found = [header.width_px, header.height_px].map(|side| side as usize);
        if found != [width, height] {
            return Err(InputError::invalid(format!(
                "{}: {} x {} px; allowed: {width} x {height} px, the size in the rig file",
                path.display(),
                found[0],
                found[1]
            )));
        }
        if header.samples != 1 {
            return Err(InputError::invalid(format!(
                "{}: {} bands; allowed: 1, a detector has one",
                path.display(),
                header.samples
            )));
        }
        Ok(Self {
            path: path.to_path_buf(),
            name: path.display().to_string(),
            reader,
        })
    }

    fn rows(&mut self, out: &mut [u16]) -> Result<(), InputError> {
        if self.reader.header().bits == 8 {
            let mut bytes = vec![0_u8; out.len()];
            let read = self.reader.read_rows(&mut bytes);
            read.map_err(|error| refused(&self.path, error))?;
            for (slot, byte) in out.iter_mut().zip(bytes) {
                *slot = u16::from(byte);
            }
        } else {
            let read = self.reader.read_rows(out);
            read.map_err(|error| refused(&self.path, error))?;
        }
        Ok(())
    }
}

impl SampleRows for OpenImage {
    fn name(&self) -> &str {
        &self.name
    }

    fn read_row(&mut self, row: &mut [u16]) -> Result<(), InputError> {
        self.rows(row)
    }
}

fn refused(path: &Path, error: ReadError) -> InputError {
    match error {
        ReadError::Io { source, .. } => InputError::reading(path, &source),
        error => InputError::invalid(format!("{}: {error}", path.display())),
    }
}

/// Reads an image of one band that must have a size.
pub(super) fn read_plane(path: &Path, size_px: [usize; 2]) -> Result<Plane, Failure> {
    let mut image = OpenImage::open(path, size_px)?;
    let [width, height] = size_px;
    let mut values = vec![0; width * height];
    image.rows(&mut values)?;
    Plane::new(width, height, values)
        .ok_or_else(|| Failure::bad_input(format!("{}: no pixels", path.display())))
}

/// Writes an image of 16 bits.
pub(super) fn write_plane(path: &Path, plane: &Plane) -> Result<(), Failure> {
    write_rows(path, [plane.width(), plane.height()], 16, |row| {
        plane.row(row).iter().copied().map(f64::from).collect()
    })
}

/// Writes an image of one band row by row.
pub(super) fn write_rows(
    path: &Path,
    size_px: [usize; 2],
    bits: u8,
    row: impl Fn(usize) -> Vec<f64> + Sync,
) -> Result<(), Failure> {
    let format = Format {
        size_px: size_px.map(|side| u32::try_from(side).unwrap_or(u32::MAX)),
        bands: 1,
        bits,
    };
    written::write(path, format, |number| row(number as usize))
}

/// Reads control and ties, of one exposure or of all.
pub(super) fn read_measurements(
    rig: &Rig,
    control: &Path,
    ties: Option<&Path>,
    only: Option<&str>,
) -> Result<Measurements, Failure> {
    let required = [
        "id", "image", "col_px", "row_px", "x_m", "y_m", "z_m", "sigma_m",
    ];
    let table = NamedColumns::read(control, &required)?;
    let mut measurements = Measurements {
        control_file: table.input.file.clone(),
        ..Measurements::default()
    };
    for row in table.rows() {
        let point = ControlPoint {
            id: row.name("id")?,
            exposure: exposure(&row)?,
            place: place(rig, &row)?,
            ground_m: [row.number("x_m")?, row.number("y_m")?, row.number("z_m")?],
            sigma_m: row.number("sigma_m")?,
            line: row.line,
        };
        if only.is_none_or(|only| only == point.exposure) {
            measurements.control.push(point);
        }
    }
    if measurements.control.is_empty() {
        let of = only.map_or_else(String::new, |only| format!(" of exposure {only}"));
        return Err(Failure::bad_input(format!(
            "{}: no control point{of}; at least 4 are needed",
            control.display()
        )));
    }
    if let Some(ties) = ties {
        measurements.ties = read_ties(rig, ties, only)?;
    }
    Ok(measurements)
}

fn exposure(row: &Row) -> Result<String, Failure> {
    match row.optional("exposure") {
        Some(_) => row.name("exposure"),
        None => Ok(ONE_EXPOSURE.to_owned()),
    }
}

fn place(rig: &Rig, row: &Row) -> Result<Place, Failure> {
    let image: String = row.name("image")?;
    let number = rig.number(&image).ok_or_else(|| {
        row.failure(format!(
            "image = {image} is no sub-image of the rig; allowed: {}",
            rig.ids()
        ))
    })?;
    Ok(Place {
        sub: number,
        pixel: [row.number("col_px")?, row.number("row_px")?],
    })
}

/// Name and exposure of a tie, and its places with their lines.
type OpenTie = (String, String, Vec<(u64, Place)>);

fn read_ties(rig: &Rig, path: &Path, only: Option<&str>) -> Result<Vec<Tie>, Failure> {
    let table = NamedColumns::read(path, &["id", "image", "col_px", "row_px"])?;
    let mut open: Vec<OpenTie> = Vec::new();
    for row in table.rows() {
        let (id, exposure): (String, String) = (row.name("id")?, exposure(&row)?);
        let place = place(rig, &row)?;
        let sub = rig.sub.get(place.sub);
        if let Some(sub) = sub.filter(|sub| !sub.contains(place.pixel)) {
            return Err(row.failure(format!(
                "tie {id}: col_px,row_px = {}, {} is outside sub-image {}; allowed: -0.5 to {}, -0.5 to {}",
                place.pixel[0],
                place.pixel[1],
                sub.id,
                sub.centre_px()[0] * 2.0 + 0.5,
                sub.centre_px()[1] * 2.0 + 0.5
            )));
        }
        let known = open
            .iter_mut()
            .find(|(one, of, _)| *one == id && *of == exposure);
        let Some((_, _, places)) = known else {
            open.push((id, exposure, vec![(row.line, place)]));
            continue;
        };
        if places.len() >= 2 || places.iter().any(|(_, other)| other.sub == place.sub) {
            return Err(row.failure(format!(
                "tie {id} appears again; a tie is one id in two different images"
            )));
        }
        places.push((row.line, place));
    }
    let mut ties = Vec::new();
    for (id, exposure, places) in open {
        let [(_, first), (_, second)] = places.as_slice() else {
            let line = places.first().map_or(0, |(line, _)| *line);
            return Err(Failure::bad_input(format!(
                "{}, line {line}: tie {id} appears in one image only; a tie is one id in two images",
                path.display()
            )));
        };
        if only.is_none_or(|only| only == exposure) {
            ties.push(Tie {
                id,
                exposure,
                places: [*first, *second],
            });
        }
    }
    Ok(ties)
}

/// Returns the files `ID_NN.tif` of a folder with NN, in its order.
pub(super) fn flat_sets(folder: &Path, id: &str) -> Result<Vec<(u32, PathBuf)>, Failure> {
    let entries = std::fs::read_dir(folder).map_err(|error| Failure::reading(folder, &error))?;
    let mut found: Vec<(u32, PathBuf)> = Vec::new();
    for entry in entries {
        let path = entry
            .map_err(|error| Failure::reading(folder, &error))?
            .path();
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let number = name.as_deref().and_then(|name| {
            let (of, rest) = name.split_once('_')?;
            let number = rest.strip_suffix(".tif")?.parse().ok()?;
            (of == id).then_some(number)
        });
        found.extend(number.map(|number| (number, path)));
    }
    if found.is_empty() {
        return Err(Failure::bad_input(format!(
            "{}: no {id}_NN.tif; every sub-image of the rig needs some",
            folder.display()
        )));
    }
    found.sort();
    Ok(found)
}
