//! Pairs of images that share an object point: where the reduced normal matrix is not zero.

/// Sparsity of the reduced normal matrix, lower triangle, in blocks of one image each.
///
/// Column i lists the images k ≥ i in ascending order, i first. A block's number counts through all
/// columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImagePairs {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl ImagePairs {
    /// Creates the pairs of `images` images from groups of images that share a point; numbers
    /// beyond `images` are left out.
    #[must_use]
    pub fn new(images: usize, groups: &[&[usize]]) -> Self {
        let mut groups_of = vec![Vec::new(); images];
        for (group, members) in groups.iter().enumerate() {
            for image in *members {
                if let Some(list) = groups_of.get_mut(*image) {
                    list.push(group);
                }
            }
        }
        let mut seen_by = vec![usize::MAX; images];
        let mut starts = vec![0];
        let mut rows = Vec::new();
        for (image, list) in groups_of.iter().enumerate() {
            let mut column = vec![image];
            for other in list.iter().filter_map(|group| groups.get(*group)).copied() {
                for &other in other {
                    match seen_by.get_mut(other) {
                        Some(seen) if other > image && *seen != image => {
                            *seen = image;
                            column.push(other);
                        }
                        _ => {}
                    }
                }
            }
            column.sort_unstable();
            rows.append(&mut column);
            starts.push(rows.len());
        }
        Self { starts, rows }
    }

    /// Number of images.
    #[must_use]
    pub fn images(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of blocks of the lower triangle.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.rows.len()
    }

    /// Images that share a point with an image and do not come before it, itself first.
    #[must_use]
    pub fn column(&self, image: usize) -> &[usize] {
        match (self.starts.get(image), self.starts.get(image + 1)) {
            (Some(&start), Some(&end)) => self.rows.get(start..end).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// Number of the first block of a column.
    #[must_use]
    pub fn start(&self, image: usize) -> usize {
        self.starts.get(image).copied().unwrap_or(0)
    }

    /// Number of the block of a pair, `row ≥ column`; `None` if the two share no point.
    #[must_use]
    pub fn block(&self, row: usize, column: usize) -> Option<usize> {
        let place = self.column(column).binary_search(&row).ok()?;
        Some(self.start(column) + place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_those_with_a_common_point() {
        let pairs = ImagePairs::new(4, &[&[0, 2], &[2, 3], &[2, 0], &[1]]);
        assert_eq!(pairs.column(0), [0, 2]);
        assert_eq!(pairs.column(1), [1]);
        assert_eq!(pairs.column(2), [2, 3]);
        assert_eq!(pairs.blocks(), 6);
        assert_eq!(pairs.block(3, 2), Some(4));
        assert_eq!(pairs.block(3, 0), None);
        assert_eq!(pairs.column(7), [0_usize; 0]);
    }
}
