//! Margins of the velocity loop on the plant that it was tuned on.

use std::f64::consts::PI;

use fmc_camera::flight::drive::{
    following_error_bounds::LoopMargins,
    loop_settings::{LoopSettings, Plant},
};
use nalgebra::Complex;

use crate::mechanics::support::TICK_S;

/// Returns the open loop's gain at a frequency.
///
/// # Model
/// Plant `F/(s·(m·s + b))`, zero-order hold and latencies as
/// `sin(ωT/2)/(ωT/2)·exp(-jω(T/2 + t_r + t_d))`, controller with `z = exp(jωT)`; aliases above half
/// the tick rate are 40 dB down and left out.
fn open_loop(settings: &LoopSettings, plant: &Plant, frequency_hz: f64) -> Complex<f64> {
    let omega = 2.0 * PI * frequency_hz;
    let s = Complex::new(0.0, omega);
    let back = (-s * TICK_S).exp();
    let difference = (1.0 - back) / TICK_S;
    let integral = back / difference;
    let controller = f64::from(settings.speed_gain_per_mm_s)
        * (1.0 + f64::from(settings.integral_rate_per_s) * integral)
        * (f64::from(settings.position_gain_per_s) + difference);
    let half = 0.5 * omega * TICK_S;
    let late_s = 0.5 * TICK_S + f64::from(settings.reading_age_s + settings.duty_delay_s);
    let hold = (-s * late_s).exp() * (half.sin() / half);
    let mass = f64::from(plant.mass_kg);
    let damping = f64::from(plant.damping_n_s_m);
    let stage = 1e3 * f64::from(plant.force_n) / (s * (mass * s + damping));
    controller * hold * stage
}

fn margins(settings: &LoopSettings, plant: &Plant) -> LoopMargins {
    let at = |step: u32| {
        let frequency_hz = 1.0 * 1.001_f64.powi(i32::try_from(step).unwrap());
        (frequency_hz, open_loop(settings, plant, frequency_hz))
    };
    let responses: Vec<_> = (0..6200).map(at).collect();
    let (crossover_hz, crossing) = *responses
        .iter()
        .rfind(|(_, gain)| gain.norm() >= 1.0)
        .unwrap();
    // The phase passes -180° on its way down, after and before the crossover.
    let passes: Vec<_> = responses
        .windows(2)
        .filter(|pair| pair[0].1.im * pair[1].1.im < 0.0 && pair[0].1.re < 0.0)
        .map(|pair| (pair[0].0, pair[0].1.norm()))
        .collect();
    let above = passes.iter().find(|(hz, _)| *hz > crossover_hz).unwrap().1;
    // Without a passage below the crossover the loop is stable with less gain, too.
    assert_eq!(passes.len(), 1, "{passes:?}");
    #[expect(
        clippy::cast_possible_truncation,
        reason = "three digits are documented"
    )]
    LoopMargins {
        crossover_hz: crossover_hz as f32,
        phase_deg: (180.0 + crossing.arg().to_degrees()) as f32,
        gain: (1.0 / above) as f32,
    }
}

#[test]
fn documented_margins_are_those_of_the_gains() {
    let found = margins(&LoopSettings::default(), &Plant::REFERENCE);
    let documented = LoopSettings::MARGINS;
    println!("{found:?}");
    let pairs = [
        (found.crossover_hz, documented.crossover_hz),
        (found.phase_deg, documented.phase_deg),
        (found.gain, documented.gain),
    ];
    for (found, documented) in pairs {
        assert!(
            (found / documented - 1.0).abs() < 0.005,
            "{found} {documented}"
        );
    }
    // The margin must cover mass and force 30 % off.
    assert!(found.gain > 1.3 / 0.7);
}
