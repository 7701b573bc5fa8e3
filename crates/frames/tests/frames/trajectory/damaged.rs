//! Trajectories that cannot be used.

use fmc_frames::trajectory::{TimeScale, TrajectoryOptions};

use super::TrajectoryFile;
use super::motion::{Motion, record, sbet, table};

fn refusal(bytes: &[u8]) -> String {
    TrajectoryFile::with(bytes).refusal(&TrajectoryOptions::default())
}

#[test]
fn sbet_with_half_a_record_wrong_numbers_or_times_is_refused_by_record() {
    let motion = Motion::SWISS;
    let good = sbet(motion, 1000.0, 10.0, 50);
    let changed = |record: usize, number: usize, value: f64| {
        let mut bytes = good.clone();
        let at = 136 * record + 8 * number;
        bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        refusal(&bytes)
    };
    assert_eq!(
        refusal(&good[..136 * 20 + 17]),
        "trajectory: 2737 bytes are not whole records of 136 bytes: 17 bytes follow record 20"
    );
    assert_eq!(
        changed(7, 8, f64::NAN),
        "trajectory, record 8: pitch = NaN: must be -1.5707963267948966 to 1.5707963267948966 rad"
    );
    // Degrees.
    assert_eq!(
        changed(3, 1, 47.5),
        "trajectory, record 4: latitude = 47.5: must be -1.5707963267948966 to 1.5707963267948966 rad"
    );
    assert_eq!(
        changed(9, 0, 1000.8),
        "trajectory, record 10: time 1000.8 s is not after 1000.8 s, that of the sample before"
    );
    assert!(changed(0, 0, -1.0).contains("record 1: time = -1: must be 0 to 1209600 s"));
    assert_eq!(
        refusal(&record(1.0, &motion.at(0.0), 0.0)),
        "trajectory: it holds 1 samples; at least 3 are needed"
    );
    let swapped: Vec<u8> = good
        .chunks(8)
        .flat_map(|number| number.iter().rev().copied())
        .collect();
    assert!(refusal(&swapped).starts_with("trajectory, record "));
    assert_eq!(refusal(b""), "trajectory: the file is empty");
}

#[test]
fn table_with_wrong_columns_or_cells_is_refused_by_line_and_column() {
    let good = table(Motion::SWISS, 1000.0, 10.0, 50);
    let changed = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        refusal(good.replacen(from, to, 1).as_bytes())
    };
    assert_eq!(
        changed("gps_seconds_of_week", "time"),
        "trajectory, line 1: one column of time is needed: gps_seconds_of_week (with gps_week, if it is known), unix_s or unix_us"
    );
    assert_eq!(
        changed("latitude_deg", "lat"),
        "trajectory, line 1: the place is needed once: latitude_deg, longitude_deg, height_m or x_m, y_m, z_m"
    );
    assert_eq!(
        changed("roll_deg", "phi"),
        "trajectory, line 1: column roll_deg is missing"
    );
    assert_eq!(
        changed("heading_deg", "kappa"),
        "trajectory, line 1: one of heading_deg, clockwise, and yaw_deg, anticlockwise, is needed"
    );
    assert_eq!(
        changed("quality", "sigma_x_m"),
        "trajectory, line 1: of sigma_x_m, sigma_y_m, sigma_z_m, sigma_pitch_deg, sigma_roll_deg, sigma_yaw_deg all are needed, or none"
    );
    for ending in ["\n", "\r\n"] {
        let text = good.replace('\n', ending);
        let text = text.replacen("1,1001,", "1,x,", 1);
        assert_eq!(
            refusal(text.as_bytes()),
            "trajectory, line 12: gps_seconds_of_week = \"x\": not a finite number"
        );
        let text = good
            .replace('\n', ending)
            .replacen("1,1001,", "1,1000.5,", 1);
        assert_eq!(
            refusal(text.as_bytes()),
            "trajectory, line 12: time 1000.5 s is not after 1000.9 s, that of the sample before"
        );
        let text = good.replace('\n', ending).replacen("1,1001,", "1001,", 1);
        assert_eq!(
            refusal(text.as_bytes()),
            "trajectory, line 12: 7 columns where the header has 8"
        );
    }
    let header = good.lines().next().unwrap();
    assert_eq!(
        refusal(header.as_bytes()),
        "trajectory: it holds no samples"
    );
    let utc = TrajectoryOptions {
        scale: Some(TimeScale::Utc),
        ..TrajectoryOptions::default()
    };
    let file = TrajectoryFile::with(good.as_bytes());
    assert_eq!(
        file.refusal(&utc),
        "--trajectory-time: the columns of trajectory say the scale of its times"
    );
}
