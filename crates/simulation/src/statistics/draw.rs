//! Random missions: a camera, its mechanism, its settings and a flight, as files.

use std::fmt::Write;

use fmc_camera::flight::settings::FlightSettings;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, InputError};

use super::drawn_fault::{self, Instruments};
use super::random::Random;
use crate::mission::file::VhSourceName;
use crate::mission::scenario::MissionScenario;

/// Number of draws after which a mission is given up.
const MOST_DRAWS: u32 = 200;

/// Greatest height at which a laser altimeter is drawn, m: its default range ends at 5000 m.
const HIGHEST_LASER_M: f64 = 4500.0;

/// Largest error of the encoder's scale, ppm.
const LARGEST_SCALE_PPM: f64 = 50.0;
/// Largest error of the age of the encoder's readings, s.
const LARGEST_AGE_ERROR_S: f64 = 1e-5;
/// Largest standard deviation of the instant at which the encoder is read, s.
const LARGEST_READING_JITTER_S: f64 = 2e-6;

/// Standard deviations of the stamps of the shutter's edges, µs. With the clock's step of 1 µs
/// their root mean square is the σ that the camera assumes.
const STAMP_JITTER_US: [f64; 2] = [0.75, 1.15];

/// Largest difference of a play from its setting, in parts of it: evenly distributed, its σ is that
/// which the camera assumes.
const LARGEST_PLAY_CHANGE: f64 = 0.173;

/// Fastest stage, mm/s.
const FASTEST_MM_S: f64 = 40.0;

/// Options of the drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DrawOptions {
    /// Seed of all missions.
    pub seed: u64,
    /// Number of faults of each mission.
    pub faults: u32,
}

/// A random mission, as files and validated.
#[derive(Debug, Clone)]
pub struct DrawnMission {
    /// Number of the mission, from 1.
    pub number: u32,
    /// Text of the camera file, which the scenario names [`Self::camera_name`].
    pub camera_text: String,
    /// Text of the scenario, which has settings and seed in it.
    pub scenario_text: String,
    /// The mission.
    pub scenario: MissionScenario,
    /// Number of draws that no camera or no flight came of.
    pub refused: u32,
}

impl DrawnMission {
    /// Draws a mission.
    ///
    /// # Errors
    /// The last refusal, if no mission comes of a great many draws.
    pub fn draw(options: DrawOptions, number: u32) -> Result<Self, InputError> {
        let mut random = Random::new(options.seed, u64::from(number));
        let mut last = InputError::invalid("no draw");
        for refused in 0..MOST_DRAWS {
            match Self::try_draw(&mut random, options.faults, number, refused) {
                Ok(mission) => return Ok(mission),
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Returns the name of a mission's scenario file.
    #[must_use]
    pub fn scenario_name(number: u32) -> String {
        format!("mission-{number:04}.toml")
    }

    /// Returns the name of a mission's camera file.
    #[must_use]
    pub fn camera_name(number: u32) -> String {
        format!("mission-{number:04}-camera.toml")
    }

    fn try_draw(
        random: &mut Random,
        faults: u32,
        number: u32,
        refused: u32,
    ) -> Result<Self, InputError> {
        let flight = Flight::draw(random);
        let camera_text = camera(random, &flight);
        let mut scenario_text = scenario(random, &flight, number, faults);
        let name = Self::scenario_name(number);
        let plain = parse(&name, &scenario_text, &camera_text)?;
        scenario_text += &settings(random, plain.flight_settings(), &flight);
        Ok(Self {
            number,
            scenario: parse(&name, &scenario_text, &camera_text)?,
            camera_text,
            scenario_text,
            refused,
        })
    }
}

fn parse(
    name: &str,
    scenario_text: &str,
    camera_text: &str,
) -> Result<MissionScenario, InputError> {
    MissionScenario::parse_of_texts(name, scenario_text, |camera| {
        CameraFile::parse(&camera.display().to_string(), camera_text)
    })
}

/// Values that camera and scenario have in common.
#[derive(Debug, Clone, Copy)]
struct Flight {
    principal_distance_mm: f64,
    vh_per_s: f64,
    exposure_s: f64,
    is_tdi: bool,
    interval_s: f64,
    exposures: u32,
    stroke_mm: f64,
    is_reversed: bool,
}

impl Flight {
    fn draw(random: &mut Random) -> Self {
        let principal_distance_mm = random.scaled(40.0, 300.0);
        let fastest_per_s = FASTEST_MM_S / principal_distance_mm;
        Self {
            principal_distance_mm,
            vh_per_s: random.scaled(0.015, fastest_per_s.min(0.25)),
            exposure_s: random.scaled(0.000_5, 0.012),
            is_tdi: random.chance(0.1),
            interval_s: random.between(0.35, 1.0),
            exposures: 10 + random.below(8),
            stroke_mm: random.between(2.0, 6.0),
            is_reversed: random.chance(0.4),
        }
    }
}

/// Draws a camera file.
fn camera(random: &mut Random, flight: &Flight) -> String {
    let f_mm = flight.principal_distance_mm;
    let pixel_um = random.between(3.0, 12.0);
    let [width_px, height_px] = [(); 2].map(|()| 2000 + random.below(9000));
    let half_mm = 0.5 * pixel_um / 1000.0 * f64::from(width_px.max(height_px));
    // Up to 0.3 % of the radius at the edge.
    let k1 = random.between(-3e-3, 3e-3) / (half_mm * half_mm);
    let fmc = if flight.is_tdi {
        format!(
            "mechanism = \"tdi\"\nfirst_transfer = {:.3}\n",
            random.between(0.0, 1.0)
        )
    } else {
        format!(
            "strategy = \"{}\"\nacceleration_mm_s2 = {:.1}\nsettling_ms = {:.2}\n\
             flatness_um = [0.0, {:.3}]\n",
            random.of(&["centred", "from-rest"], "centred"),
            random.scaled(500.0, 2000.0),
            random.between(5.0, 15.0),
            random.between(-2.0, 2.0),
        )
    };
    let shutter = if random.chance(0.5) {
        "profile = \"uniform\"\n".to_owned()
    } else {
        format!(
            "profile = \"trapezoid\"\nopening_fraction = {:.3}\nclosing_fraction = {:.3}\n",
            random.between(0.0, 0.4),
            random.between(0.0, 0.4)
        )
    };
    let [vh, exposure_s] = [flight.vh_per_s, flight.exposure_s];
    format!(
        "name = \"Random camera, {f_mm:.0} mm\"\nprincipal_distance_mm = {f_mm:.3}\n\
         principal_point_mm = [{:.4}, {:.4}]\n\n\
         [sensor]\nwidth_px = {width_px}\nheight_px = {height_px}\npixel_um = {pixel_um:.3}\n\n\
         [distortion]\nk1 = {k1:.6e}\n\n\
         [fmc]\naxis = \"{}\"\nstroke_mm = {:.3}\n{fmc}\n[shutter]\n{shutter}\n\
         [limits]\nvh_per_s = [{:.5}, {:.5}]\nexposure_s = [{:.7}, {:.7}]\n",
        random.between(-0.2, 0.2),
        random.between(-0.2, 0.2),
        random.of(&["+x", "-x", "+y", "-y"], "+y"),
        flight.stroke_mm,
        0.6 * vh,
        1.5 * vh,
        0.5 * exposure_s,
        1.5 * exposure_s,
    )
}

/// Draws a scenario, without its settings.
fn scenario(random: &mut Random, flight: &Flight, number: u32, faults: u32) -> String {
    let speed_m_s = random.between(30.0, 110.0);
    let height_m = speed_m_s / flight.vh_per_s;
    let terrain_m = random.between(0.0, 500.0);
    let direction = if flight.is_reversed {
        "reverse"
    } else {
        "forward"
    };
    let mut text = format!(
        "name = \"Random mission {number}\"\ncamera = \"{}\"\nseed = {}\n\n\
         [flight]\nheight_m = {:.2}\nspeed_m_s = {speed_m_s:.3}\nexposure_s = {:.7}\n\
         exposures = {}\ninterval_s = {:.4}\ndirection = \"{direction}\"\n\
         clear_faults_after_s = 1.0\n\n",
        DrawnMission::camera_name(number),
        random.below(2_000_000_000),
        height_m + terrain_m,
        flight.exposure_s,
        flight.exposures,
        flight.interval_s,
    );
    let instruments = world(random, &mut text, height_m, terrain_m);
    hardware(random, &mut text, flight);
    for _ in 0..faults {
        drawn_fault::append(
            &mut text,
            random,
            flight.exposures,
            flight.interval_s,
            &instruments,
        );
    }
    text
}

/// Appends air, attitude, terrain and the instruments, which it returns.
fn world(random: &mut Random, text: &mut String, height_m: f64, terrain_m: f64) -> Instruments {
    let gust_m_s = random.between(0.0, 2.0);
    let rate_deg_s = random.scaled(0.003, 0.05);
    let reported_hz = if random.chance(0.7) {
        random.between(20.0, 100.0)
    } else {
        0.0
    };
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "[air]\ngust_rms_m_s = [{gust_m_s:.3}, {gust_m_s:.3}, {:.3}]\ngust_corner_hz = {:.4}\n\n\
         [attitude]\npitch_deg = {:.3}\nroll_deg = {:.3}\ndrift_deg = {:.3}\n\
         rate_rms_deg_s = [{rate_deg_s:.5}, {rate_deg_s:.5}, {rate_deg_s:.5}]\n\
         rate_corner_hz = {:.3}\nreported_hz = {reported_hz:.2}\n\n\
         [terrain]\nheight_m = {terrain_m:.2}\nrelief_m = {:.3}\nwavelength_m = {:.1}\n\n",
        0.5 * gust_m_s,
        random.scaled(0.03, 0.5),
        random.between(-1.0, 1.0),
        random.between(-1.0, 1.0),
        random.between(-0.5, 0.5),
        random.scaled(0.5, 10.0),
        random.between(0.0, 0.02 * height_m),
        random.scaled(2000.0, 20_000.0),
    );
    let is_low = height_m < HIGHEST_LASER_M;
    let mut sources: Vec<VhSourceName> = VhSourceName::ALL
        .into_iter()
        .filter(|source| random.chance(0.4) && (is_low || *source != VhSourceName::Laser))
        .collect();
    if sources.is_empty() {
        let others = [
            VhSourceName::Direct,
            VhSourceName::Altimeter,
            VhSourceName::Terrain,
        ];
        sources.push(random.of(&others, VhSourceName::Altimeter));
    }
    for source in &sources {
        let _ = write!(
            text,
            "[[vh]]\nsource = \"{}\"\nrate_hz = {:.2}\nsigma_percent = {:.4}\n\
             latency_ms = {:.2}\n\n",
            source.name(),
            random.scaled(1.0, 20.0),
            random.scaled(0.05, 0.8),
            random.between(0.0, 150.0),
        );
    }
    if random.chance(0.8) {
        let _ = write!(
            text,
            "[gnss]\nfirst_pulse_unix_s = 1790000000\npulse_jitter_us = {:.3}\n\n",
            random.between(0.0, 1.0)
        );
    }
    let has_receiver = sources.iter().any(|source| source.has_receiver());
    let instruments = Instruments {
        has_receiver_wire: has_receiver && random.chance(0.5),
        has_autopilot_wire: random.chance(0.5),
        sources,
    };
    let _ = write!(
        text,
        "[line]\nreceiver = \"{}\"\nbaud = 115200\nautopilot = \"{}\"\nautopilot_baud = 115200\n\n",
        if instruments.has_receiver_wire {
            "nmea"
        } else {
            "whole"
        },
        if instruments.has_autopilot_wire {
            "mavlink"
        } else {
            "whole"
        },
    );
    instruments
}

/// Appends clock, shutter and mechanics.
fn hardware(random: &mut Random, text: &mut String, flight: &Flight) {
    let coulomb_n = random.between(0.1, 0.4);
    let half_mm = 0.5 * flight.stroke_mm;
    let side = random.of(&["screw", "stage"], "screw");
    let _ = write!(
        text,
        "[clock]\ndrift_ppm = {:.3}\nwander_ppm = {:.4}\n\n\
         [shutter]\nlatency_ms = {:.4}\njitter_us = {:.2}\nstamp_jitter_us = {:.3}\n\n\
         [mechanics]\nmass_kg = {:.4}\nforce_n = {:.3}\ncoulomb_n = {coulomb_n:.4}\n\
         breakaway_n = {:.4}\nbacklash_um = {:.3}\nencoder_side = \"{side}\"\n\
         encoder_step_um = {:.4}\nencoder_scale_ppm = {:.2}\nencoder_latency_s = {:.7}\n\
         encoder_latency_error_s = {:.8}\nencoder_jitter_s = {:.8}\nduty_latency_s = {:.7}\n\
         end_stops_mm = [{:.3}, {:.3}]\nlimits_mm = [{:.3}, {:.3}]\n\n\
         [detector]\nrun_out_um = [0.0, {:.3}, 0.0, 0.0]\n",
        random.between(-30.0, 30.0),
        random.between(0.0, 0.1),
        random.scaled(1.0, 20.0),
        random.between(0.0, 60.0),
        random.between(STAMP_JITTER_US[0], STAMP_JITTER_US[1]),
        random.between(0.2, 0.5),
        random.between(5.0, 10.0),
        coulomb_n * random.between(1.05, 1.4),
        random.between(0.0, 20.0),
        random.scaled(0.01, 5.0),
        random.between(-LARGEST_SCALE_PPM, LARGEST_SCALE_PPM),
        // The gains of the velocity loop are for 0.1 ms each.
        random.between(5e-5, 1.5e-4),
        random.between(-LARGEST_AGE_ERROR_S, LARGEST_AGE_ERROR_S),
        random.between(0.0, LARGEST_READING_JITTER_S),
        random.between(5e-5, 1.5e-4),
        -half_mm - 0.5,
        half_mm + 0.5,
        -half_mm - 0.2,
        half_mm + 0.2,
        random.between(-2.0, 2.0),
    );
}

/// Draws the settings that do not follow from the hardware, and writes all of them as a table.
fn settings(random: &mut Random, mut settings: FlightSettings, flight: &Flight) -> String {
    settings.drive.encoder_reversed = random.chance(0.5);
    settings.drive.motor_reversed = random.chance(0.5);
    // A play is measured when the screw is new; wear, temperature and load change it.
    let change = random.between(-LARGEST_PLAY_CHANGE, LARGEST_PLAY_CHANGE);
    settings.drive.play_um = single(f64::from(settings.drive.play_um) / (1.0 + change));
    // An engineer knows between which limits the errors of his encoders lie.
    let uniform = |largest: f64| largest / 3.0_f64.sqrt();
    settings.drive.encoder_scale_ppm = single(uniform(LARGEST_SCALE_PPM));
    settings.drive.reading_age_sigma_s =
        single(uniform(LARGEST_AGE_ERROR_S).hypot(uniform(LARGEST_READING_JITTER_S)));
    settings.smear_budget_px = single(random.between(0.2, 1.0));
    settings.speed_tolerance_percent = single(random.between(0.5, 3.0));
    settings.trigger_interval_s = single(flight.interval_s);
    let limits = format!(
        "\n[limits]\nsmear_px = {}\npp_error_px = 0.1\n",
        settings.smear_budget_px
    );
    let mut root = toml::Table::new();
    match toml::Table::try_from(settings) {
        Ok(table) => root.insert("settings".to_owned(), toml::Value::Table(table)),
        Err(_) => None,
    };
    format!("{limits}\n{root}")
}
