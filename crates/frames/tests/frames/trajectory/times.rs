//! GPS time, UTC, weeks, gaps and ends.

use fmc_camera::flight::utc::UtcTime;
use fmc_frames::trajectory::{Place, TimeScale, Trajectory, TrajectoryOptions, Unavailable};

use super::motion::{Motion, record, sbet, table};
use super::{SUNDAY_GPS_S, SUNDAY_GPS_WEEK, SUNDAY_UNIX_S, TrajectoryFile, at, utc_of};

/// Returns the latitude in degrees at a Unix time.
fn latitude_deg(trajectory: &mut Trajectory, unix_us: u64) -> f64 {
    let utc = UtcTime {
        unix_us,
        sigma_s: 0.0,
    };
    match trajectory.at(Some(utc)).unwrap().unwrap().place {
        Place::Geographic(place) => place.latitude_rad.to_degrees(),
        other @ Place::Cartesian(_) => panic!("{other:?}"),
    }
}

/// Latitude of [`Motion::SWISS`] in degrees.
fn expected_deg(t: f64) -> f64 {
    Motion::SWISS.at(t)[0].to_degrees()
}

#[test]
fn every_column_of_time_leads_to_the_same_instant() {
    let motion = Motion::SWISS;
    let first = 1000.0;
    let text = table(motion, first, 10.0, 300);
    // 18 leap seconds between the GPS time of the trajectory and the UTC of the exposure.
    let unix_us = (u64::from(SUNDAY_UNIX_S) + 1000 - 18 + 12) * 1_000_000 + 340_000;
    let other = |name: &str, of: &dyn Fn(f64) -> String| {
        let lines = text.lines().map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let time = match cells[1].parse::<f64>() {
                Ok(time) => of(time),
                Err(_) => name.to_owned(),
            };
            format!("{time},{}", cells[2..].join(","))
        });
        lines.collect::<Vec<_>>().join("\r\n")
    };
    let unix = |time: f64| f64::from(SUNDAY_UNIX_S) + time - SUNDAY_GPS_S;
    let tables = [
        text.clone(),
        format!("\u{feff}{}", text.replace('\n', "\r\n")),
        other("gps_week,gps_seconds_of_week", &|time| {
            format!("{SUNDAY_GPS_WEEK},{time}")
        }),
        other("unix_s", &|time| format!("{:.6}", unix(time))),
        other("unix_us", &|time| format!("{:.0}", unix(time) * 1e6)),
    ];
    for text in tables {
        let mut trajectory = TrajectoryFile::with(text.as_bytes()).opened();
        let found = latitude_deg(&mut trajectory, unix_us);
        assert!((found - expected_deg(12.34)).abs() < 1e-9, "{found}");
    }
    let bytes = sbet(motion, first, 200.0, 6000);
    let file = TrajectoryFile::with(&bytes);
    let found = latitude_deg(&mut file.opened(), unix_us);
    assert!((found - expected_deg(12.34)).abs() < 1e-12);
    // The same numbers as seconds of the week of UTC are 18 s later.
    let options = TrajectoryOptions {
        scale: Some(TimeScale::Utc),
        ..TrajectoryOptions::default()
    };
    let mut trajectory = file.open(&options).unwrap();
    let found = latitude_deg(&mut trajectory, unix_us + 18_000_000);
    assert!((found - expected_deg(12.34)).abs() < 1e-12);
}

#[test]
fn a_table_that_states_the_week_does_not_serve_another() {
    let text = table(Motion::SWISS, 1000.0, 10.0, 300);
    let text = text.replace("quality", "gps_week");
    let text = text.replace("\n1,", &format!("\n{},", SUNDAY_GPS_WEEK - 1));
    let file = TrajectoryFile::with(text.as_bytes());
    let mut trajectory = file.opened();
    assert!(trajectory.has_week());
    assert_eq!(
        at(&mut trajectory, 1012.0),
        Err(Unavailable::Outside {
            time_s: 605_812.0,
            first_s: 1000.0,
            last_s: 1029.9,
            scale: TimeScale::Gps,
        })
    );
    assert!(at(&mut trajectory, 1012.0 - 604_800.0).is_ok());
}

#[test]
fn flight_goes_on_where_the_week_turns() {
    let motion = Motion::SWISS;
    for turns_over in [true, false] {
        let start = 604_790.0;
        let bytes: Vec<u8> = (0..8000)
            .flat_map(|index| {
                let t = f64::from(index) / 200.0;
                let time = start + t;
                let time = if turns_over && time >= 604_800.0 {
                    time - 604_800.0
                } else {
                    time
                };
                record(time, &motion.at(t), -0.2)
            })
            .collect();
        let mut trajectory = TrajectoryFile::with(&bytes).opened();
        assert_eq!(trajectory.gaps(), 0);
        for t in [3.0, 9.998, 10.0, 10.001, 25.0, 4.0] {
            // Times of the exposures are those of the week before until it turns.
            let utc = utc_of(start - 604_800.0 + t, 0.0);
            let found = latitude_deg(&mut trajectory, utc.unix_us);
            assert!((found - expected_deg(t)).abs() < 1e-11, "{t}");
        }
    }
}

#[test]
fn exposures_in_any_order_have_the_numbers_of_those_in_order() {
    let mut trajectory = TrajectoryFile::with(&sbet(Motion::SWISS, 5e4, 100.0, 20_000)).opened();
    let mut times: Vec<f64> = (0..500).map(|index| 5e4 + 0.4 * f64::from(index)).collect();
    let ascending: Vec<_> = times
        .iter()
        .map(|time| at(&mut trajectory, *time).unwrap())
        .collect();
    let mut shuffled: Vec<usize> = (0..times.len()).collect();
    fastrand::Rng::with_seed(4).shuffle(&mut shuffled);
    for place in shuffled {
        assert_eq!(at(&mut trajectory, times[place]).unwrap(), ascending[place]);
    }
    // First and last sample.
    times = vec![5e4, 5e4 + 199.99];
    assert!(times.iter().all(|time| at(&mut trajectory, *time).is_ok()));
}

#[test]
fn exposures_outside_and_in_gaps_have_no_orientation_and_the_reason() {
    let motion = Motion::SWISS;
    let mut bytes = sbet(motion, 1000.0, 10.0, 100);
    bytes.extend((0..100).flat_map(|index| {
        let t = 20.0 + f64::from(index) / 10.0;
        record(1000.0 + t, &motion.at(t), 0.0)
    }));
    // Two samples alone.
    bytes.extend(
        [50.0, 50.1]
            .iter()
            .flat_map(|t| record(1000.0 + t, &motion.at(*t), 0.0)),
    );
    let mut trajectory = TrajectoryFile::with(&bytes).opened();
    assert_eq!(trajectory.gaps(), 2);
    let reason = |found: Result<_, Unavailable>| found.unwrap_err().to_string();
    assert_eq!(
        reason(at(&mut trajectory, 999.999)),
        "its centroid at 999.999 s of the week (GPS) is outside the trajectory, 1000.000 to 1050.100 s"
    );
    assert_eq!(
        reason(at(&mut trajectory, 1015.0)),
        "the samples about its centroid are 10.100 s from each other; allowed are 1.5 s"
    );
    assert_eq!(
        reason(at(&mut trajectory, 1050.05)),
        "about its centroid there are fewer than three samples between gaps"
    );
    assert_eq!(
        reason(trajectory.at(None).unwrap()),
        "its centroid has no UTC"
    );
    // The last interval before a gap has the samples before it alone.
    let found = at(&mut trajectory, 1009.85).unwrap();
    let Place::Geographic(place) = found.place else {
        panic!("{found:?}");
    };
    let off_m = (place.latitude_rad - motion.at(9.85)[0]) * 6.37e6;
    assert!(off_m.abs() < 1e-4, "{off_m}");
    let longer = TrajectoryOptions {
        longest_gap_s: 11.0,
        ..TrajectoryOptions::default()
    };
    let mut trajectory = TrajectoryFile::with(&bytes).open(&longer).unwrap();
    let found = at(&mut trajectory, 1015.0).unwrap();
    let [_, _, up] = found.interpolation_sigma.position_m;
    assert!(up > 0.1, "{up}");
}
