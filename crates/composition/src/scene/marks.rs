//! Ground marks.

use crate::number::real;

/// Parts of a step of the sequence of marks: inverse powers of the plastic number, whose multiples
/// fill a square evenly.
const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// A ground mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Name.
    pub id: String,
    /// True place, m.
    pub ground_m: [f64; 3],
}

/// Returns so many places spread evenly over a rectangle.
pub(super) fn marks(count: usize, least: [f64; 2], most: [f64; 2]) -> Vec<[f64; 2]> {
    let places = (1..=count).map(|number| {
        let part = STEP.map(|step| (0.5 + step * real(number)).fract());
        let [x, y] = part;
        [
            least[0] + (most[0] - least[0]) * x,
            least[1] + (most[1] - least[1]) * y,
        ]
    });
    places.collect()
}
