//! Five aerial images with weighted control: Börlin and Grussenmeyer's Strasbourg block.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::snooping::snooped;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::data::{answers, ideal, oriented, tables};

#[test]
fn every_printed_digit() {
    let tables = tables("strasbourg", [8858.0, 12996.0, 6.0]);
    let network = oriented(&tables, ideal(123.9392), "").network;
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    assert_eq!(solution.observations, 2434);
    assert_eq!(solution.redundancy(), 1261);
    assert_eq!(format!("{:.4}", solution.sigma0()), "1.1786");
    assert_eq!(format!("{:.4}", solution.cost.sqrt()), "41.8527");
    let cofactors = Cofactors::of(&network, &solution).unwrap();
    let images = cofactors.images.as_ref().unwrap();
    let answers = answers("strasbourg");
    for (number, image) in network.images.iter().enumerate() {
        let Some(station) = answers["stations_m"].get(&image.name) else {
            continue;
        };
        for axis in 0..3 {
            let printed = station[axis].as_f64().unwrap();
            let found = solution.state.poses[number].position_m[axis];
            assert!((found - printed).abs() < 1e-6, "{} {axis}", image.name);
            let printed = answers["station_sigma_m"][&image.name][axis]
                .as_f64()
                .unwrap();
            let sigma = images.block(number, number)[(axis, axis)].sqrt() * solution.sigma0();
            assert!((sigma / printed - 1.0).abs() < 5e-3, "{sigma} {printed}");
        }
    }
    for (number, point) in network.points.iter().enumerate() {
        let Some(printed) = answers["check_minus_given_m"].get(&point.name) else {
            continue;
        };
        let difference = solution.state.point(number) - point.given_m;
        for axis in 0..3 {
            let printed = printed[axis].as_f64().unwrap();
            assert!((difference[axis] - printed).abs() < 1e-3);
        }
    }
    let snooped = snooped(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    // Six of 1196 image points exceed Pope's τ of 4.24; the control fits.
    assert_eq!(snooped.misfits, []);
    let rejected = snooped
        .network
        .image_points
        .iter()
        .filter(|observed| !observed.accepted);
    assert_eq!(rejected.count(), 6);
}
