//! Geometry of networks: σ that the arrangement of the images decides.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::geometry::{is_plane_without_tilt, largest_roll_deg};
use fmc_adjustment::bundle::solution::{DatumChoice, Solution, adjust};
use fmc_adjustment::bundle::state::State;

use crate::simulated::{Shape, Simulated};

/// Returns σ of x0 and y0, µm, and the solution.
fn principal_point(shape: Shape) -> ([f64; 2], Solution) {
    let network = Simulated::new(shape, 21).network;
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    let cofactors = Cofactors::of(&network, &solution).unwrap();
    let sigma = [1, 2].map(|index| 1000.0 * cofactors.border[(index, index)].sqrt());
    (sigma, solution)
}

#[test]
fn images_rolled_in_turn_tell_the_principal_point_from_the_attitude() {
    let (rolled, solution) = principal_point(Shape::BUNDLE);
    assert!(largest_roll_deg(&solution.state.poses) > 170.0);
    let (unrolled, solution) = principal_point(Shape {
        roll_deg: 0.0,
        ..Shape::BUNDLE
    });
    assert!(largest_roll_deg(&solution.state.poses) < 45.0);
    assert!(!is_plane_without_tilt(&solution));
    for (rolled, unrolled) in rolled.into_iter().zip(unrolled) {
        assert!(rolled < 3.0, "{rolled}");
        assert!(unrolled > 3.0 * rolled, "{unrolled} {rolled}");
    }
}

#[test]
fn plane_field_without_tilt_is_recognised() {
    let shape = Shape {
        depth_m: 0.0,
        tilt_deg: 3.0,
        held: true,
        ..Shape::BUNDLE
    };
    let (_, solution) = principal_point(shape);
    assert!(is_plane_without_tilt(&solution));
}
