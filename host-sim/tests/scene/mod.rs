//! The physical exposure against the strict solver, ray tracing, the camera's image motion, and
//! estimates by hand.

#[cfg(test)]
mod image_motion;
#[cfg(test)]
mod lens_smear;
#[cfg(test)]
mod ray_traced_truth;
#[cfg(test)]
mod smear_numbers;
#[cfg(test)]
mod stage;
#[cfg(test)]
mod strict;
#[cfg(test)]
mod support;
