//! Accuracy of the integration of the mechanics: against a formula, and against itself with half
//! the step.

use fmc_simulation::mechanics::{LONGEST_SUBSTEP_S, Mechanics, MechanicsSettings};

/// Duties of 10 ms each: breaking away, both directions, reversal through rest, and a push that
/// friction withstands.
const DUTIES: [f64; 8] = [0.2, 0.5, -0.3, -0.4, 0.0, 0.03, 0.25, 0.0];

/// Returns the stage's path, every millisecond, mm.
fn path(settings: MechanicsSettings) -> Vec<f64> {
    let mut mechanics = Mechanics::new(settings).unwrap();
    let mut path = Vec::new();
    for duty in DUTIES {
        for _ in 0..10 {
            mechanics.advance(duty, true, 1e-3);
            path.push(mechanics.position_mm());
        }
    }
    path
}

fn with_substep(substep_s: f64) -> MechanicsSettings {
    MechanicsSettings {
        substep_s,
        ..MechanicsSettings::default()
    }
}

#[test]
fn halving_the_step_quarters_the_error_and_the_longest_is_right_to_a_fiftieth_of_a_count() {
    let reference = path(with_substep(3.125e-7));
    let error_nm = |substep_s| {
        let path = path(with_substep(substep_s));
        let errors = path
            .iter()
            .zip(&reference)
            .map(|(one, exact)| (one - exact).abs());
        1e6 * errors.fold(0.0, f64::max)
    };
    let errors = [5e-5, 2e-5, 1e-5, 5e-6].map(error_nm);
    println!("{errors:.3?} nm");
    // The motion is 2 mm long, a count is 100 nm.
    assert!(errors[0] < 2.0 && errors[1] < 0.4, "{errors:?}");
    for (coarse, fine) in [(1, 2), (2, 3)] {
        let ratio = errors[coarse] / errors[fine];
        assert!((3.5..4.6).contains(&ratio), "{errors:?}");
    }
    assert!((LONGEST_SUBSTEP_S - 5e-5).abs() < 1e-12);
}

#[test]
fn steady_force_against_friction_and_damping_is_the_formula() {
    let settings = MechanicsSettings {
        breakaway_n: 0.25,
        duty_latency_s: 0.0,
        ..MechanicsSettings::default()
    };
    let mut mechanics = Mechanics::new(settings).unwrap();
    mechanics.advance(0.2, true, 0.03);
    // m·v' = F - F_c - b·v: v = (F - F_c)/b·(1 - exp(-t·b/m)), integrated.
    let (force, damping) = (0.2 * 6.0 - 0.25, 22.0);
    let tau: f64 = 0.3 / damping;
    let speed = force / damping * (1.0 - (-0.03 / tau).exp());
    let way_mm = 1e3 * (force / damping * 0.03 - tau * speed);
    let off_nm = 1e6 * (mechanics.position_mm() - way_mm);
    // The trapezoidal rule for the position errs by h²/12 of the change of acceleration, a tenth of
    // a nanometre.
    assert!(off_nm.abs() < 1.0, "{off_nm} nm of {way_mm} mm");
    assert!((mechanics.speed_mm_s() - 1e3 * speed).abs() < 1e-6);
}

#[test]
fn time_between_calls_does_not_matter() {
    let mut coarse = Mechanics::new(MechanicsSettings::default()).unwrap();
    let mut fine = coarse.clone();
    coarse.advance(0.3, true, 0.02);
    for _ in 0..40 {
        fine.advance(0.3, true, 5e-4);
    }
    assert!((coarse.position_mm() - fine.position_mm()).abs() < 1e-6);
}
