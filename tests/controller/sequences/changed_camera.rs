//! Sequences in which another camera was loaded between two flights.

use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::flown_deck::FlownDeck;

use super::*;

/// A board with a clock of rows, which flies whatever camera it is given.
struct Board {
    deck: FlownDeck<RigDrive>,
    now: Time,
}

impl Board {
    fn new(start: Start) -> Self {
        let drive = RigDrive::new(DriveSettings::default()).unwrap();
        Self {
            deck: FlownDeck::new(drive, start).with_row_clock(),
            now: Time::START,
        }
    }

    fn prepare(&mut self, camera: &CameraParameters) {
        let settings = FlightSettings {
            encoder_survives_brown_out: false,
            ..FlightSettings::default()
        };
        self.deck.load(identified(camera));
        self.deck.prepare(&settings).unwrap();
    }

    fn round(&mut self, event: Event) -> State {
        self.now = self.now.plus_s(1e-3);
        self.deck.set_now(self.now);
        self.deck.capture(self.now, event);
        self.deck
            .capture(self.now, Event::Vh(VhSample::Direct(0.1)));
        self.deck.round(self.now);
        self.deck.controller().unwrap().state()
    }

    fn obey(&mut self, command: Command) -> State {
        self.round(Event::Command(command))
    }

    fn is_place_lost(&self) -> bool {
        self.deck.controller().unwrap().is_place_lost()
    }
}

#[test]
fn place_that_is_lost_stays_lost_while_a_tdi_camera_flies() {
    // A camera without a stage began with its place known, and so did the next one with a stage: it
    // was driven from wherever it stood.
    let lose: [(Start, &[Event]); 4] = [
        (Start::Unreferenced, &[]),
        (Start::AfterWatchdog, &[]),
        (Start::Orderly, &[Event::Drive(Fault::Encoder)]),
        (
            Start::Orderly,
            &[Event::Supply(Supply::Low), Event::Supply(Supply::Good)],
        ),
    ];
    for (start, events) in lose {
        let mut board = Board::new(start);
        board.prepare(&tdi());
        for event in events {
            board.round(*event);
        }
        assert_eq!(board.obey(Command::ClearFault), State::Standby, "{start:?}");
        // The rows need no encoder.
        assert_eq!(board.obey(Command::Arm), State::Armed, "{start:?}");
        assert_eq!(board.obey(Command::Disarm), State::Standby, "{start:?}");
        assert!(board.is_place_lost(), "{start:?}, {events:?}");
        board.prepare(&camera());
        let armed = board.obey(Command::Arm);
        assert_eq!(armed, State::Degraded(Fault::Encoder), "{start:?}");
        assert!(!board.deck.drive().powered());
    }
}

#[test]
fn place_found_while_a_tdi_camera_flies_is_known_to_the_next_one() {
    let mut board = Board::new(Start::Unreferenced);
    board.prepare(&tdi());
    board.obey(Command::Referenced);
    assert!(!board.is_place_lost());
    board.prepare(&camera());
    assert_eq!(board.obey(Command::Arm), State::FlyBack);
    assert!(board.deck.drive().powered());
}
