//! `camera inputs`, `jog`, `duty` and `shutter`: a board before a camera is loaded.

use std::thread::sleep;
use std::time::{Duration, Instant};

use fmc_camera::flight::bring_up::{MAX_TRIAL_S, SHUTTER_LEAD_S, TEST_EXPOSURE_S, Trial, TrialEnd};
use fmc_camera::io::link::message::Inputs;
use fmc_camera_file::number::single;
use fmc_report::board_inputs;

use super::camera::failed;
use crate::cli::{CameraArgs, DutyArgs, JogArgs, ShutterArgs};
use crate::device::remote::Session;
use crate::failure::Failure;
use crate::formats::output;

/// Time from one look at a trial to the next.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Longest time of the shutter from its command to its edge, s.
const SHUTTER_WITHIN_S: f32 = 0.2;

/// Longest wait for the end of a trial: models of boards are slower than a board.
const OVER_WITHIN: Duration = Duration::from_secs(20);

pub(super) fn inputs(args: &CameraArgs, json: bool) -> Result<(), Failure> {
    let mut device = args.device.open_flown(Session::Reading)?;
    let inputs = device.inputs().map_err(failed)?;
    output::write(None, |sink| {
        if json {
            board_inputs::write_json(&inputs, sink)
        } else {
            board_inputs::write_text(&inputs, sink)
        }
    })
}

pub(super) fn jog(args: &CameraArgs, jog: &JogArgs) -> Result<(), Failure> {
    let way_um = single(jog.way_um);
    try_out(args, Trial::Jog { way_um })
}

pub(super) fn duty(args: &CameraArgs, duty: &DutyArgs) -> Result<(), Failure> {
    let trial = Trial::Duty {
        duty: single(duty.duty),
        time_s: single(duty.for_s),
    };
    try_out(args, trial)
}

pub(super) fn shutter(args: &CameraArgs, shutter: &ShutterArgs) -> Result<(), Failure> {
    let exposure_s = single(shutter.exposure);
    let [least, most] = TEST_EXPOSURE_S;
    if !(least..=most).contains(&exposure_s) {
        return Err(Failure::bad_input(format!(
            "exposure of {exposure_s} s is outside {least} to {most} s"
        )));
    }
    try_out(args, Trial::Shutter { exposure_s })
}

/// Makes a trial, waits for its end, and says what has come of it. Fails where it did not get to
/// its end.
fn try_out(args: &CameraArgs, trial: Trial) -> Result<(), Failure> {
    let mut device = args.device.open_flown(Session::Whole)?;
    let before = device.inputs().map_err(failed)?;
    device.try_out(trial).map_err(failed)?;
    let start = Instant::now();
    if let Trial::Shutter { exposure_s } = trial {
        // The last edge comes after the trial.
        let after_s = SHUTTER_LEAD_S + exposure_s + SHUTTER_WITHIN_S;
        sleep(Duration::from_secs_f32(after_s));
    }
    loop {
        sleep(LOOK_EVERY);
        let after = device.inputs().map_err(failed)?;
        if let Some(end) = after.trial.and_then(|trial| trial.end) {
            output::write(None, |sink| {
                board_inputs::write_trial(&before, &after, sink)
            })?;
            return judge(trial, end, &before, &after);
        }
        if start.elapsed() > OVER_WITHIN {
            return Err(Failure::device_or_io(format!(
                "the trial has not ended within {} s; no force lasts longer than {MAX_TRIAL_S} s and a round of the control loop",
                OVER_WITHIN.as_secs()
            )));
        }
    }
}

fn judge(trial: Trial, end: TrialEnd, before: &Inputs, after: &Inputs) -> Result<(), Failure> {
    match (trial, end) {
        (Trial::Shutter { .. }, TrialEnd::Done) => {
            let new = |of: fn(&Inputs) -> u32| of(after).wrapping_sub(of(before));
            let edges = [
                new(|inputs| inputs.edges.shutter_opened),
                new(|inputs| inputs.edges.shutter_closed),
            ];
            if edges == [1, 1] {
                return Ok(());
            }
            let [opened, closed] = edges;
            Err(Failure::check(format!(
                "the shutter's sensor has given {opened} edges \"opened\" and {closed} \"closed\" in place of one each"
            ))
            .with_help("is the shutter connected? docs/board.md has its lines, and edges that fall are a setting"))
        }
        (Trial::Duty { .. }, TrialEnd::FarEnough) | (_, TrialEnd::Done) => Ok(()),
        (Trial::Duty { .. }, TrialEnd::NotFollowing) => {
            Err(Failure::check(format!("the trial has {end}")).with_help(
                "its encoder stood still: the stage is stuck, or friction is stronger than this duty, or motor or encoder is not connected; `host-sim camera inputs` shows the lines of the encoder",
            ))
        }
        (_, TrialEnd::NotFollowing) => Err(Failure::check(format!("the trial has {end}")).with_help(
            "try a small duty: positive duty must move the encoder along the FMC axis; else motor or encoder is reversed, or the stage is stuck, or the encoder is silent",
        )),
        _ => Err(Failure::check(format!("the trial has {end}"))),
    }
}
