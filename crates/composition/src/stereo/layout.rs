//! Choice of the marks that are control.

/// Layouts of Zhao et al. 2013.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One control point in each corner; the others are check points.
    FourCorners,
    /// Two control points in each corner and two in the middle.
    DoubledCorners,
    /// All are control: no check.
    All,
}

impl Layout {
    /// All layouts, by control.
    pub const ALL: [Self; 3] = [Self::FourCorners, Self::DoubledCorners, Self::All];

    /// Name with 40 marks.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FourCorners => "4+36",
            Self::DoubledCorners => "10+30",
            Self::All => "40",
        }
    }

    /// Returns `true` for the marks that are control, from their places on the ground.
    #[must_use]
    pub fn control(self, marks_m: &[[f64; 2]]) -> Vec<bool> {
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for mark in marks_m {
            for ((least, most), at) in least.iter_mut().zip(&mut most).zip(mark) {
                *least = least.min(*at);
                *most = most.max(*at);
            }
        }
        let ([left, low], [right, high]) = (least, most);
        let corners = [[left, low], [right, low], [left, high], [right, high]];
        let middle = [0.5 * (left + right), 0.5 * (low + high)];
        let each = match self {
            Self::FourCorners => 1,
            Self::DoubledCorners => 2,
            Self::All => return vec![true; marks_m.len()],
        };
        let mut control = vec![false; marks_m.len()];
        let centre = (self == Self::DoubledCorners).then_some(middle);
        for place in corners.into_iter().chain(centre) {
            for _ in 0..each {
                let free = marks_m.iter().zip(&control).enumerate();
                let free = free.filter(|(_, (_, taken))| !**taken);
                let distance = |mark: &[f64; 2]| (mark[0] - place[0]).hypot(mark[1] - place[1]);
                let nearest =
                    free.min_by(|(_, (a, _)), (_, (b, _))| distance(a).total_cmp(&distance(b)));
                let number = nearest.map(|(number, _)| number);
                if let Some(slot) = number.and_then(|number| control.get_mut(number)) {
                    *slot = true;
                }
            }
        }
        control
    }
}
