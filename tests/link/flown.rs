//! A camera on a board: its events come from wires and over the link, its stage is a number.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::pwm_encoder::DriveSettings;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::shutter_output::ShutterOutput;
use fmc_camera::flight::time::{Clock, Time};
use fmc_camera::flight::vh::VhSample;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::io::link::deck::FlightDeck;
use fmc_camera::io::link::flown_deck::FlownDeck;
use fmc_camera::io::link::message::{
    Answer, Grid, Identity, Observations, Refusal, Request, Start, Status,
};
use fmc_camera::io::link::station::Station;

use crate::pc::{Pc, camera_record};

/// What the encoder counts where the stage stands at power-on, which is the calibrated position.
const COUNT_AT_START: i32 = 12_345;

/// From the shutter's command to light, and from its end to the end of light, µs.
const LATENCY_US: u32 = 2000;

/// A board with an ideal stage and a shutter that does as its wire says.
struct Board {
    pc: Pc<FlownDeck<RigDrive>>,
    clock: Clock,
    counter_us: u32,
    shutter: ShutterOutput,
    is_high: bool,
    /// What the capture inputs will have stamped.
    stamps: Vec<(u32, Event)>,
    levels: InputLevels,
    faults: Vec<Fault>,
}

impl Board {
    /// Connected, loaded and prepared; its counter at some number.
    fn prepared_at(counter_us: u32) -> Self {
        let mut board = Self::connected(Start::PowerOn, counter_us);
        let loaded = board.pc.ask(&Request::Load(camera_record()));
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
        assert_eq!(board.prepare(), Answer::Prepared);
        board
    }

    fn connected(start: Start, counter_us: u32) -> Self {
        let identity = Identity::new("test build", "test board", false, start);
        let drive = RigDrive::new(DriveSettings::default()).unwrap();
        let station = Station::with(identity, || 0, FlownDeck::new(drive, start));
        let mut clock = Clock::new();
        // It has run for a while.
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

    fn deck(&mut self) -> &mut FlownDeck<RigDrive> {
        self.pc.station.deck_mut()
    }

    fn count(&mut self, count: i32) {
        self.deck().drive_mut().set_count(count);
    }

    fn prepare(&mut self) -> Answer {
        self.pc.ask(&Request::Prepare(FlightSettings::default()))
    }

    fn tell(&mut self, event: Event) -> Answer {
        let now = self.clock.extend(self.counter_us);
        self.deck().set_now(now);
        self.pc.ask(&Request::Tell(event))
    }

    fn command(&mut self, command: Command) {
        assert_eq!(self.tell(Event::Command(command)), Answer::Told);
        self.round();
    }

    fn status(&mut self) -> Status {
        match self.pc.ask(&Request::Status) {
            Answer::Status(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// The wire of the shutter at a time of the counter, and what its sensor says of it later.
    fn work_shutter(&mut self, counter_us: u32) -> Option<u32> {
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

    /// A millisecond, and the round at its end.
    fn round(&mut self) {
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

    fn run_until(&mut self, state: State) {
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

    fn arm(&mut self) {
        self.command(Command::Referenced);
        self.command(Command::Arm);
        self.run_until(State::Armed);
    }

    /// A trigger, stamped so long before the end of the round.
    fn trigger(&mut self, before_end_us: u32) {
        let stamp = self.counter_us.wrapping_add(1000 - before_end_us);
        self.stamps.push((stamp, Event::Trigger));
        self.run_until(State::Exposing);
        self.run_until(State::Armed);
    }

    fn record(&mut self, sequence: u32) -> FrameRecord {
        match self.pc.ask(&Request::FlightRecord(sequence)) {
            Answer::FlightRecord(Some((record, _))) if record.sequence == sequence => record,
            other => panic!("{other:?}"),
        }
    }
}

fn exposed(record: &FrameRecord) -> &ExposedFrame {
    match &record.outcome {
        Outcome::Exposed(frame) => frame,
        Outcome::Refused(reason) => panic!("{}", reason.name()),
    }
}

/// The exposure is the wire's to the microsecond, the travel f·V/H·t to the encoder's step.
fn assert_compensated(record: &FrameRecord) {
    let frame = exposed(record);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert!(!record.flags.contains(Flag::NoCompensation));
    assert!(!record.flags.contains(Flag::PlannedMotion));
    assert_eq!(frame.closed.us_since(frame.opened), 3333);
    let travel_mm = 51.3712 * 0.1 * 3.333e-3;
    let off_um = 1e3 * (frame.interior.motion.travel_mm - travel_mm);
    // Two readings of 0.1 µm, by which the line through all of them is off at most.
    assert!(off_um.abs() < 0.1, "{off_um} µm");
}

#[test]
fn camera_is_flown_over_the_link_and_by_its_wires_alone() {
    let mut board = Board::prepared_at(0);
    board.round();
    let status = board.status();
    assert_eq!(status.state, State::Standby);
    assert!(
        status.is_place_lost,
        "nobody has said where the stage stands"
    );
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Degraded(Fault::Encoder));
    board.command(Command::Disarm);

    board.arm();
    assert!(!board.status().is_place_lost);
    board.trigger(300);
    board.trigger(999);
    for sequence in [1, 2] {
        assert_compensated(&board.record(sequence));
    }
    assert_eq!(
        board.pc.ask(&Request::FlightRecord(3)),
        Answer::FlightRecord(None)
    );
    assert_eq!(board.status().kept, 2);
    assert_eq!(board.pc.ask(&Request::Acknowledge(2)), Answer::Kept(0));
    let counts = board.status().counts;
    assert_eq!(
        (counts.triggers, counts.exposed, counts.lost_events),
        (2, 2, 0)
    );
    assert!(board.faults.iter().all(|fault| *fault == Fault::Encoder));

    assert_eq!(
        board.tell(Event::Command(Command::Exposure(5e-3))),
        Answer::Told
    );
    board.trigger(0);
    let record = board.record(3);
    let frame = exposed(&record);
    assert_eq!(frame.closed.us_since(frame.opened), 5000);
}

#[test]
fn counter_that_wraps_between_trigger_and_round_changes_nothing_but_the_times() {
    let mut first = Board::prepared_at(0);
    first.arm();
    let flown_us = first.counter_us;
    first.trigger(300);
    let record = first.record(1);

    // The trigger is stamped 200 µs before the wrap, and the round that takes it comes 100 µs after it.
    let start_us = 0_u32.wrapping_sub(flown_us).wrapping_sub(900);
    let mut second = Board::prepared_at(start_us);
    second.arm();
    second.trigger(300);
    let wrapped = second.record(1);
    assert_eq!(wrapped.trigger.us(), (1 << 32) - 200);
    assert!(exposed(&wrapped).opened.us() > 1 << 32);
    let shift = |time: Time| Time::from_us(time.us() - u64::from(start_us));
    let frame = exposed(&wrapped);
    let shifted = FrameRecord {
        trigger: shift(wrapped.trigger),
        outcome: Outcome::Exposed(ExposedFrame {
            opened: shift(frame.opened),
            closed: shift(frame.closed),
            centroid: shift(frame.centroid),
            ..*frame
        }),
        ..wrapped
    };
    assert_eq!(shifted, record);
}

#[test]
fn bouncing_trigger_costs_its_own_bounces_and_says_so() {
    let mut board = Board::prepared_at(0);
    board.arm();
    board.trigger(300);
    // In the millisecond of the shutter's opening.
    let stamp = board.counter_us.wrapping_add(500);
    board.stamps.push((stamp, Event::Trigger));
    board.run_until(State::Tracking);
    while !board
        .stamps
        .iter()
        .any(|(_, event)| *event == Event::Shutter(ShutterEdge::Opened))
    {
        board.round();
    }
    board.round();
    let stamp = board.counter_us.wrapping_add(1);
    for bounce in 0..40 {
        board
            .stamps
            .insert(0, (stamp.wrapping_add(bounce), Event::Trigger));
    }
    board.run_until(State::Exposing);
    board.run_until(State::Armed);
    let record = board.record(2);
    let frame = exposed(&record);
    assert_eq!(frame.closed.us_since(frame.opened), 3333);
    assert!(
        record.faults.contains(Fault::Overload),
        "{:?}",
        record.faults
    );
    assert!(board.faults.contains(&Fault::Overload));
    let counts = board.status().counts;
    // 2 that were meant, and 4 of the 40 that had a place.
    assert_eq!((counts.triggers, counts.lost_events), (6, 36));
    assert_eq!((counts.exposed, counts.refused), (2, 4));
    assert_eq!((counts.late_ticks, counts.unexpected_edges), (0, 0));
}

#[test]
fn only_what_is_told_may_be_told_and_what_finds_no_place_is_refused() {
    let mut board = Board::connected(Start::PowerOn, 0);
    let arm = Event::Command(Command::Arm);
    let refused = |answer| match answer {
        Answer::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(board.tell(arm)), Refusal::NotPrepared);
    // Lost on nobody: there is no camera.
    board.deck().capture(Time::START, Event::Trigger);
    board.pc.ask(&Request::Load(camera_record()));
    board.prepare();
    for wired in [
        Event::Trigger,
        Event::TimePulse,
        Event::Shutter(ShutterEdge::Opened),
        Event::LimitSwitch,
        Event::Drive(Fault::Drive),
        Event::Tick,
        Event::Lost(1),
    ] {
        assert_eq!(refused(board.tell(wired)), Refusal::NotTold, "{wired:?}");
    }
    let vh = Event::Vh(VhSample::Direct(0.1));
    for _ in 0..4 {
        assert_eq!(board.tell(vh), Answer::Told);
    }
    assert_eq!(refused(board.tell(vh)), Refusal::QueueFull);
    // What somebody wants finds a place all the same.
    assert_eq!(board.tell(Event::Command(Command::Disarm)), Answer::Told);
    board.round();
    assert_eq!(board.tell(vh), Answer::Told);
    board.round();
    let counts = board.status().counts;
    assert_eq!((counts.triggers, counts.lost_events), (0, 0));

    let mut rig = Pc::loaded();
    assert_eq!(refused(rig.ask(&Request::Tell(arm))), Refusal::OnRig);
    let step = fmc_camera::flight::rig::RigStep::default();
    assert_eq!(refused(board.pc.ask(&Request::Rig(step))), Refusal::NoRig);
}

#[test]
fn nothing_that_lasts_longer_than_a_round_is_begun_while_the_stage_has_force_on_it() {
    let mut board = Board::prepared_at(0);
    board.arm();
    let long = [
        Request::Digest(Grid {
            x_mm: heapless_of(0.0),
            y_mm: heapless_of(0.0),
        }),
        Request::StartFit(FitOptions::default()),
        Request::Observe(Observations::new()),
        Request::Fit,
        Request::Load(camera_record()),
        Request::Prepare(FlightSettings::default()),
    ];
    board.trigger(0);
    let flown = board.pc.ask(&Request::Flown);
    assert!(matches!(flown, Answer::Flown(1, _)), "{flown:?}");
    for request in &long {
        let answer = board.pc.ask(request);
        assert_eq!(
            answer,
            Answer::Refused(Refusal::FrameInFlight),
            "{request:?}"
        );
    }
    board.command(Command::Disarm);
    for request in &long[..2] {
        let answer = board.pc.ask(request);
        assert!(!matches!(answer, Answer::Refused(_)), "{answer:?}");
    }
}

fn heapless_of<const N: usize>(value: f32) -> heapless::Vec<f32, N> {
    std::iter::once(value).collect()
}

#[test]
fn second_prepare_takes_new_drive_settings_and_keeps_the_place() {
    let mut board = Board::prepared_at(0);
    board.arm();
    board.command(Command::Disarm);
    board.count(COUNT_AT_START + 1000);
    let offset_mm = |board: &mut Board| {
        let reading = board.deck().drive_mut().position(Time::START).unwrap();
        reading.offset_mm
    };
    assert!((offset_mm(&mut board) - 0.1).abs() < 1e-6);
    let mut settings = FlightSettings::default();
    settings.drive.encoder_step_um = 0.2;
    settings.drive.encoder_reversed = true;
    assert_eq!(board.pc.ask(&Request::Prepare(settings)), Answer::Prepared);
    assert!((offset_mm(&mut board) + 0.2).abs() < 1e-6);
    board.round();
    let status = board.status();
    assert!(!status.is_place_lost);
    assert_eq!(status.counts.triggers, 0);
}

#[test]
fn reference_is_taken_in_standby_alone() {
    let mut board = Board::prepared_at(0);
    board.arm();
    let count = board.deck().drive_mut().position(Time::START).unwrap();
    board.command(Command::Referenced);
    board.round();
    let unchanged = board.deck().drive_mut().position(Time::START).unwrap();
    // At the waiting place, 51 µm at most from where it was: a new zero there would be 0.
    assert!((unchanged.offset_mm - count.offset_mm).abs() < 1e-3);
    assert!(unchanged.offset_mm.abs() > 1e-3, "{unchanged:?}");
    assert_eq!(board.deck().controller().unwrap().state(), State::Armed);
}

#[test]
fn switches_and_supply_are_events_once_when_they_change_and_after_every_prepare() {
    let mut board = Board::prepared_at(0);
    board.levels.limit_low = true;
    board.round();
    board.round();
    assert_eq!(board.faults, [Fault::LimitSwitch]);
    board.levels.limit_high = true;
    board.levels.supply_low = true;
    board.round();
    // The other switch is another event.
    let expected = [Fault::LimitSwitch, Fault::LimitSwitch, Fault::BrownOut];
    assert_eq!(board.faults, expected);
    board.levels = InputLevels::GOOD;
    board.round();
    board.faults.clear();

    board.levels.supply_low = true;
    board.round();
    assert_eq!(board.faults, [Fault::BrownOut]);
    board.faults.clear();
    assert_eq!(board.prepare(), Answer::Prepared);
    board.round();
    assert_eq!(board.faults, [Fault::BrownOut]);
    board.command(Command::Arm);
    assert_eq!(board.status().state, State::Standby, "there is no supply");
    board.levels = InputLevels::GOOD;
    board.round();
    board.arm();
}

#[test]
fn after_the_watchdog_the_shutter_is_closed_and_somebody_must_look() {
    let mut board = Board::connected(Start::Watchdog, 0);
    board.pc.ask(&Request::Load(camera_record()));
    assert_eq!(board.prepare(), Answer::Prepared);
    board.shutter.open(Time::from_us(500), 1.0);
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::Watchdog));
    assert!(!board.shutter.look(board.counter_us).is_high);
    // Prepared again, it is still so.
    assert_eq!(board.prepare(), Answer::Prepared);
    board.round();
    assert_eq!(board.status().state, State::Fault(Fault::Watchdog));
    board.command(Command::ClearFault);
    board.arm();
}

#[test]
fn tdi_camera_needs_an_output_that_clocks_its_rows() {
    let mut board = Board::connected(Start::PowerOn, 0);
    let mut camera = camera_record();
    camera.mechanism = fmc_camera::flight::camera::Mechanism::Tdi {
        first_transfer: 0.5,
    };
    let loaded = board.pc.ask(&Request::Load(camera));
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(board.prepare(), Answer::Refused(Refusal::NoRowClock));

    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    let mut clocking = FlownDeck::new(drive, Start::PowerOn).with_row_clock();
    assert_eq!(
        clocking.prepare(&camera, 0, &FlightSettings::default()),
        Ok(())
    );
}
