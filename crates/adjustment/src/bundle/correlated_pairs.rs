//! Pairs of shared unknowns that a flight hardly tells apart, with what would tell them apart.

use super::interior::InteriorElement;
use super::parameters::Parameter;
use super::stage::StageElement;

/// An unknown by the way in which it moves the ground of one image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effect {
    /// f: with the height above ground, vertically.
    Distance,
    /// x0, y0: with the height above ground, in camera axes.
    Point,
    /// s, α: with c̄ and the height above ground, in camera axes.
    Travel,
    /// z1: with c̄ and the height above ground, vertically.
    RunOut,
    /// dt: with the speed.
    Time,
    /// Horizontal components of the lever arm: constant, in camera axes.
    Arm,
    /// Vertical component of the lever arm: constant.
    VerticalArm,
    /// b: with the height above ground.
    Boresight,
    /// Shift of a strip: constant, in ground axes.
    Shift,
}

impl Effect {
    const fn of(parameter: Parameter) -> Option<Self> {
        match parameter {
            Parameter::Interior(InteriorElement::PrincipalDistance) => Some(Self::Distance),
            Parameter::Interior(InteriorElement::X0 | InteriorElement::Y0) => Some(Self::Point),
            Parameter::Stage(StageElement::Scale | StageElement::AxisAngle) => Some(Self::Travel),
            Parameter::Stage(StageElement::RunOut) => Some(Self::RunOut),
            Parameter::TimeOffset => Some(Self::Time),
            Parameter::LeverArm(2) => Some(Self::VerticalArm),
            Parameter::LeverArm(_) => Some(Self::Arm),
            Parameter::Boresight(_) => Some(Self::Boresight),
            Parameter::Shift { .. } => Some(Self::Shift),
            Parameter::Interior(_) | Parameter::Additional(_) | Parameter::Point { .. } => None,
        }
    }
}

/// Returns what would tell two correlated unknowns apart, in words; `None` for a pair of which no
/// change of the flight is known to help.
#[must_use]
pub const fn remedy(a: Parameter, b: Parameter) -> Option<&'static str> {
    use Effect::{Arm, Boresight, Distance, Point, RunOut, Shift, Time, Travel, VerticalArm};
    let (Some(a), Some(b)) = (Effect::of(a), Effect::of(b)) else {
        return None;
    };
    match (a, b) {
        (Travel | RunOut, _) | (_, Travel | RunOut) => {
            Some("exposures at other V/H and exposure times, so that c̄ varies")
        }
        (Time, Point) | (Point, Time) => Some("strips at another V/H"),
        (Time, Arm | VerticalArm) | (Arm | VerticalArm, Time) => {
            Some("strips at another speed over ground")
        }
        (Point | Distance, Boresight) | (Boresight, Point | Distance) => {
            Some("an interior orientation held from the laboratory")
        }
        (Shift, Arm | VerticalArm | Time) | (Arm | VerticalArm | Time, Shift) => {
            Some("cross strips, or control points")
        }
        (Distance | Point | Boresight, Arm | VerticalArm | Shift)
        | (Arm | VerticalArm | Shift, Distance | Point | Boresight) => Some("two flying heights"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_a_flight_have_a_remedy_in_either_order() {
        let y0 = Parameter::Interior(InteriorElement::Y0);
        let f = Parameter::Interior(InteriorElement::PrincipalDistance);
        let scale = Parameter::Stage(StageElement::Scale);
        for (a, b, words) in [
            (Parameter::TimeOffset, Parameter::LeverArm(1), "speed"),
            (y0, Parameter::TimeOffset, "V/H"),
            (y0, Parameter::LeverArm(1), "two flying heights"),
            (f, Parameter::LeverArm(2), "two flying heights"),
            (scale, y0, "c̄ varies"),
            (Parameter::Stage(StageElement::RunOut), f, "c̄ varies"),
            (
                Parameter::Shift { strip: 0, axis: 0 },
                Parameter::LeverArm(0),
                "cross strips",
            ),
        ] {
            for found in [remedy(a, b), remedy(b, a)] {
                assert!(found.unwrap().contains(words), "{found:?}");
            }
        }
    }

    #[test]
    fn coefficients_of_the_lens_have_none() {
        let [k1, p1] = [InteriorElement::K1, InteriorElement::P1].map(Parameter::Interior);
        assert_eq!(remedy(k1, p1), None);
    }
}
