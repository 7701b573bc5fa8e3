//! Blocks of a row side by side, on a PC.

use core::ops::{Add, Mul, Sub};
use fmc_camera_kernel::{Coefficients, Terms};

use fmc_camera_kernel::host::Batch;
use fmc_camera_kernel::inverse::LastStep;

use super::block_matrix::BlockMatrix;
use super::row_store::RowStore;
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::sensor::SensorPoint;

/// Blocks that are filled side by side: their numbers fit the registers of every PC.
pub(super) const ABREAST: u16 = 4;
/// Numbers of a vertex of each: x and y.
const LANES: usize = 2 * ABREAST as usize;
/// Blocks whose nodes are found together.
const TOGETHER: u16 = 4 * ABREAST;
/// Their nodes: the last of a block is the first of the next.
const NODES: usize = 5 * TOGETHER as usize + 1;

/// Sources at the nodes of consecutive blocks of a row.
#[derive(Debug)]
pub(super) struct BlockGroup {
    /// Numbers of the first vertex of the first block and of that behind the last.
    start: u32,
    end: u32,
    /// Measured x, NaN where Newton's first step is not the last or leads near an edge, mm.
    measured_x: [f32; NODES],
    dx_mm: [f32; NODES],
    dy_mm: [f32; NODES],
}

impl BlockGroup {
    /// Returns a group without blocks.
    pub(super) const fn empty() -> Self {
        Self {
            start: 0,
            end: 0,
            measured_x: [f32::NAN; NODES],
            dx_mm: [0.0; NODES],
            dy_mm: [0.0; NODES],
        }
    }

    /// Returns true if a block that starts at a vertex may be in the group.
    pub(super) fn contains(&self, start: u32) -> bool {
        (self.start..self.end).contains(&start)
    }

    /// Finds the sources at the nodes of the blocks from `start` on, of which `offsets` has the
    /// first block's, by the first step of Newton's method.
    pub(super) fn find(
        &mut self,
        frame: (&Coefficients, &LastStep),
        (start, offsets): (u32, [u16; 6]),
        ideal: impl Fn(u32) -> SensorPoint,
    ) {
        let (form, last_step) = frame;
        let [_, inner @ .., length] = offsets.map(u32::from);
        let of_block = |block: u32| {
            let at = |node| start + block * length + node;
            inner.map(at).into_iter().chain([at(length)])
        };
        let mut ideal_x = [0.0; NODES];
        let mut ideal_y = [0.0; NODES];
        let vertices = core::iter::once(start).chain((0..).flat_map(of_block));
        for ((x, y), vertex) in ideal_x.iter_mut().zip(&mut ideal_y).zip(vertices) {
            let ideal = ideal(vertex);
            (*x, *y) = (ideal.x_mm, ideal.y_mm);
        }
        let mut measured_y = [0.0; NODES];
        // Those that do not end are NaN.
        let _ = Batch::new(*form, Terms::Full).xy_distorted(
            last_step,
            [&ideal_x, &ideal_y],
            [&mut self.measured_x, &mut measured_y],
            [&mut self.dx_mm, &mut self.dy_mm],
        );
        self.start = start;
        self.end = start.saturating_add(length * u32::from(TOGETHER));
    }

    /// Returns the sources at the nodes of the block that starts at a vertex, if Newton's first
    /// step is the last at all of them; `None` as well for a block that is not of the group.
    pub(super) fn nodes(&self, start: u32, length: u32) -> Option<[Displacement; 6]> {
        self.contains(start).then_some(())?;
        let vertices = start - self.start;
        vertices.is_multiple_of(length).then_some(())?;
        let first = 5 * (vertices / length) as usize;
        let of = |values: &[f32; NODES]| values.get(first..)?.first_chunk::<6>().copied();
        let is_found = of(&self.measured_x)?.iter().all(|x| !x.is_nan());
        let [dx_mm, dy_mm] = [of(&self.dx_mm)?, of(&self.dy_mm)?];
        let mut nodes = [Displacement::default(); 6];
        for ((node, dx_mm), dy_mm) in nodes.iter_mut().zip(dx_mm).zip(dy_mm) {
            *node = Displacement { dx_mm, dy_mm };
        }
        is_found.then_some(nodes)
    }
}

/// Numbers of all blocks, each with its own.
#[derive(Debug, Clone, Copy)]
struct Lanes([f32; LANES]);

impl Lanes {
    #[inline]
    fn each(mut self, other: Self, operation: impl Fn(f32, f32) -> f32) -> Self {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            *own = operation(*own, other);
        }
        self
    }
}

impl Add for Lanes {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }
}

impl Mul<f32> for Lanes {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f32) -> Self {
        self.each(Self([factor; LANES]), |a, b| a * b)
    }
}

/// Blocks that are filled side by side.
#[derive(Debug)]
pub(super) struct Abreast<S> {
    stores: [S; ABREAST as usize],
    nodes: [Lanes; 6],
}

impl<S: RowStore> Abreast<S> {
    /// Returns the blocks before their stores have begun.
    pub(super) fn new(store: &S) -> Self {
        Self {
            stores: [(); ABREAST as usize].map(|()| store.clone()),
            nodes: [Lanes([0.0; LANES]); 6],
        }
    }

    /// Returns the stores of the blocks.
    pub(super) const fn stores(&mut self) -> &mut [S; ABREAST as usize] {
        &mut self.stores
    }

    /// Sets the sources at the nodes of a block.
    pub(super) fn set(&mut self, block: u16, nodes: [Displacement; 6]) {
        for (Lanes(lanes), node) in self.nodes.iter_mut().zip(nodes) {
            if let Some([x, y]) = lanes.as_chunks_mut().0.get_mut(usize::from(block)) {
                (*x, *y) = (node.dx_mm, node.dy_mm);
            }
        }
    }

    /// Fills the words of all blocks.
    pub(super) fn fill(self, matrix: &BlockMatrix, words: &mut [S::Word]) {
        let [store, ..] = &self.stores;
        let [x, y] = store.steps_per_mm();
        let steps = Lanes([x, y, x, y, x, y, x, y]);
        let differences = matrix.differences(self.nodes);
        let differences = differences.map(|value| value.each(steps, |value, steps| steps * value));
        let mut blocks = words.chunks_exact_mut(usize::from(matrix.length));
        if let (Some(first), Some(second), Some(third), Some(fourth)) =
            (blocks.next(), blocks.next(), blocks.next(), blocks.next())
        {
            take_all(self.stores, differences, [first, second, third, fourth]);
        }
    }
}

/// Fills the words of blocks from their differences. Within its caller the differences would not
/// keep their registers, and a vertex would take twice as long.
#[inline(never)]
fn take_all<S: RowStore>(
    [mut store_a, mut store_b, mut store_c, mut store_d]: [S; ABREAST as usize],
    mut differences: [Lanes; 6],
    [first, second, third, fourth]: [&mut [S::Word]; ABREAST as usize],
) {
    let words = first.iter_mut().zip(second).zip(third).zip(fourth);
    for (((word_a, word_b), word_c), word_d) in words {
        let Lanes([ax, ay, bx, by, cx, cy, dx, dy]) = take(&mut differences);
        *word_a = store_a.next([ax, ay]);
        *word_b = store_b.next([bx, by]);
        *word_c = store_c.next([cx, cy]);
        *word_d = store_d.next([dx, dy]);
    }
}

/// Returns the values here and moves the differences to the next point.
#[expect(clippy::inline_always, reason = "a call would store all differences")]
#[inline(always)]
fn take([values, d1, d2, d3, d4, d5]: &mut [Lanes; 6]) -> Lanes {
    let here = *values;
    *values = *values + *d1;
    *d1 = *d1 + *d2;
    *d2 = *d2 + *d3;
    *d3 = *d3 + *d4;
    *d4 = *d4 + *d5;
    here
}
