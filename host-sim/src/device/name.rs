//! Names of devices on the command line.

use std::fmt;
use std::str::FromStr;

use super::serial_line::SerialLine;

/// A machine of QEMU that the firmware runs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Machine {
    /// Cortex-M4F.
    An386,
    /// Cortex-M7.
    An500,
}

impl Machine {
    /// Name that QEMU uses.
    #[must_use]
    pub const fn qemu_name(self) -> &'static str {
        match self {
            Self::An386 => "mps2-an386",
            Self::An500 => "mps2-an500",
        }
    }

    /// Processor of the machine.
    #[must_use]
    pub const fn core(self) -> &'static str {
        match self {
            Self::An386 => "Cortex-M4F",
            Self::An500 => "Cortex-M7",
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::An386 => "an386",
            Self::An500 => "an500",
        })
    }
}

/// A device, as the command line names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceName {
    /// The camera's own code in this process.
    Sil,
    /// The firmware in QEMU.
    Qemu(Machine),
    /// A camera on a serial port.
    Serial(SerialLine),
    /// A camera whose link is forwarded over TCP: host and port.
    Tcp(String),
}

impl DeviceName {
    /// Machine of the plain name `qemu`: the smaller processor.
    pub const QEMU: Self = Self::Qemu(Machine::An386);
}

impl FromStr for DeviceName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(':') {
            None if text == "sil" => Ok(Self::Sil),
            None if text == "qemu" => Ok(Self::QEMU),
            Some(("qemu", "an386")) => Ok(Self::Qemu(Machine::An386)),
            Some(("qemu", "an500")) => Ok(Self::Qemu(Machine::An500)),
            Some(("serial", line)) => SerialLine::parse(line).map(Self::Serial),
            Some(("tcp", address)) if is_address(address) => Ok(Self::Tcp(address.to_owned())),
            _ => Err(
                "not a device; there is: sil, qemu, qemu:an386, qemu:an500, serial:PATH, serial:PATH:BAUD, tcp:HOST:PORT with a port of 1 to 65535"
                    .to_owned(),
            ),
        }
    }
}

/// Returns true for a host and a port that could be those of a camera.
fn is_address(text: &str) -> bool {
    text.rsplit_once(':').is_some_and(|(host, port)| {
        !host.is_empty() && port.parse::<u16>().is_ok_and(|port| port > 0)
    })
}

impl fmt::Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sil => f.write_str("sil"),
            Self::Qemu(machine) => write!(f, "qemu:{machine}"),
            Self::Serial(line) => write!(f, "serial:{line}"),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for name in [
            "sil",
            "qemu:an386",
            "qemu:an500",
            "serial:/dev/ttyACM0",
            "serial:COM3",
            "serial:COM3:115200",
            "tcp:camera.local:4000",
            "tcp:[::1]:65535",
        ] {
            assert_eq!(name.parse::<DeviceName>().unwrap().to_string(), name);
        }
        assert_eq!("qemu".parse(), Ok(DeviceName::QEMU));
    }

    #[test]
    fn other_names_are_refused_with_those_there_are() {
        for name in [
            "",
            "Sil",
            "qemu:",
            "qemu:an547",
            "serial",
            "tcp:1",
            "tcp::4000",
            "tcp:host:",
            "tcp:host:0",
            "tcp:host:65536",
            "tcp:host:http",
        ] {
            let error = name.parse::<DeviceName>().unwrap_err();
            assert!(error.contains("serial:PATH"), "{name}: {error}");
            assert!(error.contains("tcp:HOST:PORT"), "{name}: {error}");
        }
    }
}
