//! Observation files for `calibrate five`, made from the five-coefficient model as it is published.

use std::fmt::Write as _;

/// One row of a file, as numbers.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub(crate) x_mm: f64,
    pub(crate) y_mm: f64,
    pub(crate) dx_um: f64,
    pub(crate) dy_um: f64,
    pub(crate) vh: f64,
    pub(crate) exposure_s: f64,
    pub(crate) offset_mm: f64,
}

/// Coefficients of the observations, `km0`, `km1`, `km2`, `kd1`, `pm1`: per mm of δ.
pub(crate) const TRUTH: [f64; 5] = [1.5e-4, -1.1e-6, 2.2e-10, 3e-6, 1.4e-6];

/// Returns the distortion by the model for `support::CAMERA`: f = 100 mm, e = +y, principal point
/// (0.02, -0.01) mm.
pub(crate) fn distortion_um(
    [km0, km1, km2, kd1, pm1]: [f64; 5],
    x: f64,
    y: f64,
    s: f64,
) -> [f64; 2] {
    let (x, y) = (x - 0.02, y + 0.01);
    let r2 = x * x + y * y;
    let (p1, p2, b1, b2) = (1e-6, -2e-6, 1e-5, 2e-5);
    let radial = km0 + km1 * r2 + km2 * r2 * r2;
    [
        x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y + kd1 * s * x * y,
        y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y + kd1 * s * y * y + pm1 * s * r2,
    ]
    .map(|mm| 1000.0 * mm)
}

/// Returns `steps` x `steps` points over the sensor in each of these exposures, opening at Δδ = 0.
pub(crate) fn rows(exposures: &[(f64, f64)], steps: i32) -> Vec<Row> {
    let place = |index: i32| 40.0 * (2.0 * f64::from(index) / f64::from(steps - 1) - 1.0);
    let mut rows = Vec::new();
    for (vh, exposure_s) in exposures {
        for index in 0..steps * steps {
            let (x_mm, y_mm) = (place(index % steps), place(index / steps));
            let [dx_um, dy_um] = distortion_um(TRUTH, x_mm, y_mm, 100.0 * vh * exposure_s);
            rows.push(Row {
                x_mm,
                y_mm,
                dx_um,
                dy_um,
                vh: *vh,
                exposure_s: *exposure_s,
                offset_mm: 0.0,
            });
        }
    }
    rows
}

pub(crate) const EXPOSURES: [(f64, f64); 6] = [
    (0.05, 0.002),
    (0.05, 0.01),
    (0.1, 0.005),
    (0.1, 0.01),
    (0.17, 0.005),
    (0.17, 0.01),
];

/// Normal random numbers of standard deviation 1, the same in every run.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let high = u32::try_from(self.0 >> 32).unwrap();
        (f64::from(high) + 0.5) / 4_294_967_296.0
    }

    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Returns rows with normal errors of `sigma_um`.
pub(crate) fn noisy(mut rows: Vec<Row>, sigma_um: f64, seed: u64) -> Vec<Row> {
    let mut noise = Noise(seed);
    for row in &mut rows {
        row.dx_um += sigma_um * noise.normal();
        row.dy_um += sigma_um * noise.normal();
    }
    rows
}

/// Returns a file with all columns but `sigma_um`.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = String::from("id,x_mm,y_mm,dx_um,dy_um,vh_per_s,exposure_s,opening_offset_mm\n");
    for (index, row) in rows.iter().enumerate() {
        let Row {
            x_mm,
            y_mm,
            dx_um,
            dy_um,
            vh,
            exposure_s,
            offset_mm,
        } = row;
        writeln!(
            text,
            "p{index},{x_mm},{y_mm},{dx_um},{dy_um},{vh},{exposure_s},{offset_mm}"
        )
        .unwrap();
    }
    text
}
