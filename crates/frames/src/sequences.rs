//! Sequence numbers that have been read.

use std::collections::HashSet;

/// The sequence numbers of a file, to find one that comes twice.
///
/// Records come in ascending order, and then only the last number is kept; from the first that
/// does not ascend, all are.
#[derive(Debug, Default)]
pub(crate) struct Sequences {
    ascending: Vec<[u32; 2]>,
    others: HashSet<u32>,
}

impl Sequences {
    /// Adds a number; returns `false` if it has been added before.
    pub(crate) fn insert(&mut self, sequence: u32) -> bool {
        match self.ascending.last_mut() {
            Some([_, last]) if last.checked_add(1) == Some(sequence) => {
                *last = sequence;
                !self.others.contains(&sequence)
            }
            Some([_, last]) if sequence <= *last => {
                let place = self
                    .ascending
                    .partition_point(|[first, _]| *first <= sequence);
                let run = place.checked_sub(1).and_then(|run| self.ascending.get(run));
                run.is_none_or(|[_, last]| *last < sequence) && self.others.insert(sequence)
            }
            _ => {
                self.ascending.push([sequence; 2]);
                !self.others.contains(&sequence)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_that_comes_twice_is_seen_in_any_order() {
        let mut random = fastrand::Rng::with_seed(4);
        for most in [10, 60, 4000] {
            let (mut sequences, mut all) = (Sequences::default(), HashSet::new());
            for _ in 0..2000 {
                let start = random.u32(..most);
                for sequence in start..start + random.u32(..4) {
                    assert_eq!(sequences.insert(sequence), all.insert(sequence));
                }
            }
        }
    }

    #[test]
    fn ascending_numbers_take_no_memory() {
        let mut sequences = Sequences::default();
        assert!((1..100_000).all(|sequence| sequences.insert(sequence)));
        assert_eq!(sequences.ascending.len(), 1);
        assert!(sequences.others.is_empty());
        assert!(!sequences.insert(1) && !sequences.insert(99_999));
    }
}
