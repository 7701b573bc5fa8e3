//! Drive by step and direction, with limit switches.

use std::cell::RefCell;
use std::convert::Infallible;
use std::io;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::flown_drive::FlownDrive;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::step_dir::{Homing, StepDir, StepPins};
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

fn settings() -> StepSettings {
    StepSettings {
        steps_per_mm: 1000.0,
        setup_pulses: 2,
        homing_offset_mm: -2.0,
        homing_speed_mm_s: 5.0,
        homing_travel_mm: 5.0,
        ..StepSettings::default()
    }
}

fn at(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

fn open(times: usize) -> Vec<Transaction> {
    vec![Transaction::get(State::High); times]
}

fn step() -> [Transaction; 2] {
    [Transaction::set(State::High), Transaction::set(State::Low)]
}

fn broken() -> MockError {
    MockError::Io(io::ErrorKind::Other)
}

#[test]
fn two_steps_forth_and_one_back_are_exactly_this_traffic() {
    let mut pins = [
        Mock::new(&[step(), step(), step()].concat()),
        // A low level moves along the axis.
        Mock::new(&[Transaction::set(State::Low), Transaction::set(State::High)]),
        // The switch is read at each pulse at which a step is due, whether it is made or not.
        Mock::new(&open(3)),
        Mock::new(&open(5)),
    ];
    let [step, direction, low, high] = pins.clone();
    let mut drive = StepDir::new(
        settings(),
        StepPins {
            step,
            direction,
            low,
            high,
        },
    )
    .unwrap();
    drive.follow(Time::START, at(0.002)).unwrap();
    let mut positions = Vec::new();
    let mut pulse = |drive: &mut StepDir<Mock, Mock, Mock, Mock>| {
        drive.pulse();
        let um = 1e3 * drive.position(Time::START).unwrap().offset_mm;
        positions.push(um.round());
    };
    for _ in 0..6 {
        pulse(&mut drive);
    }
    drive.follow(Time::START, at(0.001)).unwrap();
    for _ in 0..5 {
        pulse(&mut drive);
    }
    // Two pulses set up the direction, then every other pulse is a step.
    let expected = [0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0];
    assert_eq!(positions, expected);
    for pin in &mut pins {
        pin.done();
    }
}

#[test]
fn pin_that_fails_is_a_drive_fault_once_and_the_next_set_point_is_followed() {
    let mut pins = [
        Mock::new(&[
            Transaction::set(State::High).with_error(broken()),
            Transaction::set(State::High),
        ]),
        Mock::new(&[Transaction::set(State::Low)]),
        Mock::new(&[]),
        Mock::new(&open(2)),
    ];
    let [step, direction, low, high] = pins.clone();
    let immediate = StepSettings {
        setup_pulses: 0,
        ..settings()
    };
    let mut drive = StepDir::new(
        immediate,
        StepPins {
            step,
            direction,
            low,
            high,
        },
    )
    .unwrap();
    drive.follow(Time::START, at(0.001)).unwrap();
    drive.pulse();
    // Without a target no step is tried again.
    drive.pulse();
    assert_eq!(drive.follow(Time::START, at(0.001)), Err(Fault::Drive));
    drive.pulse();
    drive.follow(Time::START, at(0.001)).unwrap();
    drive.pulse();
    assert!((drive.position(Time::START).unwrap().offset_mm - 0.001).abs() < 1e-7);
    for pin in &mut pins {
        pin.done();
    }
}

/// A stage with its switches, moved by the edges of its pins.
#[derive(Debug, Default)]
struct Bench {
    steps: i32,
    backwards: bool,
    step_is_high: bool,
}

#[derive(Debug, Clone)]
enum Pin {
    Step(Rc<RefCell<Bench>>),
    Direction(Rc<RefCell<Bench>>),
    /// Lower switch, closed (low) at and below a number of steps.
    Low(Rc<RefCell<Bench>>, i32),
    /// Upper switch, closed at and above a number of steps.
    High(Rc<RefCell<Bench>>, i32),
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

impl Pin {
    fn set(&self, level: bool) {
        match self {
            Self::Step(bench) => {
                let mut bench = bench.borrow_mut();
                if level && !bench.step_is_high {
                    bench.steps += if bench.backwards { -1 } else { 1 };
                }
                bench.step_is_high = level;
            }
            Self::Direction(bench) => bench.borrow_mut().backwards = level,
            Self::Low(..) | Self::High(..) => unreachable!("an input"),
        }
    }
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(match self {
            Self::Low(bench, end) => bench.borrow().steps > *end,
            Self::High(bench, end) => bench.borrow().steps < *end,
            Self::Step(_) | Self::Direction(_) => unreachable!("an output"),
        })
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

type BenchDrive = StepDir<Pin, Pin, Pin, Pin>;

fn bench(low_end: i32, high_end: i32) -> (Rc<RefCell<Bench>>, BenchDrive) {
    let bench = Rc::new(RefCell::new(Bench::default()));
    let pins = StepPins {
        step: Pin::Step(bench.clone()),
        direction: Pin::Direction(bench.clone()),
        low: Pin::Low(bench.clone(), low_end),
        high: Pin::High(bench.clone(), high_end),
    };
    (bench, StepDir::new(settings(), pins).unwrap())
}

fn pulses(drive: &mut BenchDrive, number: u32) {
    for _ in 0..number {
        drive.pulse();
    }
}

#[test]
fn ramp_and_cruise_are_followed_within_a_step_between_set_points() {
    let (bench, mut drive) = bench(-100_000, 100_000);
    let wanted_mm = |time_s: f32| {
        let ramp_s = time_s.min(0.015);
        500.0 * ramp_s * ramp_s + 15.0 * (time_s - ramp_s)
    };
    for tick in 0..60_u16 {
        let time_s = f32::from(tick) * 1e-3;
        let setpoint = Setpoint {
            offset_mm: wanted_mm(time_s),
            speed_mm_s: 1000.0 * time_s.min(0.015),
            acceleration_mm_s2: if time_s < 0.015 { 1000.0 } else { 0.0 },
        };
        drive.follow(Time::START, setpoint).unwrap();
        for pulse in 1..=40_u16 {
            drive.pulse();
            let off = wanted_mm(time_s + f32::from(pulse) / 40_000.0) * 1000.0
                - f32::from(i16::try_from(bench.borrow().steps).unwrap());
            // Half a step, and two pulses at 15 steps per ms.
            assert!(off.abs() <= 1.4, "{tick} {pulse}: {off} steps");
        }
    }
}

#[test]
fn set_points_that_fail_to_come_end_the_motion_after_five_ms() {
    let (bench, mut drive) = bench(-100_000, 100_000);
    let cruise = Setpoint {
        speed_mm_s: 10.0,
        ..Setpoint::default()
    };
    drive.follow(Time::START, cruise).unwrap();
    pulses(&mut drive, 4000);
    assert_eq!(bench.borrow().steps, 50);
    drive.release();
    drive.release();
    pulses(&mut drive, 100);
    assert_eq!(bench.borrow().steps, 50);
}

#[test]
fn limit_switch_stops_at_once_and_the_way_back_is_free() {
    let (bench, mut drive) = bench(-20, 20);
    for (end, sign) in [(20, 1.0), (-20, -1.0)] {
        drive.follow(Time::START, at(0.05 * sign)).unwrap();
        pulses(&mut drive, 400);
        assert_eq!(bench.borrow().steps, end);
        assert_eq!(
            drive.follow(Time::START, at(0.05 * sign)),
            Err(Fault::LimitSwitch)
        );
        // The switch is still closed, with the same result.
        drive.follow(Time::START, at(0.05 * sign)).unwrap();
        pulses(&mut drive, 40);
        assert_eq!(drive.follow(Time::START, at(0.0)), Err(Fault::LimitSwitch));
        drive.follow(Time::START, at(0.0)).unwrap();
        pulses(&mut drive, 400);
        assert_eq!(bench.borrow().steps, 0);
    }
}

#[test]
fn homing_finds_the_place_where_the_low_switch_opens_whichever_way_it_starts() {
    for low_end in [-300, 50] {
        let (bench, mut drive) = bench(low_end, 5000);
        assert_eq!(drive.homing(), Homing::None);
        drive.start_homing();
        assert_eq!(drive.follow(Time::START, at(0.0)), Err(Fault::Drive));
        // 5 steps per ms: 300 steps down and one up take 61 ms.
        pulses(&mut drive, 40 * 62);
        assert_eq!(drive.homing(), Homing::Done);
        assert_eq!(bench.borrow().steps, low_end + 1);
        assert!((drive.position(Time::START).unwrap().offset_mm + 2.0).abs() < 1e-6);
        drive.follow(Time::START, at(-1.9)).unwrap();
        pulses(&mut drive, 400);
        assert_eq!(bench.borrow().steps, low_end + 101);
    }
}

#[test]
fn homing_without_a_switch_ends_and_says_so() {
    let (bench, mut drive) = bench(-100_000, 100_000);
    drive.start_homing();
    pulses(&mut drive, 40 * 1100);
    assert_eq!(drive.homing(), Homing::Failed);
    assert_eq!(bench.borrow().steps, -5000);
    assert_eq!(drive.follow(Time::START, at(0.0)), Err(Fault::Drive));
    // Homing can be tried again, and released.
    drive.start_homing();
    pulses(&mut drive, 400);
    drive.release();
    let stopped = bench.borrow().steps;
    pulses(&mut drive, 400);
    assert_eq!(
        (drive.homing(), bench.borrow().steps),
        (Homing::Failed, stopped)
    );
}

#[test]
fn switch_that_bounces_between_two_looks_makes_no_step_and_does_not_end_homing() {
    let level = |high| Transaction::get(if high { State::High } else { State::Low });
    let mut pins = [
        Mock::new(&step()),
        // Against the axis to the switch, which was open at the first look of the pulse alone.
        Mock::new(&[Transaction::set(State::High)]),
        Mock::new(&[true, false, true, true, true].map(level)),
        Mock::new(&[]),
    ];
    let [step, direction, low, high] = pins.clone();
    let immediate = StepSettings {
        setup_pulses: 0,
        ..settings()
    };
    let pins_of_drive = StepPins {
        step,
        direction,
        low,
        high,
    };
    let mut drive = StepDir::new(immediate, pins_of_drive).unwrap();
    drive.start_homing();
    drive.pulse();
    assert_eq!((drive.homing(), drive.steps()), (Homing::Seeking, 0));
    drive.pulse();
    assert_eq!((drive.homing(), drive.steps()), (Homing::Seeking, -1));
    drive.pulse();
    assert_eq!((drive.homing(), drive.steps()), (Homing::Seeking, -1));
    assert!(drive.pins_mut().low.next().is_none(), "all have been read");
    for pin in &mut pins {
        pin.done();
    }
}

#[test]
fn step_rate_keeps_its_limit() {
    let bench = Rc::new(RefCell::new(Bench::default()));
    let slow = StepSettings {
        max_step_rate_hz: 10_000.0,
        ..settings()
    };
    let pins = StepPins {
        step: Pin::Step(bench.clone()),
        direction: Pin::Direction(bench.clone()),
        low: Pin::Low(bench.clone(), -100_000),
        high: Pin::High(bench.clone(), 100_000),
    };
    let mut drive = StepDir::new(slow, pins).unwrap();
    drive.follow(Time::START, at(5.0)).unwrap();
    pulses(&mut drive, 402);
    // 402 pulses less two of set-up; every fourth is a step.
    assert_eq!(bench.borrow().steps, 100);
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let fast = StepSettings {
        max_step_rate_hz: 30_000.0,
        ..settings()
    };
    let none = || Mock::new(&[]);
    let pins = StepPins {
        step: none(),
        direction: none(),
        low: none(),
        high: none(),
    };
    let mut used = [&pins.step, &pins.direction, &pins.low, &pins.high].map(Clone::clone);
    let refused = StepDir::new(fast, pins).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "max_step_rate_hz = 30000 is outside 1 to 20000"
    );
    for pin in &mut used {
        pin.done();
    }
}

#[test]
fn other_settings_keep_the_place_and_the_rate_of_the_timer() {
    let (bench, mut drive) = bench(-100_000, 100_000);
    drive.follow(Time::START, at(0.3)).unwrap();
    pulses(&mut drive, 400 * 40);
    let steps = bench.borrow().steps;
    assert_eq!(steps, 300);
    let finer = DriveSettings {
        kind: DriveKind::Stepper,
        stepper: StepSettings {
            steps_per_mm: 2000.0,
            ..settings()
        },
        ..DriveSettings::default()
    };
    drive.set_settings(finer).unwrap();
    let place_mm = drive.position(Time::START).unwrap().offset_mm;
    assert!((place_mm - 0.3).abs() < 1e-6, "{place_mm}");
    // It is released: nothing moves until the next set point.
    pulses(&mut drive, 400);
    assert_eq!(bench.borrow().steps, steps);
    let mut faster = finer;
    faster.stepper.pulse_rate_hz = 80_000.0;
    let refused = drive.set_settings(faster).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "pulse_rate_hz = 80000 is outside 40000 to 40000"
    );
    // Settings of a motor, as those of a trial, leave the steps as they are.
    drive.set_settings(DriveSettings::default()).unwrap();
    assert_eq!(drive.steps(), 600);
    assert!(drive.is_of(DriveKind::Stepper) && !drive.is_of(DriveKind::Motor));
    drive.set_reference();
    assert_eq!(drive.steps(), 0);
}
