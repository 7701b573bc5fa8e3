//! Vertices of a row of sources that are solved one by one.

use super::row_store::RowStore;
use super::source_mesh::ideal;
use super::vertex::{MeshError, VertexRow};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::inverse::DistortError;
use crate::geometry::sensor::{Sensor, SensorPoint};

impl VertexRow {
    /// Fills a slice with vertices from `first` on, each with the source that `source` finds.
    pub(super) fn fill_singly<S: RowStore>(
        &self,
        sensor: &Sensor,
        store: &S,
        mut source: impl FnMut(SensorPoint) -> Result<Displacement, DistortError>,
        (first, words): (u16, &mut [S::Word]),
    ) -> Result<(), MeshError> {
        // In this order no number is taken behind that of the last vertex.
        for (word, index) in words.iter_mut().zip(first..) {
            let place = self.place(sensor, index)?;
            let d = source(ideal(sensor, place)).map_err(|error| {
                let [col_px, row_px] = place;
                MeshError::Distort {
                    col_px,
                    row_px,
                    error,
                }
            })?;
            *word = store
                .single(self.counted_from_origin(place), d, sensor.pixel_mm())
                .map_err(MeshError::Format)?;
        }
        Ok(())
    }
}
