//! The calibration in use to the board's store, and from it.

use embedded_storage::nor_flash::NorFlash;

use super::deck::FlightDeck;
use super::link_event::LinkEvent;
use super::message::{Answer, Header, Refusal};
use super::responder::Responder;
use super::{deck, digest};
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::CameraParameters;
use crate::io::store::{CalibrationStore, NothingStored, Origin, StoredIdentity};

impl<Deck: FlightDeck> Responder<Deck> {
    /// Puts the stored calibration into use; notes what was found.
    #[inline(never)]
    pub(super) fn start_from<F: NorFlash>(
        &mut self,
        store: &mut CalibrationStore<F>,
    ) -> &Result<StoredIdentity, NothingStored> {
        let loaded = store.load(self.grids.memory_mut());
        let found = loaded.map(|stored| {
            // The store has made the same checks: a refusal leaves a camera without a calibration,
            // which its identity shows.
            let _ = self.put_stored_into_use(&stored.parameters);
            stored.identity
        });
        self.shelf.found.insert(found)
    }

    /// Stores the calibration in use as it was ordered, and answers.
    #[inline(never)]
    pub(super) fn carry_out<F: NorFlash>(&mut self, store: &mut CalibrationStore<F>) -> LinkEvent {
        let Some((header, origin)) = self.shelf.ordered.take() else {
            return LinkEvent::Answered;
        };
        let done = self.store(store, header, &origin);
        self.conclude(header, done)
    }

    fn store<F: NorFlash>(
        &mut self,
        store: &mut CalibrationStore<F>,
        header: Header,
        origin: &Origin,
    ) -> Result<LinkEvent, Refusal> {
        let parameters = self.shelf.in_use.ok_or(Refusal::NoCalibration)?;
        deck::check_over(&self.deck)?;
        self.grids.end();
        match store.store(&parameters, origin, self.grids.memory_mut()) {
            Ok(stored) => {
                let id = self.put_stored_into_use(&parameters)?;
                let found = self.shelf.found.insert(Ok(stored.identity));
                self.reply.send(header, &Answer::Stored(found.clone()));
                Ok(LinkEvent::Loaded(id))
            }
            Err(error) => {
                // The flash may hold something else now.
                let found = store.load(self.grids.memory_mut());
                self.shelf.found = Some(found.map(|stored| stored.identity));
                Err(Refusal::NotStored(error))
            }
        }
    }

    fn put_stored_into_use(
        &mut self,
        parameters: &CameraParameters,
    ) -> Result<CalibrationId, Refusal> {
        let crc = digest::of_camera(parameters);
        self.load(*parameters, crc, Storage::Stored)
    }
}
