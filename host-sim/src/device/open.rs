//! The opening of the device that the command line names.

use std::path::PathBuf;

use super::error::DeviceError;
use super::link_error::LinkError;
use super::qemu::{Qemu, QemuOptions};
use super::remote::Session;
use super::{Device, DeviceName, FlownCamera, FlyingDevice, InProcess, LinkedCamera, serial, tcp};
use crate::failure::Failure;

/// Opener of devices.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Opener {
    /// Options of the firmware in QEMU.
    pub qemu: QemuOptions,
}

/// A reason why a device cannot be opened.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// This machine has no QEMU, or no image of the firmware.
    #[error("{reason}")]
    NotHere {
        /// Missing part.
        reason: String,
        /// Way to get it.
        help: String,
    },
    /// The image that the user named is not firmware.
    #[error("{}: {what}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// Fault of the file.
        what: String,
    },
    /// The file that the user named is not the flash of a camera in QEMU, or cannot be used.
    #[error("--flash {}: {what}", path.display())]
    Flash {
        /// The file.
        path: PathBuf,
        /// Fault of the file.
        what: String,
    },
    /// A serial port or an address, or the device on it, cannot be used.
    #[error("{}: {what}", path.display())]
    Port {
        /// The port, or host and port.
        path: PathBuf,
        /// Fault of the port or the device.
        what: String,
        /// Possible remedy.
        help: Option<&'static str>,
    },
    /// The camera does not answer as it should.
    #[error(transparent)]
    Device(#[from] DeviceError),
}

/// Remedy for a firmware of another protocol.
const OTHER_PROTOCOL: &str = "firmware and program must be built from the same sources: build the \
                              firmware with `cargo xtask firmware`, and flash it where the camera \
                              is on a serial port";

impl From<OpenError> for Failure {
    fn from(error: OpenError) -> Self {
        let text = error.to_string();
        match error {
            OpenError::NotHere { help, .. } => Self::device_or_io(text).with_help(help),
            OpenError::Image { .. } | OpenError::Flash { .. } => Self::bad_input(text),
            OpenError::Port { help, .. } => {
                let failure = Self::device_or_io(text);
                match help {
                    Some(help) => failure.with_help(help),
                    None => failure,
                }
            }
            OpenError::Device(error) => error.into(),
        }
    }
}

impl From<DeviceError> for Failure {
    /// Turns an error of the device into a failure; where the user's input is at fault the command
    /// knows more.
    fn from(error: DeviceError) -> Self {
        let text = error.to_string();
        match error {
            DeviceError::Calibration(_) | DeviceError::Frame(_) => Self::bad_input(text),
            DeviceError::Link {
                error: LinkError::OtherProtocol(_),
                ..
            } => Self::device_or_io(text).with_help(OTHER_PROTOCOL),
            _ => Self::device_or_io(text),
        }
    }
}

impl Opener {
    /// Opens a device.
    ///
    /// # Errors
    /// [`OpenError`] for a device that is missing, in use, or not a camera.
    pub fn open(&self, name: &DeviceName) -> Result<Box<dyn Device>, OpenError> {
        Ok(match name {
            DeviceName::Sil => Box::new(InProcess::default()),
            DeviceName::Qemu(machine) => Box::new(Qemu::start(*machine, &self.qemu)?),
            DeviceName::Serial(line) => Box::new(serial::connect(line, Session::Whole)?),
            DeviceName::Tcp(address) => Box::new(tcp::connect(address, Session::Whole)?),
        })
    }

    /// Opens a device for a simulated flight.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_flying(
        &self,
        name: &DeviceName,
    ) -> Result<Box<dyn FlyingDevice<Error = DeviceError>>, OpenError> {
        Ok(match name {
            DeviceName::Sil => Box::new(InProcess::default()),
            DeviceName::Qemu(machine) => Box::new(Qemu::start(*machine, &self.qemu)?),
            DeviceName::Serial(line) => Box::new(serial::connect(line, Session::Whole)?),
            DeviceName::Tcp(address) => Box::new(tcp::connect(address, Session::Whole)?),
        })
    }

    /// Opens a camera behind a link that may keep records and a calibration; `None` for the camera
    /// in this process, which keeps nothing. A session for reading lets another fly the camera.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_linked(
        &self,
        name: &DeviceName,
        session: Session,
    ) -> Result<Option<Box<dyn LinkedCamera>>, OpenError> {
        Ok(match name {
            DeviceName::Sil => None,
            DeviceName::Qemu(machine) => Some(Box::new(Qemu::start(*machine, &self.qemu)?)),
            DeviceName::Serial(line) => Some(Box::new(serial::connect(line, session)?)),
            DeviceName::Tcp(address) => Some(Box::new(tcp::connect(address, session)?)),
        })
    }

    /// Opens a camera on a board; `None` for a device without a mechanism.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_flown(
        &self,
        name: &DeviceName,
        session: Session,
    ) -> Result<Option<Box<dyn FlownCamera>>, OpenError> {
        Ok(match name {
            DeviceName::Sil | DeviceName::Qemu(_) => None,
            DeviceName::Serial(line) => Some(Box::new(serial::connect(line, session)?)),
            DeviceName::Tcp(address) => Some(Box::new(tcp::connect(address, session)?)),
        })
    }
}
