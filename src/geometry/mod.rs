//! The geometry of one exposure: pure numbers, no time of day, no I/O.
//!
//! Conventions (`docs/conventions.md`): sensor frame in millimetres, x right, y up, origin at the
//! centre of the pixel array; distortion is *measured - ideal*, a function of the measured point.

pub mod brown;
pub mod calibration;
pub mod camera_grids;
pub mod estimation;
pub mod evaluation_form;
pub mod exposure_distortion;
pub mod five_coefficient;
pub mod focus_table;
pub mod frame_correction;
pub mod grid;
pub mod gridded_correction;
mod gridded_inverse;
mod hypotenuse;
pub mod image_motion;
pub(crate) mod interval;
pub mod inverse;
pub mod invertibility;
pub mod left_out_terms;
pub mod lens_grid_bounds;
pub mod mesh;
pub mod moments;
pub mod newton_step;
mod planar_flow;
pub mod point_kernel;
pub mod principal_distance;
pub mod principal_point;
pub mod range;
pub mod sensor;
pub mod shutter;
pub mod tdi;
