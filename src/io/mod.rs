//! Inputs and outputs of the camera: the link, the store, and messages of other instruments.

#[cfg(all(feature = "mavlink", feature = "nmea"))]
pub mod instruments;
#[cfg(feature = "link")]
pub mod link;
#[cfg(feature = "mavlink")]
pub mod mavlink;
#[cfg(feature = "nmea")]
pub mod nmea;
#[cfg(feature = "link")]
pub mod store;
