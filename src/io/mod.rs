//! What crosses the camera's boundary.

#[cfg(feature = "link")]
pub mod link;
#[cfg(feature = "mavlink")]
pub mod mavlink;
#[cfg(feature = "nmea")]
pub mod nmea;
