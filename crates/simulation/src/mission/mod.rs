//! Simulated flight with the camera in the loop.
//!
//! Aircraft, sensors, shutter and stage are simulated. The camera that reacts to them runs its own
//! code, in this process or at the end of a link, once per millisecond of simulated time. Its
//! report of every frame is compared with the physical exposure.

pub mod aircraft;
mod autopilot;
pub mod camera_clock;
pub mod check;
pub mod clock;
pub mod device;
pub mod expectation;
pub mod fault;
pub mod file;
mod file_range;
pub mod flight_loop;
pub mod flown;
pub mod focus_check;
pub mod frame_errors;
mod hardware;
pub mod judgement;
mod lens;
mod light;
mod operator;
pub mod oracle;
mod outcome;
mod physical_truth;
pub mod planned_fault;
pub mod receiver;
pub mod rig_camera;
mod row_clock;
pub mod scenario;
mod scenario_checks;
pub mod sensors;
pub mod settings;
pub mod shutter;
mod sigma_checks;
mod source;
pub(crate) mod spurious_faults;
pub mod trace;
mod tracer;
pub mod wire;
mod wire_load;
mod wires;
mod wiring;
