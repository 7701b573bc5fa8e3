//! Coordinates about an origin, against PROJ.

use fmc_frames::trajectory::{
    Attitude, GeographicPlace, ImageOrientation, OrientationSigma, Place,
};

/// Latitude, longitude and height, and east, north and up about 47.5°, 8.25° and 450 m by PROJ
/// 9.5.1: `+proj=cart +ellps=WGS84`, then `+proj=topocentric +lat_0=47.5 +lon_0=8.25 +h_0=450`.
const PROJ: [([f64; 3], [f64; 3]); 3] = [
    (
        [47.6, 8.4, 1650.0],
        [11_282.957_710, 11_131.919_545, 1_180.317_001],
    ),
    (
        [47.43, 8.1, 1655.5],
        [-11_319.467_590, -7_773.689_764, 1_190.734_333],
    ),
    (
        [-33.9, 151.2, 900.0],
        [3_193_432.678_328, 750_027.313_102, -11_833_115.588_787],
    ),
];

fn place([latitude_deg, longitude_deg, height_m]: [f64; 3]) -> GeographicPlace {
    GeographicPlace {
        latitude_rad: f64::to_radians(latitude_deg),
        longitude_rad: f64::to_radians(longitude_deg),
        height_m,
    }
}

fn orientation(geographic: [f64; 3]) -> ImageOrientation {
    ImageOrientation {
        place: Place::Geographic(place(geographic)),
        attitude: Attitude {
            pitch_rad: 0.0,
            roll_rad: 0.0,
            yaw_rad: 0.3,
        },
        velocity_m_s: [0.0, 75.0, 0.0],
        trajectory_sigma: Some(OrientationSigma {
            position_m: [0.02, 0.03, 0.05],
            angles_rad: [1e-4; 3],
        }),
        time_sigma: OrientationSigma::default(),
        interpolation_sigma: OrientationSigma::default(),
    }
}

#[test]
fn coordinates_about_an_origin_are_those_of_proj() {
    let origin = place([47.5, 8.25, 450.0]);
    for (geographic, expected) in PROJ {
        let found = orientation(geographic).about(&origin);
        let Place::Cartesian(found) = found.place else {
            panic!("{found:?}");
        };
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-6, "{found} {expected}");
        }
    }
}

#[test]
fn angles_about_an_origin_contain_convergence_and_the_bend_of_the_earth() {
    let origin = place([47.5, 8.25, 450.0]);
    let east = orientation([47.5, 8.4, 450.0]).about(&origin);
    // Meridians converge by Δλ·sin φ: north of a place to the east points to the left.
    let convergence = 0.15_f64.to_radians() * 47.5_f64.to_radians().sin();
    assert!((east.attitude.yaw_rad - 0.3 - convergence).abs() < 1e-6);
    // The vertical there leans to the east by Δλ·cos φ: right of the origin's north is down.
    let lean = 0.15_f64.to_radians() * 47.5_f64.to_radians().cos();
    assert!((east.attitude.roll_rad - lean * 0.3_f64.cos()).abs() < 1e-5);
    assert!((east.attitude.pitch_rad - lean * 0.3_f64.sin()).abs() < 1e-5);
    let [vx, vy, _] = east.velocity_m_s;
    assert!((vx + 75.0 * convergence).abs() < 1e-3 && (vy - 75.0).abs() < 1e-3);
    let sigma = east.sigma().unwrap();
    let sum = |sigma: [f64; 3]| sigma.map(|one| one * one).iter().sum::<f64>();
    assert!((sum(sigma.position_m) - sum([0.02, 0.03, 0.05])).abs() < 1e-15);
    let here = orientation([47.5, 8.25, 450.0]).about(&origin);
    assert!((here.attitude.yaw_rad - 0.3).abs() < 1e-15);
}
