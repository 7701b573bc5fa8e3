//! Correction of the points of many frames that lie behind each other in one slice.
//!
//! Called for one frame after the other, [`super::pairs`] stores the ends of each in the ordinary
//! way, and waits for their lines of the cache, which the streams of both neighbours then drop.
//! Here a line that two frames share is put together first, and streamed as every other.

use core::mem;

use super::form::Form;
use super::level::Level;
use super::pairs::{before, few, pass, put_few, replace, twos, twos_mut};
use super::vectors::{Vectors, Work};
use super::{STREAMED_FROM_BYTES, head};
use crate::{Coefficients, Terms};

/// Numbers of two vectors of the widest instruction set.
const WIDEST: usize = 32;

/// Points of one frame, behind each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Coefficients of the frame.
    pub form: Coefficients,
    /// Terms of its correction.
    pub terms: Terms,
    /// Number of points.
    pub points: usize,
}

/// Correction of the points of many frames, run by run, in the calling thread.
///
/// Points beyond those of all runs stay as they are.
///
/// # Accuracy
/// The bits of [`crate::portable`]. 1e4 runs of 1e3 points take 1.1 times as long as one of 1e7
/// (`bindings/python/benches/points.py`).
///
/// # Examples
/// ```
/// use fmc_camera_kernel::host::{Run, Runs};
/// use fmc_camera_kernel::{Coefficients, Terms};
///
/// let moved = |tx| Coefficients { tx, ..Coefficients::default() };
/// let run = |tx, points| Run { form: moved(tx), terms: Terms::Full, points };
/// let mut points = [[1.0, 2.0]; 3];
/// Runs::new().pairs(&mut [run(0.5, 1), run(0.25, 2)].into_iter(), &mut points);
/// assert_eq!(points, [[0.5, 2.0], [0.75, 2.0], [0.75, 2.0]]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Runs {
    level: Level,
    streamed_from_bytes: usize,
}

impl Default for Runs {
    fn default() -> Self {
        Self::new()
    }
}

impl Runs {
    /// Creates a correction with the widest vectors of this machine, and with streaming from its
    /// measured size on.
    #[must_use]
    pub fn new() -> Self {
        Self {
            level: Level::widest(),
            streamed_from_bytes: STREAMED_FROM_BYTES,
        }
    }

    /// Selects other vectors.
    #[must_use]
    pub const fn at(mut self, level: Level) -> Self {
        self.level = level;
        self
    }

    /// Writes past the caches for sets of at least this many bytes of ideal points.
    #[must_use]
    pub const fn streamed_from(mut self, bytes: usize) -> Self {
        self.streamed_from_bytes = bytes;
        self
    }

    /// Replaces points (x, y), mm, by their ideal points.
    pub fn pairs(&self, runs: &mut dyn Iterator<Item = Run>, points: &mut [[f32; 2]]) {
        self.level.run(InPlace { runs, points });
    }

    /// Writes the ideal points of points (x, y), mm, into another slice; the longer of both stays
    /// as it is beyond the length of the shorter.
    pub fn pairs_into(
        &self,
        runs: &mut dyn Iterator<Item = Run>,
        points: &[[f32; 2]],
        ideal: &mut [[f32; 2]],
    ) {
        let count = points.len().min(ideal.len());
        let (points, ideal) = (points.split_at(count).0, ideal.split_at_mut(count).0);
        let stream = size_of_val(ideal) >= self.streamed_from_bytes;
        self.level.run(Into {
            runs,
            points,
            ideal,
            stream,
        });
    }
}

/// Replacement of every point by its ideal one.
struct InPlace<'a> {
    runs: &'a mut dyn Iterator<Item = Run>,
    points: &'a mut [[f32; 2]],
}

impl Work for InPlace<'_> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let points = self.points.as_flattened_mut();
        let mut places = Places {
            vectors,
            to_block: before::<V>(points),
            points,
        };
        for Run {
            form,
            terms,
            points,
        } in self.runs
        {
            let count = points.saturating_mul(2);
            match terms {
                Terms::Short => places.run::<false>(&form, count),
                Terms::Full => places.run::<true>(&form, count),
            }
            if places.points.is_empty() {
                break;
            }
        }
    }
}

/// Numbers that have not been replaced yet.
struct Places<'a, V> {
    vectors: V,
    points: &'a mut [f32],
    /// Count of numbers to the next aligned block of two vectors.
    to_block: usize,
}

impl<V: Vectors> Places<'_, V> {
    #[inline(always)]
    fn run<const FULL: bool>(&mut self, form: &Coefficients, count: usize) {
        let form = &Form::<V, FULL>::new(self.vectors, form);
        let n = 2 * V::F32_LANES;
        let count = count.min(self.points.len());
        let first = count.min(self.to_block);
        self.part(form, first);
        let last = (count - first) % n;
        let vectors = self.vectors;
        let whole = self.next(count - first - last);
        for points in twos_mut::<V>(whole) {
            replace(vectors, form, points);
        }
        self.to_block -= first;
        if last > 0 {
            self.part(form, last);
            self.to_block = n - last;
        }
    }

    /// Replaces fewer points than two vectors hold.
    #[inline(always)]
    fn part<const FULL: bool>(&mut self, form: &Form<V, FULL>, count: usize) {
        if count > 0 {
            let vectors = self.vectors;
            let points = self.next(count);
            let ideal = form.ideal_pairs(few(vectors, points));
            put_few(vectors, points, ideal);
        }
    }

    #[inline(always)]
    fn next(&mut self, count: usize) -> &mut [f32] {
        let all = mem::take(&mut self.points);
        let (next, behind) = all.split_at_mut(count.min(all.len()));
        self.points = behind;
        next
    }
}

/// Ideal points written into another slice of the same length.
struct Into<'a> {
    runs: &'a mut dyn Iterator<Item = Run>,
    points: &'a [[f32; 2]],
    ideal: &'a mut [[f32; 2]],
    /// `true` to write past the caches where alignment allows it.
    stream: bool,
}

impl Work for Into<'_> {
    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let ideal = self.ideal.as_flattened_mut();
        let before = before::<V>(ideal);
        let mut blocks = Blocks {
            vectors,
            points: self.points.as_flattened(),
            stream: self.stream && before == head(ideal, 2 * V::ALIGNMENT),
            ideal,
            block: [0.0; WIDEST],
            filled: 0,
            size: if before > 0 { before } else { 2 * V::F32_LANES },
        };
        for Run {
            form,
            terms,
            points,
        } in self.runs
        {
            let count = points.saturating_mul(2);
            match terms {
                Terms::Short => blocks.run::<false>(&form, count),
                Terms::Full => blocks.run::<true>(&form, count),
            }
            if blocks.points.is_empty() {
                break;
            }
        }
        blocks.put();
        vectors.streamed();
    }
}

/// Points that have no answers yet, and the places of the answers, in blocks of two vectors.
struct Blocks<'a, V> {
    vectors: V,
    points: &'a [f32],
    ideal: &'a mut [f32],
    stream: bool,
    /// Ideal points of the next block, as far as its runs have come.
    block: [f32; WIDEST],
    filled: usize,
    /// Count of numbers in the next block: that of two vectors, or fewer before the first that is
    /// aligned.
    size: usize,
}

impl<V: Vectors> Blocks<'_, V> {
    #[inline(always)]
    fn run<const FULL: bool>(&mut self, form: &Coefficients, count: usize) {
        let form = &Form::<V, FULL>::new(self.vectors, form);
        let n = 2 * V::F32_LANES;
        let mut count = count.min(self.points.len());
        if self.filled > 0 || self.size < n {
            let first = count.min(self.size - self.filled);
            self.part(form, first);
            count -= first;
        }
        let last = count % n;
        self.whole(form, count - last);
        self.part(form, last);
    }

    #[inline(always)]
    fn whole<const FULL: bool>(&mut self, form: &Form<V, FULL>, count: usize) {
        let (points, behind) = self.points.split_at(count.min(self.points.len()));
        self.points = behind;
        let all = mem::take(&mut self.ideal);
        let (ideal, behind) = all.split_at_mut(count.min(all.len()));
        self.ideal = behind;
        let both = twos::<V>(points).iter().zip(twos_mut::<V>(ideal));
        if self.stream {
            for (point, ideal) in both {
                // SAFETY: blocks begin where the slice is aligned; the fence follows the runs.
                unsafe { pass(self.vectors, form, point, ideal) }
            }
        } else {
            for (point, ideal) in both {
                *ideal = form.ideal_pairs(*point);
            }
        }
    }

    /// Adds fewer points than two vectors hold to the next block.
    #[inline(always)]
    fn part<const FULL: bool>(&mut self, form: &Form<V, FULL>, count: usize) {
        if count == 0 {
            return;
        }
        let (points, behind) = self.points.split_at(count.min(self.points.len()));
        self.points = behind;
        let ideal = form.ideal_pairs(few(self.vectors, points));
        let (_, free) = self.block.split_at_mut(self.filled.min(WIDEST));
        put_few(
            self.vectors,
            free.split_at_mut(count.min(free.len())).0,
            ideal,
        );
        self.filled += count;
        if self.filled == self.size {
            self.put();
        }
    }

    /// Writes the block, as far as it is filled.
    #[inline(always)]
    fn put(&mut self) {
        let all = mem::take(&mut self.ideal);
        let (ideal, behind) = all.split_at_mut(self.filled.min(all.len()));
        self.ideal = behind;
        let block = self.block.split_at(self.filled.min(WIDEST)).0;
        match (twos::<V>(block), twos_mut::<V>(ideal)) {
            ([[low, high]], [[at_low, at_high]]) if self.stream => {
                // SAFETY: as in `whole`.
                unsafe {
                    self.vectors.stream(at_low, *low);
                    self.vectors.stream(at_high, *high);
                }
            }
            _ => ideal.copy_from_slice(block),
        }
        self.filled = 0;
        self.size = 2 * V::F32_LANES;
    }
}
