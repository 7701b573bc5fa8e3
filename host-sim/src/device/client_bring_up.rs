//! The client's requests to a board before a camera is loaded.

use fmc_camera::flight::bring_up::Trial;
use fmc_camera::io::link::message::{Answer, Inputs, Request};

use super::client::Client;
use super::link_error::LinkError;
use super::port::Port;

impl<P: Port> Client<P> {
    /// Returns levels of the lines, counts of their edges, and the last trial.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera on a test rig.
    pub fn inputs(&mut self) -> Result<Inputs, LinkError> {
        match self.ask(&Request::Inputs)? {
            Answer::Inputs(inputs) => Ok(inputs),
            _ => Err(self.unexpected(&Request::Inputs)),
        }
    }

    /// Begins a trial of mechanism or shutter.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where it is not safe.
    pub fn try_out(&mut self, trial: Trial) -> Result<(), LinkError> {
        let request = Request::Try(trial);
        match self.ask(&request)? {
            Answer::Told => Ok(()),
            _ => Err(self.unexpected(&request)),
        }
    }
}
