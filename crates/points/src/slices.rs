//! Points of an array, in the precision that it has.

/// Points that are read.
#[derive(Debug, Clone, Copy)]
pub enum Points<'a> {
    /// In single precision.
    Single(&'a [[f32; 2]]),
    /// In double precision.
    Double(&'a [[f64; 2]]),
}

/// Points that are replaced by their answers.
#[derive(Debug)]
pub enum PointsMut<'a> {
    /// In single precision.
    Single(&'a mut [[f32; 2]]),
    /// In double precision.
    Double(&'a mut [[f64; 2]]),
}

/// Points, and as many places for their answers.
#[derive(Debug)]
pub enum Answers<'a> {
    /// In single precision.
    Single {
        /// The points.
        of: &'a [[f32; 2]],
        /// Places of the answers.
        to: &'a mut [[f32; 2]],
    },
    /// In double precision.
    Double {
        /// The points.
        of: &'a [[f64; 2]],
        /// Places of the answers.
        to: &'a mut [[f64; 2]],
    },
}
