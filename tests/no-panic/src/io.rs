//! The link.

use fmc_camera::io::link::{
    deck::RigDeck,
    digest,
    frame::{Frame, FrameReceiver},
    message::{Answer, Grid, Identity, Request},
    station::Station,
};

/// Keeps the public functions of `fmc_camera::io`.
pub(crate) fn keep() {
    keep![
        Frame::bytes,
        FrameReceiver::new,
        FrameReceiver::receive,
        Identity::new,
        Grid::points,
        Request::write,
        Request::read,
        Answer::write,
        Answer::read,
        digest::of_grid,
        digest::of_record,
        digest::of_flight_record,
        RigDeck::new,
        Station::new,
        Station::<RigDeck>::with,
        Station::<RigDeck>::receive,
        Station::<RigDeck>::to_send,
        Station::<RigDeck>::sent,
        Station::<RigDeck>::count_overrun,
        Station::<RigDeck>::counters,
        Station::<RigDeck>::deck_mut,
    ];
}
