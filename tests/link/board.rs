//! A board on the PC: its events come from wires and over the link, and a number stands for its
//! stage.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::shutter_output::ShutterOutput;
use fmc_camera::flight::time::Clock;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Identity, Request, ResetCause, Status};
use fmc_camera::io::link::station::Station;

use crate::link::pc::{Pc, camera_parameters};
/// Count of the encoder where the stage stands at power-on, which is the calibrated position.
pub(crate) const COUNT_AT_START: i32 = 12_345;

/// Time from the shutter's command to light, and from its end to the end of light, µs.
const LATENCY_US: u32 = 2000;

/// Board with an ideal stage and a shutter that follows its wire.
pub(crate) struct Board {
    pub(crate) pc: Pc<FlownDeck<RigDrive>>,
    clock: Clock,
    pub(crate) counter_us: u32,
    pub(crate) shutter: ShutterOutput,
    is_high: bool,
    /// Events that the capture inputs stamp later.
    pub(crate) stamps: Vec<(u32, Event)>,
    pub(crate) levels: InputLevels,
    pub(crate) faults: Vec<Fault>,
}

impl Board {
    /// Returns a board that is connected, loaded and prepared, with its counter at a number.
    pub(crate) fn prepared_at(counter_us: u32) -> Self {
        let mut board = Self::connected(ResetCause::PowerOn, counter_us);
        let loaded = board.pc.load(&camera_parameters());
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
        assert_eq!(board.prepare(), Answer::Prepared);
        board
    }

    pub(crate) fn connected(start: ResetCause, counter_us: u32) -> Self {
        Self::kept_in(start, counter_us, None)
    }

    /// As [`Self::connected`], with the memory of a flight that goes on over a reset.
    pub(crate) fn kept_in(
        start: ResetCause,
        counter_us: u32,
        memory: Option<&'static FlightMemory>,
    ) -> Self {
        Self::driven(start, counter_us, memory, DriveSettings::default())
    }

    /// As [`Self::kept_in`], with the drive of these settings.
    pub(crate) fn driven(
        start: ResetCause,
        counter_us: u32,
        memory: Option<&'static FlightMemory>,
        settings: DriveSettings,
    ) -> Self {
        let identity = Identity::new("test build", "test board", false, start);
        let drive = RigDrive::new(settings).unwrap();
        let deck = FlownDeck::new(drive, start.unreferenced());
        let mut station = Station::with(identity, || 0, deck);
        if let Some(memory) = memory {
            station.keep_flight_in(memory);
        }
        let mut clock = Clock::new();
        // The board has run for a while.
        for quarter in 1..=counter_us >> 30 {
            clock.extend(quarter << 30);
        }
        let mut board = Self {
            pc: Pc::of(station),
            clock,
            counter_us,
            shutter: ShutterOutput::new(),
            is_high: false,
            stamps: Vec::new(),
            levels: InputLevels::GOOD,
            faults: Vec::new(),
        };
        board.count(COUNT_AT_START);
        let connected = board.pc.ask(&Request::Connect);
        assert!(matches!(connected, Answer::Connected(_)));
        board
    }

    pub(crate) fn deck(&mut self) -> &mut FlownDeck<RigDrive> {
        self.pc.station.deck_mut()
    }

    pub(crate) fn count(&mut self, count: i32) {
        self.deck().drive_mut().set_count(count);
    }

    pub(crate) fn prepare(&mut self) -> Answer {
        self.pc.ask(&Request::Prepare(FlightSettings::default()))
    }

    pub(crate) fn tell(&mut self, event: Event) -> Answer {
        let now = self.clock.extend(self.counter_us);
        self.deck().set_now(now);
        self.pc.ask(&Request::Tell(event))
    }

    pub(crate) fn command(&mut self, command: Command) {
        assert_eq!(self.tell(Event::Command(command)), Answer::Told);
        self.round();
    }

    pub(crate) fn status(&mut self) -> Status {
        match self.pc.ask(&Request::Status) {
            Answer::Status(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// Sets the wire of the shutter at a time of the counter, and the later answer of its sensor.
    pub(crate) fn work_shutter(&mut self, counter_us: u32) -> Option<u32> {
        let level = self.shutter.look(counter_us);
        if level.is_high != self.is_high {
            self.is_high = level.is_high;
            let edge = if level.is_high {
                ShutterEdge::Opened
            } else {
                ShutterEdge::Closed
            };
            let stamp = counter_us.wrapping_add(LATENCY_US);
            self.stamps.push((stamp, Event::Shutter(edge)));
        }
        level.next_us
    }

    /// Runs a millisecond and the round at its end.
    pub(crate) fn round(&mut self) {
        let end_us = self.counter_us.wrapping_add(1000);
        let is_due = |time_us: u32| end_us.wrapping_sub(time_us).cast_signed() >= 0;
        while let Some(next_us) = self.work_shutter(self.counter_us)
            && is_due(next_us)
        {
            self.counter_us = next_us;
        }
        self.counter_us = end_us;
        let due: Vec<_> = self.stamps.extract_if(.., |it| is_due(it.0)).collect();
        for (stamp, event) in due {
            let time = self.clock.extend(stamp);
            self.deck().capture(time, event);
        }
        let now = self.clock.extend(end_us);
        let setpoint = self
            .deck()
            .controller()
            .and_then(|controller| controller.setpoint(now));
        if let Some(setpoint) = setpoint {
            let counts: i32 = format!("{:.0}", setpoint.offset_mm * 1e4).parse().unwrap();
            self.count(COUNT_AT_START + counts);
        }
        let levels = self.levels;
        self.deck().see(levels);
        for action in self.deck().round(now) {
            match action {
                Action::OpenShutter { at, exposure_s } => self.shutter.open(at, exposure_s),
                Action::CloseShutter => self.shutter.close(),
                Action::Fault(fault) => self.faults.push(fault),
                _ => {}
            }
        }
    }

    pub(crate) fn run_until(&mut self, state: State) {
        for round in 0..2000 {
            if round % 400 == 0 {
                assert_eq!(self.tell(Event::Vh(VhSample::Direct(0.1))), Answer::Told);
            }
            self.round();
            if self.deck().controller().unwrap().state() == state {
                return;
            }
        }
        panic!("never {state}");
    }

    pub(crate) fn arm(&mut self) {
        self.command(Command::Referenced);
        self.command(Command::Arm);
        self.run_until(State::Armed);
    }

    /// Runs a round with a trigger stamped that long before its end.
    pub(crate) fn trigger(&mut self, before_end_us: u32) {
        let stamp = self.counter_us.wrapping_add(1000 - before_end_us);
        self.stamps.push((stamp, Event::Trigger));
        self.run_until(State::Exposing);
        self.run_until(State::Armed);
    }

    pub(crate) fn record(&mut self, sequence: u32) -> FrameRecord {
        match self.pc.ask(&Request::FrameRecord(sequence)) {
            Answer::FrameRecord(Some((record, _))) if record.sequence == sequence => record,
            other => panic!("{other:?}"),
        }
    }
}
