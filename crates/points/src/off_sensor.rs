//! Points that are not on the sensor.

/// Answer to a point that is off the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffSensor {
    /// The polynomial continued, as the library in Rust and in C does; of a point to be distorted,
    /// whose measured place must be on the sensor, NaN.
    Extrapolate,
    /// NaN in both coordinates.
    Nan,
    /// An error, before anything is written.
    Error,
}
