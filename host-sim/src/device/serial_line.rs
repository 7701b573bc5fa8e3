//! A serial port and its speed, as the command line names them.

use std::fmt;
use std::path::PathBuf;

/// Bits per second without another setting: 8 data bits, no parity, one stop bit, no flow control.
pub const BAUD: u32 = 921_600;

/// Speeds allowed: at the lowest one the longest request and its answer take 0.4 s, less than
/// [`ANSWER_WITHIN`](super::client::ANSWER_WITHIN).
pub const BAUDS: [u32; 2] = [57_600, 3_000_000];

/// A serial port, and the speed of the camera's link on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SerialLine {
    /// The port.
    pub path: PathBuf,
    /// Bits per second.
    pub baud: u32,
}

impl SerialLine {
    /// Reads `PATH` or `PATH:BAUD`. Names of ports may have colons themselves: what follows the
    /// last one is a speed if it is a whole number of four digits or more.
    ///
    /// # Errors
    /// The reason, in words: no path, or a speed that is not allowed.
    pub fn parse(text: &str) -> Result<Self, String> {
        let is_speed =
            |speed: &str| speed.len() >= 4 && speed.bytes().all(|it| it.is_ascii_digit());
        let (path, baud) = match text.rsplit_once(':') {
            Some((path, speed)) if is_speed(speed) => {
                let [least, most] = BAUDS;
                let baud = speed.parse().ok();
                let baud = baud.filter(|baud| (least..=most).contains(baud));
                let baud = baud.ok_or_else(|| {
                    format!("{speed} baud is outside {least} to {most}; serial:PATH:BAUD, {BAUD} without BAUD")
                })?;
                (path, baud)
            }
            _ => (text, BAUD),
        };
        if path.is_empty() {
            return Err("no port is named: serial:PATH or serial:PATH:BAUD".to_owned());
        }
        Ok(Self {
            path: path.into(),
            baud,
        })
    }
}

impl fmt::Display for SerialLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        match self.baud {
            BAUD => Ok(()),
            baud => write!(f, ":{baud}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use fmc_camera::io::link::LONGEST_PACKET;

    use super::*;
    use crate::device::client::ANSWER_WITHIN;

    #[test]
    fn colons_of_a_name_are_told_from_that_of_a_speed() {
        for (text, path, baud) in [
            ("/dev/ttyACM0", "/dev/ttyACM0", BAUD),
            ("/dev/ttyACM0:115200", "/dev/ttyACM0", 115_200),
            ("COM3:3000000", "COM3", 3_000_000),
            (
                "/dev/by-path/pci-0:14.0-usb-0:1",
                "/dev/by-path/pci-0:14.0-usb-0:1",
                BAUD,
            ),
            (
                "/dev/by-path/usb-0:1:1.0-port0:57600",
                "/dev/by-path/usb-0:1:1.0-port0",
                57_600,
            ),
        ] {
            let line = SerialLine::parse(text).unwrap();
            assert_eq!((line.path.to_str().unwrap(), line.baud), (path, baud));
            assert_eq!(line.to_string(), text);
        }
        for wrong in ["COM3:9600", "COM3:3000001", "COM3:99999999999999"] {
            let error = SerialLine::parse(wrong).unwrap_err();
            assert!(error.contains("57600 to 3000000"), "{error}");
        }
        for wrong in ["", ":115200"] {
            assert!(
                SerialLine::parse(wrong)
                    .unwrap_err()
                    .contains("serial:PATH")
            );
        }
    }

    #[test]
    fn slowest_line_carries_the_longest_request_and_answer_within_the_wait() {
        let [least, _] = BAUDS;
        let bits = 2 * 10 * u32::try_from(LONGEST_PACKET).unwrap();
        let seconds = f64::from(bits) / f64::from(least);
        assert!(seconds < 0.5 * ANSWER_WITHIN.as_secs_f64(), "{seconds}");
    }
}
