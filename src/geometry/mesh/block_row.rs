//! One row of a mesh of sources, in blocks.

#[cfg(host_kernel)]
use fmc_camera_kernel::inverse::LastStep;

#[cfg(host_kernel)]
use super::block_group::{ABREAST, Abreast, BlockGroup};
use super::differences::Differences;
use super::row_store::{RowStore, Span};
use super::source_mesh::{Blocks, ideal};
use super::source_row::SourceRow;
use super::vertex::{MeshError, VertexRow};
use crate::geometry::evaluation_form::Displacement;
use crate::geometry::frame_correction::{FrameCorrection, Terms};
use crate::geometry::inverse::{FREE_STEPS, shifted};
use crate::geometry::sensor::{PixelPoint, SensorPoint};

/// Distance that the first and the last vertex of a row's blocks keep from the edge of the sensor,
/// pixels: rounding does not put their measured points beyond it.
const OFF_EDGE_PX: f32 = 0.05;

/// A row whose vertices have numbers: 0 is the first of the whole image's row that has the same
/// columns, so that blocks lie alike whatever part of the row is asked for.
pub(super) struct BlockRow<'a> {
    row: &'a VertexRow,
    correction: &'a FrameCorrection,
    blocks: &'a Blocks,
    /// Column of vertex 0.
    phase_px: u32,
    /// Number of the row's first vertex.
    first: u32,
    /// Numbers of the first and the last vertex of all blocks, at least a block apart.
    ends: Option<[u32; 2]>,
    /// Source that was found last, with its vertex.
    last_node: Option<(u32, Displacement)>,
    #[cfg(host_kernel)]
    group: BlockGroup,
}

impl<'a> BlockRow<'a> {
    pub(super) fn new(
        row: &'a VertexRow,
        correction: &'a FrameCorrection,
        blocks: &'a Blocks,
    ) -> Self {
        let spacing_px = u32::from(row.spacing_px).max(1);
        let mut new = Self {
            row,
            correction,
            blocks,
            phase_px: row.first_col_px % spacing_px,
            first: row.first_col_px / spacing_px,
            ends: None,
            last_node: None,
            #[cfg(host_kernel)]
            group: BlockGroup::empty(),
        };
        new.ends = new.ends_on_sensor();
        new
    }

    /// Fills a slice with the row's vertices, from its first on.
    pub(super) fn fill<S: RowStore>(
        mut self,
        mut store: S,
        words: &mut [S::Word],
    ) -> Result<(), MeshError> {
        let mut index = 0;
        let mut rest = words;
        while !rest.is_empty() {
            let vertex = self.first.saturating_add(u32::from(index));
            #[cfg(host_kernel)]
            {
                let filled = self.fill_abreast(&store, (vertex, index), rest)?;
                if filled > 0 {
                    index = index.saturating_add(filled);
                    rest = rest.split_at_mut(usize::from(filled)).1;
                    continue;
                }
            }
            let room = u16::try_from(rest.len()).unwrap_or(u16::MAX);
            let span = self.span(vertex);
            let Some((now, behind)) = rest.split_at_mut_checked(usize::from(span.count(room)))
            else {
                break;
            };
            let count = u16::try_from(now.len()).unwrap_or(u16::MAX);
            let block = span
                .start
                .and_then(|start| Some((start, self.nodes(start)?)));
            if let Some((start, nodes)) = block {
                let place = self.row.place(self.correction.sensor(), index)?;
                self.fill_block(&mut store, nodes, (vertex - start, place), now)?;
            } else {
                let correction = self.correction;
                let alone = |ideal| SourceRow::new(correction).next(ideal);
                self.row
                    .fill_singly(correction.sensor(), &store, alone, (index, now))?;
            }
            index = index.saturating_add(count);
            rest = behind;
        }
        Ok(())
    }

    /// Returns the block of a vertex, or the vertices up to the next block.
    fn span(&self, vertex: u32) -> VertexSpan {
        let outside = |count| VertexSpan { start: None, count };
        let Some([first, last]) = self.ends else {
            return outside(u32::MAX);
        };
        if vertex < first {
            return outside(first - vertex);
        }
        if vertex > last {
            return outside(u32::MAX);
        }
        let length = u32::from(self.blocks.matrix.length).max(1);
        let start = first + (vertex - first) / length * length;
        if start + length > last {
            VertexSpan {
                start: Some(last - length),
                count: last - vertex + 1,
            }
        } else {
            VertexSpan {
                start: Some(start),
                count: start + length - vertex,
            }
        }
    }

    /// Fills a slice with vertices of a block, from the one that lies `skipped` behind its start.
    fn fill_block<S: RowStore>(
        &self,
        store: &mut S,
        nodes: [Displacement; 6],
        (skipped, place): (u32, [u32; 2]),
        words: &mut [S::Word],
    ) -> Result<(), MeshError> {
        let [mut x, mut y] = self.differences(store, &nodes).map(Differences::of_values);
        for _ in 0..skipped {
            x.take();
            y.take();
        }
        let from_origin = self.row.counted_from_origin(place);
        let span = Span {
            place: from_origin,
            spacing_px: self.row.spacing_px,
            count: words.len(),
        };
        if self.holds(store, &span, &nodes) {
            store.begin(&span);
            // Four vertices are unrolled by hand: a jump costs a quarter of one.
            let (fours, rest) = words.as_chunks_mut::<4>();
            for four in fours {
                for word in four {
                    *word = store.next([x.take(), y.take()]);
                }
            }
            for word in rest {
                *word = store.next([x.take(), y.take()]);
            }
            return Ok(());
        }
        let [mut col_px, row_px] = from_origin;
        for word in words {
            let steps = [x.take(), y.take()];
            *word = store
                .checked([col_px, row_px], steps)
                .map_err(MeshError::Format)?;
            col_px = col_px.saturating_add(i32::from(self.row.spacing_px));
        }
        Ok(())
    }

    /// Returns x and y at the first vertex of a block and their differences, in steps of the store.
    #[inline]
    fn differences<S: RowStore>(&self, store: &S, nodes: &[Displacement; 6]) -> [[f32; 6]; 2] {
        let [steps_x, steps_y] = store.steps_per_mm();
        let matrix = &self.blocks.matrix;
        let scaled =
            |values: [f32; 6], steps: f32| matrix.differences(values).map(|value| steps * value);
        [
            scaled(nodes.map(|node| node.dx_mm), steps_x),
            scaled(nodes.map(|node| node.dy_mm), steps_y),
        ]
    }

    /// Returns true if all vertices of a span of a block fit the store's format.
    #[inline]
    fn holds<S: RowStore>(&self, store: &S, span: &Span, nodes: &[Displacement; 6]) -> bool {
        let [steps_x, steps_y] = store.steps_per_mm();
        let node_steps = nodes.map(|node| [steps_x * node.dx_mm, steps_y * node.dy_mm]);
        store.holds(span, &node_steps, self.blocks.off_nodes_mm * steps_x.abs())
    }

    /// Returns the largest |y| of a node's measured point.
    #[inline]
    fn highest_mm(&self) -> f32 {
        self.correction.sensor().half_height_mm() - self.blocks.off_nodes_mm
    }

    /// Fills the first words with blocks side by side, the bits those of one block after the other,
    /// and returns their number: 0 where that is not possible. `vertex` is the number of the first,
    /// `index` its place in the row.
    #[cfg(host_kernel)]
    fn fill_abreast<S: RowStore>(
        &mut self,
        store: &S,
        (vertex, index): (u32, u16),
        words: &mut [S::Word],
    ) -> Result<u16, MeshError> {
        let length = self.blocks.matrix.length;
        let count = length.saturating_mul(ABREAST);
        let is_start = self.ends.is_some_and(|[first, last]| {
            (first..last).contains(&vertex)
                && (vertex - first).is_multiple_of(u32::from(length))
                && vertex + u32::from(count) <= last
        });
        let Some(words) = words.get_mut(..usize::from(count)).filter(|_| is_start) else {
            return Ok(0);
        };
        let mut blocks = Abreast::new(store);
        for number in 0..ABREAST {
            let skipped = number * length;
            let start = vertex + u32::from(skipped);
            if !self.group.contains(start) {
                self.move_group(start);
            }
            let Some(nodes) = self.group.nodes(start, u32::from(length)) else {
                return Ok(0);
            };
            let sensor = self.correction.sensor();
            let place = self.row.place(sensor, index + skipped)?;
            let span = Span {
                place: self.row.counted_from_origin(place),
                spacing_px: self.row.spacing_px,
                count: usize::from(length),
            };
            if !self.holds(store, &span, &nodes) {
                return Ok(0);
            }
            if let Some(store) = blocks.stores().get_mut(usize::from(number)) {
                store.begin(&span);
            }
            blocks.set(number, nodes);
        }
        blocks.fill(&self.blocks.matrix, words);
        Ok(count)
    }

    /// Finds the sources at the nodes of the blocks from `start` on, as [`Self::node`] does in its
    /// first step.
    #[cfg(host_kernel)]
    fn move_group(&mut self, start: u32) {
        let correction = self.correction;
        let last_step = LastStep {
            longest2_mm2: correction.longest_last_step2(),
            farthest_mm: [correction.sensor().half_width_mm(), self.highest_mm()],
        };
        let [phase_px, row_px] = [self.phase_px, self.row.row_px];
        let spacing_px = u32::from(self.row.spacing_px);
        self.group.find(
            (&correction.coefficients(), &last_step),
            (start, self.blocks.nodes),
            |vertex| {
                ideal(
                    correction.sensor(),
                    [phase_px + vertex * spacing_px, row_px],
                )
            },
        );
    }

    /// Returns the sources at the nodes of a block, unless one of them is off the sensor or so near
    /// its upper or lower edge that a vertex of the block might be.
    fn nodes(&mut self, start: u32) -> Option<[Displacement; 6]> {
        #[cfg(host_kernel)]
        if let Some(nodes) = self
            .group
            .nodes(start, u32::from(self.blocks.matrix.length))
        {
            return Some(nodes);
        }
        let mut nodes = [Displacement::default(); 6];
        for (node, offset) in nodes.iter_mut().zip(self.blocks.nodes) {
            let vertex = start + u32::from(offset);
            *node = match self.last_node {
                Some((last, source)) if last == vertex => source,
                _ => self.node(vertex)?,
            };
            self.last_node = Some((vertex, *node));
        }
        Some(nodes)
    }

    /// Returns the source of a vertex by Newton's method.
    #[inline(never)]
    fn node(&self, vertex: u32) -> Option<Displacement> {
        let correction = self.correction;
        let (form, centre, sensor) = (correction.form(), correction.centre(), correction.sensor());
        let col_px = self.phase_px + vertex * u32::from(self.row.spacing_px);
        let ideal = ideal(sensor, [col_px, self.row.row_px]);
        let (x, y) = (ideal.x_mm - centre.x_mm, ideal.y_mm - centre.y_mm);
        let mut d = form.start(Terms::Full, x, y);
        for _ in 0..FREE_STEPS {
            let step2_mm2;
            (d, step2_mm2) = form.stepped(Terms::Full, x, y, d);
            if step2_mm2 <= correction.longest_last_step2() {
                let measured = shifted(ideal, d);
                let inside = measured.x_mm.abs() <= sensor.half_width_mm()
                    && measured.y_mm.abs() <= self.highest_mm();
                return inside.then_some(d);
            }
        }
        None
    }

    /// Returns the numbers of the first and the last vertex of the image's row whose measured
    /// points are on the sensor; `None` unless a block fits between them.
    fn ends_on_sensor(&self) -> Option<[u32; 2]> {
        let sensor = self.correction.sensor();
        let spacing_px = u32::from(self.row.spacing_px).max(1);
        let ideal = ideal(sensor, [self.phase_px, self.row.row_px]);
        let [left, right] = [-1.0, 1.0].map(|side| {
            let x_mm = self.ideal_of_edge(side * sensor.half_width_mm(), ideal.y_mm);
            let PixelPoint { col_px, .. } =
                sensor.pixel_from_sensor(SensorPoint::new(x_mm, ideal.y_mm));
            col_px
        });
        let after_left = self.vertices_to(left + OFF_EDGE_PX);
        let first = after_left.map_or(0, |vertex| vertex.saturating_add(1));
        let last_of_image = sensor
            .width_px()
            .saturating_add(spacing_px - 1)
            .saturating_sub(self.phase_px)
            / spacing_px;
        let last = self.vertices_to(right - OFF_EDGE_PX)?.min(last_of_image);
        let length = u32::from(self.blocks.matrix.length);
        (last >= first.saturating_add(length)).then_some([first, last])
    }

    /// Returns the number of the last vertex at or before a column; `None` if there is none.
    fn vertices_to(&self, col_px: f32) -> Option<u32> {
        let [phase_px, spacing_px] =
            [self.phase_px, u32::from(self.row.spacing_px)].map(crate::geometry::sensor::pixels);
        let vertices = (col_px - phase_px) / spacing_px;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates; not negative"
        )]
        (vertices >= 0.0).then_some(vertices as u32)
    }

    /// Returns x of the ideal point at height `y_mm` whose measured point has `edge_mm` as its x. A
    /// last block that an error of it puts off the sensor is solved vertex by vertex.
    fn ideal_of_edge(&self, edge_mm: f32, y_mm: f32) -> f32 {
        let (form, centre) = (self.correction.form(), self.correction.centre());
        let (x, y) = (edge_mm - centre.x_mm, y_mm - centre.y_mm);
        let mut d = form.displacement(x, y);
        for _ in 0..2 {
            d = form.displacement(x, y + d.dy_mm);
        }
        edge_mm - d.dx_mm
    }
}

/// Vertices of one block, or between blocks.
struct VertexSpan {
    /// First vertex of the block.
    start: Option<u32>,
    /// Number of vertices from the one in question to the end.
    count: u32,
}

impl VertexSpan {
    /// Returns the number of vertices, at most `room`.
    fn count(&self, room: u16) -> u16 {
        u16::try_from(self.count).unwrap_or(u16::MAX).min(room)
    }
}
