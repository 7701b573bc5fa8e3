//! Coefficients with every term, for tests and timing.

use fmc_camera_kernel::Coefficients;

/// Coefficients of a wide-angle camera, with every term; their f32 products neither vanish nor
/// overflow on the sensor.
pub(crate) const FORM: Coefficients = Coefficients {
    cx: 0.0123,
    cy: -0.0711,
    k0: 3.1e-5,
    k1: -2.3e-7,
    k2: 4.7e-11,
    k3: -6.1e-15,
    hx: 1.3e-7,
    hy: -2.9e-7,
    gx: 5.3e-7,
    gy: 7.1e-8,
    b1: -1.1e-5,
    b2: 2.3e-5,
    tx: 3.7e-6,
    ty: -4.1e-6,
};
