//! Sequences of events that once led to wrong behaviour, which the comments describe.

mod changed_camera;
mod closing_shutter;
mod degraded_modes;
mod principal_point;
mod record;
mod speed_at_opening;
mod stage_after_a_fault;

use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::{Action, AttitudeSample, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, FrameRecord, Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;

use crate::controller::bench::{Bench, camera, identified};

/// Runs a round of a given length, with a reading of a stage that is off its set point, or with
/// none.
fn round(bench: &mut Bench, round_s: f32, off_mm: Option<f32>) {
    bench.now = bench.now.plus_s(round_s);
    bench.send(Event::Vh(VhSample::Direct(0.1)));
    while let Some((time, edge)) = bench.edges.first().copied()
        && time <= bench.now
    {
        bench.edges.remove(0);
        bench.send_at(time, Event::Shutter(edge));
    }
    if let Some(off_mm) = off_mm {
        let reading = StageReading {
            time: bench.now,
            offset_mm: bench.place_mm() + off_mm,
        };
        bench.send(Event::Stage(reading));
    }
    bench.send(Event::Tick);
}

fn late_round(bench: &mut Bench) {
    bench.now = bench.now.plus_s(0.001);
    bench.round();
}

fn tdi() -> CameraParameters {
    CameraParameters {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        ..camera()
    }
}

fn exposing_for(exposure_s: f32) -> Bench {
    let mut bench = Bench::new(FlightSettings {
        exposure_s,
        ..FlightSettings::default()
    });
    bench.arm();
    bench.send(Event::Trigger);
    bench.run_until(200, |it| it == State::Exposing);
    bench
}

fn stalled() -> Bench {
    let mut bench = Bench::new(FlightSettings {
        exposure_s: 0.02,
        ..FlightSettings::default()
    });
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(8);
    bench.stage_follows = false;
    bench.run_until(200, |it| it == State::Degraded(Fault::Stall));
    bench
}

fn exposed(record: &FrameRecord) -> ExposedFrame {
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

fn closes(bench: &Bench) -> usize {
    let is_close = |it: &&(Time, Action)| it.1 == Action::CloseShutter;
    bench.actions.iter().filter(is_close).count()
}

fn is_unflagged(record: &FrameRecord) -> bool {
    record.flags == Flags::NONE
        && record.faults == Faults::NONE
        && exposed(record).principal_point_sigma.total_mm() < 1e-3
}
