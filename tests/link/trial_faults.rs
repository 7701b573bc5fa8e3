//! Trials of a mechanism that is not as it should be.

use fmc_camera::flight::bring_up::{
    JOG_WITHIN_UM, MAX_DUTY, MAX_DUTY_S, MAX_JOG_ERROR_UM, MAX_JOG_UM, Trial, TrialEnd,
};

use crate::link::trial_bench::Bench;

#[derive(Debug, Clone, Copy)]
enum Wrong {
    SilentEncoder,
    /// The encoder stands still from 12 µm on, in either direction.
    EncoderFallsSilent,
    HeldStage,
    EncoderBackwards,
    MotorReversed,
}

impl Wrong {
    const ALL: [Self; 5] = [
        Self::SilentEncoder,
        Self::EncoderFallsSilent,
        Self::HeldStage,
        Self::EncoderBackwards,
        Self::MotorReversed,
    ];

    fn bench(self, friction_n: f32) -> Bench {
        let mut bench = Bench::new();
        bench.friction_n = friction_n;
        match self {
            Self::SilentEncoder => bench.encoder = |_| 0.0,
            Self::EncoderFallsSilent => bench.encoder = |way_mm| 1e4 * way_mm.clamp(-0.012, 0.012),
            Self::HeldStage => bench.force_n = 0.0,
            Self::EncoderBackwards => bench.encoder = |way_mm| -1e4 * way_mm,
            Self::MotorReversed => bench.force_n = -6.0,
        }
        bench
    }
}

#[test]
fn jog_of_a_mechanism_that_is_wrong_ends_before_it_is_far_or_fast() {
    for wrong in Wrong::ALL {
        for friction_n in [0.0, 0.25, 0.5] {
            for way_um in [20.0, -50.0, 150.0, MAX_JOG_UM] {
                let mut bench = wrong.bench(friction_n);
                let (rounds, report) = bench.run(Trial::Jog { way_um });
                bench.coast();
                let of = format!("{wrong:?}, {friction_n} N, {way_um} µm: {rounds}, {report:?}");
                assert_eq!(report.end, Some(TrialEnd::NotFollowing), "{of}");
                assert!(rounds <= 30, "{of}");
                assert!(bench.largest_duty <= MAX_DUTY + 1e-4, "{of}");
                // The farthest and fastest is a free stage whose encoder falls silent, with 0.2 mm
                // of the way after it is released.
                assert!(bench.farthest_mm < 0.5, "{of}: {} mm", bench.farthest_mm);
                assert!(
                    bench.fastest_mm_s < 25.0,
                    "{of}: {} mm/s",
                    bench.fastest_mm_s
                );
            }
        }
    }
}

#[test]
fn jog_of_a_stage_that_is_heavier_weaker_or_stiffer_follows_with_half_the_error_that_ends_it() {
    for mass_kg in [0.2, 0.3, 0.4] {
        for force_n in [4.2, 6.0, 7.8] {
            for friction_n in [0.0, 0.25, 0.5] {
                for way_um in [20.0, -50.0, 150.0, -MAX_JOG_UM] {
                    let mut bench = Bench::new();
                    (bench.mass_kg, bench.force_n) = (mass_kg, force_n);
                    bench.friction_n = friction_n;
                    let (_, report) = bench.run(Trial::Jog { way_um });
                    let of = format!("{mass_kg} kg, {force_n} N, {friction_n} N: {report:?}");
                    assert_eq!(report.end, Some(TrialEnd::Done), "{of}");
                    assert!(report.largest_error_um < MAX_JOG_ERROR_UM / 2.0, "{of}");
                    let moved_um = 1e3 * (report.to_mm.unwrap() - report.from_mm.unwrap());
                    assert!((moved_um - way_um).abs() < JOG_WITHIN_UM, "{of}");
                }
            }
        }
    }
}

#[test]
fn duty_under_which_the_encoder_is_silent_ends_before_the_stage_is_far_or_fast() {
    let silent = [
        Wrong::SilentEncoder,
        Wrong::EncoderFallsSilent,
        Wrong::HeldStage,
    ];
    for wrong in silent {
        for (duty, within) in [(0.05, 36), (-MAX_DUTY, 11)] {
            let mut bench = wrong.bench(0.0);
            let (rounds, report) = bench.run(Trial::Duty {
                duty,
                time_s: MAX_DUTY_S,
            });
            bench.coast();
            let of = format!("{wrong:?}, {duty}: {rounds}, {report:?}");
            assert_eq!(report.end, Some(TrialEnd::NotFollowing), "{of}");
            assert!(rounds <= within, "{of}");
            assert!(bench.farthest_mm < 0.62, "{of}: {} mm", bench.farthest_mm);
            assert!(
                bench.fastest_mm_s < 31.0,
                "{of}: {} mm/s",
                bench.fastest_mm_s
            );
        }
        // One that is over before the encoder has been silent for long.
        let (_, report) = wrong.bench(0.0).run(Trial::Duty {
            duty: 0.01,
            time_s: 0.005,
        });
        let is_silent = !matches!(wrong, Wrong::EncoderFallsSilent);
        let expected = if is_silent {
            TrialEnd::NotFollowing
        } else {
            TrialEnd::Done
        };
        assert_eq!(report.end, Some(expected), "{wrong:?}");
    }
}

#[test]
fn duty_the_wrong_way_ends_where_it_is_far_enough_and_tells_its_sign() {
    for wrong in [Wrong::EncoderBackwards, Wrong::MotorReversed] {
        let (_, report) = wrong.bench(0.0).run(Trial::Duty {
            duty: MAX_DUTY,
            time_s: MAX_DUTY_S,
        });
        assert_eq!(report.end, Some(TrialEnd::FarEnough));
        assert!(report.to_mm < report.from_mm, "{report:?}");
    }
}
