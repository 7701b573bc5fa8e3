//! Friction, play, end stops, encoder and limit switches, each tested alone.

use fmc_simulation::mechanics::{EncoderSide, Mechanics, MechanicsSettings};

fn mechanics(settings: MechanicsSettings) -> Mechanics {
    Mechanics::new(settings).unwrap()
}

#[test]
fn below_breakaway_it_stands_exactly_and_above_it_moves() {
    let mut stage = mechanics(MechanicsSettings::default());
    // 0.32 N of 6 N.
    stage.advance(0.0532, true, 1.0);
    assert!(stage.position_mm().abs() <= 0.0 && stage.speed_mm_s().abs() <= 0.0);
    stage.advance(0.055, true, 0.1);
    assert!(stage.position_mm() > 0.01);
    // A moving stage keeps moving with less force than that.
    stage.advance(0.05, true, 0.05);
    assert!(stage.speed_mm_s() > 0.5);
}

#[test]
fn without_duty_friction_stops_it_where_energy_says() {
    let settings = MechanicsSettings {
        back_emf_n_s_m: 0.0,
        viscous_n_s_m: 0.0,
        breakaway_n: 0.25,
        duty_latency_s: 0.0,
        ..MechanicsSettings::default()
    };
    let mut stage = mechanics(settings);
    stage.advance(0.2, true, 0.01);
    let (start_mm, speed) = (stage.position_mm(), stage.speed_mm_s());
    stage.advance(0.0, false, 0.2);
    let way_mm = stage.position_mm() - start_mm;
    // v²·m/(2·F_c), in mm/s and mm.
    let expected_mm = speed * speed * 0.3 / (2.0 * 0.25) * 1e-3;
    assert!(
        (way_mm - expected_mm).abs() < 1e-5,
        "{way_mm} {expected_mm}"
    );
    assert!(stage.speed_mm_s().abs() <= 0.0);
}

#[test]
fn play_is_between_screw_and_stage_and_the_encoder_is_on_either_side() {
    for (side, lost_counts) in [(EncoderSide::Screw, 0.0), (EncoderSide::Stage, 100.0)] {
        let settings = MechanicsSettings {
            backlash_um: 10.0,
            encoder_side: side,
            encoder_phase_um: Some(0.0),
            ..MechanicsSettings::default()
        };
        let mut stage = mechanics(settings);
        stage.advance(0.3, true, 0.02);
        stage.advance(0.0, true, 0.1);
        let forth = stage.history(0.12).last().unwrap();
        let count = stage.encoder_count();
        assert!((forth.stage_mm - forth.screw_mm).abs() < 1e-12);
        stage.advance(-0.3, true, 0.01);
        stage.advance(0.0, true, 0.1);
        let back = stage.history(0.2).last().unwrap();
        assert!((back.stage_mm - back.screw_mm - 0.01).abs() < 1e-12);
        let screw_counts = (forth.screw_mm - back.screw_mm) / 1e-4;
        let counts = f64::from(count - stage.encoder_count());
        assert!(
            (screw_counts - counts - lost_counts).abs() <= 1.0,
            "{counts}"
        );
    }
}

#[test]
fn end_stops_hold_and_limit_switches_close_before() {
    let mut stage = mechanics(MechanicsSettings::default());
    assert!(!stage.limit_closed());
    stage.advance(0.5, true, 1.0);
    assert!((stage.position_mm() - 2.5).abs() < 1e-12);
    assert_eq!(stage.limits_closed(), [false, true]);
    stage.advance(-0.5, true, 1.0);
    // The screw stands at its stop, and the stage is ahead of it by the play.
    assert!((stage.position_mm() + 2.5 - 1e-3).abs() < 1e-12);
    assert_eq!(stage.limits_closed(), [true, false]);
}

#[test]
fn encoder_reads_the_past_in_whole_steps() {
    let settings = MechanicsSettings {
        encoder_latency_s: 1e-3,
        encoder_step_um: 0.5,
        encoder_phase_um: Some(0.1),
        ..MechanicsSettings::default()
    };
    let mut stage = mechanics(settings);
    for _ in 0..30 {
        stage.advance(0.3, true, 1e-3);
        let was_um = 1e3 * stage.position_at_mm(stage.time_s() - 1e-3);
        let read_um = 0.5 * f64::from(stage.encoder_count()) + 0.1;
        assert!((read_um - was_um).abs() <= 0.2501, "{read_um} {was_um}");
    }
    assert!(stage.speed_mm_s() > 30.0);
}

#[test]
fn duty_acts_after_its_latency() {
    let settings = MechanicsSettings {
        duty_latency_s: 3.3e-4,
        ..MechanicsSettings::default()
    };
    let mut stage = mechanics(settings);
    stage.advance(0.5, true, 3.3e-4);
    assert!(stage.position_mm().abs() <= 0.0);
    stage.advance(0.5, true, 1e-4);
    assert!(stage.speed_mm_s() > 0.5);
}

#[test]
fn history_has_every_substep_and_no_more_than_it_should() {
    let settings = MechanicsSettings {
        history_s: 0.05,
        ..MechanicsSettings::default()
    };
    let mut stage = mechanics(settings);
    stage.advance(0.3, true, 0.2);
    let instants: Vec<_> = stage.history(0.0).collect();
    assert!((2500..2510).contains(&instants.len()), "{}", instants.len());
    for pair in instants.windows(2) {
        let step_s = pair[1].time_s - pair[0].time_s;
        assert!(step_s > 0.0 && step_s <= settings.substep_s + 1e-12);
    }
    let [before, after] = [instants[10], instants[11]];
    let middle_mm = stage.position_at_mm(0.5 * (before.time_s + after.time_s));
    assert!((middle_mm - 0.5 * (before.stage_mm + after.stage_mm)).abs() < 1e-12);
}

#[test]
fn settings_that_are_no_stage_are_refused_by_name() {
    let settings = MechanicsSettings {
        breakaway_n: 0.2,
        ..MechanicsSettings::default()
    };
    let refused = Mechanics::new(settings).unwrap_err();
    assert_eq!(refused, "breakaway_n = 0.2 is outside 0.25 to 1000");
}
