//! σ of V/H and predicted smear over random flights: both are judged by their coverage.

use fmc_camera::flight::frame_record::Outcome;
use fmc_simulation::mission::file::{VhSourceName, VhTable};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::flown;

/// Flights, and frames of each.
const FLIGHTS: u64 = 120;
const FRAMES: u32 = 15;

/// Returns a flight drawn at random: sources, their noise and latency, gusts, terrain, attitude.
fn random_flight(random: &mut fastrand::Rng) -> MissionScenario {
    let mut between = |least: f64, most: f64| least + (most - least) * random.f64();
    let mut scenario = MissionScenario::nominal(Some(FRAMES)).unwrap();
    let written = &mut scenario.written;
    let gust_m_s = between(0.0, 5.0);
    written.air.gust_rms_m_s = [gust_m_s, gust_m_s, 0.5 * gust_m_s];
    written.flight.height_m = between(800.0, 1500.0);
    let above_ground_m = written.flight.height_m - written.terrain.height_m;
    written.flight.speed_m_s = between(0.07, 0.15) * above_ground_m;
    written.flight.exposure_s = between(0.001, 0.006);
    written.terrain.relief_m = between(0.0, 0.04) * above_ground_m;
    written.terrain.wavelength_m = between(3000.0, 8000.0);
    let rate_deg_s = between(0.005, 0.05);
    written.attitude.rate_rms_deg_s = [rate_deg_s; 3];
    written.attitude.pitch_deg = between(-1.0, 1.0);
    written.attitude.roll_deg = between(-1.0, 1.0);
    written.attitude.drift_deg = between(-1.0, 1.0);
    written.attitude.reported_hz = if between(0.0, 1.0) < 0.5 {
        0.0
    } else {
        between(20.0, 100.0)
    };
    let sources = [
        &[VhSourceName::Direct][..],
        &[VhSourceName::Altimeter],
        &[VhSourceName::Laser],
        &[VhSourceName::Terrain],
        &[VhSourceName::Direct, VhSourceName::Altimeter],
        &[VhSourceName::Altimeter, VhSourceName::Laser],
        &[VhSourceName::Laser, VhSourceName::Terrain],
        &[VhSourceName::Direct, VhSourceName::Terrain],
    ];
    let drawn = between(0.0, 8.0);
    let mut names = &sources[0];
    for (number, candidate) in (0_u8..).zip(&sources) {
        if drawn >= f64::from(number) {
            names = candidate;
        }
    }
    written.vh = names
        .iter()
        .map(|source| VhTable {
            source: *source,
            rate_hz: between(1.0, 20.0),
            sigma_percent: between(0.05, 0.5),
            latency_ms: between(0.0, 500.0),
        })
        .collect();
    scenario.interval_s = between(0.6, 1.5);
    scenario
}

/// Errors of V/H in units of its σ, and true smear over the predicted, of the frames of a flight.
fn statistics(flown: &Flown) -> Vec<[f64; 2]> {
    flown
        .frames
        .iter()
        .filter_map(|frame| {
            let Outcome::Exposed(exposed) = frame.record.outcome else {
                return None;
            };
            let (vh, truth) = (exposed.vh?, frame.truth?);
            let error = f64::from(vh.vh_per_s) - truth.vh_per_s;
            let predicted_mm = f64::from(exposed.smear_um) / 1000.0;
            Some([
                error / f64::from(vh.sigma_per_s),
                truth.smear_mm / predicted_mm,
            ])
        })
        .collect()
}

/// Coverage over many frames.
#[derive(Debug)]
struct Coverage {
    frames: usize,
    /// Root mean square of error/σ of V/H.
    rms: f64,
    /// Part of the frames with an error beyond 5 σ, and the largest error/σ.
    beyond_5_sigma: f64,
    largest: f64,
    /// Part of the frames whose smear is above the predicted one.
    smear_above: f64,
    /// Inverse of the mean of true over predicted smear.
    predicted_over_true: f64,
}

impl Coverage {
    fn of(frames: &[[f64; 2]]) -> Self {
        let count = f64::from(u32::try_from(frames.len()).unwrap());
        let share = |is: &dyn Fn(&[f64; 2]) -> bool| {
            let number = frames.iter().filter(|frame| is(frame)).count();
            f64::from(u32::try_from(number).unwrap()) / count
        };
        let mean_square = frames.iter().map(|[error, _]| error * error).sum::<f64>() / count;
        Self {
            frames: frames.len(),
            rms: mean_square.sqrt(),
            beyond_5_sigma: share(&|[error, _]| error.abs() > 5.0),
            largest: frames
                .iter()
                .map(|[error, _]| error.abs())
                .fold(0.0, f64::max),
            smear_above: share(&|[_, smear]| *smear > 1.0),
            predicted_over_true: count / frames.iter().map(|[_, smear]| smear).sum::<f64>(),
        }
    }
}

#[test]
fn sigma_of_vh_and_predicted_smear_cover_the_errors_of_random_flights() {
    let mut random = fastrand::Rng::with_seed(15);
    let mut frames = Vec::new();
    for seed in 0..FLIGHTS {
        let scenario = random_flight(&mut random);
        frames.extend(statistics(&flown(&scenario, seed)));
    }
    let found = Coverage::of(&frames);
    eprintln!("{found:?}");
    assert!(found.frames >= 800, "{found:?}");
    assert!((0.8..=1.3).contains(&found.rms), "{found:?}");
    assert!(found.beyond_5_sigma <= 0.001, "{found:?}");
    // A source may contradict the others for a while; no error is beyond any bound.
    assert!(found.largest < 8.0, "{found:?}");
    assert!(found.smear_above <= 0.05, "{found:?}");
    // A prediction that is far too large covers everything, and says nothing.
    assert!(found.predicted_over_true <= 3.0, "{found:?}");
}

/// Flights with a TDI sensor, and frames of each.
const TDI_FLIGHTS: u32 = 30;
const TDI_FRAMES: u32 = 8;

#[test]
fn predicted_smear_of_a_tdi_sensor_has_the_row_by_which_the_image_moves_on_the_charge() {
    let bench = tempfile::tempdir().unwrap();
    std::fs::create_dir(bench.path().join("cameras")).unwrap();
    let mut random = fastrand::Rng::with_seed(7);
    let mut frames = Vec::new();
    let (mut with_transfers, mut without) = (0, 0);
    for seed in 0..TDI_FLIGHTS {
        let first_transfer = random.f32();
        let camera = include_str!("../../scenarios/cameras/mission.toml")
            .replace(
                "strategy = \"centred\"",
                &format!("mechanism = \"tdi\"\nfirst_transfer = {first_transfer}"),
            )
            .replace("[0.001, 0.02]", "[0.0002, 0.02]");
        std::fs::write(bench.path().join("cameras/mission.toml"), camera).unwrap();
        let nominal = include_str!("../../scenarios/mission.toml");
        let mut scenario =
            MissionScenario::parse("tdi.toml", nominal, bench.path(), Some(TDI_FRAMES), None)
                .unwrap();
        // 12 mm/s: a row of 8.75 µm takes 0.73 ms.
        scenario.written.flight.exposure_s = 0.0002 * (random.f64() * 50.0_f64.ln()).exp();
        let flown = flown(&scenario, seed.into());
        for frame in &flown.frames {
            let Outcome::Exposed(exposed) = frame.record.outcome else {
                panic!("{:?}", frame.record);
            };
            let rows = exposed.interior.motion.travel_mm / 0.00875;
            let least_px = if rows > first_transfer {
                with_transfers += 1;
                1.0
            } else {
                without += 1;
                rows
            };
            assert!(exposed.smear_px > 0.999 * least_px, "{rows}: {exposed:?}");
        }
        frames.extend(statistics(&flown));
    }
    let found = Coverage::of(&frames);
    eprintln!("{found:?}, {with_transfers} with transfers, {without} without");
    assert!(with_transfers > 100 && without > 30);
    assert!(found.smear_above <= 0.05, "{found:?}");
    assert!(found.predicted_over_true <= 2.0, "{found:?}");
}
