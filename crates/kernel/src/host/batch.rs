//! Correction of many points of one frame.

use rayon::prelude::*;

use super::level::Level;
use super::{distort, pairs, xy};
use crate::inverse::LastStep;
use crate::{Coefficients, Terms};

/// Smallest size in bytes of a set's ideal points from which on they are written past the caches.
///
/// Measured on a Xeon with 2 MiB of second-level cache per core, x and y apart, short form, one
/// thread, ns per point stored and streamed: 0.8 MB 0.29 and 0.53, 1.6 MB 0.54 and 0.55, 4 MB 0.68
/// and 0.60, 80 MB 1.48 and 0.93. Between the size of the second-level cache and this one streaming
/// gains nothing, and code that reads the points next may still find them in a cache.
pub const STREAMED_FROM_BYTES: usize = 4 << 20;

/// Smallest number of points from which on a set is shared out to threads.
///
/// Measured on the same machine with two threads, ns per point in one and in both: 1e5 points 0.29
/// and 0.31, 2e5 points 0.54 and 0.44; waking the second thread takes as long as 1e5 points do.
pub const THREADED_FROM_POINTS: usize = 1 << 18;

/// Number of points that a thread takes at once.
const SHARE: usize = 1 << 15;

/// Correction of many points of one frame.
///
/// Slices of unequal length are processed up to the length of the shortest; the rest of a longer
/// one stays as it is.
#[derive(Debug, Clone, Copy)]
pub struct Batch {
    form: Coefficients,
    terms: Terms,
    level: Level,
    streamed_from_bytes: usize,
    threaded_from_points: usize,
}

impl Batch {
    /// Creates a correction with the widest vectors of this machine, and with threads and streaming
    /// from their measured sizes on.
    #[must_use]
    pub fn new(form: Coefficients, terms: Terms) -> Self {
        Self {
            form,
            terms,
            level: Level::widest(),
            streamed_from_bytes: STREAMED_FROM_BYTES,
            threaded_from_points: THREADED_FROM_POINTS,
        }
    }

    /// Selects other vectors.
    #[must_use]
    pub const fn at(mut self, level: Level) -> Self {
        self.level = level;
        self
    }

    /// Computes in the calling thread alone.
    #[must_use]
    pub const fn in_one_thread(self) -> Self {
        self.threaded_from(usize::MAX)
    }

    /// Uses threads for sets of at least this many points.
    #[must_use]
    pub const fn threaded_from(mut self, points: usize) -> Self {
        self.threaded_from_points = points;
        self
    }

    /// Writes past the caches for sets of at least this many bytes of ideal points.
    #[must_use]
    pub const fn streamed_from(mut self, bytes: usize) -> Self {
        self.streamed_from_bytes = bytes;
        self
    }

    /// Instruction set in use.
    #[must_use]
    pub const fn level(&self) -> Level {
        self.level
    }

    /// Replaces points (x, y), mm, by their ideal points.
    pub fn pairs(&self, points: &mut [[f32; 2]]) {
        if points.len() < self.threaded_from_points {
            self.pairs_here(points);
        } else {
            points
                .par_chunks_mut(SHARE)
                .for_each(|points| self.pairs_here(points));
        }
    }

    fn pairs_here(&self, points: &mut [[f32; 2]]) {
        let form = &self.form;
        match self.terms {
            Terms::Short => self.level.run(pairs::InPlace::<false> { form, points }),
            Terms::Full => self.level.run(pairs::InPlace::<true> { form, points }),
        }
    }

    /// Writes the ideal points of points (x, y), mm, into another slice.
    pub fn pairs_into(&self, points: &[[f32; 2]], ideal: &mut [[f32; 2]]) {
        let count = points.len().min(ideal.len());
        let (points, ideal) = (first(points, count), first_mut(ideal, count));
        let stream = size_of_val(ideal) >= self.streamed_from_bytes;
        if count < self.threaded_from_points {
            self.pairs_into_here(points, ideal, stream);
        } else {
            points
                .par_chunks(SHARE)
                .zip(ideal.par_chunks_mut(SHARE))
                .for_each(|(points, ideal)| self.pairs_into_here(points, ideal, stream));
        }
    }

    fn pairs_into_here(&self, points: &[[f32; 2]], ideal: &mut [[f32; 2]], stream: bool) {
        let form = &self.form;
        match self.terms {
            Terms::Short => self.level.run(pairs::Into::<false> {
                form,
                points,
                ideal,
                stream,
            }),
            Terms::Full => self.level.run(pairs::Into::<true> {
                form,
                points,
                ideal,
                stream,
            }),
        }
    }

    /// Replaces x and y, mm, by those of the ideal points.
    pub fn xy(&self, x: &mut [f32], y: &mut [f32]) {
        let count = x.len().min(y.len());
        let (x, y) = (first_mut(x, count), first_mut(y, count));
        if count < self.threaded_from_points {
            self.xy_here(x, y);
        } else {
            x.par_chunks_mut(SHARE)
                .zip(y.par_chunks_mut(SHARE))
                .for_each(|(x, y)| self.xy_here(x, y));
        }
    }

    fn xy_here(&self, x: &mut [f32], y: &mut [f32]) {
        let form = &self.form;
        match self.terms {
            Terms::Short => self.level.run(xy::InPlace::<false> { form, x, y }),
            Terms::Full => self.level.run(xy::InPlace::<true> { form, x, y }),
        }
    }

    /// Writes the ideal points of x and y, mm, into other slices.
    pub fn xy_into(&self, [x, y]: [&[f32]; 2], [ideal_x, ideal_y]: [&mut [f32]; 2]) {
        let count = [x.len(), y.len(), ideal_x.len(), ideal_y.len()]
            .into_iter()
            .fold(usize::MAX, usize::min);
        let (x, y) = (first(x, count), first(y, count));
        let (ideal_x, ideal_y) = (first_mut(ideal_x, count), first_mut(ideal_y, count));
        let stream = 2 * size_of_val(ideal_x) >= self.streamed_from_bytes;
        if count < self.threaded_from_points {
            self.xy_into_here([x, y], [ideal_x, ideal_y], stream);
        } else {
            x.par_chunks(SHARE)
                .zip(y.par_chunks(SHARE))
                .zip(ideal_x.par_chunks_mut(SHARE))
                .zip(ideal_y.par_chunks_mut(SHARE))
                .for_each(|(((x, y), ideal_x), ideal_y)| {
                    self.xy_into_here([x, y], [ideal_x, ideal_y], stream);
                });
        }
    }

    fn xy_into_here(&self, [x, y]: [&[f32]; 2], [ideal_x, ideal_y]: [&mut [f32]; 2], stream: bool) {
        let form = &self.form;
        match self.terms {
            Terms::Short => self.level.run(xy::Into::<false> {
                form,
                x,
                y,
                ideal_x,
                ideal_y,
                stream,
            }),
            Terms::Full => self.level.run(xy::Into::<true> {
                form,
                x,
                y,
                ideal_x,
                ideal_y,
                stream,
            }),
        }
    }

    /// Writes the ideal points of x and y, mm, and the distortion that was subtracted into other
    /// slices, in the calling thread.
    pub fn xy_with_distortion(
        &self,
        [x, y]: [&[f32]; 2],
        [ideal_x, ideal_y]: [&mut [f32]; 2],
        [dx, dy]: [&mut [f32]; 2],
    ) {
        let form = &self.form;
        let count = [x.len(), y.len(), ideal_x.len(), ideal_y.len()]
            .into_iter()
            .chain([dx.len(), dy.len()])
            .fold(usize::MAX, usize::min);
        let (x, y) = (first(x, count), first(y, count));
        let (ideal_x, ideal_y) = (first_mut(ideal_x, count), first_mut(ideal_y, count));
        let (dx, dy) = (first_mut(dx, count), first_mut(dy, count));
        match self.terms {
            Terms::Short => self.level.run(xy::WithDistortion::<false> {
                form,
                x,
                y,
                ideal: [ideal_x, ideal_y],
                distortion: [dx, dy],
            }),
            Terms::Full => self.level.run(xy::WithDistortion::<true> {
                form,
                x,
                y,
                ideal: [ideal_x, ideal_y],
                distortion: [dx, dy],
            }),
        }
    }

    /// Writes the measured points of ideal x and y, mm, and their distortion, measured - ideal,
    /// into other slices, in the calling thread: [`Coefficients::first_step`], bit for bit. Returns
    /// `true` if that step is the last of every point; x is NaN where it is not.
    #[must_use = "x is NaN where the first step is not the last"]
    pub fn xy_distorted(
        &self,
        last_step: &LastStep,
        [x, y]: [&[f32]; 2],
        [measured_x, measured_y]: [&mut [f32]; 2],
        [dx, dy]: [&mut [f32]; 2],
    ) -> bool {
        let form = &self.form;
        let count = [x.len(), y.len(), measured_x.len(), measured_y.len()]
            .into_iter()
            .chain([dx.len(), dy.len()])
            .fold(usize::MAX, usize::min);
        let ideal = [first(x, count), first(y, count)];
        let measured = [first_mut(measured_x, count), first_mut(measured_y, count)];
        let distortion = [first_mut(dx, count), first_mut(dy, count)];
        let mut all_end = true;
        match self.terms {
            Terms::Short => self.level.run(distort::WithDistortion::<false> {
                form,
                last_step,
                ideal,
                measured,
                distortion,
                all_end: &mut all_end,
            }),
            Terms::Full => self.level.run(distort::WithDistortion::<true> {
                form,
                last_step,
                ideal,
                measured,
                distortion,
                all_end: &mut all_end,
            }),
        }
        all_end
    }
}

/// Returns at most the first `count` elements of a slice.
fn first<T>(of: &[T], count: usize) -> &[T] {
    of.get(..count).unwrap_or(of)
}

/// Returns the elements of [`first`] as mutable.
fn first_mut<T>(of: &mut [T], count: usize) -> &mut [T] {
    let count = count.min(of.len());
    of.split_at_mut(count).0
}
