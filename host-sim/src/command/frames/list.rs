//! `frame` for the frames of a flight.
