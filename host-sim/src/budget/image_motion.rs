//! Residual smear of a nadir camera in closed form. To be replaced by `geometry::image_motion` of
//! the library.
//!
//! Camera axes x right, y forward; ẋ = -f·d(Px/Pz)/dt with Ṗ = -T - ω x P.

/// Smear of an error of V/H: the compensation is off by that fraction of δ.
pub(super) fn of_vh_error(travel_mm: f64, relative: f64) -> f64 {
    travel_mm * relative
}

/// Smear of terrain higher by the fraction `relief` of H: it passes faster by 1/(1 - relief).
pub(super) fn of_relief(travel_mm: f64, relief: f64) -> f64 {
    travel_mm * (1.0 / (1.0 - relief) - 1.0)
}

/// Smear across the track of a drift angle: δ·sinχ.
pub(super) fn of_drift(travel_mm: f64, drift_rad: f64) -> f64 {
    travel_mm * drift_rad.sin()
}

/// Smear of a pitch rate at the point (x, y): f·ω·t·(xy/f², 1 + y²/f²); of a roll rate with x and y
/// exchanged.
pub(super) fn of_tilt_rate(f_mm: f64, [x, y]: [f64; 2], angle_rad: f64) -> f64 {
    let (a, b) = (x / f_mm, y / f_mm);
    let pitch = (a * b).hypot(1.0 + b * b);
    let roll = (a * b).hypot(1.0 + a * a);
    f_mm * angle_rad * pitch.max(roll)
}

/// Smear of a yaw rate: r·ω·t.
pub(super) fn of_yaw_rate([x, y]: [f64; 2], angle_rad: f64) -> f64 {
    x.hypot(y) * angle_rad
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = 100 mm, 80.64 mm square, V/H 0.10 1/s, 1/300 s: δ = 33.3 µm.
    #[test]
    fn smear_of_the_reference_case() {
        let (f, corner, travel) = (100.0, [40.32, 40.32], 0.1 / 3.0);
        let turned = 1.0_f64.to_radians() / 300.0;
        for (found_mm, expected_um) in [
            (of_vh_error(travel, 0.01), 0.33),
            (of_relief(travel, 0.1), 3.70),
            (of_drift(travel, 5.0_f64.to_radians()), 2.91),
            (of_tilt_rate(f, corner, turned), 6.8),
            (of_yaw_rate(corner, turned), 3.3),
        ] {
            // Half a unit in the last place of the expected numbers.
            assert!((1e3 * found_mm - expected_um).abs() < 0.05, "{found_mm}");
        }
    }
}
