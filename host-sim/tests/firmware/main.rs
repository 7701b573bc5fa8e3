//! The firmware's image in QEMU. `cargo xtask test` builds the images and names them in `FMC_FIRMWARE` and
//! `FMC_FIRMWARE_WITH_DRILLS`.

#[cfg(test)]
mod accident;
#[cfg(test)]
mod link;
#[cfg(test)]
mod machine;
#[cfg(test)]
mod start;
