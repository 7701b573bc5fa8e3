//! Public functions of the link and of the receivers of aircraft data.

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::ring::Ring;
use fmc_camera::io::link::{
    deck::{FlightDeck, RigDeck},
    digest,
    frame::{Frame, FrameReceiver},
    message::{Answer, Grid, Identity, Request, Start},
    station::Station,
};

type Bytes = Ring<u8, 8>;
type Deck = FlownDeck<RigDrive>;
type Stamps = Ring<u32, 8>;

/// Keeps the public functions of `fmc_camera::io`.
pub(crate) fn keep() {
    keep![
        Bytes::new,
        Bytes::push,
        Bytes::pop,
        Bytes::has_room,
        Bytes::is_empty,
        Bytes::lose,
        Bytes::take_lost,
        Stamps::new,
        Stamps::push,
        Stamps::pop,
        Stamps::has_room,
        Stamps::is_empty,
        Stamps::lose,
        Stamps::take_lost,
        Stamps::capture,
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
        RigDeck::after,
        Deck::new,
        Deck::with_row_clock,
        Deck::set_now,
        Deck::capture,
        Deck::count_lost,
        Deck::see,
        Deck::round,
        Deck::drive,
        Deck::drive_mut,
        Deck::prepare,
        Deck::controller,
        Deck::controller_mut,
        Deck::offset_mm,
        Deck::tell,
        Deck::step,
        Start::counting_on,
        Start::unreferenced,
        Station::<Deck>::receive,
        Station::new,
        Station::<RigDeck>::with,
        Station::<RigDeck>::receive,
        Station::<RigDeck>::to_send,
        Station::<RigDeck>::sent,
        Station::<RigDeck>::count_overrun,
        Station::<RigDeck>::counters,
        Station::<RigDeck>::deck_mut,
    ];
    #[cfg(feature = "mavlink")]
    keep_mavlink();
    #[cfg(feature = "nmea")]
    keep_nmea();
}

#[cfg(feature = "mavlink")]
fn keep_mavlink() {
    use fmc_camera::io::mavlink::MavlinkReceiver;
    keep![
        MavlinkReceiver::new,
        MavlinkReceiver::receive,
        MavlinkReceiver::buffered,
    ];
}

#[cfg(feature = "nmea")]
fn keep_nmea() {
    use fmc_camera::io::nmea::NmeaReceiver;
    keep![NmeaReceiver::new, NmeaReceiver::receive];
}
