//! Judgement on what a slot holds.

use embedded_storage::nor_flash::ReadNorFlash;

use super::body::{self, CARRIERS, Head};
use super::commit::Commit;
use super::fault::SlotFault;
use super::slot::Slot;
use crate::flight::calibration_id::SerialNumber;
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::grid_memory::{GridMemory, GridMemoryError};
use crate::geometry::camera_grids::CameraGrids;
use crate::geometry::grid::ResidualGrid;
use crate::io::link::loading;

/// A record that is whole and that this camera can use.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub(super) head: Head,
    pub(super) parameters: CameraParameters,
}

/// Reads the record of a slot whose commit word has been read; its grids, checked, are in the
/// buffers of `memory` that are not in use.
///
/// # Errors
/// [`SlotFault`] with what is wrong.
pub(super) fn record<F: ReadNorFlash>(
    slot: &mut Slot<'_, F>,
    commit: &Commit,
    serial: SerialNumber,
    mut memory: Option<&mut GridMemory>,
) -> Result<Record, SlotFault> {
    let head = body::read(slot, commit, memory.as_deref_mut())?;
    let parameters = loading::parameters(&head.camera).ok_or(SlotFault::Contents)?;
    if !serial.is_empty() && parameters.serial != serial {
        return Err(SlotFault::OtherCamera(parameters.serial));
    }
    let camera = Camera::new(parameters).map_err(SlotFault::Calibration)?;
    for (carrier, bytes) in CARRIERS.into_iter().zip(head.grid_bytes) {
        let memory = memory.as_deref_mut().filter(|_| bytes > 0);
        if let Some(memory) = memory {
            let checked = memory.spare_mut(carrier).check();
            checked.map_err(|error| SlotFault::Grid { carrier, error })?;
        }
    }
    let grids = stated(&camera, memory.as_deref())?;
    let computed = head.probe.computed(&camera, grids.as_ref());
    let computed = computed.map_err(SlotFault::Frame)?;
    let stored = head.probe.bits();
    if computed != stored {
        return Err(SlotFault::ProbePoint { stored, computed });
    }
    Ok(Record { head, parameters })
}

/// Returns the grids that a camera states, from the buffers that are not in use.
fn stated<'a>(
    camera: &Camera,
    memory: Option<&'a GridMemory>,
) -> Result<Option<CameraGrids<'a>>, SlotFault> {
    let stated = camera.grid_checksums();
    let [lens, sensor] = CARRIERS.map(|carrier| {
        let found: Option<ResidualGrid<'a>> = memory.and_then(|memory| memory.spare(carrier));
        match (stated.of(carrier), found) {
            (None, None) => Ok(None),
            (None, Some(_)) => Err(SlotFault::Contents),
            (Some(crc32), Some(grid)) if grid.crc32() == crc32 => Ok(Some(grid)),
            (Some(crc32), _) => Err(SlotFault::Grids(GridMemoryError::Missing {
                carrier,
                crc32,
            })),
        }
    });
    if stated.is_empty() {
        return lens.and(sensor).map(|_| None);
    }
    CameraGrids::new(camera.calibration(), lens?, sensor?)
        .map(Some)
        .map_err(|error| SlotFault::Grids(GridMemoryError::Unfit(error)))
}
