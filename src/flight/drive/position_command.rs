//! Amplifier that takes a position as an analogue command, with an absolute sensor on the stage.

use super::feed_forward_motion::moved;
use super::flown_drive::FlownDrive;
use super::kind::DriveKind;
use super::settings::DriveSettings;
use super::velocity_loop::limited;
use super::{FmcDrive, StageReading};
use crate::flight::controller::timing::TICK_S;
use crate::flight::fault::Fault;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::geometry::range::OutOfRange;

/// Age of a reading beyond which it does not count, s: two rounds.
const OLDEST_READING_S: f32 = 2.0 * TICK_S;

/// Longest time without a set point, s; after a longer one the correction begins afresh.
const LONGEST_PAUSE_S: f32 = 0.005;

/// Analogue output to an amplifier: a converter from words to voltage, and the amplifier's force.
pub trait CommandOutput {
    /// Error of the output.
    type Error;

    /// The largest word; 0 is command -1, and this one is command 1.
    fn max_word(&self) -> u16;

    /// Sets the word; the amplifier has force. It does not wait.
    ///
    /// # Errors
    /// The word has not been set.
    fn set_word(&mut self, word: u16) -> Result<(), Self::Error>;

    /// Takes the amplifier's force off. One without such an input rests at a command that the
    /// implementation knows.
    ///
    /// # Errors
    /// The force may still be on.
    fn release(&mut self) -> Result<(), Self::Error>;
}

/// A reading of the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SensorReading {
    /// Time at which it was converted, camera time.
    pub time: Time,
    /// The converter's word.
    pub counts: i32,
}

/// Sensor that shows the place of the stage at any time: strain gauge, capacitive sensor or LVDT
/// behind a converter.
pub trait PositionSensor {
    /// Error of the sensor.
    type Error;

    /// Returns the newest reading; it does not wait for another.
    ///
    /// # Errors
    /// There is none, or its transfer failed.
    fn read(&mut self, now: Time) -> Result<SensorReading, Self::Error>;
}

/// The drive: position command, and what the sensor shows to correct it.
///
/// # Model
/// The command leads the set point by the delay of the command and half a round, for which it is
/// held, and by what the stage lags behind it: `u·s = x + T·v + a/ω² + c + u₀·s`, with s the travel
/// per command, x, v and a the set point at that time, T and 1/ω² from a second-order stage
/// `x″ = ω²·(s·u - x) - 2ζω·x′` with `T = 2ζ/ω` (Leang and Devasia, IEEE Trans. Control Syst.
/// Technol. 15 (2007) 927: feedback against hysteresis and creep, feed-forward against dynamics).
/// The correction `c = k·∫e dt` takes out hysteresis, creep and errors of s, where e is the set
/// point at the time of the reading less the reading. It stands still while the command is at its
/// limit and e would drive it further, and goes as far as `max_correction_um`.
///
/// # Faults
/// [`Fault::Encoder`] from a sensor that is silent for two rounds, reads outside of its range, or
/// repeats the same word for longer than `sensor_frozen_s`. The next good reading counts again; it
/// is the controller that waits until the fault is cleared. A sensor that fails in none of these
/// ways, but stands while the stage moves, is [`Fault::Stall`] to the controller.
#[derive(Debug, Clone)]
pub struct PositionCommand<Output, Sensor> {
    output: Output,
    sensor: Sensor,
    settings: DriveSettings,
    /// Following error taken out, mm along the FMC axis.
    correction_mm: f32,
    /// Newest reading.
    read: Option<StageReading>,
    /// Newest word of the sensor, and the time of the first that was the same.
    unchanged: Option<SensorReading>,
    followed: Option<Time>,
    /// Newest command, -1 to 1.
    command: f32,
    release_failed: bool,
}

impl<Output: CommandOutput, Sensor: PositionSensor> PositionCommand<Output, Sensor> {
    /// Returns a drive without force.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn new(
        settings: DriveSettings,
        output: Output,
        sensor: Sensor,
    ) -> Result<Self, OutOfRange> {
        let settings = settings.checked()?;
        let mut drive = Self::unprepared(output, sensor);
        drive.settings = settings;
        Ok(drive)
    }

    /// Returns a drive without force and with default settings, until others are set.
    #[must_use]
    pub fn unprepared(output: Output, sensor: Sensor) -> Self {
        let settings = DriveSettings {
            kind: DriveKind::PositionCommand,
            ..DriveSettings::default()
        };
        Self {
            output,
            sensor,
            settings,
            correction_mm: 0.0,
            read: None,
            unchanged: None,
            followed: None,
            command: 0.0,
            release_failed: false,
        }
    }

    /// Returns `true` if the amplifier has force.
    #[must_use]
    pub const fn is_powered(&self) -> bool {
        self.followed.is_some()
    }

    /// The output, for inspection.
    pub(crate) const fn output(&self) -> &Output {
        &self.output
    }

    /// The output, to operate it.
    pub const fn output_mut(&mut self) -> &mut Output {
        &mut self.output
    }

    /// The sensor, to operate it.
    pub const fn sensor_mut(&mut self) -> &mut Sensor {
        &mut self.sensor
    }

    /// Returns the sensor's place, mm along the FMC axis from the calibrated position.
    #[expect(
        clippy::cast_precision_loss,
        reason = "exact to 16 million counts, twice what is in range"
    )]
    fn offset_mm(&self, counts: i32) -> f32 {
        let from_zero = counts as f32 - self.settings.position_command.sensor_zero_counts;
        let offset_mm = from_zero * self.settings.encoder_step_mm();
        if self.settings.encoder_reversed {
            -offset_mm
        } else {
            offset_mm
        }
    }

    /// Judges a reading of the sensor by itself.
    #[expect(clippy::cast_precision_loss, reason = "compared with a range")]
    fn is_believed(&mut self, now: Time, reading: SensorReading) -> bool {
        let settings = &self.settings.position_command;
        let range = settings.sensor_least_counts..=settings.sensor_most_counts;
        let since = match self.unchanged {
            Some(first) if first.counts == reading.counts && first.time <= reading.time => first,
            _ => reading,
        };
        self.unchanged = Some(since);
        let is_frozen = settings.sensor_frozen_s > 0.0
            && reading.time.seconds_since(since.time) > settings.sensor_frozen_s;
        let age_s = now.seconds_since(reading.time);
        range.contains(&(reading.counts as f32)) && !is_frozen && age_s <= OLDEST_READING_S
    }

    /// Takes the following error of the newest reading into the correction.
    fn correct(&mut self, now: Time, setpoint: Setpoint, dt_s: f32) {
        let Some(reading) = self.read.take() else {
            return;
        };
        let settings = &self.settings.position_command;
        let told = moved(setpoint, -now.seconds_since(reading.time));
        let step_mm = settings.correction_rate_per_s * dt_s * (told.offset_mm - reading.offset_mm);
        let along = if self.settings.motor_reversed {
            -self.command
        } else {
            self.command
        };
        let is_limited = libm::fabsf(self.command) >= settings.max_command;
        if is_limited && along * step_mm > 0.0 {
            return;
        }
        let most_mm = 1e-3 * settings.max_correction_um;
        self.correction_mm = limited(self.correction_mm + step_mm, most_mm);
    }

    /// Returns the command for a set point of now, within its limits.
    fn command_for(&self, setpoint: Setpoint) -> f32 {
        let settings = &self.settings.position_command;
        let delay_s = self.settings.velocity_loop.duty_delay_s + 0.5 * TICK_S;
        let ahead = moved(setpoint, delay_s);
        let lead_mm = settings.lag_s * ahead.speed_mm_s
            + settings.acceleration_lag_s2 * ahead.acceleration_mm_s2;
        let place_mm = ahead.offset_mm + lead_mm + self.correction_mm;
        let part = 1e3 * place_mm / settings.command_travel_um;
        let part = if self.settings.motor_reversed {
            -part
        } else {
            part
        };
        let most = settings.max_command;
        limited(settings.command_zero + part, most)
    }

    /// Sends a command to the amplifier.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast saturates"
    )]
    fn send(&mut self, command: f32) -> Result<(), Fault> {
        let full = f32::from(self.output.max_word());
        let word = libm::roundf(0.5 * (command + 1.0) * full) as u16;
        let word = word.min(self.output.max_word());
        self.output.set_word(word).map_err(|_| Fault::Drive)
    }
}

impl<Output: CommandOutput, Sensor: PositionSensor> FmcDrive for PositionCommand<Output, Sensor> {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.read = None;
        let reading = self.sensor.read(now).map_err(|_| Fault::Encoder)?;
        if !self.is_believed(now, reading) {
            return Err(Fault::Encoder);
        }
        let age_s = self.settings.velocity_loop.reading_age_s;
        let reading = StageReading {
            time: reading.time.plus_s(-age_s),
            offset_mm: self.offset_mm(reading.counts),
        };
        self.read = Some(reading);
        Ok(reading)
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        if core::mem::take(&mut self.release_failed) {
            self.release();
            return Err(Fault::Drive);
        }
        let dt_s = self
            .followed
            .map_or(f32::INFINITY, |before| now.seconds_since(before));
        if (0.0..=LONGEST_PAUSE_S).contains(&dt_s) {
            self.correct(now, setpoint, dt_s);
        } else {
            self.correction_mm = 0.0;
        }
        let command = self.command_for(setpoint);
        if !command.is_finite() {
            self.release();
            return Err(Fault::Drive);
        }
        self.command = command;
        self.followed = Some(now);
        self.send(command).inspect_err(|_| self.release())
    }

    fn release(&mut self) {
        self.followed = None;
        self.read = None;
        self.correction_mm = 0.0;
        self.release_failed = self.output.release().is_err();
    }
}

impl<Output: CommandOutput, Sensor: PositionSensor> FlownDrive for PositionCommand<Output, Sensor> {
    fn is_of(&self, kind: DriveKind) -> bool {
        kind == DriveKind::PositionCommand
    }

    /// Settings of another mechanism, as those of a trial, leave its own as they are.
    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        let settings = settings.checked()?;
        if self.is_of(settings.kind) {
            self.settings = settings;
            self.unchanged = None;
        }
        self.release();
        Ok(())
    }

    /// Does nothing: the sensor's zero is a setting.
    fn set_reference(&mut self) {}
}
