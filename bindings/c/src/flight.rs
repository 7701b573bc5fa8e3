//! The flight machine: events in, actions out.

use fmc::flight::controller::state::State;
use fmc::flight::controller::{MAX_ACTIONS, Start};
use fmc::flight::event::Action;
use fmc::flight::prepared_camera::PreparedCamera;

use crate::FMC_ERROR_NONE;
use crate::camera::{fmc_camera, stamp};
use crate::code::{codes, fmc_code};
use crate::error::{fmc_error, fmc_status};
use crate::event::{fmc_action, fmc_event};
use crate::flight_settings::fmc_flight_settings;
use crate::frame::fmc_frame;
use crate::frame_record::fmc_record;
use crate::memory::{self, Extent, Storage};
use crate::refusal::Failure;

/// Words of a flight.
pub const FMC_FLIGHT_WORDS: usize = 1536;

/// Most actions of one event.
pub const FMC_MAX_ACTIONS: usize = 6;

const _: () = assert!(FMC_MAX_ACTIONS == MAX_ACTIONS);

/// A flight: a camera with the state machine that flies it, in storage of the caller.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_flight {
    /// Words of the library alone.
    pub opaque: [u64; FMC_FLIGHT_WORDS],
}

impl Storage for fmc_flight {
    type Object = PreparedCamera;
    const LETTERS: [u8; 4] = *b"flgt";
}

/// The camera was switched on, or asked to start again.
pub const FMC_START_ORDERLY: fmc_code = 0;
/// The watchdog was not fed, or the processor failed.
pub const FMC_START_AFTER_WATCHDOG: fmc_code = 1;
/// As `FMC_START_ORDERLY`, but the encoder has lost its place.
pub const FMC_START_UNREFERENCED: fmc_code = 2;
/// A reset has ended the flight, and it goes on: as `FMC_START_AFTER_WATCHDOG`, but the fault ends by itself
/// once the stage stands, and triggers are obeyed without force on the stage.
pub const FMC_START_FLIES_ON: fmc_code = 3;

codes!(start, code_of_start, Start:
    FMC_START_ORDERLY = Start::Orderly,
    FMC_START_AFTER_WATCHDOG = Start::AfterWatchdog,
    FMC_START_UNREFERENCED = Start::Unreferenced,
    FMC_START_FLIES_ON = Start::FliesOn,
);

/// Triggers are refused; the stage is left alone.
pub const FMC_STATE_STANDBY: fmc_code = 0;
/// The stage waits at its starting place; a trigger will be obeyed.
pub const FMC_STATE_ARMED: fmc_code = 1;
/// Armed without compensation because of a fault.
pub const FMC_STATE_DEGRADED: fmc_code = 2;
/// The stage accelerates and settles.
pub const FMC_STATE_RUN_UP: fmc_code = 3;
/// The stage is at speed, the shutter is about to open.
pub const FMC_STATE_TRACKING: fmc_code = 4;
/// The shutter is open.
pub const FMC_STATE_EXPOSING: fmc_code = 5;
/// The stage stops and returns.
pub const FMC_STATE_FLY_BACK: fmc_code = 6;
/// A fault has occurred; the stage is released.
pub const FMC_STATE_FAULT: fmc_code = 7;

/// State of a flight.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct fmc_flight_status {
    /// `FMC_STATE_...`
    pub state: fmc_code,
    /// Code of the fault of `FMC_STATE_DEGRADED` and `FMC_STATE_FAULT`, or 0.
    pub fault: fmc_code,
    /// Triggers since the flight began.
    pub triggers: u32,
    /// Records that have not been acknowledged.
    pub records: u32,
    /// `FMC_START_...` of the flight that may follow: faults that have not been cleared are kept.
    pub next_start: fmc_code,
}

/// Prepares a camera for flight and puts the flight into storage, with a camera of its own, in
/// standby. After a refusal the storage is as before.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_init(
    flight: *mut fmc_flight,
    camera: *const fmc_camera,
    settings: *const fmc_flight_settings,
    how: fmc_code,
    error: *mut fmc_error,
) -> fmc_status {
    let initialised = || {
        memory::room(flight, 1)?;
        Extent::of(flight, 1, 1).apart_from(Extent::of(camera, 1, 2))?;
        // SAFETY: the caller's promise.
        let camera = unsafe { memory::object(camera, 2) }?;
        // SAFETY: the caller's promise.
        let settings = unsafe { memory::input(settings, 3) }?.settings()?;
        let how = start(how)?;
        let make = |place: &mut _| {
            PreparedCamera::new_in(place, camera, &settings, how)?;
            Ok(())
        };
        // SAFETY: the caller's promise; the camera is apart.
        unsafe { memory::put_in_place(flight, stamp(camera), make) }
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(initialised(), error) }
}

/// Takes an event, and writes the actions that follow from it, in order. `actions` has room for
/// `FMC_MAX_ACTIONS`, of which `count` are written; without that room the event is not taken.
///
/// Events come in order of their times. In each round of the control loop, of a millisecond, the
/// flight gets the events since the last round, then `FMC_EVENT_STAGE`, then `FMC_EVENT_TICK`.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `actions` to
/// `FMC_MAX_ACTIONS` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_step(
    flight: *mut fmc_flight,
    event: *const fmc_event,
    actions: *mut fmc_action,
    count: *mut usize,
    error: *mut fmc_error,
) -> fmc_status {
    let stepped = || {
        // SAFETY: the caller's promise; all fields are valid with all bits.
        let (time, event) = unsafe { memory::structure(event, 2) }?.event()?;
        let written = memory::output(count, 4)?;
        let extent = Extent::of(actions, FMC_MAX_ACTIONS, 3);
        extent.apart_from(Extent::of(flight, 1, 1))?;
        extent.apart_from(Extent::of(count, 1, 4))?;
        // SAFETY: the caller's promise.
        let places = unsafe { memory::elements_mut(actions, FMC_MAX_ACTIONS, 3) }?;
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object_mut(flight, 1) }?;
        let actions = flight.handle(time, event);
        for (place, action) in places.iter_mut().zip(&actions) {
            *place = action.into();
        }
        // SAFETY: the caller's promise.
        unsafe { written.write(actions.len()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(stepped(), error) }
}

/// Returns the state of a flight.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_state(
    flight: *const fmc_flight,
    status: *mut fmc_flight_status,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object(flight, 1) }?;
        let place = memory::output(status, 2)?;
        let controller = flight.controller();
        let (state, fault) = code_of_state(controller.state());
        let status = fmc_flight_status {
            state,
            fault,
            triggers: controller.counts().triggers,
            records: controller.kept(),
            next_start: code_of_start(controller.next_start()),
        };
        // SAFETY: the caller's promise.
        unsafe { place.write(status) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

/// Returns the oldest record with this number or a higher one; `FMC_ERROR_NONE` if there is none.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_record(
    flight: *const fmc_flight,
    from_sequence: u32,
    record: *mut fmc_record,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object(flight, 1) }?;
        let place = memory::output(record, 3)?;
        Extent::of(record, 1, 3).apart_from(Extent::of(flight, 1, 1))?;
        let found = flight.controller().record(from_sequence);
        let found = found.ok_or(Failure::of_argument(FMC_ERROR_NONE, 2))?;
        // SAFETY: the caller's promise.
        unsafe { place.write((&found).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

/// Forgets the records up to this number; their memory is free for others.
///
/// # Safety
/// Unless it is NULL or misaligned, `flight` is to an object of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_acknowledge(
    flight: *mut fmc_flight,
    through_sequence: u32,
    error: *mut fmc_error,
) -> fmc_status {
    let acknowledged = || {
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object_mut(flight, 1) }?;
        flight.controller_mut().acknowledge(through_sequence);
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(acknowledged(), error) }
}

/// Returns the number of the last recorded exposure, and its frame for the correction of its
/// points; `FMC_ERROR_NONE` if there is none. It is a frame of the camera that the flight began with.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_frame(
    flight: *const fmc_flight,
    sequence: *mut u32,
    frame: *mut fmc_frame,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object(flight, 1) }?;
        let number = memory::output(sequence, 2)?;
        memory::room(frame, 3)?;
        Extent::of(frame, 1, 3).apart_from(Extent::of(flight, 1, 1))?;
        let latest = flight.controller().latest();
        let (latest, kept) = latest.ok_or(Failure::of_argument(FMC_ERROR_NONE, 1))?;
        // SAFETY: the caller's promise.
        unsafe { number.write(*latest) };
        // SAFETY: the caller's promise.
        unsafe { memory::put(frame, stamp(flight.camera()), *kept) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

/// Returns the set point of a time as `FMC_ACTION_MOVE_STAGE`, or `FMC_ACTION_RELEASE_STAGE`: a drive
/// with a faster clock than the control loop asks for it.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_setpoint(
    flight: *const fmc_flight,
    time_us: u64,
    action: *mut fmc_action,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let flight = unsafe { memory::object(flight, 1) }?;
        let place = memory::output(action, 3)?;
        let time = fmc::flight::time::Time::from_us(time_us);
        let setpoint = flight.controller().setpoint(time);
        let action = setpoint.map_or(Action::ReleaseStage, Action::MoveStage);
        // SAFETY: the caller's promise.
        unsafe { place.write((&action).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

/// Returns the code of a state, and that of its fault.
fn code_of_state(state: State) -> (fmc_code, fmc_code) {
    match state {
        State::Standby => (FMC_STATE_STANDBY, 0),
        State::Armed => (FMC_STATE_ARMED, 0),
        State::Degraded(fault) => (FMC_STATE_DEGRADED, i32::from(fault.code())),
        State::RunUp => (FMC_STATE_RUN_UP, 0),
        State::Tracking => (FMC_STATE_TRACKING, 0),
        State::Exposing => (FMC_STATE_EXPOSING, 0),
        State::FlyBack => (FMC_STATE_FLY_BACK, 0),
        State::Fault(fault) => (FMC_STATE_FAULT, i32::from(fault.code())),
    }
}
