//! Tests of reading and writing frames, as a user of the library would check it.

#[cfg(test)]
mod exiftool;
#[cfg(test)]
mod layouts;
#[cfg(test)]
mod refusals;
#[cfg(test)]
mod system_errors;
#[cfg(test)]
mod tags;
#[cfg(test)]
mod tiff_bytes;
