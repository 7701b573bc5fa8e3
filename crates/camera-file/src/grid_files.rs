//! Residual grids of a camera file: the files that its `[grid]` names, read and checked.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::{CameraGrids, CameraGridsError};
use fmc_camera::geometry::grid::{GridCarrier, GridError, MAX_FILE_BYTES, ResidualGrid};

use crate::input_error::InputError;
use crate::tables::{self, GridTable};
use crate::toml_text::TomlText;

/// Bytes of the largest grid, with one more by which a longer file shows.
const LONGEST: u64 = MAX_FILE_BYTES as u64 + 1;

/// Files of a camera's residual grids, which borrow their coefficients from them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct GridFiles {
    lens: Option<Vec<u8>>,
    sensor: Option<Vec<u8>>,
}

/// Residual grids that a camera cannot use.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridRefusal {
    /// The file of a grid is none, or damaged.
    #[error("{error}")]
    File {
        /// Part as whose grid the file is given.
        carrier: GridCarrier,
        /// The fault.
        error: GridError,
    },
    /// The grids do not fit the camera.
    #[error("{0}")]
    Camera(CameraGridsError),
}

impl GridFiles {
    /// Takes the bytes of grids.
    #[must_use]
    pub const fn new(lens: Option<Vec<u8>>, sensor: Option<Vec<u8>>) -> Self {
        Self { lens, sensor }
    }

    /// Returns true for a camera without residual grids.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.lens.is_none() && self.sensor.is_none()
    }

    /// Bytes of the grid of a part.
    #[must_use]
    pub fn bytes(&self, carrier: GridCarrier) -> Option<&[u8]> {
        match carrier {
            GridCarrier::Lens => self.lens.as_deref(),
            GridCarrier::Sensor => self.sensor.as_deref(),
        }
    }

    /// Returns the grids for the camera of a calibration.
    ///
    /// # Errors
    /// [`GridRefusal`] for a damaged file and for grids that do not fit the camera; not for those
    /// that [`CameraFile::read_with_grids`](crate::CameraFile::read_with_grids) has returned with
    /// it.
    pub fn grids(&self, calibration: &Calibration) -> Result<CameraGrids<'_>, GridRefusal> {
        let grid = |carrier| {
            self.bytes(carrier)
                .map(ResidualGrid::parse)
                .transpose()
                .map_err(|error| GridRefusal::File { carrier, error })
        };
        let (lens, sensor) = (grid(GridCarrier::Lens)?, grid(GridCarrier::Sensor)?);
        CameraGrids::new(calibration, lens, sensor).map_err(GridRefusal::Camera)
    }

    /// Reads the files that a camera file names with `read`.
    pub(crate) fn read(
        text: &TomlText,
        table: &GridTable,
        read: &dyn Fn(&str) -> Result<Vec<u8>, InputError>,
        calibration: &Calibration,
    ) -> Result<Self, InputError> {
        let lens = read_one(text, "lens", read, (&table.lens, &table.lens_crc32))?;
        let sensor = read_one(text, "sensor", read, (&table.sensor, &table.sensor_crc32))?;
        let files = Self { lens, sensor };
        let refused = files.grids(calibration).err();
        refused.map_or(Ok(files), |refusal| Err(invalid(text, &refusal)))
    }
}

/// Creates the error of grids at their place in the camera file.
fn invalid(text: &TomlText, refusal: &GridRefusal) -> InputError {
    let key = |carrier| match carrier {
        GridCarrier::Lens => "lens",
        GridCarrier::Sensor => "sensor",
    };
    match refusal {
        GridRefusal::File { carrier, .. }
        | GridRefusal::Camera(
            CameraGridsError::Carrier { given_as: carrier }
            | CameraGridsError::Grid { carrier, .. },
        ) => text.invalid(&["grid", key(*carrier)], &format!("({refusal})")),
        GridRefusal::Camera(_) => text.invalid_table("grid", &refusal.to_string()),
    }
}

/// Reads the file of a grid in a folder.
pub(crate) fn read_from(folder: &Path, name: &str) -> Result<Vec<u8>, InputError> {
    let path = folder.join(name);
    let mut bytes = Vec::new();
    File::open(&path)
        .and_then(|file| file.take(LONGEST).read_to_end(&mut bytes))
        .map_err(|error| InputError::reading(&path, &error))?;
    Ok(bytes)
}

/// Reads the file of a grid whose name and CRC are given.
fn read_one(
    text: &TomlText,
    key: &str,
    read: &dyn Fn(&str) -> Result<Vec<u8>, InputError>,
    (name, crc32): (&Option<String>, &Option<String>),
) -> Result<Option<Vec<u8>>, InputError> {
    let crc_key = format!("{key}_crc32");
    let (name, crc32) = match (name, crc32) {
        (Some(name), Some(crc32)) => (name, crc32),
        (None, None) => return Ok(None),
        (Some(_), None) => {
            return Err(text.invalid(
                &["grid", key],
                &format!(
                    "has no {crc_key}: the CRC-32 at the end of that file, eight hexadecimal digits"
                ),
            ));
        }
        (None, Some(_)) => {
            return Err(text.invalid(
                &["grid", &crc_key],
                &format!("is of no file: {key} is missing"),
            ));
        }
    };
    let stated = tables::crc32(crc32).ok_or_else(|| {
        text.invalid(
            &["grid", &crc_key],
            "is no CRC-32; allowed: eight hexadecimal digits",
        )
    })?;
    let bytes = read(name)?;
    let stored = bytes.last_chunk().map(|crc| u32::from_le_bytes(*crc));
    if ResidualGrid::parse(&bytes).is_ok()
        && let Some(stored) = stored
        && stored != stated
    {
        return Err(text.invalid(
            &["grid", &crc_key],
            &format!("is not that of {name}, which ends with {stored:08x}: it is the grid of another calibration"),
        ));
    }
    Ok(Some(bytes))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use fmc_camera::SensorPoint;
    use fmc_camera::geometry::grid::GridHeader;

    use super::*;
    use crate::CameraFile;

    const CAMERA: &str = "name = \"A\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 2000\nheight_px = 1000\npixel_um = 10.0\n[fmc]\nstroke_mm = 4.0\n";

    /// Folder of a camera file, which is removed at the end.
    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    impl Folder {
        fn new(name: &str) -> Self {
            let folder =
                std::env::temp_dir().join(format!("fmc-grid-{name}-{}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn read(&self, table: &str) -> Result<GridFiles, String> {
            let path = self.0.join("a.toml");
            fs::write(&path, format!("{CAMERA}[grid]\n{table}\n")).unwrap();
            let refused = CameraFile::read(&path).unwrap_err().to_string();
            assert!(
                refused.contains("line 9: [grid]: residual grids are not used here"),
                "{refused}"
            );
            CameraFile::read_with_grids(&path)
                .map(|(_, _, grids)| grids)
                .map_err(|error| error.to_string())
        }

        fn refused(&self, table: &str, words: &[&str]) {
            let message = self.read(table).unwrap_err();
            for word in words {
                assert!(message.contains(word), "{word}: {message}");
            }
        }
    }

    /// Returns a grid of four by four nodes whose cell covers ±15 mm.
    fn grid(carrier: GridCarrier, amplitude: i16, pitch_mm: f32) -> (Vec<u8>, String) {
        let header = GridHeader {
            carrier,
            columns: 4,
            rows: 4,
            first_node: SensorPoint::new(-1.5 * pitch_mm, -1.5 * pitch_mm),
            pitch_mm,
            scale_mm: 1e-4,
        };
        let mut bytes = header.to_bytes().to_vec();
        for node in 0..16_i16 {
            let value = if node % 2 == 0 { amplitude } else { -amplitude };
            bytes.extend([value.to_le_bytes(), value.to_le_bytes()].concat());
        }
        let crc = GridHeader::checksum(&bytes);
        bytes.extend(crc.to_le_bytes());
        (bytes, format!("{crc:08x}"))
    }

    #[test]
    fn grids_of_both_parts_are_read() {
        let folder = Folder::new("both");
        let (lens, lens_crc) = grid(GridCarrier::Lens, 5, 30.0);
        let (sensor, sensor_crc) = grid(GridCarrier::Sensor, -7, 25.0);
        fs::write(folder.0.join("l.fmcg"), &lens).unwrap();
        fs::create_dir_all(folder.0.join("grids")).unwrap();
        fs::write(folder.0.join("grids/s.fmcg"), &sensor).unwrap();
        let found = folder
            .read(&format!("lens = \"l.fmcg\"\nlens_crc32 = \"{lens_crc}\"\nsensor = \"grids/s.fmcg\"\nsensor_crc32 = \"{sensor_crc}\""))
            .unwrap();
        assert_eq!(found, GridFiles::new(Some(lens), Some(sensor)));
        assert!(folder.read("").unwrap().is_empty());
    }

    #[test]
    fn bad_grids_are_refused_by_key() {
        let folder = Folder::new("bad");
        let put = |name: &str, bytes: &[u8]| fs::write(folder.0.join(name), bytes).unwrap();
        let (good, crc) = grid(GridCarrier::Lens, 5, 30.0);
        put("good.fmcg", &good);
        let lens = |name: &str, crc: &str| format!("lens = \"{name}\"\nlens_crc32 = \"{crc}\"");
        assert!(folder.read(&lens("good.fmcg", &crc)).is_ok());
        folder.refused(
            "lens = \"good.fmcg\"",
            &["line 10: grid.lens = \"good.fmcg\" has no lens_crc32"],
        );
        folder.refused(
            "sensor_crc32 = \"00000000\"",
            &["grid.sensor_crc32", "sensor is missing"],
        );
        folder.refused(
            &lens("good.fmcg", "xyz"),
            &[
                "line 11: grid.lens_crc32 = \"xyz\"",
                "eight hexadecimal digits",
            ],
        );
        folder.refused(
            &lens("good.fmcg", "00000000"),
            &["is not that of good.fmcg", &crc],
        );
        folder.refused(&lens("none.fmcg", &crc), &["none.fmcg: cannot be read"]);
        let mut cut = good.clone();
        cut.truncate(60);
        put("cut.fmcg", &cut);
        folder.refused(
            &lens("cut.fmcg", &crc),
            &["line 10: grid.lens = \"cut.fmcg\"", "60 bytes"],
        );
        let mut damaged = good.clone();
        damaged[40] ^= 4;
        put("damaged.fmcg", &damaged);
        folder.refused(&lens("damaged.fmcg", &crc), &["grid.lens", "damaged", &crc]);
        put("long.fmcg", &vec![b'F'; 100_000]);
        folder.refused(&lens("long.fmcg", &crc), &["grid.lens", "begins with FMCG"]);
        let (other, crc) = grid(GridCarrier::Sensor, 5, 30.0);
        put("other.fmcg", &other);
        folder.refused(
            &lens("other.fmcg", &crc),
            &["grid.lens", "its file says sensor"],
        );
        let (small, crc) = grid(GridCarrier::Lens, 5, 18.0);
        put("small.fmcg", &small);
        folder.refused(
            &lens("small.fmcg", &crc),
            &["grid.lens", "(-9, -9) to (9, 9) mm", "(-10, -7)"],
        );
        let (steep, crc) = grid(GridCarrier::Lens, 30_000, 30.0);
        put("steep.fmcg", &steep);
        folder.refused(&lens("steep.fmcg", &crc), &["[grid]", "slope"]);
    }
}
