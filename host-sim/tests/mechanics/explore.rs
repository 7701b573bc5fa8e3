use crate::profile::Profile;
use crate::support::*;
use fmc_camera::flight::drive::pwm_encoder::DriveSettings;
use host_sim::mechanics::*;

fn env(name: &str, default: f64) -> f64 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(default)
}

pub(crate) fn profile(speed: f64, phase_s: f64) -> Profile {
    let mut p = Profile::at_rest(0.02 + phase_s);
    for _ in 0..env("STROKES", 0.0) as u32 {
        p.move_to(-1.0, 50.0, 1000.0);
        p.rest(0.02);
        p.move_to(1.0, 50.0, 1000.0);
        p.rest(0.02);
    }
    p.measure_from_here();
    let way = speed * speed / 1000.0 + speed * 0.025;
    p.move_to(-way / 2.0, 50.0, 1000.0);
    p.rest(0.04);
    p.cruise(speed, 0.025, 1000.0);
    p.rest(0.04);
    p.move_to(-way / 2.0, 50.0, 1000.0);
    p.rest(0.04);
    p
}

#[test]
#[ignore]
fn explore() {
    let mut drive = DriveSettings::default();
    let l = &mut drive.velocity_loop;
    let base = 1e-3 * 0.3 / 6.0;
    l.position_gain_per_s = env("WP", 250.0) as f32;
    l.speed_gain_per_mm_s = (env("WV", 750.0) * base) as f32;
    l.integral_rate_per_s = env("WI", 120.0) as f32;
    l.slope_weight = env("SW", 1.0) as f32;
    let step = env("STEP", 0.1);
    drive.encoder_step_um = step as f32;
    let lat = env("LAT", 1e-4);
    l.reading_age_s = lat as f32;
    l.duty_delay_s = env("DLAT", lat) as f32;
    l.learning_rate_per_s = env("LR", 30.0) as f32;
    l.rest_band_um = env("RB", 1.0) as f32;
    if step > 0.3 {
        l.rest_band_um = 1.5;
    }
    let nominal = MechanicsSettings {
        encoder_step_um: step,
        encoder_latency_s: lat,
        duty_latency_s: env("DLAT", lat),
        ..Default::default()
    };
    for varied in [false, true] {
        let mut all = Followed::default();
        for speed in [5.0, 10.0, 17.0, 25.0] {
            let mut worst = Followed::default();
            for phase in [0.0, 0.3e-3, 0.7e-3] {
                if !varied {
                    worst = worst.worst(followed(nominal, drive, &profile(speed, phase)));
                } else {
                    for (m, f, k) in (0..8).map(|i| {
                        (
                            if i & 1 == 0 { 0.7 } else { 1.3 },
                            if i & 2 == 0 { 0.7 } else { 1.3 },
                            if i & 4 == 0 { 0.7 } else { 1.3 },
                        )
                    }) {
                        let s = MechanicsSettings {
                            mass_kg: nominal.mass_kg * m,
                            coulomb_n: nominal.coulomb_n * f,
                            breakaway_n: nominal.breakaway_n * f,
                            force_n: nominal.force_n * k,
                            ..nominal
                        };
                        worst = worst.worst(followed(s, drive, &profile(speed, phase)));
                    }
                }
            }
            println!("{varied} {speed}: {worst:.2?}");
            all = all.worst(worst);
        }
        println!("{varied} ALL: {all:.2?}");
    }
}
