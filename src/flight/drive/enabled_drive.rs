//! Drive with an enable pin for its power stage.

use embedded_hal::digital::OutputPin;

use super::flown_drive::FlownDrive;
use super::kind::DriveKind;
use super::settings::DriveSettings;
use super::{FmcDrive, Latches, StageReading};
use crate::flight::fault::Fault;
use crate::flight::shutter_edge::ShutterEdge;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::geometry::range::OutOfRange;

/// A drive, and the pin that is high while it may put force on the stage.
///
/// The pin stays high if rounds fail to come: a device that works without the control loop must
/// then take it low ([`RoundGuard`](crate::flight::round_guard::RoundGuard)).
#[derive(Debug)]
pub struct EnabledDrive<Drive, Enable> {
    drive: Drive,
    enable: Enable,
    release_failed: bool,
}

impl<Drive: FmcDrive, Enable: OutputPin> EnabledDrive<Drive, Enable> {
    /// Returns a released drive, its pin low.
    pub fn new(drive: Drive, enable: Enable) -> Self {
        let mut enabled = Self {
            drive,
            enable,
            release_failed: false,
        };
        enabled.release();
        enabled
    }

    /// Lets the drive put force on the stage.
    fn power(&mut self, force: impl FnOnce(&mut Drive) -> Result<(), Fault>) -> Result<(), Fault> {
        if core::mem::take(&mut self.release_failed) {
            self.release();
            return Err(Fault::Drive);
        }
        let forced = force(&mut self.drive);
        // The pin goes high after the new duty is set, so that the old one never acts.
        let enabled = match forced {
            Ok(()) => self.enable.set_high().map_err(|_| Fault::Drive),
            Err(fault) => Err(fault),
        };
        if enabled.is_err() {
            self.release();
        }
        enabled
    }
}

impl<Drive: FmcDrive, Enable: OutputPin> FmcDrive for EnabledDrive<Drive, Enable> {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.drive.position(now)
    }

    fn take_index(&mut self) -> Option<f32> {
        self.drive.take_index()
    }

    fn take_latched(&mut self, edge: ShutterEdge, at: Time) -> Option<StageReading> {
        self.drive.take_latched(edge, at)
    }

    fn take_latches(&mut self) -> Latches {
        self.drive.take_latches()
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.power(|drive| drive.follow(now, setpoint))
    }

    fn release(&mut self) {
        self.release_failed = self.enable.set_low().is_err();
        self.drive.release();
    }
}

impl<Drive: FlownDrive, Enable: OutputPin> FlownDrive for EnabledDrive<Drive, Enable> {
    fn is_of(&self, kind: DriveKind) -> bool {
        self.drive.is_of(kind)
    }

    fn set_settings(&mut self, settings: DriveSettings) -> Result<(), OutOfRange> {
        self.release();
        self.drive.set_settings(settings)
    }

    fn push(&mut self, now: Time, duty: f32) -> Result<(), Fault> {
        self.power(|drive| drive.push(now, duty))
    }

    fn asked_duty(&self) -> Option<f32> {
        self.drive.asked_duty()
    }

    fn set_reference(&mut self) {
        self.drive.set_reference();
    }
}
