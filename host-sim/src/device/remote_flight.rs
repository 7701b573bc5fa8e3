//! A camera at the other end of a link in a simulated flight, round by round beside its twin.

use std::time::{Duration, Instant};

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::digest;
use fmc_camera::io::link::message;
use fmc_camera::io::link::message::{Counters, FetchedRecord, Refusal};
use fmc_camera_file::GridFiles;
use fmc_simulation::mission::wire::WireTraffic;

use super::error::DifferentResult;
use super::link_error::LinkError;
use super::port::Port;
use super::remote::{Remote, same_bits};
use super::{CorrectingDevice, DeviceError, FlyingDevice};

/// Longest time for which bytes may be on their way to the camera.
const ARRIVED_WITHIN: Duration = Duration::from_secs(2);

impl<P: Port> Remote<P> {
    /// Returns the oldest record with at least that number, of a flight that this program or
    /// another has prepared.
    ///
    /// # Errors
    /// [`DeviceError::Link`], also for a record that does not have its CRC.
    pub fn fetch_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        let fetched = self
            .client
            .frame_record(from_sequence)
            .map_err(|error| self.failed(error, 0))?;
        let Some((record, crc)) = fetched else {
            return Ok(None);
        };
        if digest::of_frame_record(&record) == Some(crc) {
            self.fetched.insert(record.sequence, crc);
            Ok(Some(record))
        } else {
            Err(self.failed(LinkError::RecordCrc(record.sequence), 0))
        }
    }

    /// Runs one round of the control loop of the camera alone: without a twin, which does not know
    /// of a flight that the camera has taken up after a reset.
    ///
    /// # Errors
    /// [`DeviceError::Link`].
    pub fn step_by_itself(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        self.client.rig(step).map_err(|error| self.failed(error, 0))
    }

    /// Tells the camera that records up to that number are stored. Returns how many are left.
    ///
    /// The record of the last trigger that was refused for want of room changes with the next one:
    /// if it is not accepted, the records before are acknowledged first, and then it by its number.
    ///
    /// # Errors
    /// [`DeviceError::Link`], also for a record that was not fetched.
    pub fn acknowledge_records(&mut self, through: u32) -> Result<u32, DeviceError> {
        let last = FetchedRecord {
            sequence: through,
            crc: self.fetched.get(&through).copied().unwrap_or_default(),
        };
        let mut left = self.client.acknowledge(last);
        if let Err(LinkError::Refused {
            refusal: Refusal::NotFetched { .. },
            ..
        }) = left
        {
            for (&sequence, &crc) in self.fetched.range(..through).rev() {
                let earlier = FetchedRecord { sequence, crc };
                if self.client.acknowledge(earlier).is_ok() {
                    break;
                }
            }
            left = self.client.acknowledge(last);
        }
        let left = left.map_err(|error| self.failed(error, 0))?;
        self.fetched.retain(|&sequence, _| sequence > through);
        Ok(left)
    }

    /// Returns the kind of start of the camera's flight: the first flight after a watchdog reset
    /// begins with that fault.
    fn start_of_flight(&mut self) -> Result<Start, DeviceError> {
        let status = self
            .client
            .status()
            .map_err(|error| self.failed(error, 0))?;
        let has_failed = matches!(
            self.identity().reset_cause,
            message::ResetCause::Watchdog
                | message::ResetCause::Fault
                | message::ResetCause::StackOverflow
        );
        Ok(
            if has_failed && status.state == State::Fault(Fault::Watchdog) {
                Start::AfterWatchdog
            } else if status.is_place_lost {
                Start::Unreferenced
            } else {
                Start::Orderly
            },
        )
    }

    /// Sends the bytes and asks for the round until the camera has got them, which may be on their
    /// way for a moment: at most [`ARRIVED_WITHIN`].
    fn wired(&mut self, step: &RigStep, traffic: &WireTraffic) -> Result<RigAnswer, DeviceError> {
        let sent = match &mut self.wires {
            Some(wires) => wires.send(traffic).map_err(|error| error.kind()),
            None => return Err(DeviceError::NoWires),
        };
        let sent = sent.map_err(|error| self.failed(LinkError::Port(error), 0))?;
        let deadline = Instant::now() + ARRIVED_WITHIN;
        loop {
            match self.client.wired(step, sent) {
                Err(LinkError::Refused {
                    refusal: Refusal::OtherBytes(_),
                    ..
                }) if Instant::now() < deadline => {}
                answer => return answer.map_err(|error| self.failed(error, 0)),
            }
        }
    }

    /// Returns the counts of the camera's wires.
    pub(super) fn counters_of_wires(&mut self) -> Result<InstrumentCounters, DeviceError> {
        self.client
            .instruments()
            .map_err(|error| self.failed(error, 0))
    }

    fn other_round(&self, camera: &RigAnswer, twin: &RigAnswer) -> DeviceError {
        self.different(DifferentResult::Round {
            camera: format!("{camera:?}"),
            twin: format!("{twin:?}"),
        })
    }
}

impl<P: Port> FlyingDevice for Remote<P> {
    type Error = DeviceError;

    fn description(&self) -> String {
        CorrectingDevice::description(self)
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        CorrectingDevice::load_grids(self, grids)
    }

    fn prepare(
        &mut self,
        camera: &CameraParameters,
        settings: &FlightSettings,
    ) -> Result<(), DeviceError> {
        CorrectingDevice::load(self, camera)?;
        let prepared = self
            .client
            .prepare(settings)
            .map_err(|error| self.failed(error, 0));
        if let (Ok(()), Some(wires)) = (&prepared, &mut self.wires) {
            wires.restart();
        }
        let start = match &prepared {
            Ok(()) => self.start_of_flight()?,
            Err(_) => Start::Orderly,
        };
        match self.twin.prepare_after(start, camera, settings) {
            Ok(()) => prepared,
            // The twin's error says more than the refusal that the link carries.
            Err(error) if prepared.is_err() => Err(error),
            Err(error) => Err(self.different(DifferentResult::Refusal {
                camera: None,
                twin: Some(error.to_string()),
            })),
        }
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.twin.setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        let camera = self
            .client
            .rig(step)
            .map_err(|error| self.failed(error, 0))?;
        let twin = self.twin.step(step)?;
        if same_bits(&camera, &twin) {
            Ok(camera)
        } else {
            Err(self.other_round(&camera, &twin))
        }
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, DeviceError> {
        let camera = self.wired(step, traffic)?;
        let twin = self.twin.step_with_wires(step, traffic)?;
        if same_bits(&camera, &twin) {
            Ok(camera)
        } else {
            Err(self.other_round(&camera, &twin))
        }
    }

    fn link_counters(&mut self) -> Result<Option<Counters>, DeviceError> {
        CorrectingDevice::counters(self)
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, DeviceError> {
        let camera = self.counters_of_wires()?;
        let twin = FlyingDevice::instruments(&mut self.twin)?;
        if camera == twin {
            Ok(camera)
        } else {
            Err(self.different(DifferentResult::Round {
                camera: format!("{camera:?}"),
                twin: format!("{twin:?}"),
            }))
        }
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        let camera = self.fetch_record(from_sequence)?;
        // The twin counts neither starts of the camera nor flights before it connected.
        let twin = self.twin.frame_record(from_sequence)?.map(|twin| {
            let (boot, flight) = camera.map_or((0, 0), |it| (it.boot, it.flight));
            FrameRecord {
                boot,
                flight,
                ..twin
            }
        });
        if same_bits(&camera, &twin) {
            Ok(camera)
        } else {
            Err(self.different(DifferentResult::Round {
                camera: format!("{camera:?}"),
                twin: format!("{twin:?}"),
            }))
        }
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, DeviceError> {
        self.twin.acknowledge(through)?;
        self.acknowledge_records(through)
    }
}
