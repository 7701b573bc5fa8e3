//! Virtual images, as a user of the crate composes them.

#[cfg(test)]
mod matching;
#[cfg(test)]
mod mosaic;
#[cfg(test)]
mod radiometry;
#[cfg(test)]
mod rig;
#[cfg(test)]
mod stereo;
