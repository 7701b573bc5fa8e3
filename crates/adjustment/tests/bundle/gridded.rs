//! Flights with a lens of polynomial and residual grids: the grids that are held beside the
//! polynomial are taken off exactly, and the adjustment finds camera and stations without bias.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions, GrossErrors};
use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::eliminated_point::WeightedRay;
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::layout::Layout;
use fmc_adjustment::bundle::network::Network;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::records::{FlightRecords, RecordRow};
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::stage::Stage;
use fmc_adjustment::bundle::state::State;
use fmc_adjustment::bundle::tables::NetworkTables;
use fmc_reference::residual_spline::ResidualSpline;
use fmc_reference::residual_splines::ResidualSplines;

use crate::aerial::{CROSSED, F_MM, Flight, Platform};

/// Camera of the flights; 0.2 % of distortion at the corner.
const TRUTH: Interior = Interior {
    principal_distance_mm: F_MM,
    principal_point_mm: [0.12, -0.2],
    k: [0.0, -2e-6, 3e-10, 0.0],
    p: [2e-6, -3e-6],
    b: [0.0; 2],
};

/// Elements that are estimated.
const ESTIMATED: [InteriorElement; 7] = [
    InteriorElement::PrincipalDistance,
    InteriorElement::X0,
    InteriorElement::Y0,
    InteriorElement::K1,
    InteriorElement::K2,
    InteriorElement::P1,
    InteriorElement::P2,
];

/// Grids of waves of some micrometres, 12 to 25 mm long: 5 µm in the lens, 3 µm in the sensor.
fn grids() -> ResidualSplines {
    let spline = |size: f64, phase: f64| {
        let nodes = (0..1024_u16).map(|node| {
            let [column, row] = [node % 32, node / 32].map(f64::from);
            [
                size * (0.6 * column + 0.3 * row + phase).sin(),
                size * (0.5 * row - 0.8 * column + 2.0 * phase).cos(),
            ]
        });
        ResidualSpline::new([-31.0; 2], 2.0, 32, nodes.collect())
    };
    ResidualSplines::new(Some(spline(5e-3, 0.4)), Some(spline(3e-3, 1.7)))
}

fn flight(stage: Option<Stage>) -> Flight {
    Flight {
        strips: CROSSED.to_vec(),
        platform: Platform::default(),
        tilt_rad: 0.02,
        control: 6,
        stage,
    }
}

/// Returns the measured point whose ideal point is given, both of one exposure: the camera of the
/// flight has no distortion and its calibrated principal point in the middle.
///
/// # Model
/// With ρ = (measured - PP - c̄·e)/(1+κ): `ρ - D(ρ) - L((measured - c̄·e)/(1+κ)) - S(measured)` is
/// the ideal point of the calibrated focus, by iteration.
fn measured(ideal: [f64; 2], record: &RecordRow, grids: &ResidualSplines) -> [f64; 2] {
    let [x0, y0] = TRUTH.principal_point_mm;
    let (c, scale) = (record.offset_mm, 1.0 + record.enlargement);
    let aim = [ideal[0] / scale, (ideal[1] - c) / scale];
    let mut rho = aim;
    for _ in 0..60 {
        let point = [x0 + scale * rho[0], y0 + c + scale * rho[1]];
        let distortion = TRUTH.distortion(rho);
        let of_lens = grids.of_lens([point[0] / scale, (point[1] - c) / scale]);
        let of_sensor = grids.of_sensor(point);
        rho = [0, 1].map(|axis| aim[axis] + distortion[axis] + of_lens[axis] + of_sensor[axis]);
    }
    [x0 + scale * rho[0], y0 + c + scale * rho[1]]
}

/// Returns the tables of a flight through the lens, and its records; without a stage those of one
/// that rests.
fn flown(flight: &Flight, seed: u64, grids: &ResidualSplines) -> (NetworkTables, FlightRecords) {
    let mut records = flight.records();
    if flight.stage.is_none() {
        for row in &mut records.table.rows {
            (row.offset_mm, row.enlargement) = (0.0, 0.0);
        }
    }
    records.principal_point_mm = TRUTH.principal_point_mm;
    let mut tables = flight.tables(seed);
    for row in &mut tables.image_points.rows {
        let sequence: usize = row.image.parse().unwrap();
        row.measured_mm = measured(row.measured_mm, &records.table.rows[sequence], grids);
    }
    (tables, records)
}

fn unknowns() -> Unknowns {
    Unknowns {
        estimated: ESTIMATED.map(Parameter::Interior).to_vec(),
        priors: Vec::new(),
    }
}

/// Returns all residuals of image points in a state of two networks of the same points, mm.
fn residuals(network: &Network, interior: Interior, poses: &Flight) -> Vec<[f64; 2]> {
    let layout = Layout::new(network).unwrap();
    let mut state = State::initial(network);
    state.parameters.interior = interior;
    let (points, stations) = poses.field();
    for (pose, image) in state.poses.iter_mut().zip(&network.images) {
        *pose = stations[image.name.parse::<usize>().unwrap()].pose;
    }
    for (place, point) in state.points_m.iter_mut().zip(&network.points) {
        *place = points[point.name[1..].parse::<usize>().unwrap()];
    }
    let rays = network.image_points.iter().map(|observed| {
        let ray = WeightedRay::new(network, &layout, &state, observed).unwrap();
        (observed.sigma_mm * ray.residual).into()
    });
    rays.collect()
}

/// Largest difference of residuals, mm.
fn apart(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn residuals_are_those_of_the_flight_without_lens_and_grids() {
    let flight = flight(Some(Stage::default()));
    let network = |tables: &NetworkTables| tables.network(TRUTH, &unknowns()).unwrap().network;
    let ideal = Interior {
        principal_point_mm: [0.0; 2],
        k: [0.0; 4],
        p: [0.0; 2],
        ..TRUTH
    };
    let plain = residuals(&network(&flight.with_records(1)), ideal, &flight);
    assert!(plain.len() > 400);
    let grids = grids();
    let (tables, records) = flown(&flight, 1, &grids);
    let with = |grids: &ResidualSplines| {
        let records = FlightRecords {
            grids: grids.clone(),
            ..records.clone()
        };
        let tables = records.reduced(&tables).unwrap();
        residuals(&network(&tables), TRUTH, &flight)
    };
    let exact = apart(&with(&grids), &plain);
    assert!(exact < 1e-9, "{exact}");
    // The lens's grid at rest, c̄ up to 70 µm: a slope of 1.6e-3 leaves 0.1 µm.
    let mut at_rest = records.reduced(&tables).unwrap();
    let measured = tables.clone().with_grids(&grids).image_points.rows;
    for (row, at_rest) in at_rest.image_points.rows.iter_mut().zip(measured) {
        row.by_grids_mm = at_rest.by_grids_mm;
    }
    let unmoved = apart(&residuals(&network(&at_rest), TRUTH, &flight), &plain);
    assert!(unmoved > 5e-5, "{unmoved}");
    let without = apart(&with(&ResidualSplines::NONE), &plain);
    assert!(without > 5e-3, "{without}");
}

/// Flights of the test of bias.
const SEEDS: u32 = 40;

/// Sums over flights.
#[derive(Debug, Default)]
struct Sums {
    /// Errors over σ of the estimated elements.
    elements: [f64; ESTIMATED.len()],
    /// Squares of them.
    squares: f64,
    /// Errors of the stations along x, y and z, m, and their squares.
    stations: [f64; 3],
    station_squares: f64,
    /// σ0.
    sigma0: f64,
}

/// Adjusts flights from a start that is off, with these grids held.
fn adjusted(flight: &Flight, held: &ResidualSplines) -> Sums {
    let start = Interior {
        principal_distance_mm: F_MM + 0.03,
        principal_point_mm: TRUTH.principal_point_mm,
        k: [0.0; 4],
        p: [0.0; 2],
        b: [0.0; 2],
    };
    let (_, stations) = flight.field();
    let mut sums = Sums::default();
    for seed in 1..=u64::from(SEEDS) {
        let (tables, records) = flown(flight, seed, &grids());
        let tables = if flight.stage.is_some() {
            let records = FlightRecords {
                grids: held.clone(),
                ..records
            };
            records.reduced(&tables).unwrap()
        } else {
            tables.with_grids(held)
        };
        let network = crate::aerial::oriented_from(&tables, start, &unknowns());
        let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
        let cofactors = Cofactors::of(&network, &solution).unwrap();
        let found = &solution.state.parameters.interior;
        for (sum, element) in sums.elements.iter_mut().zip(ESTIMATED) {
            let column = solution
                .layout
                .column(Parameter::Interior(element))
                .unwrap();
            let error = found.value(element) - TRUTH.value(element);
            let ratio = error / cofactors.border[(column, column)].sqrt();
            *sum += ratio;
            sums.squares += ratio * ratio;
        }
        for (image, pose) in network.images.iter().zip(&solution.state.poses) {
            let truth = stations[image.name.parse::<usize>().unwrap()].pose;
            for (axis, sum) in sums.stations.iter_mut().enumerate() {
                let error = pose.position_m[axis] - truth.position_m[axis];
                *sum += error;
                sums.station_squares += error * error;
            }
        }
        sums.sigma0 += solution.sigma0() / f64::from(SEEDS);
    }
    sums
}

#[test]
fn camera_and_stations_are_found_without_bias_with_the_grids_and_not_without_them() {
    let flights = f64::from(SEEDS);
    for stage in [Some(Stage::default()), None] {
        let flight = flight(stage);
        let found = adjusted(&flight, &grids());
        assert!((found.sigma0 - 1.0).abs() < 0.01, "{found:?}");
        for sum in found.elements {
            // Errors in units of their σ: the standard error of their mean is 1/√n.
            assert!(sum.abs() / flights.sqrt() < 4.0, "{found:?}");
        }
        // Squares over σ² have the mean 1 and the variance 2; correlated elements count as one.
        let mean = found.squares / (7.0 * flights);
        assert!(
            (mean - 1.0).abs() < 4.0 * (2.0 / flights).sqrt(),
            "{found:?}"
        );
        let images = flights * 24.0;
        let rms = (found.station_squares / (3.0 * images)).sqrt();
        // Stations of one flight err together: each flight counts as one of them.
        for sum in found.stations {
            let mean = sum / images;
            assert!(mean.abs() < 4.0 * rms / flights.sqrt(), "{mean} {rms}");
        }
        let without = adjusted(&flight, &ResidualSplines::NONE);
        assert!(without.sigma0 > 2.0, "{without:?}");
        let most = without
            .elements
            .iter()
            .fold(0.0_f64, |most, sum| most.max(sum.abs()));
        assert!(most / flights > 3.0, "{without:?}");
        assert!(
            without.station_squares > 1.5 * found.station_squares,
            "{without:?} {found:?}"
        );
    }
}

#[test]
fn calibration_by_records_holds_the_grids_in_every_trial() {
    let flight = flight(Some(Stage::default()));
    let (tables, records) = flown(&flight, 3, &grids());
    let options = CalibrationOptions {
        unknowns: unknowns(),
        gross_errors: GrossErrors::Keep,
        ..CalibrationOptions::default()
    };
    let sigma0 = |grids: ResidualSplines| {
        let records = FlightRecords {
            grids,
            ..records.clone()
        };
        let tables = records.reduced(&tables).unwrap();
        let calibration = BundleCalibration::new(&tables, TRUTH, &options).unwrap();
        calibration.snooped.solution.sigma0()
    };
    let (with, without) = (sigma0(grids()), sigma0(ResidualSplines::NONE));
    assert!((with - 1.0).abs() < 0.1, "{with}");
    assert!(without > 2.0, "{without}");
}
