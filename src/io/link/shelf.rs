//! The board's store as the link knows it.

use super::deck::FlightDeck;
use super::message::{Header, Refusal};
use super::{deck, message::Answer};
use crate::flight::camera::CameraParameters;
use crate::flight::controller::state::State;
use crate::io::store::{NothingStored, StoreOrder, StoredIdentity};

/// The store as the start has found it, and the calibration that may be stored.
#[derive(Debug)]
pub(super) struct Shelf {
    /// `None` in a camera without a store.
    pub(super) found: Option<Result<StoredIdentity, NothingStored>>,
    /// Parameters in use.
    pub(super) in_use: Option<CameraParameters>,
    /// Request that waits for the board, and what it states.
    pub(super) ordered: Option<(Header, StoreOrder)>,
}

impl Shelf {
    /// No store.
    pub(super) const NONE: Self = Self {
        found: None,
        in_use: None,
        ordered: None,
    };

    /// Says what is stored.
    pub(super) fn tell(&self) -> Result<Answer, Refusal> {
        self.found
            .clone()
            .map(Answer::Stored)
            .ok_or(Refusal::NoStore)
    }

    /// Takes the order to store the calibration in use, which the board carries out.
    pub(super) fn order(
        &mut self,
        deck: &impl FlightDeck,
        header: Header,
        order: &StoreOrder,
    ) -> Result<(), Refusal> {
        if self.found.is_none() {
            return Err(Refusal::NoStore);
        }
        if self.in_use.is_none() {
            return Err(Refusal::NoCalibration);
        }
        deck::check_load(deck, true)?;
        // Low supply is a fault, too, but a camera may be cleared of it while it is low, and one
        // that is not prepared has no state.
        if !deck.is_supply_good() {
            return Err(Refusal::SupplyLow);
        }
        if let Some(controller) = deck.controller() {
            match controller.state() {
                State::Standby => {}
                other => return Err(Refusal::NotStandby(other)),
            }
        }
        self.ordered = Some((header, order.clone()));
        Ok(())
    }
}
