//! The camera and the strict solver against published numbers, theory and ray tracing.

#[cfg(test)]
mod budget;
#[cfg(test)]
mod moment_terms;
#[cfg(test)]
mod paper_numbers;
#[cfg(test)]
mod published_cameras;
#[cfg(test)]
mod ray_traced_truth;
mod run_up;
#[cfg(test)]
mod support;
#[cfg(test)]
mod sweep;
#[cfg(test)]
mod tdi;
#[cfg(test)]
mod usgs_tables;
