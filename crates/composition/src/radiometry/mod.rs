//! Radiometry of the sub-images: offset and gain of every pixel, falloff of the lens, defects.

mod correction;
mod falloff;
mod figures;
mod flats;
mod response;

pub use correction::{Correction, GAIN_UNIT, OFFSET_UNIT, OFFSET_ZERO};
pub use falloff::Falloff;
pub use figures::{DetectorFigures, Linearity};
pub use flats::{Levels, SATURATION_DN, SampleRows, levels};
pub use response::{Method, Response, correction, response};
