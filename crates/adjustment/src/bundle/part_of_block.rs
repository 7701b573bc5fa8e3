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

#[cfg(test)]
mod tests {
    use super::super::tables::{ObjectPointRow, Table};
    use super::*;

    /// A strip of images, each of which shares ten points with the next; control in the middle.
    fn strip(images: usize) -> NetworkTables {
        let row = |image: usize, point: usize| ImagePointRow {
            line: 0,
            image: format!("{image:05}").into(),
            point: format!("{point}").into(),
            measured_mm: [0.0; 2],
            by_grids_mm: [0.0; 2],
            sigma_mm: None,
        };
        let rows = (0..images)
            .flat_map(|image| (0..20).map(move |number| row(image, 10 * image + number)));
        let control = (0..4).map(|number| ObjectPointRow {
            line: 0,
            point: format!("{}", 5 * images + number).into(),
            position_m: [0.0; 3],
            sigmas_m: [0.0; 3],
            role: RowRole::Control,
        });
        NetworkTables {
            image_points: Table {
                file: String::new(),
                rows: rows.collect(),
            },
            object_points: Table {
                file: String::new(),
                rows: control.collect(),
            },
            images: None,
            scale_bars: None,
            stages: HashMap::new(),
        }
    }

    #[test]
    fn part_is_connected_about_the_control_and_no_larger_than_asked_for() {
        let whole = strip(1000);
        let part = part_of_block(&whole, 400);
        let rows = &part.image_points.rows;
        assert!(rows.len() <= 400 && rows.len() > 300, "{}", rows.len());
        let images: HashSet<usize> = rows.iter().map(|row| row.image.parse().unwrap()).collect();
        let (first, last) = (images.iter().min().unwrap(), images.iter().max().unwrap());
        // Every image between the first and the last, about the middle.
        assert_eq!(images.len(), last - first + 1);
        assert!((480..500).contains(first) && (500..520).contains(last));
        assert_eq!(part.object_points.rows.len(), 4);
        let rays = |point: &str| rows.iter().filter(|row| *row.point == *point).count();
        for row in rows {
            let is_control = part
                .object_points
                .rows
                .iter()
                .any(|own| own.point == row.point);
            assert!(is_control || rays(&row.point) > 1, "{}", row.point);
        }
    }

    #[test]
    fn small_block_is_taken_whole() {
        let whole = strip(10);
        assert_eq!(part_of_block(&whole, 200), whole);
    }
}
