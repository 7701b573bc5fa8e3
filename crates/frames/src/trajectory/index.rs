//! Index of a trajectory by time.

use fmc_camera_file::InputError;

use super::samples::{SampleFile, SamplePlace};

/// Samples of a part at first.
const PART: usize = 256;

/// Parts of the index at most: when there are more, each becomes twice as long.
const PARTS: usize = 1 << 14;

/// Beginnings of parts of a trajectory, in ascending time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Index {
    parts: Vec<(f64, SamplePlace)>,
    /// Samples of each part but the last.
    part: usize,
    /// Parts at most.
    most: usize,
    pub(super) count: u64,
    pub(super) gaps: u64,
    /// Times of the first and the last sample, s.
    pub(super) first_s: f64,
    pub(super) last_s: f64,
}

impl Index {
    const fn new(part: usize, most: usize) -> Self {
        Self {
            parts: Vec::new(),
            part,
            most,
            count: 0,
            gaps: 0,
            first_s: f64::NAN,
            last_s: f64::NAN,
        }
    }

    /// Reads a file from its first sample to its last.
    ///
    /// # Errors
    /// [`InputError`] for a sample that cannot be used, for a time that does not ascend, and for
    /// fewer than three samples.
    pub(super) fn of(
        file: &mut SampleFile,
        from: SamplePlace,
        longest_gap_s: f64,
        read_bytes: impl Fn(u64),
    ) -> Result<Self, InputError> {
        let mut index = Self::new(PART, PARTS);
        let name = file.place_name(0);
        let name = name.trim_end_matches('0').to_owned();
        file.read(from, |sample, place| {
            let time_s = sample.time_s;
            if index.count == 0 {
                index.first_s = time_s;
            } else if time_s <= index.last_s {
                return Err(InputError::invalid(format!(
                    "{name}{}: time {time_s} s is not after {} s, that of the sample before",
                    place.number, index.last_s
                )));
            } else if time_s - index.last_s > longest_gap_s {
                index.gaps += 1;
            }
            index.last_s = time_s;
            if index.begins(time_s, place) {
                read_bytes(place.byte);
            }
            Ok(true)
        })?;
        if index.count < 3 {
            return Err(InputError::invalid(format!(
                "{}: it holds {} samples; at least 3 are needed",
                file.name, index.count
            )));
        }
        Ok(index)
    }

    /// Counts a sample; returns `true` if a part begins with it.
    fn begins(&mut self, time_s: f64, place: SamplePlace) -> bool {
        let begins = self.count.is_multiple_of(self.part as u64);
        self.count += 1;
        if begins {
            self.push(time_s, place);
        }
        begins
    }

    fn push(&mut self, time_s: f64, place: SamplePlace) {
        if self.parts.len() == self.most {
            let mut place = 0;
            self.parts.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.part *= 2;
        }
        self.parts.push((time_s, place));
    }

    /// Returns the part of a time.
    pub(super) fn part(&self, time_s: f64) -> usize {
        let after = self.parts.partition_point(|(start, _)| *start <= time_s);
        after.saturating_sub(1)
    }

    /// Returns the place from which, and the number of samples with which, a part has its
    /// neighbours to both sides.
    pub(super) fn around(&self, part: usize) -> (SamplePlace, usize) {
        let first = part.saturating_sub(1);
        let place = self.parts.get(first).map(|(_, place)| *place);
        (place.unwrap_or_default(), (part + 2 - first) * self.part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_of_any_length_is_bounded_and_leads_to_every_sample() {
        let mut index = Index::new(4, 8);
        for (count, number) in (1..).zip(0..10_000_u32) {
            let place = SamplePlace {
                byte: u64::from(number),
                ..SamplePlace::default()
            };
            index.begins(f64::from(number), place);
            assert!(index.parts.len() <= 8);
            assert_eq!(index.count, count);
            let (first, length) = index.around(index.part(f64::from(number)));
            let samples = first.byte..first.byte + length as u64;
            assert!(samples.contains(&u64::from(number)), "{number}");
        }
        assert_eq!((index.part, index.parts.len()), (2048, 5));
        // A part in the middle is read with its neighbours.
        let (first, length) = index.around(index.part(4100.0));
        assert_eq!((first.byte, length), (2048, 3 * 2048));
    }
}
