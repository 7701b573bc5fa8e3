//! Recorded path of a stage.

/// Positions of the stage over time, straight in between.
///
/// # Units and frames
/// Times in s after the shutter's first light, rising; offsets in mm along the FMC axis from the
/// calibrated position. Before the first knot and after the last one the stage stands at that knot.
///
/// # Examples
/// ```
/// use fmc_simulation::scene::stage_path::StagePath;
/// let path = StagePath::new(vec![(0.0, 0.1), (0.002, 0.2), (0.004, 0.2)]).unwrap();
/// assert!((path.offset_mm(0.001) - 0.15).abs() < 1e-12);
/// assert_eq!(StagePath::new(vec![(0.0, 0.1), (0.0, 0.2)]), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StagePath {
    knots: Vec<(f64, f64)>,
}

impl StagePath {
    /// Creates the path through knots of (time, offset); `None` if there are no knots, if their
    /// times do not rise, or if a value is not a number.
    #[must_use]
    pub fn new(knots: Vec<(f64, f64)>) -> Option<Self> {
        let rising = knots
            .iter()
            .zip(knots.iter().skip(1))
            .all(|((one, _), (next, _))| one < next);
        let finite = knots
            .iter()
            .all(|(time, offset)| time.is_finite() && offset.is_finite());
        (rising && finite && !knots.is_empty()).then_some(Self { knots })
    }

    /// Returns the offset at a time, mm.
    #[must_use]
    pub fn offset_mm(&self, after_opening_s: f64) -> f64 {
        let next = self
            .knots
            .partition_point(|(time, _)| *time <= after_opening_s);
        let after = self.knots.get(next);
        let before = next.checked_sub(1).and_then(|last| self.knots.get(last));
        match (before, after) {
            (Some((from_s, from_mm)), Some((to_s, to_mm))) => {
                from_mm + (to_mm - from_mm) * (after_opening_s - from_s) / (to_s - from_s)
            }
            (Some((_, offset_mm)), None) | (None, Some((_, offset_mm))) => *offset_mm,
            (None, None) => 0.0,
        }
    }

    /// Returns the times of the knots, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> {
        self.knots.iter().map(|(time, _)| *time)
    }

    /// Returns the first and the last time, s.
    #[must_use]
    pub fn span_s(&self) -> [f64; 2] {
        let time = |knot: Option<&(f64, f64)>| knot.map_or(0.0, |(time, _)| *time);
        [time(self.knots.first()), time(self.knots.last())]
    }

    /// Returns the same path with knots at least `spacing_s` apart; the first and the last one
    /// stay.
    #[must_use]
    pub fn thinned(&self, spacing_s: f64) -> Self {
        let mut knots: Vec<(f64, f64)> = Vec::new();
        for (time, offset) in &self.knots {
            if knots
                .last()
                .is_none_or(|(last, _)| time - last >= spacing_s * (1.0 - 1e-9))
            {
                knots.push((*time, *offset));
            }
        }
        if let (Some(last), Some(end)) = (self.knots.last(), knots.last_mut())
            && end.0 < last.0
        {
            if knots.len() > 1 {
                knots.pop();
            }
            knots.push(*last);
        }
        Self { knots }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path() -> StagePath {
        let knots = (0..=20).map(|knot| {
            let time = 1e-4 * f64::from(knot);
            (time, 20.0 * time * time)
        });
        StagePath::new(knots.collect()).unwrap()
    }

    #[test]
    fn offset_is_straight_between_knots_and_stays_beyond_them() {
        let path = path();
        assert!((path.offset_mm(-1.0)).abs() < 1e-15);
        assert!((path.offset_mm(1.0) - 20.0 * 4e-6).abs() < 1e-15);
        let between = path.offset_mm(1.5e-4);
        assert!((between - 10.0 * (1e-8 + 4e-8)).abs() < 1e-15, "{between}");
        for bad in [vec![], vec![(0.0, f64::NAN)], vec![(1.0, 0.0), (0.5, 0.0)]] {
            assert_eq!(StagePath::new(bad), None);
        }
    }

    #[test]
    fn thinned_path_keeps_its_ends_and_the_places_of_its_knots() {
        let thin = path().thinned(5e-4);
        assert!(thin.times_s().count() <= 6);
        let [from, to] = thin.span_s();
        assert!(from.abs() < 1e-15 && (to - 2e-3).abs() < 1e-15);
        for time in thin.times_s() {
            assert!((thin.offset_mm(time) - path().offset_mm(time)).abs() < 1e-15);
        }
    }
}
