//! Columns of the exterior orientation of a frame.

use fmc_frames::trajectory::{ImageOrientation, OrientationSigma, Place, Unavailable};
use serde::Serialize;

/// The exterior orientation of a frame: of the navigation body, at the centroid. What is not known
/// is empty.
#[derive(Debug, Default, Serialize)]
pub(super) struct OrientationColumns {
    latitude_deg: Option<f64>,
    longitude_deg: Option<f64>,
    height_m: Option<f64>,
    x_m: Option<f64>,
    y_m: Option<f64>,
    z_m: Option<f64>,
    pitch_deg: Option<f64>,
    roll_deg: Option<f64>,
    yaw_deg: Option<f64>,
    sigma_x_m: Option<f64>,
    sigma_y_m: Option<f64>,
    sigma_z_m: Option<f64>,
    sigma_pitch_deg: Option<f64>,
    sigma_roll_deg: Option<f64>,
    sigma_yaw_deg: Option<f64>,
    vx_m_s: Option<f64>,
    vy_m_s: Option<f64>,
    vz_m_s: Option<f64>,
    time_sigma_m: Option<f64>,
    time_sigma_deg: Option<f64>,
    interpolation_sigma_m: Option<f64>,
    interpolation_sigma_deg: Option<f64>,
    no_orientation: Option<String>,
}

impl OrientationColumns {
    pub(super) fn of(found: Result<ImageOrientation, Unavailable>) -> Self {
        let orientation = match found {
            Ok(orientation) => orientation,
            Err(reason) => {
                return Self {
                    no_orientation: Some(reason.to_string()),
                    ..Self::default()
                };
            }
        };
        let (geographic, [x_m, y_m, z_m]) = match orientation.place {
            Place::Geographic(place) => (Some(place), [None; 3]),
            Place::Cartesian(place) => (None, place.map(|metres| Some(decimals(metres, 1e6)))),
        };
        let degrees = |angle_rad: f64| Some(decimals(angle_rad.to_degrees(), 1e9));
        let attitude = orientation.attitude;
        let sigma = orientation.sigma();
        let [sigma_x_m, sigma_y_m, sigma_z_m] = sigma.map_or([None; 3], |sigma| {
            sigma.position_m.map(|metres| Some(decimals(metres, 1e6)))
        });
        let [sigma_pitch_deg, sigma_roll_deg, sigma_yaw_deg] =
            sigma.map_or([None; 3], |sigma| sigma.angles_rad.map(degrees));
        let [vx_m_s, vy_m_s, vz_m_s] = orientation
            .velocity_m_s
            .map(|speed| Some(decimals(speed, 1e4)));
        let [time_m, time_rad] = lengths(&orientation.time_sigma);
        let [interpolation_m, interpolation_rad] = lengths(&orientation.interpolation_sigma);
        Self {
            latitude_deg: geographic.map(|place| place.latitude_rad.to_degrees()),
            longitude_deg: geographic.map(|place| place.longitude_rad.to_degrees()),
            height_m: geographic.map(|place| decimals(place.height_m, 1e6)),
            x_m,
            y_m,
            z_m,
            pitch_deg: degrees(attitude.pitch_rad),
            roll_deg: degrees(attitude.roll_rad),
            yaw_deg: degrees(attitude.yaw_rad),
            sigma_x_m,
            sigma_y_m,
            sigma_z_m,
            sigma_pitch_deg,
            sigma_roll_deg,
            sigma_yaw_deg,
            vx_m_s,
            vy_m_s,
            vz_m_s,
            time_sigma_m: Some(decimals(time_m, 1e6)),
            time_sigma_deg: degrees(time_rad),
            interpolation_sigma_m: Some(decimals(interpolation_m, 1e6)),
            interpolation_sigma_deg: degrees(interpolation_rad),
            no_orientation: None,
        }
    }
}

/// Returns a number with as many decimals as `scale` has zeros.
fn decimals(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}

/// Returns the lengths of the vectors of σ, m and rad.
fn lengths(sigma: &OrientationSigma) -> [f64; 2] {
    [sigma.position_m, sigma.angles_rad].map(|[a, b, c]| a.hypot(b).hypot(c))
}
