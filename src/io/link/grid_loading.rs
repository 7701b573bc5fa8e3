//! Residual grids that come over the link in parts, and those in use.

use super::MAX_GRID_PART;
use super::loading::{Announced, number};
use super::message::{Part, Refusal};
use crate::flight::camera::Camera;
use crate::flight::grid_memory::{GridMemory, GridMemoryError};
use crate::geometry::camera_grids::{CameraGrids, CameraGridsError};
use crate::geometry::grid::{GridCarrier, GridError, MAX_FILE_BYTES};

/// The memory for grids, with the grid of which parts have come.
#[derive(Debug)]
pub(super) struct GridLoading {
    /// `None` in a camera without.
    memory: Option<&'static mut GridMemory>,
    announced: Option<(GridCarrier, Announced)>,
}

impl GridLoading {
    /// No memory for grids.
    pub(super) const NONE: Self = Self {
        memory: None,
        announced: None,
    };

    /// Takes the memory for grids.
    pub(super) const fn keep_in(&mut self, memory: &'static mut GridMemory) {
        self.memory = Some(memory);
    }

    /// The memory for grids.
    pub(super) fn memory_mut(&mut self) -> Option<&mut GridMemory> {
        self.memory.as_deref_mut()
    }

    /// Forgets the grid of which parts have come.
    pub(super) fn end(&mut self) {
        if let (Some(memory), Some((carrier, _))) = (&mut self.memory, self.announced.take()) {
            memory.spare_mut(carrier).clear();
        }
    }

    /// Begins the load of a grid of so many bytes; ends another.
    pub(super) fn begin(
        &mut self,
        carrier: GridCarrier,
        length: u32,
        crc: u32,
    ) -> Result<(), Refusal> {
        self.end();
        let memory = self.memory.as_mut().ok_or(Refusal::NoGridMemory)?;
        if length > number(MAX_FILE_BYTES) {
            let bytes = usize::try_from(length).unwrap_or(usize::MAX);
            let error = GridError::TooLong { bytes };
            return Err(Refusal::Grid { carrier, error });
        }
        memory.spare_mut(carrier).clear();
        self.announced = Some((carrier, Announced { length, crc }));
        Ok(())
    }

    /// Takes the next part.
    pub(super) fn add(&mut self, part: &Part<MAX_GRID_PART>) -> Result<GridProgress, Refusal> {
        let (carrier, announced) = self.announced.ok_or(Refusal::NoLoad)?;
        let memory = self.memory.as_mut().ok_or(Refusal::NoGridMemory)?;
        let buffer = memory.spare_mut(carrier);
        let is_last = announced.is_last(part, buffer.bytes().len())?;
        let refused = |error| Refusal::Grid { carrier, error };
        buffer.add(&part.bytes).map_err(refused)?;
        if !is_last {
            return Ok(GridProgress::Bytes(number(buffer.bytes().len())));
        }
        let checked = buffer.check().map_err(refused).and_then(|computed| {
            if computed != announced.crc {
                return Err(Refusal::LoadCrc { computed });
            }
            match buffer.grid() {
                Some(grid) if grid.header().carrier == carrier => Ok(()),
                _ => {
                    let given_as = carrier;
                    let other = CameraGridsError::Carrier { given_as };
                    Err(Refusal::Grids(GridMemoryError::Unfit(other)))
                }
            }
        });
        if checked.is_err() {
            buffer.clear();
        }
        self.announced = None;
        checked.map(|()| GridProgress::Loaded(carrier))
    }

    /// Puts the grids that a camera states into use, or none, and returns it with their bounds.
    pub(super) fn put_into_use(&mut self, camera: Camera) -> Result<Camera, Refusal> {
        match &mut self.memory {
            Some(memory) => {
                memory.put_into_use(&camera).map_err(Refusal::Grids)?;
                Ok(match memory.in_use() {
                    Some(grids) => camera.bounded_by(&grids),
                    None => camera,
                })
            }
            None if camera.grid_checksums().is_empty() => Ok(camera),
            None => Err(Refusal::NoGridMemory),
        }
    }

    /// The grids of the camera in use; `None` if it has none.
    pub(super) fn in_use(&self) -> Option<CameraGrids<'_>> {
        self.memory.as_ref()?.in_use()
    }
}

/// State of a load after a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GridProgress {
    /// So many bytes have come.
    Bytes(u32),
    /// The grid is complete and sound.
    Loaded(GridCarrier),
}
