//! A pin of unknown behaviour.

use core::hint::black_box;

use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};

/// Pin for input, output and pulse width, of which any call can fail.
#[derive(Debug)]
pub(crate) struct Pin;

/// Failure of a pin.
#[derive(Debug)]
pub(crate) struct Failed;

impl Error for Failed {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl pwm::Error for Failed {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

impl ErrorType for Pin {
    type Error = Failed;
}

impl pwm::ErrorType for Pin {
    type Error = Failed;
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Failed> {
        black_box(Ok(true))
    }

    fn is_low(&mut self) -> Result<bool, Failed> {
        black_box(Ok(true))
    }
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Failed> {
        black_box(Ok(()))
    }

    fn set_high(&mut self) -> Result<(), Failed> {
        black_box(Ok(()))
    }
}

impl SetDutyCycle for Pin {
    fn max_duty_cycle(&self) -> u16 {
        black_box(1000)
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Failed> {
        black_box(duty);
        black_box(Ok(()))
    }
}
