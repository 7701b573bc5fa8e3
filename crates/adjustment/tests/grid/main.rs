//! Residual grids: against known structures and against ray-traced exposures.

#[cfg(test)]
mod calibration;
#[cfg(test)]
mod carrier;
#[cfg(test)]
mod implausible;
#[cfg(test)]
mod ray_traced_truth;
#[cfg(test)]
mod simulated;
#[cfg(test)]
mod structure;
