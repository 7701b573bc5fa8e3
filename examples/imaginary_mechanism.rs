//! A user's own mechanism: a voice coil whose amplifier follows a set point. Coil, shutter, V/H and
//! time are imaginary, the rest is as in firmware. `cargo run --example imaginary_mechanism`

use fmc_camera::flight::control_loop::{ControlLoop, Events};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::drive::{FmcDrive, StageReading};
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::{fault::Fault, frame_record::Outcome};
use fmc_camera::flight::{time::Time, vh::VhSample};
use fmc_camera::{CalibrationParameters, Camera, CameraParameters};
use std::{error::Error, fmt::Write};

/// Part of the way to its set point that the stage goes in a round: it lags by a millisecond.
const PART: f32 = 0.632;

#[derive(Debug, Default)]
struct VoiceCoil {
    offset_mm: f32,
    /// Set point of the amplifier; without force the stage stays in place.
    told_mm: Option<f32>,
}

impl FmcDrive for VoiceCoil {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.offset_mm += PART * (self.told_mm.unwrap_or(self.offset_mm) - self.offset_mm);
        // The scale has steps of 0.1 µm.
        let offset_mm = (self.offset_mm * 1e4).round() / 1e4;
        Ok(StageReading {
            time: now,
            offset_mm,
        })
    }

    fn follow(&mut self, _: Time, setpoint: Setpoint) -> Result<(), Fault> {
        // The set point leads by the lag, and by half of the millisecond until the next.
        self.told_mm = Some(setpoint.offset_mm + 1.5e-3 * setpoint.speed_mm_s);
        Ok(())
    }

    fn release(&mut self) {
        self.told_mm = None;
    }
}

/// Flies a second and a half with one trigger, and returns the events.
pub(crate) fn flight() -> Result<String, Box<dyn Error>> {
    let lens = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    let camera = Camera::new(CameraParameters::new(lens))?;
    let camera = PreparedCamera::new(camera, &FlightSettings::default(), Start::Orderly)?;
    let mut unit = ControlLoop::new(camera, VoiceCoil::default());
    let (mut edges, mut log) = (Vec::new(), String::new());
    for round in 1..=1500 {
        let now = Time::from_us(1000 * round);
        let before = unit.controller().state();
        // Events that interrupts have stamped since the last round, in order of time.
        let mut events: Events = edges.extract_if(.., |(time, _)| *time <= now).collect();
        let stamped = match round {
            1 => events.push((now, Event::Command(Command::Arm))),
            1000 => events.push((now.plus_s(-3e-4), Event::Trigger)),
            _ if round % 100 == 50 => events.push((now, Event::Vh(VhSample::Direct(0.1)))),
            _ => Ok(()),
        };
        stamped.map_err(|_| "more has happened than one round takes")?;
        for action in unit.round(now, &events) {
            match action {
                Action::OpenShutter { at, exposure_s } => {
                    // The blade comes 30 µs late and stays open 5 µs too long.
                    let opened = at.plus_s(unit.settings().shutter_latency_s + 30e-6);
                    let closed = opened.plus_s(exposure_s + 5e-6);
                    edges.push((opened, Event::Shutter(ShutterEdge::Opened)));
                    edges.push((closed, Event::Shutter(ShutterEdge::Closed)));
                }
                Action::CloseShutter => edges.clear(),
                other => writeln!(log, "{now}  {other:?}")?,
            }
        }
        if unit.controller().state() != before {
            writeln!(log, "{now}  {}", unit.controller().state())?;
        }
        while let Some(record) = unit.controller().record(0) {
            if let Outcome::Exposed(frame) = &record.outcome {
                let place_um = 1e3 * frame.interior.motion.centroid_mm;
                let sigma_um = 1e3 * frame.principal_point_sigma.total_mm();
                writeln!(log, "principal point {place_um:.2} µm, σ {sigma_um:.2} µm")?;
                writeln!(log, "at {}, smear {:.2} px", frame.centroid, frame.smear_px)?;
            }
            unit.controller_mut().acknowledge(record.sequence);
        }
    }
    Ok(log)
}

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", flight()?);
    Ok(())
}
