//! `mesh` for the frames of a flight.
