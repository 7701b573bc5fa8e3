//! Tests of the geometry, through its public interface.

#[cfg(test)]
mod accuracy;
#[cfg(test)]
mod axes;
#[cfg(test)]
mod camera_grids;
#[cfg(test)]
mod cameras;
#[cfg(test)]
mod golden;
#[cfg(test)]
mod grid;
#[cfg(test)]
mod gridded;
#[cfg(test)]
mod inverse;
#[cfg(test)]
mod jacobian;
#[cfg(test)]
mod mesh;
#[cfg(test)]
mod mesh_format;
#[cfg(test)]
mod mesh_rounding;
#[cfg(test)]
mod pixel_correction;
#[cfg(test)]
mod pixel_correction_row;
#[cfg(test)]
mod point_kernel;
#[cfg(test)]
mod round_trip;
#[cfg(test)]
mod source_mesh;
#[cfg(test)]
mod source_rounding;
#[cfg(test)]
mod source_row;
#[cfg(test)]
mod source_words;
#[cfg(test)]
pub(crate) mod spline;
