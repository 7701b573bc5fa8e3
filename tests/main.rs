//! Tests of the library as its users see it, in one program, so that all of them share the
//! processor's cores.

#[cfg(all(test, feature = "mavlink", feature = "nmea"))]
mod aircraft;
#[cfg(test)]
mod controller;
#[cfg(all(test, feature = "estimation"))]
mod conventions;
#[cfg(all(
    test,
    any(feature = "link", all(feature = "mavlink", feature = "nmea"))
))]
#[path = "../fuzz/corpus.rs"]
mod corpus;
#[cfg(test)]
mod drive;
#[cfg(all(test, feature = "estimation"))]
mod estimation;
#[cfg(all(test, feature = "estimation"))]
mod examples;
#[cfg(test)]
mod geometry;
#[cfg(all(test, feature = "link"))]
mod link;
#[cfg(test)]
mod stage;
#[cfg(all(test, feature = "store"))]
mod store;
