//! `camera`: a camera on a board, prepared, armed and watched from the PC.

use std::thread::sleep;
use std::time::{Duration, Instant};

use fmc_camera::flight::bring_up::NotTried;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::vh::{VhSample, VhSettings};
use fmc_camera::io::link::message::{Refusal, Status};
use fmc_camera_file::GridFiles;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_camera_file::number::single;
use fmc_report::camera_status;

use super::{bring_up, camera_store};
use crate::cli::{
    CameraAction, CameraArgs, DirectionName, FocusShiftArgs, PrepareArgs, RecalibrateArgs,
    StatusArgs, TemperatureArgs, VhArgs,
};
use crate::device::DeviceError;
use crate::device::link_error::LinkError;
use crate::device::remote::Session;
use crate::failure::{Failure, note};
use crate::formats::output;

/// Longest time until the camera has obeyed a command.
const DONE_WITHIN: Duration = Duration::from_secs(5);

/// Longest time of the strokes at arming, for the slowest stage.
const STROKES_WITHIN: Duration = Duration::from_mins(1);

/// Time from one look at the camera's status to the next.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Time from one message of V/H to the next.
const VH_EVERY: Duration = Duration::from_millis(500);

pub(super) fn run(args: &CameraArgs) -> Result<(), Failure> {
    // Wrong input is reported before a port is opened.
    match &args.action {
        CameraAction::Prepare(prepare) => {
            let (camera, grids, settings) = read(prepare)?;
            let mut device = args.device.open_flown(Session::Whole)?;
            device
                .load_grids(&grids)
                .and_then(|()| device.prepare(&camera, &settings))
                .map_err(failed)?;
            say(&device.status().map_err(failed)?)
        }
        CameraAction::Arm => obey(args, Command::Arm, |status| {
            matches!(status.state, State::Armed | State::Degraded(_))
        }),
        CameraAction::Disarm => obey(args, Command::Disarm, |status| {
            matches!(status.state, State::Standby | State::Fault(_))
        }),
        CameraAction::ClearFault => obey(args, Command::ClearFault, |status| {
            status.state == State::Standby
        }),
        CameraAction::Referenced => obey(args, Command::Referenced, |status| {
            status.state == State::Standby && !status.is_place_lost
        }),
        CameraAction::Exposure(args_of) => {
            let exposure_s = single(args_of.exposure);
            let settings = FlightSettings {
                exposure_s,
                ..FlightSettings::default()
            };
            settings
                .checked()
                .map_err(|error| Failure::bad_input(error.to_string()))?;
            tell(args, Event::Command(Command::Exposure(exposure_s)))
        }
        CameraAction::FocusShift(FocusShiftArgs { shift_um }) => {
            let shift_um = single(*shift_um);
            tell(args, Event::Command(Command::FocusShift(shift_um)))
        }
        CameraAction::Temperature(TemperatureArgs { celsius }) => {
            let celsius = single(*celsius);
            tell(args, Event::Command(Command::Temperature(celsius)))
        }
        CameraAction::Recalibrate(of) => recalibrate(args, of),
        CameraAction::Vh(vh) => tell_vh(args, vh),
        CameraAction::Store(store) => camera_store::store(args, store),
        CameraAction::Stored(StatusArgs { json }) => camera_store::stored(args, *json),
        CameraAction::Inputs(StatusArgs { json }) => bring_up::inputs(args, *json),
        CameraAction::Jog(jog) => bring_up::jog(args, jog),
        CameraAction::Duty(duty) => bring_up::duty(args, duty),
        CameraAction::Shutter(shutter) => bring_up::shutter(args, shutter),
        CameraAction::Status(StatusArgs { json }) => {
            let mut device = args.device.open_flown(Session::Reading)?;
            let status = device.status().map_err(failed)?;
            let instruments = device.instruments().map_err(failed)?;
            output::write(None, |sink| {
                if *json {
                    camera_status::write_json(&status, instruments.as_ref(), sink)
                } else {
                    camera_status::write_text(&status, instruments.as_ref(), sink)
                }
            })
        }
    }
}

/// Reads calibration and settings, and checks on this PC that the camera can fly with them.
fn read(args: &PrepareArgs) -> Result<(CameraParameters, GridFiles, FlightSettings), Failure> {
    let (file, grids) = super::read_camera_with_grids(&args.camera)?;
    let mut settings = match &args.settings {
        Some(path) => FlightSettingsFile::read(path)?.settings,
        None => FlightSettings::default(),
    };
    match args.direction {
        Some(DirectionName::Forward) => settings.direction = FlightDirection::Forward,
        Some(DirectionName::Reverse) => settings.direction = FlightDirection::Reverse,
        None => {}
    }
    let camera = file.flown(&settings);
    let ([_, allowed], [_, flown]) = (file.limits.vh_per_s, camera.limits.vh_per_s);
    if flown < single(allowed) {
        note(format_args!(
            "note: {}: with exposures of {} s{} the mechanism can fly V/H up to {flown:.3} 1/s, less than the default limits, {allowed} 1/s",
            args.camera.display(),
            settings.exposure_s,
            match settings.trigger_interval_s {
                0.0 => String::new(),
                interval_s => format!(" every {interval_s} s"),
            }
        ));
    }
    let flown = Camera::new(camera)
        .map_err(|error| Failure::bad_input(format!("{}: {error}", args.camera.display())))?;
    PreparedCamera::new(flown, &settings, Start::Orderly)
        .map_err(|error| Failure::bad_input(format!("{}: {error}", args.camera.display())))?;
    Ok((camera, grids, settings))
}

/// Puts another calibration into use in the flight that is under way.
fn recalibrate(args: &CameraArgs, of: &RecalibrateArgs) -> Result<(), Failure> {
    let (camera, grids, _) = read(&PrepareArgs {
        camera: of.camera.clone(),
        settings: of.settings.clone(),
        direction: None,
    })?;
    let mut device = args.device.open_flown(Session::Whole)?;
    // Without a flight there is nothing that could go on.
    device.status().map_err(failed)?;
    device.load_grids(&grids).map_err(failed)?;
    device.recalibrate(&camera).map_err(failed)?;
    say(&device.status().map_err(failed)?)
}

fn tell(args: &CameraArgs, event: Event) -> Result<(), Failure> {
    let mut device = args.device.open_flown(Session::Whole)?;
    device.tell(event).map_err(failed)?;
    say(&device.status().map_err(failed)?)
}

/// Gives a command and waits until it is done.
fn obey(
    args: &CameraArgs,
    command: Command,
    is_done: impl Fn(&Status) -> bool,
) -> Result<(), Failure> {
    let mut device = args.device.open_flown(Session::Whole)?;
    device.tell(Event::Command(command)).map_err(failed)?;
    let start = Instant::now();
    let mut is_said = false;
    loop {
        sleep(LOOK_EVERY);
        let status = device.status().map_err(failed)?;
        if let (Command::Arm, State::Fault(fault)) = (command, status.state) {
            return Err(Failure::device_or_io(format!("the camera has not armed: {fault}"))
                .with_help("docs/integration.md, section 7, has cause and remedy; then `host-sim camera clear-fault`"));
        }
        if is_done(&status) {
            return say(&status);
        }
        let (elapsed, within) = (start.elapsed(), done_within(command, status.state));
        if elapsed > within {
            return Err(not_done(command, status.state));
        }
        if elapsed > DONE_WITHIN && !is_said {
            note(format_args!(
                "note: waiting for the stage, which makes its strokes to and fro, {} s at most",
                within.as_secs()
            ));
            is_said = true;
        }
    }
}

/// Returns how long a command may take while the camera is in a state.
fn done_within(command: Command, state: State) -> Duration {
    match (command, state) {
        (Command::Arm, State::FlyBack) => STROKES_WITHIN,
        _ => DONE_WITHIN,
    }
}

fn not_done(command: Command, state: State) -> Failure {
    let failure = Failure::device_or_io(format!(
        "{} s after the command the camera is still in state {state}",
        done_within(command, state).as_secs(),
    ));
    match command {
        Command::Arm if state == State::FlyBack => failure.with_help(
            "its strokes to and fro are as slow as acceleration_mm_s2, jerk_mm_s3 and max_speed_mm_s of the camera file say",
        ),
        Command::Referenced => failure.with_help(
            "a place is taken in standby alone: `host-sim camera disarm`, or `clear-fault` after a fault",
        ),
        Command::Arm if state == State::Standby => {
            failure.with_help("it does not arm while its supply is low")
        }
        Command::ClearFault => {
            failure.with_help("it stays while a frame is in flight, or is armed: `host-sim camera disarm`")
        }
        _ => failure,
    }
}

fn tell_vh(args: &CameraArgs, vh: &VhArgs) -> Result<(), Failure> {
    let vh_per_s = single(vh.vh.per_s());
    let [least, most] = VhSettings::DEFAULT.direct.range;
    if !(least..=most).contains(&vh_per_s) {
        return Err(Failure::bad_input(format!(
            "vh = {vh_per_s} is outside {least} to {most} 1/s"
        )));
    }
    let mut device = args.device.open_flown(Session::Whole)?;
    let end = Instant::now() + Duration::from_secs_f64(vh.for_s);
    loop {
        device
            .tell(Event::Vh(VhSample::Direct(vh_per_s)))
            .map_err(failed)?;
        if Instant::now() + VH_EVERY > end {
            return say(&device.status().map_err(failed)?);
        }
        sleep(VH_EVERY);
    }
}

/// Prints the state, on one line.
fn say(status: &Status) -> Result<(), Failure> {
    output::write(None, |sink| writeln!(sink, "{}", status.state))
}

/// Turns an error into a failure, with advice.
pub(super) fn failed(error: DeviceError) -> Failure {
    let help = match &error {
        DeviceError::NotPrepared => {
            "give it calibration and settings first: `host-sim camera prepare --camera FILE`"
        }
        DeviceError::Link {
            error: LinkError::Refused { refusal, .. },
            ..
        } => match refusal {
            Refusal::NotTried(NotTried::Prepared) => {
                "a flight goes on over a reset, also by the button: trials are for a board that was \
                 switched off and on, or to which a calibration was loaded for another flight, as \
                 `host-sim frame` does"
            }
            Refusal::NotTried(NotTried::LimitSwitch) => {
                "`host-sim camera inputs` shows the lines; a switch opens its line at the end of the way"
            }
            Refusal::OnRig => "fly it with `host-sim mission`, which simulates what is around it",
            Refusal::FrameInFlight => "`host-sim camera disarm` comes first",
            Refusal::OtherMechanism => {
                "prepare it for a flight of its own: `host-sim camera prepare --camera FILE`"
            }
            Refusal::NoRowClock => {
                "its firmware can fly cameras whose stage moves the detector, mechanism = \"stage\""
            }
            _ => return error.into(),
        },
        _ => return error.into(),
    };
    Failure::from(error).with_help(help)
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::fault::Fault;

    use super::*;

    #[test]
    fn strokes_at_arming_are_waited_for_longer_than_anything_else() {
        let states = [
            State::Standby,
            State::Armed,
            State::Degraded(Fault::VhLost),
            State::FlyBack,
        ];
        for state in states {
            let is_stroke = state == State::FlyBack;
            let expected_s = if is_stroke { 60 } else { 5 };
            assert_eq!(done_within(Command::Arm, state).as_secs(), expected_s);
            assert_eq!(done_within(Command::Disarm, state).as_secs(), 5);
        }
        let failure = format!("{:?}", not_done(Command::Arm, State::FlyBack));
        assert!(
            failure.contains("60 s after") && failure.contains("fly-back"),
            "{failure}"
        );
        let failure = format!("{:?}", not_done(Command::Arm, State::Standby));
        assert!(failure.contains("5 s after"), "{failure}");
    }
}
