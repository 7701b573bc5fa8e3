//! The link of a camera as it is, for another program to talk to.

use std::collections::VecDeque;
use std::io;
use std::thread::sleep;
use std::time::Instant;

use fmc_camera::flight::grid_memory::GridMemory;
use fmc_camera::io::link::link_event::LinkEvent;
use fmc_camera::io::link::message::{Identity, ResetCause};
use fmc_camera::io::link::station::Station;

use super::error::DeviceError;
use super::link_error::LinkError;
use super::open::OpenError;
use super::port::{Port, time_left};
use super::qemu::{LinkOfQemu, QemuOptions};
use super::serial::SerialPort;
use super::{DeviceName, tcp};

/// A camera whose link is served.
#[derive(Debug)]
pub struct ServedCamera {
    name: String,
    link: Link,
}

#[derive(Debug)]
enum Link {
    Here(Box<StationPort>),
    Qemu(Box<LinkOfQemu>),
    Serial(SerialPort),
    Tcp(super::port::TcpPort),
}

impl ServedCamera {
    /// Opens a device without asking it anything.
    ///
    /// # Errors
    /// [`OpenError`] where it is missing or in use.
    pub fn open(name: &DeviceName, qemu: &QemuOptions) -> Result<Self, OpenError> {
        let link = match name {
            DeviceName::Sil => Link::Here(Box::default()),
            DeviceName::Qemu(machine) => Link::Qemu(Box::new(LinkOfQemu::start(*machine, qemu)?)),
            DeviceName::Serial(line) => Link::Serial(SerialPort::open(line)?),
            DeviceName::Tcp(address) => Link::Tcp(tcp::open(address)?),
        };
        Ok(Self {
            name: name.to_string(),
            link,
        })
    }

    /// The link.
    pub fn port(&mut self) -> &mut dyn Port {
        match &mut self.link {
            Link::Here(station) => station.as_mut(),
            Link::Qemu(machine) => machine.link(),
            Link::Serial(port) => port,
            Link::Tcp(port) => port,
        }
    }

    /// Says why the link has failed.
    pub fn explain(&mut self, error: &io::Error) -> DeviceError {
        match &mut self.link {
            Link::Qemu(machine) => machine.explain(error),
            _ => DeviceError::Link {
                device: self.name.clone(),
                error: LinkError::from(io::Error::from(error.kind())),
            },
        }
    }
}

/// The camera's own end of the link in this process, its camera on a test rig.
#[derive(Debug)]
struct StationPort {
    station: Station,
    /// Bytes that it has sent.
    sent: VecDeque<u8>,
}

impl Default for StationPort {
    fn default() -> Self {
        Self {
            station: station(ResetCause::PowerOn),
            sent: VecDeque::new(),
        }
    }
}

fn station(cause: ResetCause) -> Station {
    let identity = Identity::new("of host-sim", "sil", false, cause);
    let mut station = Station::new(identity, || 0);
    // For as long as the program runs, as on a board.
    station.keep_grids_in(Box::leak(Box::new(GridMemory::EMPTY)));
    station
}

impl Port for StationPort {
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        if self.sent.is_empty() {
            sleep(time_left(deadline));
        }
        io::Read::read(&mut self.sent, buffer)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        for byte in bytes {
            let event = self.station.receive(*byte);
            let answer = self.station.to_send();
            self.sent.extend(answer);
            let count = answer.len();
            self.station.sent(count);
            if event == Some(LinkEvent::Reset) {
                self.station = station(ResetCause::Requested);
            }
        }
        Ok(())
    }
}
