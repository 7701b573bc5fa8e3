//! Digital filter of a timer's inputs.

/// Samples of each filter that a timer of the STM32 has, in periods of the timer's clock: number of
/// its code, 0 for none (RM0433, `TIMx_CCMR1`, field `IC1F`, with the sampling clock undivided).
pub const FILTER_PERIODS: [u16; 16] = [
    0, 2, 4, 8, 12, 16, 24, 32, 48, 64, 80, 96, 128, 160, 192, 256,
];

/// Returns the code of the longest filter that lets a pulse of this length pass, ns, with the
/// timer's clock in MHz.
///
/// A pulse that is shorter than the filter's periods is rejected; edges are stamped as much later.
///
/// # Examples
/// ```
/// use fmc_camera::flight::input_filter::filter_code;
///
/// // 8 periods of 5 ns.
/// assert_eq!(filter_code(40.0, 200), 3);
/// assert_eq!(filter_code(39.0, 200), 2);
/// assert_eq!(filter_code(0.0, 200), 0);
/// ```
#[must_use]
pub fn filter_code(shortest_ns: f32, timer_mhz: u16) -> u8 {
    let passes = |periods: &u16| 1e3 * f32::from(*periods) <= shortest_ns * f32::from(timer_mhz);
    let longer = FILTER_PERIODS.iter().skip(1).take_while(|it| passes(it));
    longer.fold(0, |code, _| code.saturating_add(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filter_is_the_longest_that_lets_the_pulse_pass() {
        for (code, periods) in (0..).zip(FILTER_PERIODS) {
            let ns = 5.0 * f32::from(periods);
            assert_eq!(filter_code(ns, 200), code, "{ns} ns");
            if code > 0 {
                assert_eq!(filter_code(ns.next_down(), 200), code - 1, "below {ns} ns");
            }
        }
        assert_eq!(filter_code(f32::MAX, 200), 15);
        assert_eq!(filter_code(f32::NAN, 200), 0);
    }
}
