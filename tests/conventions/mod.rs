//! `docs/conventions.md` and `docs/integration.md` against the code: names, ranges, constants and
//! worked examples; the links of the README; and the direction of the dependencies inside the
//! crates.

#[cfg(test)]
mod arrows;
#[cfg(test)]
mod bounds;
#[cfg(test)]
mod camera;
#[cfg(test)]
mod comments;
#[cfg(test)]
mod constants;
#[cfg(test)]
mod document;
#[cfg(test)]
mod examples;
#[cfg(test)]
mod integration;
#[cfg(test)]
mod names;
#[cfg(test)]
mod ranges;
#[cfg(test)]
mod readme;
#[cfg(test)]
mod terms;
