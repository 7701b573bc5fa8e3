//! Faults of the mechanics: each has its effect from its time on.

use fmc_simulation::mechanics::{Injection, MechanicalFault, Mechanics, MechanicsSettings};

fn broken(fault: MechanicalFault, from_s: f64, until_s: f64) -> Mechanics {
    let mut mechanics = Mechanics::new(MechanicsSettings {
        encoder_latency_s: 0.0,
        duty_latency_s: 0.0,
        ..MechanicsSettings::default()
    })
    .unwrap();
    mechanics.inject(Injection {
        fault,
        from_s,
        until_s,
    });
    mechanics
}

const FOR_EVER: f64 = f64::INFINITY;

#[test]
fn jam_stops_it_and_holds_until_it_is_over() {
    let mut stage = broken(MechanicalFault::Stall { force_n: 50.0 }, 0.01, 0.05);
    stage.advance(0.3, true, 0.01);
    assert!(stage.speed_mm_s() > 20.0);
    stage.advance(1.0, true, 0.01);
    let jammed_mm = stage.position_mm();
    assert!(stage.speed_mm_s().abs() <= 0.0);
    stage.advance(1.0, true, 0.02);
    assert!((stage.position_mm() - jammed_mm).abs() <= 0.0);
    stage.advance(1.0, true, 0.02);
    assert!(stage.speed_mm_s() > 50.0);
}

#[test]
fn glitch_moves_the_count_and_not_the_stage() {
    let mut stage = broken(MechanicalFault::EncoderGlitch { counts: 500 }, 0.01, 0.02);
    let counts = [(); 3].map(|()| {
        stage.advance(0.0, true, 0.009);
        stage.encoder_count()
    });
    assert_eq!((counts[1] - counts[0], counts[2] - counts[0]), (500, 0));
    assert!(stage.position_mm().abs() <= 0.0);
}

#[test]
fn reversed_motor_moves_it_the_other_way() {
    let mut stage = broken(MechanicalFault::MotorReversed, 0.0, FOR_EVER);
    stage.advance(0.3, true, 0.02);
    assert!(stage.position_mm() < -0.1);
}

#[test]
fn reversed_encoder_counts_back_from_where_it_was_and_forth_again() {
    let mut stage = broken(MechanicalFault::EncoderReversed, 0.0095, 0.0195);
    let mut counts = Vec::new();
    let mut ways_mm = Vec::new();
    for _ in 0..30 {
        let before_mm = stage.position_mm();
        stage.advance(0.3, true, 1e-3);
        ways_mm.push(stage.position_mm() - before_mm);
        counts.push(stage.encoder_count());
    }
    for (tick, pair) in counts.windows(2).enumerate() {
        let moved = 1e4 * ways_mm[tick + 1];
        let reversed = (9..19).contains(&tick);
        let expected = if reversed { -moved } else { moved };
        let change = f64::from(pair[1] - pair[0]);
        // The fault changes the direction of counting at a reading, and the count never jumps.
        assert!(
            (change - expected).abs() <= 1.0,
            "{tick}: {change} {expected}"
        );
    }
}

#[test]
fn bridge_that_runs_away_drives_switched_off_and_a_dead_one_does_not() {
    let mut stage = broken(MechanicalFault::Runaway { duty: -1.0 }, 0.0, FOR_EVER);
    stage.advance(0.0, false, 0.02);
    assert!(stage.position_mm() < -1.0);
    let mut stage = broken(MechanicalFault::BridgeOff, 0.0, FOR_EVER);
    stage.advance(1.0, true, 0.02);
    assert!(stage.position_mm().abs() <= 0.0);
}

#[test]
fn stuck_limit_switch_is_closed_in_the_middle() {
    let mut stage = broken(MechanicalFault::LimitStuck, 0.01, FOR_EVER);
    assert!(!stage.limit_closed());
    stage.advance(0.0, false, 0.02);
    assert!(stage.limit_closed());
}

#[test]
fn faults_are_named_in_text() {
    let text = r#"
        [[fault]]
        fault = { kind = "stall", force_n = 50.0 }
        from_s = 2.5
        [[fault]]
        fault = { kind = "encoder-glitch", counts = -40 }
        from_s = 1.0
        until_s = 1.1
    "#;
    let read: std::collections::BTreeMap<String, Vec<Injection>> = toml::from_str(text).unwrap();
    let stall = Injection::from(MechanicalFault::Stall { force_n: 50.0 }, 2.5);
    assert_eq!(read["fault"][0], stall);
    assert_eq!(
        read["fault"][1].fault,
        MechanicalFault::EncoderGlitch { counts: -40 }
    );
}
