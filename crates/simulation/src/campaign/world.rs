//! Flight of a campaign without faults, and its copies in every round of a frame cycle.

use fmc_camera_file::{CameraFile, InputError};

use super::effect::Baseline;
use crate::mechanics::Mechanics;
use crate::mission::clock::ROUND_US;
use crate::mission::device::FlyingDevice;
use crate::mission::file::VhSourceName;
use crate::mission::flight_loop::{Flight, FlightOptions, Told};
use crate::mission::scenario::MissionScenario;

/// Text of the scenario, which is part of the program.
const TEXT: &str = include_str!("../../../../host-sim/scenarios/campaign.toml");
/// Text of its camera file.
pub const CAMERA_TEXT: &str = include_str!("../../../../host-sim/scenarios/cameras/mission.toml");
/// A second source of V/H.
const SECOND_SOURCE: &str =
    "\n[[vh]]\nsource = \"laser\"\nrate_hz = 22.222222\nsigma_percent = 0.3\nlatency_ms = 10.0\n";

/// Trigger at which the frame cycle of the campaign begins, µs.
const FIRST_US: u64 = 4_360_000;
/// Rounds after which frames and samples come round together: the least common
/// multiple of 120 and 45 ms.
pub const TICKS: u32 = 360;
/// Time between triggers, ms.
pub const INTERVAL_MS: u32 = 120;
/// Time for which the flight without faults goes on after the cycle, µs.
const AFTER_US: u64 = 4_500_000;

/// Instruments of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum World {
    /// One source of V/H: receiver and radar altimeter, each on its wire.
    OneSource,
    /// A second one: inertial speed and laser altimeter.
    TwoSources,
    /// One source, in a flight against the FMC axis: the screw pushes the other way, and the play
    /// is between it and the stage.
    Reverse,
}

impl World {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::OneSource, Self::TwoSources, Self::Reverse];

    /// The second source.
    pub const SECOND: VhSourceName = VhSourceName::Laser;

    /// Returns the text of the scenario without faults.
    #[must_use]
    pub fn scenario_text(self) -> String {
        match self {
            Self::OneSource => TEXT.to_owned(),
            Self::TwoSources => format!("{TEXT}{SECOND_SOURCE}"),
            Self::Reverse => TEXT.replace("[flight]", "[flight]\ndirection = \"reverse\""),
        }
    }

    /// Reads the scenario.
    ///
    /// # Errors
    /// [`InputError`] if it cannot be flown.
    pub fn scenario(self) -> Result<MissionScenario, InputError> {
        MissionScenario::parse_of_texts("campaign.toml", &self.scenario_text(), |_| {
            CameraFile::parse("cameras/mission.toml", CAMERA_TEXT)
        })
    }
}

/// Returns the time of the first round after a tick, µs.
#[must_use]
pub fn next_us(tick: u32) -> u64 {
    FIRST_US + (u64::from(tick) + 1) * ROUND_US
}

/// A flight without faults, with its copies in every round of the cycle.
#[derive(Debug)]
pub struct OriginalFlight<D> {
    /// The scenario.
    pub scenario: MissionScenario,
    /// Copies of the flight, one per round.
    flights: Vec<Flight<D>>,
    /// Readings and events of each round from the first copy on.
    told: Vec<Told>,
    /// Records of the whole flight.
    pub baseline: Baseline,
}

/// A reason why a campaign cannot begin.
#[derive(Debug, thiserror::Error)]
pub enum OriginalError<E> {
    /// The scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] InputError),
    /// The mechanics are invalid.
    #[error("mechanics: {0}")]
    Mechanics(String),
    /// A frame of the flight without faults has a fault or a flag, so that nothing can be judged.
    #[error("the flight without faults has a fault, a flag or no record at {time_us} µs")]
    Flagged {
        /// Time of its trigger, µs.
        time_us: u64,
    },
    /// The camera failed.
    #[error(transparent)]
    Device(E),
}

impl<D: FlyingDevice + Clone> OriginalFlight<D> {
    /// Flies to the cycle and through it, with a camera that is prepared here.
    ///
    /// # Errors
    /// [`OriginalError`] if scenario, mechanics or camera fail.
    pub fn fly(world: World, seed: u64, mut device: D) -> Result<Self, OriginalError<D::Error>> {
        let scenario = world.scenario()?;
        let mechanics = Mechanics::seeded(scenario.written.mechanics, seed)
            .map_err(OriginalError::Mechanics)?;
        device
            .prepare(&scenario.camera.parameters(), &scenario.flight_settings())
            .map_err(OriginalError::Device)?;
        let options = FlightOptions {
            seed,
            frame: Some(0),
        };
        let mut flight = Flight::new(&scenario, options, mechanics, device);
        let mut flights = Vec::new();
        let mut told = Vec::new();
        while flight.now_us() < FIRST_US {
            flight.advance().map_err(OriginalError::Device)?;
        }
        let end_us = FIRST_US + u64::from(TICKS) * ROUND_US + AFTER_US;
        while flight.now_us() < end_us {
            if flights.len() < usize::try_from(TICKS).unwrap_or(0) {
                flights.push(flight.clone());
            }
            flight.advance().map_err(OriginalError::Device)?;
            told.push(flight.told().clone());
        }
        flight.end_triggers(end_us);
        let flown = flight
            .to_end([150_000, 1_500_000], |_, _| {})
            .map_err(OriginalError::Device)?;
        let baseline = Baseline::of(&scenario, &flown);
        let mut triggers_us = flown
            .triggers_us
            .iter()
            .filter(|time_us| **time_us >= FIRST_US);
        if let Some(time_us) = triggers_us.find(|time_us| !baseline.is_plain(**time_us)) {
            return Err(OriginalError::Flagged { time_us: *time_us });
        }
        Ok(Self {
            scenario,
            flights,
            told,
            baseline,
        })
    }

    /// Returns a copy of the flight in a round of the cycle.
    #[must_use]
    pub fn flight(&self, tick: u32) -> Option<Flight<D>> {
        self.flights.get(usize::try_from(tick).ok()?).cloned()
    }

    /// Returns true if the camera was told the same in the flight without faults at this time, µs.
    #[must_use]
    pub fn was_told(&self, now_us: u64, told: &Told) -> bool {
        let index = now_us
            .checked_sub(FIRST_US + ROUND_US)
            .map(|since_us| since_us / ROUND_US)
            .and_then(|index| usize::try_from(index).ok());
        index
            .and_then(|index| self.told.get(index))
            .is_some_and(|usual| usual == told)
    }
}
