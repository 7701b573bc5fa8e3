//! Judgement on what a slot holds.

use embedded_storage::nor_flash::ReadNorFlash;

use super::authentication::SignatureVerifier;
use super::body::{self, CARRIERS, Head};
use super::commit::Commit;
use super::fault::SlotFault;
use super::slot::Slot;
use super::statement::Statement;
use crate::flight::calibration_id::SerialNumber;
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::grid_memory::{GridMemory, GridMemoryError};
use crate::geometry::camera_grids::CameraGrids;
use crate::geometry::grid::ResidualGrid;
use crate::io::link::loading;

/// A record that is whole, of this camera, and signed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub(super) head: Head,
    pub(super) parameters: CameraParameters,
}

/// The camera that reads a record.
#[derive(Debug)]
pub(super) struct Reader<V> {
    /// Its serial number; empty if it knows none.
    pub(super) serial: SerialNumber,
    /// Key by which it knows signatures.
    pub(super) key: Option<V>,
}

impl<V: SignatureVerifier> Reader<V> {
    /// Reads the record of a slot whose commit word has been read, and checks its signature; its
    /// grids are in the buffers of `memory` that are not in use.
    ///
    /// # Errors
    /// [`SlotFault`] with what is wrong.
    pub(super) fn read<F: ReadNorFlash>(
        &self,
        slot: &mut Slot<'_, F>,
        commit: &Commit,
        mut memory: Option<&mut GridMemory>,
    ) -> Result<Record, SlotFault> {
        let head = body::read(slot, commit, memory.as_deref_mut())?;
        let parameters = loading::parameters(&head.camera).ok_or(SlotFault::Contents)?;
        if !self.serial.is_empty() && parameters.serial != self.serial {
            return Err(SlotFault::OtherCamera(parameters.serial));
        }
        let key = self.key.as_ref().ok_or(SlotFault::NoKey)?;
        if is_signed(&head, key, memory.as_deref()) {
            Ok(Record { head, parameters })
        } else {
            Err(SlotFault::WrongSignature)
        }
    }
}

/// Returns `true` if the signature of a record is that of a key. It needs more stack than all
/// other steps, which is free again when it returns.
#[inline(never)]
fn is_signed(head: &Head, key: &impl SignatureVerifier, memory: Option<&GridMemory>) -> bool {
    // The whole of both files has come, or there are none.
    let files =
        CARRIERS.map(|carrier| memory.map_or(&[][..], |memory| memory.spare_bytes(carrier)));
    let authentication = &head.authentication;
    let permission = authentication.permission;
    Statement::of_bytes(&head.camera, &head.origin, permission, files)
        .is_some_and(|statement| key.verifies(&statement.pieces(), &authentication.signature))
}

impl Record {
    /// Checks that the camera can use the record: that the grids in the buffers of `memory` are
    /// sound and its own, and that its probe point has the stored bits.
    ///
    /// # Errors
    /// [`SlotFault`] with what is wrong.
    pub(super) fn check(&self, mut memory: Option<&mut GridMemory>) -> Result<(), SlotFault> {
        let Self { head, parameters } = self;
        let camera = Camera::new(*parameters).map_err(SlotFault::Calibration)?;
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
        if computed == stored {
            Ok(())
        } else {
            Err(SlotFault::ProbePoint { stored, computed })
        }
    }
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
