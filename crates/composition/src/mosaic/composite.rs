//! Layers joined at seams.

use rayon::prelude::*;

use super::layer::Layer;
use super::seam::{cheapest_path, cost};
use crate::image::Plane;
use crate::number::{grey, real};
use crate::rig::{Rig, VirtualSize};

/// Layers joined: grey values, and the number of the sub-image that each pixel is of, from 1; 0
/// where there is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Composite {
    /// Grey values.
    pub layer: Layer,
    /// Numbers of sub-images, 0 without content.
    pub labels: Vec<u8>,
}

/// Memory, bytes, that the images of an exposure take at most from reading to the composite:
/// sub-images, their layers with labels, and the virtual image with labels.
#[must_use]
pub fn memory_bytes(rig: &Rig) -> u64 {
    let pixels = |width: usize, height: usize| (width as u64).saturating_mul(height as u64);
    let of_subs = rig
        .sub
        .iter()
        .map(|sub| pixels(sub.width_px, sub.height_px));
    let of_subs = of_subs.fold(0, u64::saturating_add);
    let of_frame = pixels(rig.frame.width_px, rig.frame.height_px);
    let of_subs = of_subs.saturating_mul(5);
    of_subs.saturating_add(of_frame.saturating_mul(3))
}

/// Direction along which a seam is monotone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Along {
    Rows,
    Columns,
}

/// Joins the layers of a rig, one each, in its order; a pixel belongs to the frame.
///
/// The sub-images of a column are joined first, from above to below; then the columns, from the
/// middle outwards. A seam is the cheapest path along the overlap; within `feather_px` of it on
/// either side the weights are 1/2 + d/(2·feather), as in Zhao et al. 2013.
#[must_use]
pub fn compose(rig: &Rig, layers: Vec<Layer>, feather_px: usize) -> Option<Composite> {
    let mut columns: Vec<(f64, Vec<(f64, Composite)>)> = Vec::new();
    for ((sub, layer), label) in rig.sub.iter().zip(layers).zip(1..) {
        let [right, down] = sub.place_px;
        let labels = layer
            .plane
            .values()
            .iter()
            .map(|value| if *value == 0 { 0 } else { label });
        let part = Composite {
            labels: labels.collect(),
            layer,
        };
        let near = |(place, _): &&mut (f64, _)| (*place - right).abs() < real(sub.width_px) / 2.0;
        match columns.iter_mut().find(near) {
            Some((_, list)) => list.push((down, part)),
            None => columns.push((right, vec![(down, part)])),
        }
    }
    let mut joined: Vec<(f64, Composite)> = Vec::new();
    for (right, mut column) in columns {
        column.sort_by(|a, b| a.0.total_cmp(&b.0));
        let parts = column.into_iter().map(|(_, part)| part);
        let whole = parts.reduce(|a, b| join(&a, &b, Along::Columns, feather_px))?;
        joined.push((right, whole));
    }
    joined.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let mut all: Option<Composite> = None;
    for (right, part) in joined {
        all = Some(match all {
            None => part,
            Some(all) if right < 0.0 => join(&part, &all, Along::Rows, feather_px),
            Some(all) => join(&all, &part, Along::Rows, feather_px),
        });
    }
    all.map(|all| all.in_frame(rig.frame))
}

/// Joins two parts, `a` to the left of `b` or above it.
fn join(a: &Composite, b: &Composite, along: Along, feather_px: usize) -> Composite {
    let first = [0, 1].map(|axis| pick(a.layer.first_px, axis).min(pick(b.layer.first_px, axis)));
    let end = [0, 1].map(|axis| pick(a.layer.end_px(), axis).max(pick(b.layer.end_px(), axis)));
    // The rectangle in which both may have content.
    let low = [0, 1].map(|axis| pick(a.layer.first_px, axis).max(pick(b.layer.first_px, axis)));
    let high = [0, 1].map(|axis| pick(a.layer.end_px(), axis).min(pick(b.layer.end_px(), axis)));
    let sides = [0, 1].map(|axis| pick(high, axis).saturating_sub(pick(low, axis)));
    let (rows, columns) = match along {
        Along::Rows => (sides[1], sides[0]),
        Along::Columns => (sides[0], sides[1]),
    };
    let seam = seam(a, b, along, low, [rows, columns], feather_px);
    let [width, height] = [end[0] - first[0], end[1] - first[1]];
    let mut values = vec![0; width * height];
    let mut labels = vec![0; width * height];
    let rows = values
        .par_chunks_mut(width.max(1))
        .zip(labels.par_chunks_mut(width.max(1)));
    rows.zip(first[1]..end[1])
        .for_each(|((values, labels), row)| {
            let slots = values.iter_mut().zip(labels).zip(first[0]..end[0]);
            for ((value, label), col) in slots {
                let (line, place, [low_line, low_place]) = match along {
                    Along::Rows => (row, col, [low[1], low[0]]),
                    Along::Columns => (col, row, [low[0], low[1]]),
                };
                let inside = line.checked_sub(low_line).and_then(|line| seam.get(line));
                // Beyond the overlap the nearest end of the seam counts.
                let nearest = if line < low_line {
                    seam.first()
                } else {
                    seam.last()
                };
                let at = inside.or(nearest).copied().unwrap_or(0);
                let distance = real(place) - real(low_place + at) + 0.5;
                let weight = 0.5 + distance / (2.0 * real(feather_px.max(1)));
                let is_hard = feather_px == 0;
                (*value, *label) = blended(a, b, [col, row], weight.clamp(0.0, 1.0), is_hard);
            }
        });
    Composite {
        layer: Layer {
            first_px: first,
            plane: Plane::new(width, height, values)
                .unwrap_or_else(|| Plane::of_rows(width, height, |_| Vec::new())),
        },
        labels,
    }
}

/// Returns the column of `b`'s first pixel in each row of the overlap, or the row in each column.
fn seam(
    a: &Composite,
    b: &Composite,
    along: Along,
    low: [usize; 2],
    [rows, columns]: [usize; 2],
    feather_px: usize,
) -> Vec<usize> {
    let place = |line: usize, across: usize| match along {
        Along::Rows => [low[0] + across, low[1] + line],
        Along::Columns => [low[0] + line, low[1] + across],
    };
    let taps = |part: &Composite, [col, row]: [usize; 2]| {
        [(col, row), (col + 1, row), (col, row + 1)].map(|(col, row)| part.layer.at(col, row))
    };
    // Whole feathers need the content of both on either side, where the overlap is wide enough.
    let room = if columns > 4 * feather_px {
        feather_px
    } else {
        0
    };
    cheapest_path(rows, columns, |line, across| {
        let here = place(line, across);
        let before = place(line, across.saturating_sub(room));
        let after = place(line, across + room);
        let is_whole = [a, b].into_iter().all(|part| {
            [before, after]
                .into_iter()
                .all(|[col, row]| part.layer.at(col, row) > 0)
        });
        let own = cost(taps(a, here), taps(b, here));
        if is_whole { own } else { own + 1e6 }
    })
}

fn blended(
    a: &Composite,
    b: &Composite,
    [col, row]: [usize; 2],
    weight: f64,
    is_hard: bool,
) -> (u16, u8) {
    let (of_a, of_b) = (a.layer.at(col, row), b.layer.at(col, row));
    let (label_a, label_b) = (a.label(col, row), b.label(col, row));
    match (of_a, of_b) {
        (0, 0) => (0, 0),
        (_, 0) => (of_a, label_a),
        (0, _) => (of_b, label_b),
        _ => {
            let weight = if is_hard {
                f64::from(u8::from(weight > 0.5))
            } else {
                weight
            };
            let value = grey(f64::from(of_a) * (1.0 - weight) + f64::from(of_b) * weight);
            (value.max(1), if weight > 0.5 { label_b } else { label_a })
        }
    }
}

impl Composite {
    fn label(&self, col: usize, row: usize) -> u8 {
        let [first_col, first_row] = self.layer.first_px;
        let index = col
            .checked_sub(first_col)
            .filter(|col| *col < self.layer.plane.width())
            .zip(row.checked_sub(first_row))
            .map(|(col, row)| row * self.layer.plane.width() + col);
        index
            .and_then(|index| self.labels.get(index))
            .copied()
            .unwrap_or(0)
    }

    /// Returns the composite over the whole frame.
    fn in_frame(self, frame: VirtualSize) -> Self {
        if self.layer.first_px == [0, 0] && self.layer.end_px() == [frame.width_px, frame.height_px]
        {
            return self;
        }
        let plane = Plane::of_rows(frame.width_px, frame.height_px, |row| {
            (0..frame.width_px)
                .map(|col| self.layer.at(col, row))
                .collect()
        });
        let labels = (0..frame.height_px)
            .into_par_iter()
            .flat_map_iter(|row| {
                let this = &self;
                (0..frame.width_px).map(move |col| this.label(col, row))
            })
            .collect();
        Self {
            layer: Layer {
                first_px: [0, 0],
                plane,
            },
            labels,
        }
    }
}

fn pick(pair: [usize; 2], axis: usize) -> usize {
    pair.get(axis).copied().unwrap_or_default()
}
