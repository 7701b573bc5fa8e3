//! Tests of the program on the PC and its library, in one program so that all share the processor's
//! cores.

#[cfg(test)]
mod command_line;
#[cfg(test)]
mod damaged_files;
#[cfg(test)]
mod firmware;
#[cfg(test)]
mod frame_timing;
#[cfg(test)]
mod mechanics;
#[cfg(test)]
mod mission;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod scene;
#[cfg(test)]
mod strip;
