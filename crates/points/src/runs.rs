//! Runs of equal numbers.

/// Returns the places of numbers; those that follow each other and are equal are found once.
///
/// # Examples
/// ```
/// let places = fmc_points::places(&[30, 30, 10], &|number| number / 10);
/// assert_eq!(places, [3, 3, 1]);
/// ```
#[inline(never)]
#[must_use]
pub fn places(numbers: &[i64], find: &dyn Fn(i64) -> i64) -> Vec<i64> {
    let mut places = Vec::with_capacity(numbers.len());
    while let Some(number) = numbers.get(places.len()).copied() {
        let behind = numbers.get(places.len()..).unwrap_or_default();
        let length = places.len() + repeated(number, behind);
        places.resize(length, find(number));
    }
    places
}

/// Returns how many numbers at the beginning are the same as `number`.
pub(crate) fn repeated(number: i64, numbers: &[i64]) -> usize {
    const FEW: usize = 8;
    const BLOCK: usize = 128;
    let run = |numbers: &[i64]| numbers.iter().take_while(|one| **one == number).count();
    // In random order a block would cost more than the point.
    let (few, rest) = numbers.split_at(numbers.len().min(FEW));
    let found = run(few);
    if found < few.len() {
        return found;
    }
    // Whole blocks take vectors, for which the loop must not end early, nor compare: what every
    // machine has cannot compare numbers of this size. A loop of constant length is unrolled as a
    // whole and then reads backwards, which takes five times as long.
    let differences = |block: &[i64]| block.iter().fold(0, |bits, one| bits | (one ^ number));
    let blocks = rest.chunks(BLOCK);
    let alike = blocks.take_while(|block| differences(block) == 0);
    let whole = alike.map(<[i64]>::len).sum();
    found + whole + run(rest.get(whole..).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn run_ends_at_the_first_other_number_wherever_it_is() {
        for length in 1..700 {
            let mut numbers = vec![-4; length];
            assert_eq!(repeated(-4, &numbers), length);
            numbers.extend([5, -4, -4]);
            assert_eq!(repeated(-4, &numbers), length);
        }
        assert_eq!(repeated(-4, &[]), 0);
    }
}
