//! The client's requests to the store of a camera.

use fmc_camera::io::link::message::{Answer, Request};
use fmc_camera::io::store::{NothingStored, StoreOrder, StoredIdentity};

use super::client::Client;
use super::link_error::LinkError;
use super::port::Port;

impl<P: Port> Client<P> {
    /// Lets the camera store the calibration in use.
    ///
    /// # Errors
    /// [`LinkError::Refused`] without a calibration, for one that the store does not take, and
    /// outside standby.
    pub fn store(&mut self, order: &StoreOrder) -> Result<StoredIdentity, LinkError> {
        let request = Request::Store(order.clone());
        match self.ask(&request)? {
            Answer::Stored(Ok(record)) => Ok(record),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns what the camera has stored.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a camera without a store.
    pub fn stored(&mut self) -> Result<Result<StoredIdentity, NothingStored>, LinkError> {
        match self.ask(&Request::Stored)? {
            Answer::Stored(stored) => Ok(stored),
            _ => Err(self.unexpected(&Request::Stored)),
        }
    }
}
