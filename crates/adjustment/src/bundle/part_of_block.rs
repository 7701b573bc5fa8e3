//! Part of a block that is small enough to be adjusted many times.

use std::collections::{HashMap, HashSet, VecDeque};

use super::tables::{ImagePointRow, NetworkTables, RowRole};

/// Returns the tables of a connected part with at most about `most` image points, around the image
/// with the most control points; the whole tables if they have no more.
///
/// Images follow in the order in which they are reached over common points, so that they overlap.
/// Scale bars with an end outside are left out.
#[must_use]
pub(super) fn part_of_block(tables: &NetworkTables, most: usize) -> NetworkTables {
    let rows = &tables.image_points.rows;
    if rows.len() <= most {
        return tables.clone();
    }
    let mut by_image: HashMap<&str, Vec<&ImagePointRow>> = HashMap::new();
    let mut by_point: HashMap<&str, Vec<&str>> = HashMap::new();
    for row in rows {
        by_image.entry(&row.image).or_default().push(row);
        by_point.entry(&row.point).or_default().push(&row.image);
    }
    let objects = tables.object_points.rows.iter();
    let control: HashSet<&str> = objects
        .filter(|row| row.role == RowRole::Control)
        .map(|row| &*row.point)
        .collect();
    let controls = |rows: &[&ImagePointRow]| {
        let shown = rows.iter().filter(|row| control.contains(&*row.point));
        shown.count()
    };
    let first = by_image
        .iter()
        .max_by_key(|(image, rows)| (controls(rows), std::cmp::Reverse(**image)))
        .map(|(image, _)| *image);
    let mut taken: HashSet<&str> = HashSet::new();
    let mut waiting: VecDeque<&str> = first.into_iter().collect();
    let mut seen: HashSet<&str> = waiting.iter().copied().collect();
    let mut count = 0;
    while let Some(image) = waiting.pop_front() {
        let own = by_image.get(image).map_or(&[][..], Vec::as_slice);
        if count + own.len() > most && count > 0 {
            break;
        }
        count += own.len();
        taken.insert(image);
        for row in own {
            for other in by_point.get(&*row.point).into_iter().flatten() {
                if seen.insert(other) {
                    waiting.push_back(other);
                }
            }
        }
    }
    let mut part = tables.clone();
    // A point with unknown coordinates needs two images.
    let mut rays: HashMap<&str, usize> = HashMap::new();
    for row in rows.iter().filter(|row| taken.contains(&*row.image)) {
        *rays.entry(&row.point).or_default() += 1;
    }
    let is_kept = |row: &ImagePointRow| {
        let is_known = control.contains(&*row.point);
        taken.contains(&*row.image) && (is_known || rays.get(&*row.point) > Some(&1))
    };
    part.image_points.rows.retain(is_kept);
    let shown: HashSet<&str> = part
        .image_points
        .rows
        .iter()
        .map(|row| &*row.point)
        .collect();
    part.object_points
        .rows
        .retain(|row| shown.contains(&*row.point));
    if let Some(images) = &mut part.images {
        images.rows.retain(|row| taken.contains(&*row.image));
    }
    if let Some(bars) = &mut part.scale_bars {
        bars.rows
            .retain(|row| row.ends.iter().all(|end| shown.contains(&**end)));
    }
    part.stages.retain(|image, _| taken.contains(&**image));
    part
}
