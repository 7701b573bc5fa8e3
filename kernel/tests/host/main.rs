//! The kernel of a PC gives the bits of the portable one, whatever vectors, threads and stores it takes.

#[cfg(test)]
mod call;
#[cfg(test)]
mod corners;
#[cfg(test)]
mod places;
#[cfg(test)]
mod random;
