//! A simulated flight with the camera in the loop.
//!
//! Aircraft, sensors, shutter and stage are simulated; what the camera does about them is the
//! camera's own code, in this process or at the end of a link, once per millisecond of simulated
//! time. What it reports of every frame is held against the physical exposure.

pub mod aircraft;
pub mod expectation;
pub mod fault;
pub mod flight_loop;
pub mod flown;
pub mod judgement;
mod light;
mod operator;
pub mod oracle;
mod outcome;
pub mod receiver;
pub mod sensors;
pub mod settings;
pub mod shutter;
mod source;
pub mod trace;
