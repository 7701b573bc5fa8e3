//! Head of a record to be written, and the files of its grids.

use heapless::Vec;

use super::authentication::Authentication;
use super::body::{CARRIERS, Head};
use super::fault::NotStored;
use super::origin::Origin;
use super::probe_point::ProbePoint;
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::grid_memory::{GridMemory, GridMemoryError};
use crate::geometry::grid::GridCarrier;
use crate::io::link::loading::Upload;

/// Origin of a calibration, with what was checked of it.
pub(super) struct SignedOrigin<'a> {
    pub(super) origin: &'a Origin,
    pub(super) authentication: Authentication,
    /// Highest version that the camera will have stored.
    pub(super) highest: u32,
}

/// Returns the files of the grids that parameters state, which have to be in use.
pub(super) fn files_in_use<'a>(
    parameters: &CameraParameters,
    memory: Option<&'a GridMemory>,
) -> Result<[&'a [u8]; 2], NotStored> {
    let mut files: [&[u8]; 2] = [&[]; 2];
    if parameters.grids.is_empty() {
        return Ok(files);
    }
    let memory = memory.ok_or(NotStored::NoGridMemory)?;
    let in_use = memory.in_use();
    for (carrier, place) in CARRIERS.into_iter().zip(&mut files) {
        let Some(crc32) = parameters.grids.of(carrier) else {
            continue;
        };
        let grid = in_use.as_ref().and_then(|grids| match carrier {
            GridCarrier::Lens => grids.lens(),
            GridCarrier::Sensor => grids.sensor(),
        });
        *place = grid
            .filter(|grid| grid.crc32() == crc32)
            .and_then(|_| memory.file_in_use(carrier))
            .ok_or(NotStored::Grids(GridMemoryError::Missing {
                carrier,
                crc32,
            }))?;
    }
    Ok(files)
}

/// Returns the head of a record of a camera with these parameters.
pub(super) fn of(
    camera: &Camera,
    upload: &Upload,
    signed: &SignedOrigin<'_>,
    memory: Option<&GridMemory>,
    files: [&[u8]; 2],
) -> Result<Head, NotStored> {
    let in_use = memory.and_then(GridMemory::in_use);
    let grids = in_use.filter(|_| !camera.grid_checksums().is_empty());
    let [lens_bytes, sensor_bytes] = files.map(|file| u16::try_from(file.len()));
    Ok(Head {
        origin: signed.origin.clone(),
        authentication: signed.authentication,
        highest: signed.highest,
        probe: ProbePoint::of(camera, grids.as_ref()).map_err(NotStored::Frame)?,
        grid_bytes: [
            lens_bytes.map_err(|_| NotStored::TooLong)?,
            sensor_bytes.map_err(|_| NotStored::TooLong)?,
        ],
        camera: Vec::from_slice(upload.bytes()).map_err(|_| NotStored::TooLong)?,
    })
}
