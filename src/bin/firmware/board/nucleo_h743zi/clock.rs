//! Clock tree, and the count of microseconds.

use embassy_stm32::{
    Config, Peri, pac,
    peripherals::TIM2,
    rcc::{
        AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllDiv, PllMul, PllPreDiv, PllSource,
        Sysclk, VoltageScale,
    },
    time::Hertz,
    timer::low_level::Timer,
};

/// Clock of the processor, which every revision of the chip allows; 480 MHz needs revision V.
pub(super) const CORE_MHZ: u32 = 400;

/// Clock of peripherals, the link among them.
pub(super) const PERIPHERAL_HZ: u32 = 100_000_000;

/// Clock of the timers, twice that of other peripherals.
pub(super) const TIMER_MHZ: u16 = 200;

/// Longest time from a reset until the count of microseconds runs, ms.
pub(super) const RUNS_WITHIN_MS: u32 = 10;

/// Returns the clock tree: the 8 MHz that the ST-LINK feeds in are multiplied to 800 MHz and
/// halved. Buses run at their limits in this voltage range: 200 MHz, peripherals 100 MHz.
pub(super) fn configuration() -> Config {
    let mut config = Config::default();
    let rcc = &mut config.rcc;
    rcc.hse = Some(Hse {
        freq: Hertz(8_000_000),
        mode: HseMode::Bypass,
    });
    rcc.pll1 = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV1,
        mul: PllMul::MUL100,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: None,
        divr: None,
    });
    rcc.sys = Sysclk::PLL1_P;
    rcc.ahb_pre = AHBPrescaler::DIV2;
    rcc.apb1_pre = APBPrescaler::DIV2;
    rcc.apb2_pre = APBPrescaler::DIV2;
    rcc.apb3_pre = APBPrescaler::DIV2;
    rcc.apb4_pre = APBPrescaler::DIV2;
    rcc.voltage_scale = VoltageScale::Scale1;
    config
}

/// Watches the clock of the ST-LINK: when it fails, the processor goes on by its own oscillator,
/// the force goes off, and the non-maskable interrupt restarts the firmware. It stays on until a
/// reset.
pub(super) fn watch() {
    pac::RCC.cr().modify(|w| w.set_hsecsson(true));
}

/// Notes that the failure of the clock is seen to.
pub(super) fn note_failure() {
    pac::RCC.cicr().write(|w| w.set_hsecssc(true));
}

/// Free-running 32-bit count of microseconds. Its timer has the capture inputs of trigger, time
/// pulse and shutter, so that their time stamps are on this clock.
pub(super) struct Microseconds {
    _timer: Timer<'static, TIM2>,
}

impl Microseconds {
    /// Starts to count from 0.
    pub(super) fn start(timer: Peri<'static, TIM2>) -> Self {
        let timer = Timer::new(timer);
        pac::TIM2.psc().write_value(TIMER_MHZ - 1);
        pac::TIM2.arr().write_value(u32::MAX);
        timer.generate_update_event();
        timer.start();
        Self { _timer: timer }
    }
}

/// Returns the count, also before it has started.
pub(in super::super) fn now_us() -> u32 {
    pac::TIM2.cnt().read()
}
