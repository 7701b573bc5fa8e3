//! The camera's firmware: one loop between the serial link and the camera.
//!
//! On a board with a mechanism the control loop comes round in it, every millisecond, between two
//! bytes of the link.
//!
//! Requests come in byte by byte through an interrupt and a ring; the station reads and answers
//! them, and the answer leaves before the next request is looked at. The loop feeds the watchdog,
//! which bites when the loop stands still.
//!
//! `cfg(board)`, from `build.rs`, holds for the target with a board chosen.

#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code, clippy::undocumented_unsafe_blocks)]

#[cfg(board)]
#[allow(unsafe_code, reason = "registers, interrupts and the linker's symbols")]
mod board;
#[cfg(board)]
mod journal;

#[cfg(all(board, feature = "store"))]
use fmc_camera::io::store::{
    record_flash::RecordFlash,
    record_ring::{RecordRing, RingState},
};
#[cfg(board)]
use {
    board::{Board, Deck},
    fmc_camera::flight::grid_memory::GridMemory,
    fmc_camera::io::link::{
        message::{Identity, ResetCause},
        station::{LinkEvent, Station},
    },
    static_cell::{ConstStaticCell, StaticCell},
};

/// Memory for the residual grids of the camera.
#[cfg(board)]
static GRIDS: ConstStaticCell<GridMemory> = ConstStaticCell::new(GridMemory::EMPTY);

/// The camera's end of the link, with the deck and the flight: off the stack, which requests share.
#[cfg(board)]
static STATION: StaticCell<Station<Deck>> = StaticCell::new();

/// State of the sources from which this image was built: `build.rs` names it where nobody else has.
#[cfg(board)]
const BUILD: &str = env!("FMC_BUILD");

#[cfg(all(target_os = "none", not(board)))]
compile_error!("the firmware needs a board, such as --features board-mps2");

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This is the camera's firmware; `cargo xtask firmware` builds it for the target.");
}

/// Returns the camera's end of the link, in its place; `None` the second time. Whatever of it is on
/// the stack on its way is free when this returns.
#[cfg(board)]
#[inline(never)]
fn station(start: ResetCause) -> Option<&'static mut Station<Deck>> {
    let identity = Identity::new(BUILD, Board::NAME, Board::CAN_POWER_OFF, start);
    STATION.try_init_with(|| Station::with(identity, Board::stack_used_bytes, Board::deck(start)))
}

/// Takes up the flight before the start, after a reset of at most so many milliseconds, and logs
/// what it has found: in a frame of its own, which the main loop does without.
#[cfg(board)]
#[inline(never)]
fn take_up(
    station: &mut Station<Deck>,
    start: ResetCause,
    reset_at_most_ms: Option<u32>,
    #[cfg(feature = "store")] ring: Option<&mut RecordRing<impl RecordFlash>>,
) {
    station.bound_reset(reset_at_most_ms);
    let found = station.keep_flight_in(Board::flight_memory(start));
    #[cfg(feature = "store")]
    let found = ring.map_or(found, |ring| station.keep_records_in(ring));
    journal::note_flight(&found);
}

/// Runs the main loop, once the board has started.
#[cfg(board)]
fn run(mut board: Board, start: ResetCause) -> ! {
    journal::note_start(Board::NAME, BUILD, start);
    let Some(station) = station(start) else {
        // There is one main loop.
        board.reset();
    };
    if let Some(memory) = GRIDS.try_take() {
        station.keep_grids_in(memory);
    }
    #[cfg(feature = "store")]
    let mut store = board.store();
    #[cfg(feature = "store")]
    if let Some(store) = &mut store {
        journal::note_stored(station.load_stored(store));
    }
    #[cfg(feature = "store")]
    let mut ring = board.records();
    take_up(
        station,
        start,
        board.reset_at_most_ms(start),
        #[cfg(feature = "store")]
        ring.as_mut(),
    );
    let mut ending = None;
    loop {
        board.feed_watchdog();
        board.fly(station.deck_mut());
        // After every round and every request, before anything of the answer leaves.
        station.keep_flight();
        #[cfg(feature = "store")]
        let ring_state = ring.as_mut().map_or(RingState::Idle, |ring| {
            station.keep_records(ring);
            ring.state()
        });
        station.count_overrun(board.overruns());
        let waiting = station.to_send();
        if !waiting.is_empty() {
            let accepted = board.send(waiting);
            station.sent(accepted);
            continue;
        }
        // The answer to the last request has left by now.
        match ending {
            Some(LinkEvent::Reset) => board.reset(),
            Some(LinkEvent::PowerOff) => board.power_off(),
            _ => {}
        }
        #[cfg(feature = "store")]
        if let (Some(LinkEvent::Store), Some(store)) = (ending, &mut store) {
            // Both are in one bank, which does one thing at a time; between two words it is free.
            if ring_state == RingState::Erasing {
                continue;
            }
            let stored = station.store(store);
            journal::note(stored);
            ending = Some(stored);
            continue;
        }
        match board.receive() {
            Some(byte) => {
                ending = station.receive(byte);
                // A board that has all bytes of a request hands them over at once.
                while ending.is_none()
                    && let Some(byte) = board.receive_more()
                {
                    ending = station.receive(byte);
                }
                if let Some(event) = ending {
                    journal::note(event);
                }
            }
            // An entry that is being written does not wait for the next byte.
            #[cfg(feature = "store")]
            None if ring_state == RingState::Writing => {}
            None => board.idle(),
        }
    }
}
