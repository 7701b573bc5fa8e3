//! σ of a calibration against its error over many seeds.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::simulated::{LENS, Shape, Simulated};

const SEEDS: u64 = 1000;

/// Counts for each of the ten elements how often the error is below σ, and checks that all counts
/// lie within the 99.9 % binomial interval of 68.27 %: 1000·0.6827 ± 3.29·√(1000·0.6827·0.3173).
fn check(shape: Shape) {
    let mut inside = [0_u32; 10];
    for seed in 0..SEEDS {
        let simulated = Simulated::new(shape, 1 + seed);
        let network = &simulated.network;
        let solution = adjust(network, DatumChoice::Auto, &State::initial(network)).unwrap();
        let cofactors = Cofactors::of(network, &solution).unwrap();
        let interior = &solution.state.parameters.interior;
        for (index, (element, inside)) in InteriorElement::ALL
            .into_iter()
            .zip(&mut inside)
            .enumerate()
        {
            // The true σ of the observations is known: a priori σ.
            let sigma = cofactors.border[(index, index)].sqrt();
            *inside += u32::from((interior.value(element) - LENS.value(element)).abs() < sigma);
        }
    }
    for (element, inside) in InteriorElement::ALL.into_iter().zip(inside) {
        assert!(
            (634..=731).contains(&inside),
            "{element:?}: {inside} of 1000"
        );
    }
}

#[test]
fn resection_covers_one_sigma() {
    check(Shape::RESECTION);
}

#[test]
fn bundle_covers_one_sigma() {
    check(Shape::BUNDLE);
}
