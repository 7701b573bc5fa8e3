//! Memory of the camera for residual grids: those in use, and others that come while they are.

use core::fmt;

use heapless::Vec;

use super::camera::Camera;
use crate::geometry::camera_grids::{CameraGrids, CameraGridsError, GridsFit};
use crate::geometry::grid::{GridBuffer, GridCarrier, ResidualGrid};

/// Memory for the residual grids of one camera and for those of the next: 66 kB, two buffers for
/// the grid of either part.
///
/// A grid in use stays where it is until a camera with another is put into use, so that a load that
/// is cut changes nothing.
#[derive(Debug)]
pub struct GridMemory {
    lens: BufferPair,
    sensor: BufferPair,
    /// Empty while a camera without grids is in use, or none. An empty vector is all zeros, as the
    /// whole memory is before the first grid.
    in_use: Vec<InUse, 1>,
}

/// Grids in use.
#[derive(Debug, Clone, Copy)]
struct InUse {
    lens: Option<Place>,
    sensor: Option<Place>,
    fit: GridsFit,
}

/// Place of a grid in its pair of buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    First,
    Second,
}

/// The two buffers of a part.
#[derive(Debug)]
struct BufferPair {
    first: GridBuffer,
    second: GridBuffer,
}

/// The grids that a camera states cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GridMemoryError {
    /// The memory has no such grid.
    Missing {
        /// Part of the grid.
        carrier: GridCarrier,
        /// CRC-32 with which its file ends.
        crc32: u32,
    },
    /// The grids do not fit the camera.
    Unfit(CameraGridsError),
}

impl GridMemory {
    /// A memory without grids.
    pub const EMPTY: Self = Self {
        lens: BufferPair::EMPTY,
        sensor: BufferPair::EMPTY,
        in_use: Vec::new(),
    };

    /// Buffer for the next grid of a part: the one that is not in use.
    pub fn spare_mut(&mut self, carrier: GridCarrier) -> &mut GridBuffer {
        let in_use = self.in_use.first();
        let (pair, used) = match carrier {
            GridCarrier::Lens => (&mut self.lens, in_use.and_then(|grids| grids.lens)),
            GridCarrier::Sensor => (&mut self.sensor, in_use.and_then(|grids| grids.sensor)),
        };
        match used {
            Some(Place::First) => &mut pair.second,
            Some(Place::Second) | None => &mut pair.first,
        }
    }

    /// The grid of a part that is whole and not in use: the one in the buffer of
    /// [`Self::spare_mut`]; `None` unless it has been checked.
    #[must_use]
    pub fn spare(&self, carrier: GridCarrier) -> Option<ResidualGrid<'_>> {
        let (pair, used) = self.pair(carrier);
        pair.grid(match used {
            Some(Place::First) => Place::Second,
            Some(Place::Second) | None => Place::First,
        })
    }

    /// Bytes in the buffers of [`Self::spare_mut`], checked or not.
    #[cfg(feature = "store")]
    pub(crate) fn spare_bytes(&self, carrier: GridCarrier) -> &[u8] {
        let (pair, used) = self.pair(carrier);
        match used {
            Some(Place::First) => pair.second.bytes(),
            Some(Place::Second) | None => pair.first.bytes(),
        }
    }

    /// File of the grid of a part that is in use; `None` while there is none.
    #[must_use]
    pub fn file_in_use(&self, carrier: GridCarrier) -> Option<&[u8]> {
        let (pair, used) = self.pair(carrier);
        Some(match used? {
            Place::First => pair.first.bytes(),
            Place::Second => pair.second.bytes(),
        })
    }

    /// Buffers of a part, and which of them is in use.
    fn pair(&self, carrier: GridCarrier) -> (&BufferPair, Option<Place>) {
        let in_use = self.in_use.first();
        match carrier {
            GridCarrier::Lens => (&self.lens, in_use.and_then(|grids| grids.lens)),
            GridCarrier::Sensor => (&self.sensor, in_use.and_then(|grids| grids.sensor)),
        }
    }

    /// Puts the grids that a camera states into use, or none.
    ///
    /// # Errors
    /// [`GridMemoryError`] for a grid that has not come, and for grids that do not fit the camera;
    /// those before stay in use then.
    pub fn put_into_use(&mut self, camera: &Camera) -> Result<(), GridMemoryError> {
        let stated = camera.grid_checksums();
        if stated.is_empty() {
            self.in_use.clear();
            return Ok(());
        }
        let find = |carrier: GridCarrier, pair: &BufferPair| {
            let find = |crc32| {
                let missing = GridMemoryError::Missing { carrier, crc32 };
                pair.holding(crc32).ok_or(missing)
            };
            stated.of(carrier).map(find).transpose()
        };
        let lens = find(GridCarrier::Lens, &self.lens)?;
        let sensor = find(GridCarrier::Sensor, &self.sensor)?;
        let grids = CameraGrids::new(
            camera.calibration(),
            lens.and_then(|place| self.lens.grid(place)),
            sensor.and_then(|place| self.sensor.grid(place)),
        )
        .map_err(GridMemoryError::Unfit)?;
        let fit = *grids.fit();
        self.in_use.clear();
        // There is room for one.
        let _ = self.in_use.push(InUse { lens, sensor, fit });
        Ok(())
    }

    /// The grids in use; `None` while a camera without grids is in use, or none.
    #[must_use]
    pub fn in_use(&self) -> Option<CameraGrids<'_>> {
        let InUse { lens, sensor, fit } = *self.in_use.first()?;
        Some(CameraGrids::fitting(
            lens.and_then(|place| self.lens.grid(place)),
            sensor.and_then(|place| self.sensor.grid(place)),
            fit,
        ))
    }
}

impl BufferPair {
    const EMPTY: Self = Self {
        first: GridBuffer::EMPTY,
        second: GridBuffer::EMPTY,
    };

    /// Returns the place of the grid with a CRC-32; `None` if there is none.
    fn holding(&self, crc32: u32) -> Option<Place> {
        if self.first.crc32() == Some(crc32) {
            Some(Place::First)
        } else if self.second.crc32() == Some(crc32) {
            Some(Place::Second)
        } else {
            None
        }
    }

    fn grid(&self, place: Place) -> Option<ResidualGrid<'_>> {
        match place {
            Place::First => self.first.grid(),
            Place::Second => self.second.grid(),
        }
    }
}

impl fmt::Display for GridMemoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing { carrier, crc32 } => write!(
                f,
                "the residual grid of the {carrier} with CRC-32 {crc32:08x} has not been loaded"
            ),
            Self::Unfit(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for GridMemoryError {}

#[cfg(test)]
mod tests {
    use super::GridMemory;

    #[test]
    fn memory_is_as_large_as_stated() {
        // In whole kilobytes, rounded.
        assert_eq!((size_of::<GridMemory>() + 500) / 1000, 66);
    }
}
