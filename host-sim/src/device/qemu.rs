//! The firmware in QEMU.

use std::io;
use std::net::TcpStream;
use std::path::PathBuf;
use std::thread::JoinHandle;

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_camera::io::link::message::{Counters, Ending, Grid};
use fmc_camera::io::store::{NothingStored, StoreOrder, StoredIdentity};
use fmc_camera_file::GridFiles;
use fmc_simulation::mission::wire::WireTraffic;

use super::block_port::BlockPort;
use super::image::Image;
use super::link_error::LinkError;
use super::log::{self, LastLines};
use super::machine::{self, PROGRAM, Process};
use super::name::Machine;
use super::open::OpenError;
use super::port::TcpPort;
use super::remote::{Remote, Session};
use super::shared_memory::SharedMemory;
use super::{CorrectingDevice, Device, DeviceError, Evidence, FlyingDevice, KeepingCamera};

/// Options of the firmware in QEMU.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct QemuOptions {
    /// Image; without it one is found or built.
    pub firmware: Option<PathBuf>,
    /// File that keeps the firmware's flash; without it the flash is blank, and of one run.
    pub flash: Option<PathBuf>,
    /// `true` if the log is printed on the error stream as it comes.
    pub print_log: bool,
}

/// The firmware in QEMU: started, asked over its first UART, and ended when this value is dropped.
#[derive(Debug)]
pub struct Qemu {
    /// Dropped first: the process ends before the lock of its flash is freed, which is in `remote`.
    watch: Watch,
    remote: Remote<BlockPort>,
    machine: Machine,
}

/// The process and its log.
#[derive(Debug)]
struct Watch {
    process: Process,
    log_wire: TcpStream,
    log: LastLines,
    log_thread: Option<JoinHandle<()>>,
}

impl Qemu {
    /// Starts a machine and connects to the firmware in it.
    ///
    /// # Errors
    /// [`OpenError`] where there is no QEMU or no image, or the firmware does not answer.
    pub fn start(machine: Machine, options: &QemuOptions) -> Result<Self, OpenError> {
        let (mut watch, link, wires, memory) = run(machine, options)?;
        let [receiver, autopilot] = wires.map(TcpPort::new);
        let receiver = receiver.map_err(|error| connection(&error))?;
        let autopilot = autopilot.map_err(|error| connection(&error))?;
        let ports = BlockPort::all(link, [receiver, autopilot], memory);
        let [link, receiver, autopilot] = ports;
        let name = format!("qemu:{machine}");
        let remote =
            Remote::connect(&name, link, Session::Whole).map_err(|error| watch.explain(error))?;
        let remote = remote.with_wires(receiver, autopilot);
        Ok(Self {
            watch,
            remote,
            machine,
        })
    }

    /// Returns the camera itself, for functions that not every device has.
    pub const fn remote(&mut self) -> &mut Remote<BlockPort> {
        &mut self.remote
    }

    /// The operating system's number of the emulator.
    #[must_use]
    pub fn process_id(&self) -> u32 {
        self.watch.process.id()
    }

    /// Returns the far end of the log's UART. Bytes written there reach the firmware; firmware
    /// built with drills has accidents on request.
    pub const fn log_wire(&mut self) -> &mut TcpStream {
        &mut self.watch.log_wire
    }

    /// The last lines of the log.
    #[must_use]
    pub fn log(&self) -> Vec<String> {
        self.watch.log.all()
    }
}

/// Starts a machine with the firmware. Returns it with its link, the wires of receiver and
/// autopilot, and the memory that it shares.
fn run(
    machine: Machine,
    options: &QemuOptions,
) -> Result<(Watch, TcpPort, [TcpStream; 2], Option<SharedMemory>), OpenError> {
    let program = machine::find().ok_or_else(|| OpenError::NotHere {
        reason: format!("{PROGRAM} is not on the search path (PATH)"),
        help: "cargo xtask verify, which fetches it on Debian and Ubuntu; elsewhere install QEMU 7.2 or later, \
               or use --device sil"
            .to_owned(),
    })?;
    let image = Image::find(options.firmware.as_deref())?;
    let kept = options
        .flash
        .as_deref()
        .map(SharedMemory::kept)
        .transpose()?;
    let started =
        machine::start(&program, machine, &image.path, kept).map_err(DeviceError::Machine)?;
    let log_wire = started
        .log
        .try_clone()
        .map_err(|error| connection(&error))?;
    let (log, log_thread) = log::follow(started.log, &image.elf, options.print_log);
    let watch = Watch {
        process: started.process,
        log_wire,
        log,
        log_thread: Some(log_thread),
    };
    let link = TcpPort::new(started.link).map_err(|error| connection(&error))?;
    Ok((watch, link, started.wires, started.memory))
}

/// The firmware in QEMU with its link as it is, for others to talk to; ended when this value is
/// dropped.
#[derive(Debug)]
pub struct LinkOfQemu {
    name: String,
    link: TcpPort,
    watch: Watch,
    /// Open, and silent.
    _wires: [TcpStream; 2],
    /// Its flash, whose file is locked until the machine has ended.
    _memory: Option<SharedMemory>,
}

impl LinkOfQemu {
    /// Starts a machine.
    ///
    /// # Errors
    /// [`OpenError`] where there is no QEMU or no image.
    pub fn start(machine: Machine, options: &QemuOptions) -> Result<Self, OpenError> {
        let (watch, link, wires, memory) = run(machine, options)?;
        Ok(Self {
            name: format!("qemu:{machine}"),
            link,
            watch,
            _wires: wires,
            _memory: memory,
        })
    }

    /// The link.
    pub const fn link(&mut self) -> &mut TcpPort {
        &mut self.link
    }

    /// Says why the link has failed, with the end of the log.
    #[must_use]
    pub fn explain(&mut self, error: &io::Error) -> DeviceError {
        self.watch.explain(DeviceError::Link {
            device: self.name.clone(),
            error: LinkError::from(io::Error::from(error.kind())),
        })
    }
}

fn connection(error: &io::Error) -> DeviceError {
    DeviceError::Machine(format!("QEMU's connection fails: {error}"))
}

impl Watch {
    /// Adds the end of the process and of its log to an error of its link.
    fn explain(&mut self, error: DeviceError) -> DeviceError {
        let DeviceError::Link {
            device,
            error: link,
        } = &error
        else {
            return error;
        };
        if !matches!(
            link,
            LinkError::Closed
                | LinkError::Port(_)
                | LinkError::NoAnswer { .. }
                | LinkError::SessionEnded
        ) {
            return error;
        }
        let end = match self.process.end() {
            Some(end) => {
                // The process has ended, so its wire ends: wait for the last lines.
                if let Some(thread) = self.log_thread.take() {
                    let _ = thread.join();
                }
                format!("{device}: {end}")
            }
            None => error.to_string(),
        };
        let log = machine::indented("the end of the firmware's log", &self.log.all());
        DeviceError::Machine(end + &log)
    }
}

impl CorrectingDevice for Qemu {
    type Error = DeviceError;

    fn description(&self) -> String {
        let machine = self.machine;
        format!(
            "qemu:{machine} ({} in QEMU, {})",
            machine.core(),
            self.remote.firmware()
        )
    }

    fn load(&mut self, camera: &CameraParameters) -> Result<(), DeviceError> {
        let answer = self.remote.load(camera);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        CorrectingDevice::load_grids(&mut self.remote, grids)
    }

    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, DeviceError> {
        let answer = self.remote.expose(exposure);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        let answer = self.remote.correct(measured);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn correct_grid(&mut self, grid: &Grid) -> Result<Vec<Corrected>, DeviceError> {
        let answer = self.remote.correct_grid(grid);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn evidence(&self) -> Evidence {
        self.remote.evidence()
    }

    fn counters(&mut self) -> Result<Option<Counters>, DeviceError> {
        let answer = self.remote.counters();
        answer.map_err(|error| self.watch.explain(error))
    }
}

impl Device for Qemu {
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        let answer = self.remote.distort(ideal);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError> {
        let answer = self.remote.mesh(row, format);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError> {
        let answer = self.remote.corrections(row);
        answer.map_err(|error| self.watch.explain(error))
    }
}

impl Qemu {
    /// Returns the camera at the end of the serial port.
    pub(super) const fn remote_mut(&mut self) -> &mut Remote<BlockPort> {
        &mut self.remote
    }
}

impl KeepingCamera for Qemu {
    fn put_into_use(
        &mut self,
        camera: &CameraParameters,
        grids: &GridFiles,
    ) -> Result<(), DeviceError> {
        let answer = self.remote.put_into_use(camera, grids);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn store(&mut self, order: &StoreOrder) -> Result<StoredIdentity, DeviceError> {
        let answer = self.remote.store(order);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn stored(&mut self) -> Result<Result<StoredIdentity, NothingStored>, DeviceError> {
        let answer = self.remote.stored();
        answer.map_err(|error| self.watch.explain(error))
    }
}

impl FlyingDevice for Qemu {
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
        let answer = self.remote.prepare(camera, settings);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.remote.setpoint(now)
    }

    fn step(&mut self, step: &RigStep) -> Result<RigAnswer, DeviceError> {
        let answer = self.remote.step(step);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn step_with_wires(
        &mut self,
        step: &RigStep,
        traffic: &WireTraffic,
    ) -> Result<RigAnswer, DeviceError> {
        let answer = self.remote.step_with_wires(step, traffic);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn link_counters(&mut self) -> Result<Option<Counters>, DeviceError> {
        CorrectingDevice::counters(self)
    }

    fn instruments(&mut self) -> Result<InstrumentCounters, DeviceError> {
        let answer = FlyingDevice::instruments(&mut self.remote);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn frame_record(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        let answer = FlyingDevice::frame_record(&mut self.remote, from_sequence);
        answer.map_err(|error| self.watch.explain(error))
    }

    fn acknowledge(&mut self, through: u32) -> Result<u32, DeviceError> {
        let answer = self.remote.acknowledge(through);
        answer.map_err(|error| self.watch.explain(error))
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // The emulator and its records end with this program.
        if self.remote.power_off(Ending::Forced).is_ok() {
            self.watch.process.wait_or_kill();
        }
    }
}
