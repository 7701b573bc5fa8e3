//! Interpolated places and angles, and their σ.

use std::fmt::Write as _;

use fmc_frames::trajectory::{
    ImageOrientation, OrientationSigma, Place, Trajectory, TrajectoryOptions,
};

use super::motion::{Motion, sbet, table};
use super::{TrajectoryFile, at, utc_of};

const FIRST_S: f64 = 208_000.0;

/// Returns the errors of an orientation: east, north, up, m, and pitch, roll, yaw, rad.
fn errors(found: &ImageOrientation, motion: Motion, t: f64) -> [f64; 6] {
    let Place::Geographic(place) = found.place else {
        panic!("{:?}", found.place);
    };
    let [latitude, longitude, height, roll, pitch, heading] = motion.at(t);
    let turned = |angle: f64| (angle + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
    [
        turned(place.longitude_rad - longitude) * 6.39e6 * latitude.cos(),
        turned(place.latitude_rad - latitude) * 6.37e6,
        place.height_m - height,
        found.attitude.pitch_rad - pitch,
        found.attitude.roll_rad - roll,
        turned(found.attitude.yaw_rad + heading),
    ]
}

fn sigmas(sigma: &OrientationSigma) -> [f64; 6] {
    let ([x, y, z], [pitch, roll, yaw]) = (sigma.position_m, sigma.angles_rad);
    [x, y, z, pitch, roll, yaw]
}

#[test]
fn sbet_of_200_hz_gives_place_within_a_micrometre_and_angles_within_a_nanoradian() {
    // At the antimeridian and near the pole, too, and with a heading that turns over at 0°.
    let places = [
        (0.83, 0.145),
        (-0.6, std::f64::consts::PI),
        (1.55, -2.0),
        (0.0, 0.0),
    ];
    for (latitude, longitude) in places {
        let motion = Motion {
            latitude,
            longitude,
            turbulence: 1.0,
        };
        let file = TrajectoryFile::with(&sbet(motion, FIRST_S, 200.0, 8001));
        let mut trajectory = file.opened();
        assert_eq!((trajectory.len(), trajectory.gaps()), (8001, 0));
        assert!(!trajectory.has_week());
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..400 {
            let t = (random.f64() * 40.0 * 1e6).round() * 1e-6;
            let found = at(&mut trajectory, FIRST_S + t).unwrap();
            for (index, error) in errors(&found, motion, t).into_iter().enumerate() {
                // A double holds an angle of 3 rad to 0.4 fm, 3 nm on the ground.
                let allowed = if index < 3 { 1e-6 } else { 1e-9 };
                assert!(error.abs() < allowed, "{t}: {index}: {error}");
            }
            assert_eq!(found.sigma(), None);
            let [_, north, _] = found.velocity_m_s;
            let expected = (motion.at(t + 1e-3)[0] - motion.at(t - 1e-3)[0]) / 2e-3;
            assert!((north / expected / 6.37e6 - 1.0).abs() < 0.01, "{north}");
        }
    }
}

#[test]
fn sigma_of_the_interpolation_is_the_size_of_its_error() {
    // The motions of Motion::at, sampled too seldom: the cubic is then off by up to decimetres.
    for rate_hz in [1.0, 2.0, 5.0] {
        let motion = Motion::SWISS;
        let file = TrajectoryFile::with(table(motion, FIRST_S, rate_hz, 400).as_bytes());
        let mut trajectory = file.opened();
        let mut random = fastrand::Rng::with_seed(2);
        let (mut sum, mut largest, mut within, mut count) = (0.0, 0.0_f64, 0, 0);
        for _ in 0..2000 {
            // As records have it, in microseconds.
            let t = (random.f64() * 390.0 / rate_hz * 1e6).round() * 1e-6;
            let found = at(&mut trajectory, FIRST_S + t).unwrap();
            let sigma = sigmas(&found.interpolation_sigma);
            for (error, sigma) in errors(&found, motion, t).into_iter().zip(sigma) {
                // Below, the digits of the table count.
                if sigma > 1e-7 {
                    sum += (error / sigma).abs().min(10.0).powi(2);
                    within += u32::from(error.abs() <= 1.5 * sigma);
                    count += 1;
                }
                largest = largest.max(error.abs());
            }
        }
        let mean = f64::sqrt(sum / f64::from(count));
        let share = f64::from(within) / f64::from(count);
        println!(
            "{rate_hz} Hz: error/σ {mean:.2}, within 1.5 σ {share:.3}, largest {largest:.2e}, {count}"
        );
        assert!(count > 2000);
        assert!((0.8..1.3).contains(&mean), "{rate_hz} Hz: {mean}");
        assert!(share > 0.9, "{rate_hz} Hz: {share}");
    }
}

#[test]
fn sigma_of_the_time_is_carried_by_velocity_and_rates() {
    let motion = Motion::SWISS;
    let file = TrajectoryFile::with(&sbet(motion, FIRST_S, 200.0, 4000));
    let sigma = OrientationSigma {
        position_m: [0.03, 0.04, 0.05],
        angles_rad: [5e-5, 6e-5, 1e-4],
    };
    let options = TrajectoryOptions {
        sigma: Some(sigma),
        ..TrajectoryOptions::default()
    };
    let mut trajectory = file.open(&options).unwrap();
    // Coverage: the time of the exposure errs with σ, the place by velocity times that.
    let (sigma_s, mut random) = (1e-3_f32, fastrand::Rng::with_seed(5));
    let mut sums = [0.0; 6];
    let count = 1500;
    for _ in 0..count {
        let t = 1.0 + random.f64() * 18.0;
        let gaussian: f64 = (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
        let wrong = utc_of(FIRST_S + t + 1e-3 * gaussian, sigma_s);
        let found = trajectory.at(Some(wrong)).unwrap().unwrap();
        let by_time = sigmas(&found.time_sigma);
        for ((sum, error), sigma) in sums.iter_mut().zip(errors(&found, motion, t)).zip(by_time) {
            *sum += (error / sigma).powi(2).min(25.0);
        }
        let [_, north, _] = found.time_sigma.position_m;
        assert!((north - 0.075).abs() < 0.002, "{north}");
        let total = sigmas(&found.sigma().unwrap());
        for ((total, by_time), given) in total.into_iter().zip(by_time).zip(sigmas(&sigma)) {
            let interpolation = total.powi(2) - by_time.powi(2) - given.powi(2);
            assert!((-1e-15..1e-12).contains(&interpolation), "{interpolation}");
        }
    }
    for sum in sums {
        let ratio = (sum / f64::from(count)).sqrt();
        assert!((0.95..1.1).contains(&ratio), "{sums:?}");
    }
}

#[test]
fn sigma_of_the_table_is_that_of_its_samples() {
    let mut text = String::from(
        "unix_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg,sigma_x_m,sigma_y_m,sigma_z_m,sigma_pitch_deg,sigma_roll_deg,sigma_yaw_deg\n",
    );
    for index in 0..20_u32 {
        let time = super::SUNDAY_UNIX_S + index;
        writeln!(
            text,
            "{time},{},5,6,0,0,179.9,0.1,0.2,0.{},0.01,0.02,0.03",
            10 * index,
            3 + index % 2
        )
        .unwrap();
    }
    let file = TrajectoryFile::with(text.as_bytes());
    let mut trajectory: Trajectory = file.opened();
    let found = at(&mut trajectory, super::SUNDAY_GPS_S + 4.5).unwrap();
    assert_eq!(found.place, Place::Cartesian([45.0, 5.0, 6.0]));
    let [vx, vy, _] = found.velocity_m_s;
    assert!((vx - 10.0).abs() < 1e-9 && vy.abs() < 1e-9);
    let sigma = found.sigma().unwrap();
    let expected = [0.1, 0.2, 0.35, 0.01, 0.02, 0.03];
    for (index, (found, expected)) in sigmas(&sigma).into_iter().zip(expected).enumerate() {
        let found = if index < 3 { found } else { found.to_degrees() };
        assert!((found - expected).abs() < 1e-9, "{index}: {found}");
    }
    assert!((found.attitude.yaw_rad.to_degrees() - 179.9).abs() < 1e-9);
}
