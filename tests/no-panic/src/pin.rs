//! A pin of unknown behaviour.

use core::hint::black_box;

use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use fmc_camera::flight::drive::position_command::{CommandOutput, PositionSensor, SensorReading};
use fmc_camera::flight::time::Time;

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

impl CommandOutput for Pin {
    type Error = Failed;

    fn max_word(&self) -> u16 {
        black_box(4095)
    }

    fn set_word(&mut self, word: u16) -> Result<(), Failed> {
        black_box(word);
        black_box(Ok(()))
    }

    fn release(&mut self) -> Result<(), Failed> {
        black_box(Ok(()))
    }
}

impl PositionSensor for Pin {
    type Error = Failed;

    fn read(&mut self, time: Time) -> Result<SensorReading, Failed> {
        let counts = black_box(1);
        black_box(Ok(SensorReading { time, counts }))
    }
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
