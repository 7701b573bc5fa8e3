//! A flight in turbulent air, and files of it.

use std::fmt::Write;

/// Latitude, longitude, rad, height, m, roll, pitch, heading, rad.
pub(crate) type Numbers = [f64; 6];

/// A flight with a heading near north, so that it turns over, and with motions of several periods.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    pub(crate) latitude: f64,
    pub(crate) longitude: f64,
    /// Multiplies all motions but the straight flight.
    pub(crate) turbulence: f64,
}

impl Motion {
    pub(crate) const SWISS: Self = Self {
        latitude: 0.83,
        longitude: 0.145,
        turbulence: 1.0,
    };

    /// Returns the numbers `t` seconds after the flight began.
    pub(crate) fn at(&self, t: f64) -> Numbers {
        let wave = |amplitude: f64, period: f64, phase: f64| {
            self.turbulence * amplitude * (t * std::f64::consts::TAU / period + phase).sin()
        };
        // 75 m/s to the north, with 3 m of sway in 12 s and 1 m of heave in 9 s.
        let metres_per_rad = 6.37e6;
        let north = 75.0 * t + wave(0.3, 7.0, 0.4);
        let east = wave(3.0, 12.0, 0.0);
        [
            self.latitude + north / metres_per_rad,
            self.longitude + east / metres_per_rad / self.latitude.cos(),
            1650.0 + wave(1.0, 9.0, 1.0),
            wave(0.04, 6.0, 0.3),
            0.02 + wave(0.01, 5.0, 2.0),
            wave(0.03, 11.0, 0.0),
        ]
    }
}

/// Returns a record of an SBET file; the wander angle is `wander`.
pub(crate) fn record(time_s: f64, numbers: &Numbers, wander: f64) -> Vec<u8> {
    let [latitude, longitude, height, roll, pitch, heading] = *numbers;
    let heading = (heading + wander).rem_euclid(std::f64::consts::TAU);
    let all = [
        time_s, latitude, longitude, height, 7e7, -7e7, 7e7, roll, pitch, heading, wander, 0.0,
        0.0, 9.8, 0.0, 0.0, 0.0,
    ];
    all.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Returns an SBET file from `first_s` on.
pub(crate) fn sbet(motion: Motion, first_s: f64, rate_hz: f64, count: u32) -> Vec<u8> {
    let times = (0..count).map(|index| f64::from(index) / rate_hz);
    times
        .flat_map(|t| record(first_s + t, &motion.at(t), 0.7))
        .collect()
}

/// Returns a table in CSV from a second of the GPS week on.
pub(crate) fn table(motion: Motion, first_s: f64, rate_hz: f64, count: u32) -> String {
    let mut text = String::from(
        "quality,gps_seconds_of_week,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,heading_deg\n",
    );
    for t in (0..count).map(|index| f64::from(index) / rate_hz) {
        let [latitude, longitude, height, roll, pitch, heading] = motion.at(t);
        writeln!(
            text,
            "1,{},{},{},{height},{},{},{}",
            first_s + t,
            latitude.to_degrees(),
            longitude.to_degrees(),
            roll.to_degrees(),
            pitch.to_degrees(),
            heading.to_degrees().rem_euclid(360.0)
        )
        .unwrap();
    }
    text
}
