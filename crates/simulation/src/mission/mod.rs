//! A simulated flight with the camera in the loop.
//!
//! Aircraft, sensors, shutter and stage are simulated; what the camera does about them is the
//! camera's own code, in this process or at the end of a link, once per millisecond of simulated
//! time. What it reports of every frame is held against the physical exposure.

pub mod aircraft;
pub mod clock;
pub mod device;
pub mod expectation;
pub mod fault;
pub mod file;
mod file_range;
pub mod finding;
pub mod flight_loop;
pub mod flown;
pub mod frame_errors;
pub mod judgement;
mod light;
mod operator;
pub mod oracle;
mod outcome;
pub mod planned_fault;
pub mod receiver;
pub mod scenario;
pub mod sensors;
pub mod settings;
pub mod shutter;
mod source;
pub mod trace;
mod tracer;
