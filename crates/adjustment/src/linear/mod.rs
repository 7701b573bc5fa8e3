//! Linear algebra of normal equations: the sparse matrix of the images, bordered by the unknowns
//! that all images share, its Cholesky factor and parts of its inverse.

pub mod bordered_factor;
pub mod bordered_matrix;
pub mod element;
pub mod image_pairs;
pub mod weakest_direction;
