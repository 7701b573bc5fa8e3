//! Initial orientation of images and intersection of object points.

pub mod intersection;
pub mod network_orientation;
pub mod resection;
pub mod similarity;
pub mod three_points;
