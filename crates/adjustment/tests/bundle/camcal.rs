//! Close-range calibration by a printed sheet: Börlin and Grussenmeyer's camcal.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network::{Network, PointRole};
use fmc_adjustment::bundle::snooping::snooped;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::data::{ideal, oriented, tables};

/// Columns, rows and pixel pitch, µm.
const SENSOR: [f64; 3] = [2272.0, 1704.0, 3.191_103_286_384_976_6];

#[test]
fn every_printed_digit_of_the_solution_without_affinity() {
    let network = oriented(
        &tables("camcal", SENSOR),
        ideal(7.5),
        "f,x0,y0,k1,k2,k3,p1,p2",
    )
    .network;
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    let cofactors = Cofactors::of(&network, &solution).unwrap();
    assert_eq!(solution.redundancy(), 3726);
    // The file's σ is 0.1 px.
    let sigma0 = solution.sigma0();
    assert_eq!(format!("{:.6}", 0.1 * sigma0), "0.168901");
    // Published in DBAT's frame and sign: principal point from the corner, corrections.
    let [width, height, pixel_um] = SENSOR;
    let printed = [
        ("7.45740", 1.0, 0.0, "0.00109", 5),
        ("3.61589", 1.0, width * pixel_um / 2000.0, "0.000858", 6),
        ("2.60842", -1.0, height * pixel_um / 2000.0, "0.000988", 6),
        ("0.00457215", -1.0, 0.0, "0.0000231", 7),
        ("-0.0000426222", -1.0, 0.0, "0.00000276", 8),
        ("-0.00000216112", -1.0, 0.0, "0.000000105", 9),
        ("-0.0000656706", -1.0, 0.0, "0.00000367", 8),
        ("-0.0000296421", -1.0, 0.0, "0.00000405", 8),
    ];
    for (index, (element, (value, sign, offset, sigma, places))) in
        InteriorElement::ALL.into_iter().zip(printed).enumerate()
    {
        let found = cofactors.border[(index, index)].sqrt() * sigma0;
        assert_eq!(format!("{found:.places$}"), sigma, "{element:?}");
        // Half a unit of the last of six digits, and 1e-4 σ: the coordinates of the file are
        // rounded to 1e-7 mm, which is 5e-5 of their σ.
        let value: f64 = value.parse().unwrap();
        let unit = 10_f64.powf(value.abs().log10().floor() - 5.0);
        let difference = offset + sign * solution.state.parameters.interior.value(element) - value;
        assert!(
            difference.abs() < 0.5 * unit + 1e-4 * found,
            "{element:?}: {difference}"
        );
    }
    let [k2, k3] = [4, 5];
    let scale = (cofactors.border[(k2, k2)] * cofactors.border[(k3, k3)]).sqrt();
    assert_eq!(
        format!("{:.3}", cofactors.border[(k2, k3)] / scale),
        "-0.979"
    );
}

#[test]
fn control_that_does_not_fit_is_named_as_a_point() {
    let symbols = "f,x0,y0,k1,k2,k3,p1,p2";
    let network = oriented(&tables("camcal", SENSOR), ideal(7.5), symbols).network;
    let snooped = snooped(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    // The four corners are held as a square but lie on a rectangle, 0.7 mm longer along y; any of
    // them explains it.
    let [misfit] = &snooped.misfits[..] else {
        panic!("{:?}", snooped.misfits)
    };
    assert!(misfit.difference_m.norm() > 5e-4);
    assert_eq!(
        format!("{:.3}", 0.1 * snooped.sigma0_without_misfits),
        "0.149"
    );
    let of_control = snooped.network.image_points.iter().filter(|observed| {
        let point = &snooped.network.points[observed.point];
        !observed.accepted && point.role == PointRole::Control
    });
    assert_eq!(of_control.count(), 0);
    let rejected = snooped
        .network
        .image_points
        .iter()
        .filter(|observed| !observed.accepted);
    assert_eq!(rejected.count(), 6);
}

#[test]
fn affinity_and_minimal_datum() {
    let with_b1 = "f,x0,y0,k1,k2,k3,p1,p2,b1";
    let mut network = oriented(&tables("camcal", SENSOR), ideal(7.5), with_b1).network;
    let solve = |network: &Network| {
        let solution = adjust(network, DatumChoice::Auto, &State::initial(network)).unwrap();
        let cofactors = Cofactors::of(network, &solution).unwrap();
        let sigma = |index: usize| cofactors.border[(index, index)].sqrt() * solution.sigma0();
        let interior = solution.state.parameters.interior;
        (
            0.1 * solution.sigma0(),
            solution.redundancy(),
            interior.principal_distance_mm,
            sigma(0),
            interior.b[0],
            sigma(8),
        )
    };
    let (sigma0, redundancy, f, sigma_f, b1, sigma_b1) = solve(&network);
    assert!((sigma0 - 0.161_219).abs() < 1.5e-6 && redundancy == 3725);
    assert!((f - 7.457_073).abs() < 1e-6 && (sigma_f - 0.001_044).abs() < 1e-6);
    assert!((b1 + 0.000_411_02).abs() < 1e-8 && (sigma_b1 - 2.152e-5).abs() < 1e-8);
    // A minimal datum: the corners are initial values.
    for point in &mut network.points {
        point.role = PointRole::Tie;
    }
    let (sigma0, redundancy, f, sigma_f, ..) = solve(&network);
    assert!((sigma0 - 0.142_319).abs() < 1.5e-6 && redundancy == 3720);
    assert!((f - 7.45697).abs() < 1e-5 && (sigma_f - 0.000_923).abs() < 1e-6);
}
