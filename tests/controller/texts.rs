//! Texts of findings, trials and refusals of the camera, as people read them.

use std::collections::BTreeSet;
use std::fmt::Display;

use fmc_camera::flight::bring_up::{NotTried, TrialEnd};
use fmc_camera::flight::calibration_id::{SerialError, SerialNumber};
use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::controller::{ControllerError, NotExchanged};
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flown_deck::{NotFlyable, NotTaken};
use fmc_camera::flight::frame_record::Reason;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::flight::stage::{PlanError, StrokeTooShort};
use fmc_camera::flight::vh::{VhChannel, VhFinding, VhFindingKind, WrongUnit};
use fmc_camera::geometry::camera_grids::CameraGridsError;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::geometry::range::{OutOfRange, Quantity};

const TOO_HOT: OutOfRange = OutOfRange {
    quantity: Quantity::TemperatureC,
    value: 120.5,
    min: -100.0,
    max: 100.0,
};
const TOO_HOT_TEXT: &str = "temperature_c = 120.5 is outside -100 to 100";

const SHORT: StrokeTooShort = StrokeTooShort {
    from_mm: -0.6,
    to_mm: 0.25,
    half_stroke_mm: 0.5,
};
const SHORT_TEXT: &str = "the exposure moves the principal point from -0.6000 mm to 0.2500 mm, \
                          the stroke allows -0.5000 mm to 0.5000 mm";

const SPEED_TEXT: &str = "the exposure needs a speed of 25.5 mm/s, \
                          the stage allows -20 mm/s to 20 mm/s";
const TIME_TEXT: &str = "the travel takes 0.7500 s, there are 0.5000 s";

/// Checks whole texts, and that no two are the same.
pub(crate) fn assert_texts<T: Display>(texts: &[(T, &str)]) {
    for (value, text) in texts {
        assert_eq!(value.to_string(), *text);
    }
    let different: BTreeSet<&str> = texts.iter().map(|(_, text)| *text).collect();
    assert_eq!(different.len(), texts.len());
}

#[test]
fn trial_tells_how_it_has_ended_and_why_it_is_refused() {
    assert_texts(&[
        (TrialEnd::Done, "complete"),
        (TrialEnd::LimitSwitch, "ended: a limit switch has closed"),
        (TrialEnd::SupplyLow, "ended: the supply is low"),
        (TrialEnd::NotFollowing, "ended: the stage does not follow"),
        (TrialEnd::FarEnough, "ended: the stage has moved far enough"),
        (TrialEnd::Drive, "ended: the drive has failed"),
        (TrialEnd::Loaded, "ended: a camera was loaded or prepared"),
        (
            TrialEnd::Pause,
            "ended: rounds of the control loop failed to come",
        ),
    ]);
    assert_texts(&[
        (
            NotTried::Prepared,
            "it is prepared for flight: switch it off and on, \
             or load a calibration that ends the flight",
        ),
        (NotTried::UnderWay, "another trial is under way"),
        (
            NotTried::LimitSwitch,
            "a limit switch is closed, or its wire is broken",
        ),
        (NotTried::SupplyLow, "its supply is low"),
        (NotTried::NoReading, "its encoder gives no reading"),
        (
            NotTried::OutOfBounds {
                value: -12.5,
                min: -10.0,
                max: 10.0,
            },
            "-12.5 is outside -10 to 10",
        ),
    ]);
}

#[test]
fn serial_number_is_shown_as_a_text_and_its_error_names_the_byte() {
    let serial = SerialNumber::new("RC30-5282").unwrap();
    assert_eq!(serial.to_string(), "RC30-5282");
    assert_eq!(format!("{serial:?}"), "\"RC30-5282\"");
    assert_eq!(format!("{:?}", SerialNumber::EMPTY), "\"\"");
    assert_texts(&[
        (
            SerialError::TooLong { length: 17 },
            "has 17 characters; up to 16 are allowed",
        ),
        (
            SerialError::NotPrintable { index: 3 },
            "holds other than printable ASCII, ' ' to '~', at byte 3",
        ),
    ]);
}

#[test]
fn travel_that_cannot_be_made_names_its_numbers_and_those_of_the_stage() {
    assert_eq!(SHORT.to_string(), SHORT_TEXT);
    let (wanted_mm_s, max_mm_s) = (25.5, 20.0);
    let (needed_s, available_s) = (0.75, 0.5);
    let speed = PlanError::Speed {
        wanted_mm_s,
        max_mm_s,
    };
    let time = PlanError::Time {
        needed_s,
        available_s,
    };
    assert_texts(&[
        (PlanError::OutOfRange(TOO_HOT), TOO_HOT_TEXT),
        (PlanError::Stroke(SHORT), SHORT_TEXT),
        (speed, SPEED_TEXT),
        (time, TIME_TEXT),
    ]);
    let speed = FrameError::Speed {
        wanted_mm_s,
        max_mm_s,
    };
    let time = FrameError::Time {
        needed_s,
        available_s,
    };
    assert_texts(&[
        (FrameError::OutOfRange(TOO_HOT), TOO_HOT_TEXT),
        (FrameError::Stroke(SHORT), SHORT_TEXT),
        (
            FrameError::NotFitted,
            "the camera has no fitted five-coefficient model",
        ),
        (speed, SPEED_TEXT),
        (time, TIME_TEXT),
    ]);
}

#[test]
fn camera_that_cannot_be_flown_or_exchanged_says_why() {
    assert_texts(&[
        (NotFlyable::NoCamera, "no camera is loaded"),
        (
            NotFlyable::Controller(ControllerError::Settings(TOO_HOT)),
            TOO_HOT_TEXT,
        ),
        (
            NotFlyable::Controller(ControllerError::Travel(FrameError::Stroke(SHORT))),
            SHORT_TEXT,
        ),
        (
            NotFlyable::NoRowClock,
            "the board has no output that clocks the rows of a TDI sensor",
        ),
        (
            NotFlyable::OtherDrive(DriveKind::Stepper),
            "the settings are for a stepper, which the board does not have",
        ),
    ]);
    assert_texts(&[
        (
            NotExchanged::FrameInFlight,
            "the camera is armed or in flight",
        ),
        (
            NotExchanged::RecordsKept(3),
            "3 frame records of several calibrations have not been acknowledged",
        ),
        (
            NotExchanged::OtherMechanism,
            "the flight was prepared for another mechanism: a stage, or rows of a TDI sensor",
        ),
        (
            NotExchanged::NotFlyable(ControllerError::Settings(TOO_HOT)),
            TOO_HOT_TEXT,
        ),
    ]);
}

#[test]
fn event_that_is_not_taken_from_a_message_says_why() {
    assert_texts(&[
        (
            NotTaken::NotPrepared,
            "the camera has not been prepared for flight",
        ),
        (
            NotTaken::NotTold,
            "the camera takes such an event from its own inputs alone",
        ),
        (
            NotTaken::QueueFull,
            "too many events wait for the control loop",
        ),
        (NotTaken::OutOfRange(TOO_HOT), TOO_HOT_TEXT),
    ]);
}

#[test]
fn refused_trigger_has_a_short_name_that_of_a_fault_its_own() {
    assert_texts(&[
        (Reason::NotArmed, "not armed"),
        (Reason::Overlap, "overlap"),
        (Reason::OutsideLimits, "outside limits"),
        (Reason::Stroke, "stroke"),
        (Reason::Speed, "speed"),
        (Reason::NotAtSpeed, "not at speed"),
        (Reason::ShutterMissing, "shutter missing"),
        (Reason::Fault(Fault::BrownOut), "brown-out"),
        (Reason::Disarmed, "disarmed"),
        (Reason::RecordsFull, "records full"),
        (Reason::Unusable, "unusable"),
    ]);
}

#[test]
fn residual_grid_that_is_missing_or_unfit_is_named() {
    let given_as = GridCarrier::Sensor;
    assert_texts(&[
        (
            GridMemoryError::Missing {
                carrier: GridCarrier::Lens,
                crc32: 0x00c0_ffee,
            },
            "the residual grid of the lens with CRC-32 00c0ffee has not been loaded",
        ),
        (
            GridMemoryError::Unfit(CameraGridsError::Carrier { given_as }),
            "the residual grid is given as that of the sensor, and its file says lens",
        ),
    ]);
}

#[test]
fn finding_names_channel_value_and_kind_and_the_value_it_was_compared_with() {
    let finding = |channel, kind, expected| VhFinding {
        channel,
        kind,
        value: 61.5,
        expected,
    };
    let (speed, height) = (VhChannel::GroundSpeed, VhChannel::LaserHeight);
    let feet = VhFindingKind::WrongUnit(WrongUnit::Feet);
    let knots = VhFindingKind::WrongUnit(WrongUnit::Knots);
    assert_texts(&[
        (
            finding(VhChannel::Direct, VhFindingKind::Frozen, None),
            "V/H = 61.5: frozen",
        ),
        (
            finding(speed, VhFindingKind::OutOfRange, Some(50.0)),
            "ground speed = 61.5: out of range, compared with 50",
        ),
        (
            finding(speed, knots, Some(31.25)),
            "ground speed = 61.5: knots for metres per second, compared with 31.25",
        ),
        (
            finding(height, feet, Some(18.75)),
            "laser height = 61.5: feet for metres, compared with 18.75",
        ),
    ]);
    let text = |kind| finding(speed, kind, None).to_string();
    let texts: BTreeSet<String> = VhFindingKind::ALL.map(text).into_iter().collect();
    assert_eq!(texts.len(), VhFindingKind::ALL.len());
}
