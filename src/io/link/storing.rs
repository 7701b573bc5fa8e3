//! The calibration in use to the board's store, and from it.

use embedded_storage::nor_flash::NorFlash;

use super::deck::FlightDeck;
use super::link_event::LinkEvent;
use super::message::{Header, Refusal};
use super::responder::Responder;
use super::{deck, digest};
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::CameraParameters;
use crate::io::store::{
    CalibrationStore, NothingStored, SignatureVerifier, StoreOrder, StoredIdentity,
};

impl<Deck: FlightDeck> Responder<Deck> {
    /// Puts the stored calibration into use; notes what was found.
    #[inline(never)]
    pub(super) fn start_from<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
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

    /// Stores the calibration in use as it was ordered, and answers. The steps follow each other,
    /// so that none needs the stack of another.
    pub(super) fn carry_out<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
    ) -> LinkEvent {
        let Some((header, order)) = self.shelf.ordered.take() else {
            return LinkEvent::Answered;
        };
        self.keeper.pause();
        let stored = self.store(store, &order);
        if let Some(controller) = self.deck.record_holder_mut() {
            controller.note_pause();
        }
        let done = match stored {
            Ok(()) => self.use_stored(),
            Err(refusal) => {
                // The flash may hold something else now.
                self.look_again(store);
                Err(refusal)
            }
        };
        if done.is_ok() {
            self.answer_stored(header);
        }
        self.conclude(header, done)
    }

    #[inline(never)]
    fn store<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
        order: &StoreOrder,
    ) -> Result<(), Refusal> {
        deck::check_load(&self.deck, true)?;
        self.grids.end();
        let parameters = self.shelf.in_use.as_ref().ok_or(Refusal::NoCalibration)?;
        let stored = store.store(parameters, order, self.grids.memory_mut());
        let stored = stored.map_err(Refusal::NotStored)?;
        self.shelf.found = Some(Ok(stored.identity));
        Ok(())
    }

    #[inline(never)]
    fn look_again<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
    ) {
        let found = store.load(self.grids.memory_mut());
        self.shelf.found = Some(found.map(|stored| stored.identity));
    }

    #[inline(never)]
    fn use_stored(&mut self) -> Result<LinkEvent, Refusal> {
        let parameters = self.shelf.in_use.ok_or(Refusal::NoCalibration)?;
        self.put_stored_into_use(&parameters).map(LinkEvent::Loaded)
    }

    #[inline(never)]
    fn answer_stored(&mut self, header: Header) {
        if let Ok(answer) = self.shelf.tell() {
            self.reply.send(header, &answer);
        }
    }

    #[inline(never)]
    fn put_stored_into_use(
        &mut self,
        parameters: &CameraParameters,
    ) -> Result<CalibrationId, Refusal> {
        let crc = digest::of_camera(parameters);
        self.load(parameters, crc, Storage::Stored, true)
    }
}
