//! Public functions of the link and of the receivers of aircraft data.

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::geometry::{
    frame_correction::FrameCorrection, gridded_correction::GriddedCorrection,
};
use fmc_camera::io::instruments::{Instruments, counters::ReceiverCounters};
use fmc_camera::io::link::{
    after_reset::{FlightAfterReset, WithoutEyes},
    deck::{FlightDeck, RigDeck},
    digest,
    flight_memory::FlightMemory,
    loading::{self, Upload},
    message::{Answer, Grid, Identity, Request, ResetCause},
    packet::{Packet, PacketReceiver},
    station::Station,
    wired_deck::WiredDeck,
};
use fmc_camera::io::mavlink::MavlinkReceiver;
use fmc_camera::io::nmea::NmeaReceiver;
use fmc_camera::io::store::record_ring::{RecordRing, RingEntry};
use fmc_camera::io::store::{
    CalibrationStore, NothingStored, Origin, ProbePoint, PublicKey, Signature, Statement,
};

use crate::flash::Flash;

type Deck = FlownDeck<RigDrive>;
type Store = CalibrationStore<Flash>;
type Ring = RecordRing<Flash>;
type Wired = WiredDeck<RigDrive>;

/// Keeps the public functions of `fmc_camera::io`.
pub(crate) fn keep() {
    keep![
        Packet::bytes,
        PacketReceiver::new,
        PacketReceiver::receive,
        Identity::new,
        Grid::points,
        Request::write,
        Request::read,
        Answer::write,
        Answer::read,
        digest::of_grid::<FrameCorrection>,
        digest::of_grid::<GriddedCorrection<'_>>,
        digest::of_camera,
        digest::of_frame_record,
        Upload::of,
        Upload::bytes,
        Upload::crc,
        Upload::parts,
        Upload::requests,
        Upload::requests_in_flight,
        loading::grid_requests,
        loading::parameters,
        RigDeck::new,
        RigDeck::after,
        RigDeck::hear,
        RigDeck::count_lost,
        Wired::new,
        Wired::flown_mut,
        Wired::hear,
        Wired::count_lost,
        Wired::round,
        Station::<Wired>::receive,
        Instruments::new,
        Instruments::of_system,
        Instruments::clear,
        Instruments::push,
        Instruments::count_lost,
        Instruments::count_crowded_out,
        Instruments::received,
        Instruments::round,
        Instruments::wired,
        Instruments::counters,
        ReceiverCounters::has_two_receivers,
        Deck::step,
        ResetCause::counting_on,
        ResetCause::unreferenced,
        Station::<Deck>::receive,
        Station::new,
        Station::<RigDeck>::with,
        Station::<RigDeck>::load,
        Station::<RigDeck>::receive,
        Station::<RigDeck>::to_send,
        Station::<RigDeck>::sent,
        Station::<RigDeck>::count_overrun,
        Station::<RigDeck>::counters,
        Station::<RigDeck>::deck_mut,
        Station::<RigDeck>::keep_grids_in,
        Station::<RigDeck>::keep_flight_in,
        Station::<RigDeck>::keep_flight,
        Station::<Wired>::keep_flight_in,
        Station::<Wired>::keep_flight,
        FlightAfterReset::describe,
        WithoutEyes::at_most_ms,
        Station::<RigDeck>::bound_reset,
        FlightMemory::blank,
        FlightMemory::of_words,
        FlightMemory::words,
        Station::<RigDeck>::grid_memory_mut,
        Station::<RigDeck>::load_stored::<Flash, PublicKey>,
        Station::<RigDeck>::store::<Flash, PublicKey>,
        Station::<RigDeck>::keep_records_in::<Flash>,
        Station::<RigDeck>::keep_records::<Flash>,
        Station::<Wired>::keep_records_in::<Flash>,
        Station::<Wired>::keep_records::<Flash>,
        MavlinkReceiver::new,
        MavlinkReceiver::receive,
        MavlinkReceiver::buffered,
        MavlinkReceiver::is_under_way,
        MavlinkReceiver::take_unexplained,
        NmeaReceiver::new,
        NmeaReceiver::receive,
        NmeaReceiver::is_under_way,
        NmeaReceiver::take_unexplained,
    ];
    keep_store();
}

/// Keeps those of the store.
fn keep_store() {
    keep![
        Store::new,
        Store::of_camera,
        Store::trusting::<PublicKey>,
        Store::flash_mut,
        Store::into_flash,
        Store::load,
        Store::store,
        Ring::open,
        Ring::capacity,
        Ring::sector_of,
        Ring::next,
        Ring::erasures,
        Ring::state,
        Ring::holds_entry,
        Ring::flash_mut,
        Ring::into_flash,
        Ring::push,
        Ring::step,
        Ring::newest_first::<fn(u32, &[u8]) -> bool>,
        Ring::read,
        RingEntry::contents,
        Origin::new,
        Origin::lens,
        Origin::laboratory,
        Origin::date,
        ProbePoint::of,
        ProbePoint::bits,
        ProbePoint::computed,
        NothingStored::is_blank,
        PublicKey::new,
        PublicKey::from_pem,
        PublicKey::bytes,
        Signature::new,
        Signature::to_bytes,
        Statement::of,
        Statement::pieces,
    ];
}
