//! The kernel of a PC gives the bits of the portable one, whatever vectors, threads and stores it takes.

mod call;
mod corners;
mod places;
mod random;
