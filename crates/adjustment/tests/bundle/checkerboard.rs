//! Resection over a checkerboard: test data of `OpenCV`.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::snooping::snooped;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::data::{ideal, oriented, tables};

/// Columns, rows and pixel pitch, µm: with this pitch 1 mm is 100 px.
const SENSOR: [f64; 3] = [640.0, 480.0, 10.0];

#[test]
fn resection_of_seven_views() {
    let network = oriented(
        &tables("checkerboard", SENSOR),
        ideal(8.0),
        "f,x0,y0,k1,k2,p1,p2,b1",
    )
    .network;
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    let cofactors = Cofactors::of(&network, &solution).unwrap();
    assert_eq!(solution.redundancy(), 440);
    let sigma0 = solution.sigma0();
    assert_eq!(format!("{:.4}", 0.1 * sigma0), "0.1040");
    let points = f64::from(u32::try_from(network.image_points.len()).unwrap());
    let rms_px = 0.1 * (solution.cost / points).sqrt();
    assert_eq!(format!("{rms_px:.4}"), "0.1393");
    let interior = solution.state.parameters.interior;
    let sigma = |index: usize| cofactors.border[(index, index)].sqrt() * sigma0;
    assert_eq!(
        format!("{:.1}", 100.0 * interior.principal_distance_mm),
        "804.8"
    );
    assert_eq!(format!("{:.1}", 100.0 * sigma(0)), "5.7");
    let [x0, y0] = interior.principal_point_mm;
    assert!((319.5 + 100.0 * x0 - 361.4969).abs() < 2e-3);
    assert!((239.5 - 100.0 * y0 - 204.9652).abs() < 2e-3);
    assert!((interior.b[0] - 0.012_294_7).abs() < 1e-6);
    assert!((sigma(7) - 0.00552).abs() < 1e-5);
    let snooped = snooped(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    assert!(snooped.misfits.is_empty());
    assert!(
        snooped
            .network
            .image_points
            .iter()
            .all(|observed| observed.accepted)
    );
}
