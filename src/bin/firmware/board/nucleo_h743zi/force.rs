//! Force on the stage: the motor's enable is an output of TIM1, as its pulses are, so that the
//! timer's break takes both low without software: brake input, low supply, failed clock, lock-up.

use embassy_stm32::{
    Peri,
    gpio::{AfType, Flex, OutputType, Pull, Speed},
    pac::{
        self,
        common::{RW, Reg},
        timer::{
            regs::SrAdv,
            vals::{Bkinp, Bkp, CcmrOutputCcs, FilterValue, OcmGp, Ossi},
        },
    },
    peripherals::{PE12, PE15, TIM1},
    timer::{BkIn1, BreakInputPin, Ch3, TimerComplementaryPin},
};
use embedded_hal::digital::{Error, ErrorKind, ErrorType, OutputPin};
use fmc_camera::flight::input_settings::BrakeInput;

/// Channel of TIM1 whose complementary output is the enable.
const ENABLE: usize = 2;

/// Break input of TIM1 that all sources lead to.
const BREAK: usize = 0;

/// `SYSCFG_CFGR` of the manual RM0433, which the crate leaves out: offset, and the bits that lead
/// the monitor of the supply and a lock-up of the processor to the break of the timers. They stay
/// until a reset.
const SYSCFG_CFGR: usize = 0x18;
const PVDL: u32 = 1 << 2;
const CM7L: u32 = 1 << 6;

/// Pins of enable and brake.
pub(super) struct ForcePins {
    _enable: Flex<'static>,
    brake: Flex<'static>,
    brake_function: u8,
}

impl ForcePins {
    /// Makes the enable an output, low, and the brake an input that is not used. TIM1 runs already.
    pub(super) fn start(enable: Peri<'static, PE12>, brake: Peri<'static, PE15>) -> Self {
        let timer = pac::TIM1;
        timer.ccmr_output(ENABLE / 2).modify(|w| {
            w.set_ccs(ENABLE % 2, CcmrOutputCcs::OUTPUT);
            w.set_ocm(ENABLE % 2, OcmGp::FORCE_INACTIVE);
        });
        timer.ccer().modify(|w| w.set_ccne(ENABLE, true));
        // The input itself leads nowhere until the settings say so.
        timer.af1().modify(|w| w.set_bkine(false));
        timer.bdtr().modify(|w| {
            w.set_ossi(Ossi::IDLE_LEVEL);
            w.set_bkp(BREAK, Bkp::ACTIVE_HIGH);
            w.set_bke(BREAK, true);
            w.set_moe(true);
        });
        let functions = (
            <PE12 as TimerComplementaryPin<TIM1, Ch3>>::af_num(&*enable),
            <PE15 as BreakInputPin<TIM1, BkIn1>>::af_num(&*brake),
        );
        let mut pins = [Flex::new(enable), Flex::new(brake)];
        let [enable_pin, brake_pin] = &mut pins;
        let output = AfType::output(OutputType::PushPull, Speed::Low);
        enable_pin.set_as_af_unchecked(functions.0, output);
        brake_pin.set_as_af_unchecked(functions.1, AfType::input(Pull::Down));
        let [enable, brake] = pins;
        Self {
            _enable: enable,
            brake,
            brake_function: functions.1,
        }
    }

    /// Uses the brake as settings say, with a filter of this code. A broken wire brakes.
    pub(super) fn set_brake(&mut self, brake: BrakeInput, filter: u8) {
        let (is_used, polarity, pull) = match brake {
            BrakeInput::Unused => (false, Bkinp::NOT_INVERTED, Pull::Down),
            BrakeInput::High => (true, Bkinp::NOT_INVERTED, Pull::Up),
            BrakeInput::Low => (true, Bkinp::INVERTED, Pull::Down),
        };
        self.brake
            .set_as_af_unchecked(self.brake_function, AfType::input(pull));
        critical_section::with(|_| {
            let timer = pac::TIM1;
            timer.af1().modify(|w| {
                w.set_bkinp(polarity);
                w.set_bkine(is_used);
            });
            timer
                .bdtr()
                .modify(|w| w.set_bkf(BREAK, FilterValue::from_bits(filter)));
        });
    }
}

/// Leads the monitor of the supply, which must be on already, and a lock-up of the processor to the
/// break. That a clock fails leads there by itself.
pub(super) fn connect_protections() {
    // SAFETY: the register is there, aligned, and its bits have no effect on memory; nothing else
    // uses it.
    let register: Reg<u32, RW> =
        unsafe { Reg::from_ptr(pac::SYSCFG.as_ptr().byte_add(SYSCFG_CFGR).cast()) };
    register.write_value(register.read() | PVDL | CM7L);
}

/// Takes the force off, from any context: the next set point puts it on again.
pub(super) fn off() {
    pac::TIM1.bdtr().modify(|w| w.set_moe(false));
    pac::TIM1.ccr(0).write(|w| w.set_ccr(0));
}

/// Returns `true` if a break of the chip itself, that of the supply among them, has taken the force
/// off since the last call.
pub(super) fn take_supply_break() -> bool {
    let has_broken = pac::TIM1.sr().read().sbif();
    if has_broken {
        // It stays as long as its cause does.
        let mut cleared = SrAdv(u32::MAX);
        cleared.set_sbif(false);
        pac::TIM1.sr().write_value(cleared);
    }
    has_broken
}

/// The enable: high while there may be force.
pub(crate) struct Enable {
    is_high: bool,
}

/// The brake has been pulled.
#[derive(Debug)]
pub(crate) struct Braked;

impl Error for Braked {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl Enable {
    pub(super) const fn new() -> Self {
        Self { is_high: false }
    }

    fn drive(is_high: bool) {
        let mode = if is_high {
            OcmGp::FORCE_ACTIVE
        } else {
            OcmGp::FORCE_INACTIVE
        };
        pac::TIM1
            .ccmr_output(ENABLE / 2)
            .modify(|w| w.set_ocm(ENABLE % 2, mode));
    }

    /// Forgets a pull of the brake that is over.
    fn forget_brake() {
        let mut cleared = SrAdv(u32::MAX);
        cleared.set_bif(BREAK, false);
        pac::TIM1.sr().write_value(cleared);
    }
}

impl ErrorType for Enable {
    type Error = Braked;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Braked> {
        Self::drive(false);
        self.is_high = false;
        Ok(())
    }

    /// Puts the force on. After a break of the chip itself it stays off until
    /// [`take_supply_break`] has told of it.
    fn set_high(&mut self) -> Result<(), Braked> {
        if !self.is_high {
            // A pull of the brake on a stage without force is over.
            Self::forget_brake();
        }
        let status = pac::TIM1.sr().read();
        if status.bif(BREAK) {
            return Err(Braked);
        }
        if !status.sbif() {
            critical_section::with(|_| pac::TIM1.bdtr().modify(|w| w.set_moe(true)));
        }
        Self::drive(true);
        self.is_high = true;
        Ok(())
    }
}
