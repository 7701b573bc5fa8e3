//! Calibrations against published answers and simulated cameras of known truth.

#[cfg(test)]
mod angles;
#[cfg(test)]
mod dlt2d;
#[cfg(test)]
mod dlt2d_interpolation;
#[cfg(test)]
mod dlt2d_refused;
#[cfg(test)]
mod dlt3d;
#[cfg(test)]
mod dlt3d_refused;
#[cfg(test)]
mod field_angles;
#[cfg(test)]
mod held_grids;
#[cfg(test)]
mod noise;
#[cfg(test)]
mod plane;
#[cfg(test)]
mod scene;
