//! Seam of least cost through an overlap.

/// Cost of a place where one image has no content, or next to it.
const OUTSIDE: f32 = 1e9;

/// Returns the cheapest path through a table of costs, one column per row, whose columns differ by
/// at most one from row to row: dynamic programming, exact.
///
/// `cost(row, col)` is asked once for each place.
pub(super) fn cheapest_path(
    rows: usize,
    columns: usize,
    cost: impl Fn(usize, usize) -> f32,
) -> Vec<usize> {
    let mut sums = vec![0.0_f32; columns];
    // Way from the row above: 0 from the left, 1 straight, 2 from the right.
    let mut ways: Vec<u8> = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        let above = sums.clone();
        for (col, sum) in sums.iter_mut().enumerate() {
            let candidates = [col.checked_sub(1), Some(col), Some(col + 1)];
            let mut best = (1_u8, f32::INFINITY);
            for (way, from) in (0_u8..).zip(candidates) {
                let Some(of_above) = from.and_then(|from| above.get(from).copied()) else {
                    continue;
                };
                // A straight path wins over an equal one.
                let of_above = if way == 1 {
                    of_above
                } else {
                    of_above + f32::EPSILON
                };
                if of_above < best.1 {
                    best = (way, of_above);
                }
            }
            *sum = cost(row, col) + if row == 0 { 0.0 } else { best.1 };
            ways.push(best.0);
        }
    }
    let least = sums.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
    let mut col = least.map_or(0, |(col, _)| col);
    let mut path = vec![0; rows];
    for (row, slot) in path.iter_mut().enumerate().rev() {
        *slot = col;
        col = match ways.get(row * columns + col) {
            Some(0) => col.saturating_sub(1),
            Some(2) => col + 1,
            _ => col,
        };
    }
    path
}

/// Cost of a seam at a place: absolute difference and gradients of both; very much where one has
/// no content.
pub(super) fn cost(a: [u16; 3], b: [u16; 3]) -> f32 {
    if a.contains(&0) || b.contains(&0) {
        return OUTSIDE;
    }
    let [of_a, a_right, a_down] = a.map(f32::from);
    let [of_b, b_right, b_down] = b.map(f32::from);
    let gradients =
        |value: f32, right: f32, down: f32| (right - value).abs() + (down - value).abs();
    (of_a - of_b).abs()
        + 0.1 * (gradients(of_a, a_right, a_down) + gradients(of_b, b_right, b_down))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_follows_the_cheapest_columns_one_step_at_a_time() {
        let cheap = [3, 4, 4, 3, 2, 1];
        let path = cheapest_path(6, 8, |row, col| if cheap[row] == col { 0.0 } else { 5.0 });
        assert_eq!(path, cheap);
    }

    #[test]
    fn path_costs_no_more_than_any_other() {
        let mut random = 1_u32;
        let costs: Vec<f32> = (0..30)
            .map(|_| {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f32::from(u16::try_from(random >> 24).unwrap())
            })
            .collect();
        let at = |row: usize, col: usize| costs[row * 5 + col];
        let found = cheapest_path(6, 5, at);
        let sum = |path: &[usize]| (0..).zip(path).map(|(row, col)| at(row, *col)).sum::<f32>();
        let mut least = f32::INFINITY;
        for code in 0..5 * 3_usize.pow(5) {
            let (mut col, mut rest) = (i32::try_from(code % 5).unwrap(), code / 5);
            let mut path = vec![usize::try_from(col).unwrap()];
            for _ in 0..5 {
                col += i32::try_from(rest % 3).unwrap() - 1;
                rest /= 3;
                path.extend(usize::try_from(col).ok().filter(|col| *col < 5));
            }
            if path.len() == 6 {
                least = least.min(sum(&path));
            }
        }
        assert!(
            (sum(&found) - least).abs() < 1e-3,
            "{} {least}",
            sum(&found)
        );
    }
}
