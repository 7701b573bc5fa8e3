//! Hardware and flights as a maker of cameras has them: settings, direction, TDI, clock, encoder.

use std::path::Path;

use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::frame_record::{Flag, Outcome};
use fmc_camera_file::CameraFile;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_simulation::judge::verdict::Verdict;
use fmc_simulation::mechanics::{Injection, MechanicalFault, Mechanics};
use fmc_simulation::mission::file::DirectionName;
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::device::{FlyingDevice as _, InProcess};

use crate::mission::support::{flown, folder};

const NOMINAL: &str = include_str!("../../scenarios/mission.toml");

/// Returns a short nominal mission without play, in which only what a test changes is wrong.
fn calm(exposures: u32) -> MissionScenario {
    let mut scenario = MissionScenario::nominal(Some(exposures)).unwrap();
    scenario.written.mechanics.backlash_um = 0.0;
    scenario
}

fn verdicts(scenario: &MissionScenario, seed: u64) -> Vec<Verdict> {
    let flown = flown(scenario, seed);
    let verdicts = Judgement::of(scenario, &flown).verdicts;
    assert_eq!(
        verdicts.len(),
        usize::try_from(scenario.exposures()).unwrap()
    );
    verdicts.into_iter().map(Option::unwrap).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / f64::from(u32::try_from(values.len()).unwrap())
}

fn point_um(verdicts: &[Verdict]) -> f64 {
    1e3 * mean(
        verdicts
            .iter()
            .map(|verdict| verdict.principal_point_mm.error),
    )
}

#[test]
fn flight_against_the_axis_is_compensated_with_drift_as_the_one_along_it() {
    let mut scenario = calm(12);
    scenario.written.attitude.drift_deg = 1.5;
    // A gust from the side adds to the drift in one direction and takes from it in the other.
    scenario.written.air.gust_rms_m_s = [0.0; 3];
    let forward = verdicts(&scenario, 1);
    scenario.written.flight.direction = Some(DirectionName::Reverse);
    let flown = flown(&scenario, 1);
    for frame in &flown.frames {
        let Outcome::Exposed(exposed) = &frame.record.outcome else {
            panic!("{:?}", frame.record);
        };
        assert!(exposed.interior.motion.travel_mm < -0.03, "{exposed:?}");
        assert!(frame.truth.unwrap().travel_mm < -0.03);
    }
    let reverse = verdicts(&scenario, 1);
    for verdict in forward.iter().chain(&reverse) {
        // 1.5° of drift over 40 µm of travel is 0.12 px; 0.25 px are allowed without it.
        assert!(verdict.smear_px < 0.37, "{verdict:?}");
        assert!(
            verdict.principal_point_mm.ratio().abs() < 5.0,
            "{verdict:?}"
        );
    }
    let excess = |verdicts: &[Verdict]| {
        mean(
            verdicts
                .iter()
                .map(|verdict| verdict.smear_px - verdict.predicted_px),
        )
    };
    // The drift enters the prediction with the same sign in both directions; with the wrong one
    // they would differ by twice 0.12 px.
    assert!((excess(&forward) - excess(&reverse)).abs() < 0.06);
}

#[test]
fn charge_of_a_tdi_sensor_follows_the_image_in_steps_and_the_record_has_its_mean() {
    let camera = include_str!("../../scenarios/cameras/mission.toml").replace(
        "strategy = \"centred\"",
        "mechanism = \"tdi\"\nfirst_transfer = 0.5",
    );
    let bench = tempfile::tempdir().unwrap();
    std::fs::create_dir(bench.path().join("cameras")).unwrap();
    std::fs::write(bench.path().join("cameras/mission.toml"), camera).unwrap();
    let scenario =
        MissionScenario::parse("tdi.toml", NOMINAL, bench.path(), Some(10), None).unwrap();
    for verdict in verdicts(&scenario, 1) {
        // f32 at 20 µm.
        assert!(verdict.principal_point_mm.error.abs() < 1e-7, "{verdict:?}");
        // The image runs ahead of the charge by half a row and falls behind by as much.
        assert!((0.5..1.2).contains(&verdict.smear_px), "{verdict:?}");
    }
}

#[test]
fn camera_whose_clock_drifts_knows_utc_and_its_own_time() {
    let mut scenario = calm(60);
    scenario.written.clock.drift_ppm = 30.0;
    scenario.written.clock.wander_ppm = 0.5;
    let flown = flown(&scenario, 4);
    // After 40 s the clocks are 1.2 ms apart.
    let apart_us = flown.clock.stamp_us(40_000_000) - 40_000_000;
    assert!((1100..1300).contains(&apart_us), "{apart_us}");
    for verdict in verdicts(&scenario, 4).iter().skip(5) {
        assert!(verdict.centroid_us.abs() < 2.0, "{verdict:?}");
        let utc = verdict.utc_s.unwrap();
        assert!(
            utc.error.abs() < 3e-6 && utc.ratio().abs() < 3.0,
            "{verdict:?}"
        );
    }
}

#[test]
fn encoder_has_its_phase_from_the_seed_and_every_error_shows_in_the_principal_point() {
    let base = calm(8);
    let phases: Vec<f64> = (1..=6)
        .map(|seed| point_um(&verdicts(&base, seed)))
        .collect();
    // Half a step of 0.1 µm at most, either way, and not the same in all flights; the readings
    // leave 0.02 µm.
    assert!(phases.iter().all(|um| um.abs() < 0.07), "{phases:?}");
    let spread = phases.iter().copied().fold(f64::MIN, f64::max)
        - phases.iter().copied().fold(f64::MAX, f64::min);
    assert!(spread > 0.02, "{phases:?}");

    let changed = |change: fn(&mut MissionScenario)| {
        let mut scenario = calm(8);
        scenario.written.mechanics.encoder_phase_um = Some(0.0);
        change(&mut scenario);
        point_um(&verdicts(&scenario, 1))
    };
    let exact = changed(|_| {});
    assert!(exact.abs() < 0.03, "{exact}");
    // 12 mm/s for 20 µs: the reading is older than the camera knows, and the stage farther on.
    let late = changed(|scenario| scenario.written.mechanics.encoder_latency_error_s = 2e-5);
    assert!((late - exact + 0.24).abs() < 0.03, "{late}");
    // Against the axis the screw pushes the stage on its other flank.
    let reversed: fn(&mut MissionScenario) = |scenario| {
        scenario.written.mechanics.backlash_um = 5.0;
        scenario.written.flight.direction = Some(DirectionName::Reverse);
    };
    let known = changed(reversed);
    assert!((known - exact).abs() < 0.1, "{known}");
    let unknown = changed(|scenario| {
        scenario.written.flight.direction = Some(DirectionName::Reverse);
        scenario.settings = Some(scenario.flight_settings());
        scenario.written.mechanics.backlash_um = 6.0;
    });
    assert!((unknown - exact + 6.0).abs() < 0.1, "{unknown}");
}

#[test]
fn stamps_that_jitter_move_the_centroid() {
    let mut scenario = calm(20);
    scenario.written.shutter.stamp_jitter_us = 30.0;
    let times: Vec<f64> = verdicts(&scenario, 1)
        .iter()
        .map(|verdict| verdict.centroid_us)
        .collect();
    // Two edges of 30 µs each: 21 µs for their mean.
    let rms = mean(times.iter().map(|us| us * us)).sqrt();
    assert!((10.0..35.0).contains(&rms), "{rms}");
}

#[test]
fn run_out_that_is_not_known_smears_the_corners() {
    let smear = |run_out_um: [f64; 4]| {
        let mut scenario = calm(6);
        scenario.written.attitude.rate_rms_deg_s = [0.0; 3];
        scenario.written.detector.run_out_um = run_out_um;
        mean(
            verdicts(&scenario, 1)
                .iter()
                .map(|verdict| verdict.smear_px),
        )
    };
    // 400 µm per mm over 40 µm are 16 µm of focus, which move a corner at 57 mm by 9 µm.
    let more = smear([0.0, 400.0, 0.0, 0.0]) - smear([0.0; 4]);
    assert!((0.6..1.4).contains(&more), "{more}");
}

fn settings(text: &str) -> FlightSettingsFile {
    let table = text.parse().unwrap();
    FlightSettingsFile::of_table("settings.toml".to_owned(), table).unwrap()
}

/// Returns the nominal mission without the lines that hold any of these, with the settings.
fn with_settings(without: &[&str], text: &str) -> Result<MissionScenario, String> {
    let scenario: Vec<&str> = NOMINAL
        .lines()
        .filter(|line| !without.iter().any(|key| line.starts_with(key)))
        .collect();
    let (scenario, folder) = (scenario.join("\n"), folder());
    let given = Some(settings(text));
    MissionScenario::parse(
        "mission.toml",
        &scenario,
        Path::new(&folder),
        Some(6),
        given,
    )
    .map_err(|error| error.to_string())
}

#[test]
fn settings_of_a_camera_are_flown_with_the_hardware_that_they_describe() {
    let text = "direction = \"Reverse\"\nexposure_s = 0.0025\nshutter_latency_s = 0.004\n\
                [drive]\nencoder_step_um = 0.2\nencoder_reversed = true\nmotor_reversed = true\n";
    let scenario = with_settings(&["exposure_s", "latency_ms = 2.0", "encoder_step_um"], text);
    assert!(
        scenario.unwrap_err().contains("exposure_s"),
        "the flight has an exposure"
    );
    let changed = NOMINAL
        .replace("exposure_s = 0.003333333", "exposure_s = 0.0025")
        .replace("latency_ms = 2.0 ", "# ")
        .replace("encoder_step_um = 0.1", "");
    let given = Some(settings(text));
    let scenario =
        MissionScenario::parse("mission.toml", &changed, &folder(), Some(6), given).unwrap();
    let flown_settings = scenario.flight_settings();
    assert_eq!(flown_settings, settings(text).settings);
    assert_eq!(flown_settings.direction, FlightDirection::Reverse);
    assert!((scenario.written.shutter.latency_ms - 4.0).abs() < 1e-9);
    assert!((scenario.written.mechanics.encoder_step_um - 0.2).abs() < 1e-9);
    for verdict in verdicts(&scenario, 1) {
        assert!(
            verdict.smear_px < 0.3 && !verdict.is_standing,
            "{verdict:?}"
        );
    }
}

#[test]
fn scenario_that_contradicts_the_settings_is_refused_with_both() {
    for (text, parts) in [
        (
            "[drive]\nencoder_step_um = 0.5\n",
            [
                "mechanics.encoder_step_um = 0.1",
                "drive.encoder_step_um = 0.5",
            ],
        ),
        (
            "exposure_s = 0.004\n",
            ["flight.exposure_s = 0.003333333", "exposure_s = 0.004"],
        ),
        (
            "shutter_latency_s = 0.005\n",
            ["shutter.latency_ms = 2.0", "shutter_latency_s = 5"],
        ),
        (
            "trigger_interval_s = 0.8\n",
            [
                "flight.forward_overlap_percent = 90.0",
                "trigger_interval_s = 0.8",
            ],
        ),
    ] {
        let error = with_settings(&[], text).unwrap_err();
        for part in parts.into_iter().chain(["contradicts", "settings.toml"]) {
            assert!(error.contains(part), "{text}: {error}");
        }
    }
    // Without a contradiction the same file is flown, and the defaults with it.
    assert!(with_settings(&[], "").is_ok());
}

#[test]
fn scenario_may_have_the_settings_and_the_seed_in_it() {
    let text = format!("seed = 7\n{NOMINAL}\n[settings]\nspeed_tolerance_percent = 2.0\n");
    let parse = |given| MissionScenario::parse("own.toml", &text, &folder(), Some(2), given);
    let scenario = parse(None).unwrap();
    assert_eq!(scenario.seed(), 7);
    assert!((scenario.flight_settings().speed_tolerance_percent - 2.0).abs() < f32::EPSILON);
    let error = parse(Some(settings(""))).unwrap_err().to_string();
    assert!(
        error.contains("settings.toml") && error.contains("own"),
        "{error}"
    );
    let wrong = text.replace("speed_tolerance_percent", "speed_tolerance");
    let error = MissionScenario::parse("own.toml", &wrong, &folder(), Some(2), None);
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("no setting speed_tolerance")
    );
}

/// Returns the nominal mission with a stepper, whose camera has this line in its table `fmc`.
fn with_stepper(line: &str) -> Result<MissionScenario, String> {
    let stepper =
        "[mechanics]\nstepper = { pulse_rate_hz = 200000.0, max_step_rate_hz = 100000.0 }";
    let scenario = NOMINAL.replace("[mechanics] ", &format!("{stepper} #"));
    let camera = include_str!("../../scenarios/cameras/mission.toml")
        .replace("[fmc]", &format!("[fmc]\n{line}"));
    let scenario = MissionScenario::parse_of_texts("mission.toml", &scenario, |path| {
        CameraFile::parse(&path.display().to_string(), &camera)
    });
    scenario.map_err(|error| error.to_string())
}

#[test]
fn stage_of_a_stepper_is_flown_by_its_steps_and_its_records_are_not_measured() {
    let mut scenario = with_stepper("max_speed_mm_s = 25.0").unwrap();
    scenario.written.flight.exposures = 10;
    scenario.written.mechanics.backlash_um = 0.0;
    let flown = flown(&scenario, 1);
    let judgement = Judgement::of(&scenario, &flown);
    assert!(flown.announced.is_empty(), "{:?}", flown.announced);
    for (frame, verdict) in flown.frames.iter().zip(&judgement.verdicts) {
        assert!(frame.record.flags.contains(Flag::NotMeasured));
        let verdict = verdict.unwrap();
        // 12 mm/s against 302 N·s/m and 0.25 N on a spring of 200 N/mm: the stage is 19 µm behind
        // its steps, which the drive counts as its position. Its field pulls by 30 µm at most.
        let stated = verdict.principal_point_mm;
        assert!((0.015..0.023).contains(&stated.error), "{verdict:?}");
        assert!((0.030..0.032).contains(&stated.sigma), "{verdict:?}");
        assert!(verdict.smear_px < 0.3, "{verdict:?}");
    }
}

#[test]
fn steps_that_are_lost_are_in_no_record_without_its_flag() {
    let mut scenario = with_stepper("max_speed_mm_s = 25.0").unwrap();
    scenario.written.flight.exposures = 6;
    let mut mechanics = Mechanics::seeded(scenario.written.mechanics, 1).unwrap();
    // In the fly-back after the third frame.
    let lost = MechanicalFault::CountsLost { um: 300.0 };
    mechanics.inject(Injection::from(lost, 4.0));
    let mut device = InProcess::default();
    let (camera, settings) = (scenario.camera.parameters(), scenario.flight_settings());
    device.prepare(&camera, &settings).unwrap();
    let options = FlightOptions {
        seed: 1,
        frame: None,
    };
    let flown = fly(&scenario, options, mechanics, &mut device, |_| {}).unwrap();
    let judgement = Judgement::of(&scenario, &flown);
    let mut off = 0;
    for (frame, verdict) in flown.frames.iter().zip(&judgement.verdicts) {
        let verdict = verdict.unwrap();
        assert!(frame.record.flags.contains(Flag::NotMeasured));
        assert!(verdict.is_flagged);
        off += u32::from(verdict.principal_point_mm.ratio().abs() > 5.0);
    }
    // Nothing measures them: σ does not know.
    assert!(off >= 2, "{off}");
}

#[test]
fn stepper_that_is_slower_than_the_camera_allows_is_refused_with_both() {
    for (line, words) in [
        ("max_speed_mm_s = 40.0", "max_speed_mm_s = 40"),
        ("", "no max_speed_mm_s"),
    ] {
        let error = with_stepper(line).unwrap_err();
        assert!(
            error.contains("31.25 mm/s") && error.contains(words),
            "{error}"
        );
    }
}
