//! The client's requests to a camera in flight.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::instruments::WireBytes;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::message::{Answer, FetchedRecord, Request, Status};

use super::client::Client;
use super::link_error::LinkError;
use super::port::Port;

impl<P: Port> Client<P> {
    /// Makes the camera ready to be flown.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for settings that are not believable, and while records are kept.
    pub fn prepare(&mut self, settings: &FlightSettings) -> Result<(), LinkError> {
        let request = Request::Prepare(*settings);
        match self.ask(&request)? {
            Answer::Prepared => Ok(()),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Runs one round of the control loop on a test rig.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera that has not been prepared, or is not on a rig.
    pub fn rig(&mut self, step: &RigStep) -> Result<RigAnswer, LinkError> {
        let request = Request::Rig(step.clone());
        match self.ask(&request)? {
            Answer::Rig(answer) => Ok(answer),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Runs one round of the control loop on a test rig on whose wires so many bytes have been
    /// sent.
    ///
    /// # Errors
    /// As [`Self::rig`], and if the camera has not got as many bytes.
    pub fn wired(&mut self, step: &RigStep, sent: WireBytes) -> Result<RigAnswer, LinkError> {
        let request = Request::Wired(step.clone(), sent);
        match self.ask(&request)? {
            Answer::Rig(answer) => Ok(answer),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the counts of the camera's wires of receiver and autopilot.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera without such wires.
    pub fn instruments(&mut self) -> Result<InstrumentCounters, LinkError> {
        let request = Request::Instruments;
        match self.ask(&request)? {
            Answer::Instruments(counters) => Ok(counters),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the oldest frame record with this number or a higher one, and its CRC-32.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera that has not been prepared.
    pub fn frame_record(&mut self, from: u32) -> Result<Option<(FrameRecord, u32)>, LinkError> {
        let request = Request::FrameRecord(from);
        match self.ask(&request)? {
            Answer::FrameRecord(record) => Ok(record),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Tells the camera that frame records up to this one are stored; returns how many are left.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera that has not been prepared, and for a record that it
    /// does not keep so.
    pub fn acknowledge(&mut self, through: FetchedRecord) -> Result<u32, LinkError> {
        let request = Request::Acknowledge(through);
        match self.ask(&request)? {
            Answer::Kept(left) => Ok(left),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the status of a camera in flight.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera that has not been prepared.
    pub fn status(&mut self) -> Result<Status, LinkError> {
        match self.ask(&Request::Status)? {
            Answer::Status(status) => Ok(status),
            _ => Err(self.unexpected(&Request::Status)),
        }
    }

    /// Makes the frame exposed last in flight the current one; returns its number and interior
    /// orientation.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where there is none.
    pub fn flown(&mut self) -> Result<(u32, InteriorOrientation), LinkError> {
        match self.ask(&Request::Flown)? {
            Answer::Flown(sequence, interior) => Ok((sequence, interior)),
            _ => Err(self.unexpected(&Request::Flown)),
        }
    }

    /// Tells a camera that something happens now.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera that has not been prepared or is on a rig, and for an
    /// event that it takes from its own inputs alone.
    pub fn tell(&mut self, event: Event) -> Result<(), LinkError> {
        let request = Request::Tell(event);
        match self.ask(&request)? {
            Answer::Told => Ok(()),
            _ => Err(self.unexpected(&request)),
        }
    }
}
