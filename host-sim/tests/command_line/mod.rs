//! Tests of the command line, as users and scripts call it.

#[cfg(test)]
mod accepted;
#[cfg(test)]
mod bad_camera;
#[cfg(test)]
mod bad_points;
#[cfg(test)]
mod bad_request;
#[cfg(test)]
mod block;
#[cfg(test)]
#[cfg(unix)]
mod bring_up;
#[cfg(test)]
mod budget;
#[cfg(test)]
mod calibrate_angles;
#[cfg(test)]
mod calibrate_dlt;
#[cfg(test)]
mod calibrate_five;
#[cfg(test)]
mod calibrate_five_refused;
#[cfg(test)]
mod calibrate_grid;
#[cfg(test)]
mod calibrate_hand_over;
#[cfg(test)]
mod calibrate_held_grids;
#[cfg(test)]
mod calibrate_network;
#[cfg(test)]
mod calibrate_records;
#[cfg(test)]
mod calibration_files;
#[cfg(test)]
#[cfg(unix)]
mod camera;
#[cfg(test)]
mod camera_file;
#[cfg(test)]
#[cfg(unix)]
mod camera_store;
#[cfg(test)]
mod campaign;
mod certificate;
#[cfg(test)]
mod composition;
#[cfg(test)]
mod default_limits;
#[cfg(test)]
mod documents;
#[cfg(test)]
#[cfg(target_os = "linux")]
mod error_stream;
#[cfg(test)]
mod exchange;
mod export_frames;
#[cfg(test)]
#[cfg(unix)]
mod fake_camera;
#[cfg(test)]
#[cfg(unix)]
mod fake_qemu;
#[cfg(test)]
mod flight_block;
#[cfg(test)]
#[cfg(unix)]
mod following;
#[cfg(test)]
mod frames;
#[cfg(test)]
mod gpu_mesh;
#[cfg(test)]
mod gridded_camera;
#[cfg(test)]
mod images;
#[cfg(test)]
mod import_grid;
#[cfg(test)]
#[cfg(target_os = "linux")]
mod interrupted;
#[cfg(test)]
mod lens_with_grids;
#[cfg(test)]
mod mesh;
#[cfg(test)]
mod mission;
#[cfg(test)]
mod mission_grids;
#[cfg(test)]
mod mission_refused;
#[cfg(test)]
mod npy;
#[cfg(test)]
mod observations;
#[cfg(test)]
mod output;
#[cfg(test)]
#[cfg(unix)]
mod progress;
#[cfg(test)]
#[cfg(unix)]
mod qemu;
#[cfg(test)]
#[cfg(unix)]
mod records;
#[cfg(test)]
mod rectify;
#[cfg(test)]
#[cfg(unix)]
mod serial;
#[cfg(test)]
#[cfg(unix)]
mod serve;
#[cfg(test)]
mod sign;
#[cfg(test)]
#[cfg(unix)]
pub(crate) mod signals;
mod smear;
#[cfg(test)]
mod start;
mod statistics;
#[cfg(test)]
mod streaming;
#[cfg(test)]
mod strip;
#[cfg(test)]
mod support;
#[cfg(test)]
mod sweep;
#[cfg(test)]
mod table_width;
#[cfg(test)]
#[cfg(unix)]
mod tcp;
#[cfg(test)]
#[cfg(unix)]
mod terminal;
#[cfg(test)]
mod verify;
#[cfg(test)]
mod vh;
#[cfg(test)]
mod wave_grid;
#[cfg(test)]
#[cfg(unix)]
#[path = "../../../fuzz/wire_format.rs"]
#[allow(dead_code, reason = "one of its functions is enough here")]
mod wire_format;
