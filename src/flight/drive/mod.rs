//! Drives that move the stage.

use super::fault::Fault;
use super::shutter_edge::ShutterEdge;
use super::stage::Setpoint;
use super::time::Time;

pub mod enabled_drive;
mod feed_forward_motion;
pub mod flown_drive;
pub mod following_error_bounds;
pub mod kind;
mod known_force;
pub mod loop_settings;
pub mod position_command;
pub mod position_command_settings;
pub mod pwm_encoder;
pub mod quadrature;
pub mod rig;
pub mod settings;
pub mod step_dir;
pub mod step_settings;
pub mod velocity_loop;

/// A position of the stage as its encoder reports it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StageReading {
    /// Time at which it was read, camera time.
    pub time: Time,
    /// Offset along the FMC axis from the calibrated position, mm.
    pub offset_mm: f32,
}

/// Positions that were latched between two readings.
pub type Latches = heapless::Vec<StageReading, MAX_LATCHES>;

/// Largest number of positions that are latched from one reading to the next.
pub const MAX_LATCHES: usize = 4;

/// A mechanism that moves the stage.
///
/// Three are here: [`step_dir::StepDir`], [`pwm_encoder::PwmEncoder`] and
/// [`position_command::PositionCommand`], for an amplifier that takes a position as an analogue
/// command. A motion controller on a bus gets an implementation that owns its bus; for one with an
/// absolute sensor the settings name [`kind::DriveKind::PositionCommand`].
///
/// # Callers and order of calls
/// The control loop alone calls these methods, once per tick (1 kHz): first
/// [`position`](Self::position), then, unless the stage is released, [`follow`](Self::follow), both
/// with the time of the tick. [`release`](Self::release) comes at any time: between the two, twice,
/// or before anything else. Set points are of one continuous motion inside the stroke; after a
/// release the next may be anywhere, but it is at rest.
///
/// # Time allowed
/// `position` and `follow` together have 100 µs, a tenth of a tick. Neither waits: not for the
/// stage, not for a conversion, not for a bus. A mechanism behind a slow bus answers with the
/// newest reading that it has, under the time of that reading; one older than two ticks does not
/// count, and the answer is [`Fault::Encoder`].
///
/// # Signs
/// Offsets, speeds and accelerations are along the FMC axis: positive where the *principal point*
/// moves over the detector in the direction of flight. If the detector moves and the lens does not,
/// the principal point moves against the detector. The implementation reverses motors and encoders
/// that count the other way.
///
/// # Faults
/// The implementation reports faults that only it can detect: of a pin, a bus, an amplifier or a
/// limit switch. It does not judge if the stage follows or a reading is credible; the controller
/// does, from set points and readings (stall, runaway, wrong direction, encoder). After an error
/// the stage has no new set point and is under no new force, the next call is as good as the first,
/// and nothing needs to be reset. The controller answers an error with `release`.
///
/// # Examples
/// A piezo stage whose amplifier follows a voltage and reports its own position:
///
/// ```
/// use fmc_camera::flight::drive::{FmcDrive, StageReading};
/// use fmc_camera::flight::fault::Fault;
/// use fmc_camera::flight::stage::Setpoint;
/// use fmc_camera::flight::time::Time;
///
/// /// Functions of the amplifier, from its data sheet.
/// trait Amplifier {
///     fn set_um(&mut self, position_um: f32) -> Result<(), ()>;
///     fn sensor_um(&mut self) -> Result<f32, ()>;
///     fn off(&mut self);
/// }
///
/// struct Piezo<A> {
///     amplifier: A,
///     /// Position at which the principal point is at its calibrated place, µm.
///     zero_um: f32,
///     /// Lag of the stage behind the voltage, s.
///     lag_s: f32,
/// }
///
/// impl<A: Amplifier> FmcDrive for Piezo<A> {
///     fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
///         let um = self.amplifier.sensor_um().map_err(|()| Fault::Encoder)?;
///         Ok(StageReading { time: now, offset_mm: (um - self.zero_um) / 1000.0 })
///     }
///
///     fn follow(&mut self, _: Time, setpoint: Setpoint) -> Result<(), Fault> {
///         // Ahead by the lag, and by half the millisecond for which the voltage stays.
///         let ahead_mm = setpoint.speed_mm_s * (self.lag_s + 0.5e-3);
///         let um = self.zero_um + (setpoint.offset_mm + ahead_mm) * 1000.0;
///         self.amplifier.set_um(um).map_err(|()| Fault::Drive)
///     }
///
///     fn release(&mut self) {
///         self.amplifier.off();
///     }
/// }
/// # struct Bench(f32);
/// # impl Amplifier for Bench {
/// #     fn set_um(&mut self, position_um: f32) -> Result<(), ()> { self.0 = position_um; Ok(()) }
/// #     fn sensor_um(&mut self) -> Result<f32, ()> { Ok(self.0) }
/// #     fn off(&mut self) {}
/// # }
/// # let mut piezo = Piezo { amplifier: Bench(0.0), zero_um: 50.0, lag_s: 1e-3 };
/// # let setpoint = Setpoint { offset_mm: 0.01, speed_mm_s: 4.0, ..Setpoint::default() };
/// # piezo.follow(Time::START, setpoint).unwrap();
/// # assert!((piezo.position(Time::START).unwrap().offset_mm - 0.016).abs() < 1e-6);
/// ```
pub trait FmcDrive {
    /// Returns the present position of the stage.
    ///
    /// On return the reading is the newest there is, under the time at which the stage was there
    /// (which is before `now` by the encoder's latency), and nothing has moved because of the call.
    /// The call may come at any time, released or not, and more than once in a tick.
    ///
    /// # Errors
    /// [`Fault::Encoder`] if there is no such reading.
    fn position(&mut self, now: Time) -> Result<StageReading, Fault>;

    /// Returns the position that was latched when the stage last crossed its index mark, mm along
    /// the FMC axis; `None` if it has not crossed it since the last call, or has none.
    ///
    /// The control loop asks once per tick, after [`position`](Self::position). The count must be
    /// that of the crossing itself, from a timer's capture input or an interrupt at the mark's
    /// edge, since the stage moves by tens of micrometres in a tick. Of a mark that is wider than a
    /// step, the edge counts that comes first on the way along the FMC axis; on the way against it,
    /// the same one every time, which tells of the play.
    fn take_index(&mut self) -> Option<f32> {
        None
    }

    /// Returns the position that hardware latched at an edge of the shutter's sensor, which came at
    /// this time, camera time; `None` if there is none, or if it cannot be told which of several
    /// edges it belongs to.
    ///
    /// The control loop asks once for every edge, in the round that takes it. Readings are a
    /// millisecond apart, and a stage that shakes faster than that is elsewhere between them: the
    /// ends of a short exposure are known by what is latched alone.
    fn take_latched(&mut self, edge: ShutterEdge, at: Time) -> Option<StageReading> {
        let _ = (edge, at);
        None
    }

    /// Returns the positions that hardware has latched between the last two readings, in order of
    /// time; those of earlier rounds may be among them, and are left out.
    ///
    /// The control loop asks in every round of an exposure, after [`position`](Self::position).
    fn take_latches(&mut self) -> Latches {
        Latches::new()
    }

    /// Follows a set point, until the next call.
    ///
    /// The set point is for `now`: the stage should then be at `offset_mm`, and go on with that
    /// speed and acceleration. On return the mechanism has been told; it need not have moved. If
    /// calls fail to come, it must not run on for ever: after a few ticks it stands, or a watchdog
    /// takes the force off.
    ///
    /// # Errors
    /// [`Fault::LimitSwitch`] if a switch is closed on that side, [`Fault::Drive`] for anything
    /// else. The set point is then not followed.
    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault>;

    /// Takes the force off.
    ///
    /// On return no force is asked of the mechanism and none will be until the next
    /// [`follow`](Self::follow). It may be called at any time and more than once, and it cannot
    /// fail: it tries every step to the end, and the next `follow` reports an error of any of them.
    fn release(&mut self);
}
