//! The firmware's image in QEMU. `cargo xtask test` builds the images and names them in
//! `FMC_FIRMWARE` and `FMC_FIRMWARE_WITH_DRILLS`.

#[cfg(test)]
mod camera;
#[cfg(test)]
mod crash;
#[cfg(test)]
mod drills;
#[cfg(test)]
mod fit;
#[cfg(test)]
mod flight;
#[cfg(test)]
mod grids;
#[cfg(test)]
mod mission;
#[cfg(test)]
mod program;
#[cfg(test)]
mod resets;
#[cfg(test)]
#[cfg(unix)]
mod served;
#[cfg(test)]
#[cfg(unix)]
mod store;
#[cfg(test)]
mod wire;
