//! Simulated block of aerial images with the records of a camera whose detector moves: four strips
//! of ten frames to and fro, f = 50 mm, 700 m above ground, 60 and 30 % overlap.

use std::fmt::Write as _;
use std::fs;

use fastrand::Rng;

use crate::command_line::support::Bench;

const CAMERA: &str = "name = \"Block\"\nprincipal_distance_mm = 50.0\n\
                      principal_point_mm = [0.02, -0.01]\n\
                      [sensor]\nwidth_px = 14204\nheight_px = 10652\npixel_um = 3.76\n\
                      [distortion]\nsign = \"distortion\"\nk1 = -2.0e-6\n\
                      [fmc]\nstroke_mm = 1.0\n";

const F_MM: f64 = 50.0;
const PRINCIPAL_POINT_MM: [f64; 2] = [0.02, -0.01];
const K1: f64 = -2e-6;
const HEIGHT_M: f64 = 700.0;
const HALF_MM: [f64; 2] = [26.7, 20.0];

/// σ of image points, 0.3 px of 3.76 µm, mm; of positions, m; of pitch, roll and yaw, degrees.
const SIGMA_MM: f64 = 1.128e-3;
const GNSS_M: [f64; 3] = [0.03, 0.03, 0.04];
const ATTITUDE_DEG: [f64; 3] = [0.003, 0.003, 0.006];

/// Centroid of the exposure after the trigger, s: as in MODEL.md 2, 5 ms settling, 1/300 s.
const CENTROID_S: f64 = 0.012;

/// Strategy of the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RunUp {
    /// From rest at the calibrated position.
    FromRest,
    /// The centroid falls on the calibrated principal point within 0.05 µm.
    Centred,
}

/// A block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block {
    pub(crate) run_up: RunUp,
    pub(crate) seed: u64,
    /// Error of the record of frame 18, mm.
    pub(crate) fault_mm: f64,
    /// `true` for positions stated at the triggers.
    pub(crate) at_trigger: bool,
    /// s: scale of the encoder.
    pub(crate) scale: f64,
}

/// Standard normal deviate (Box and Muller 1958).
fn normal(random: &mut Rng) -> f64 {
    let (u, v) = (1.0 - random.f64(), random.f64());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

impl Block {
    /// c̄ at a speed over ground, mm: run-up at 1 m/s², 5 ms settling, half of 1/300 s.
    fn offset_mm(&self, speed_m_s: f64, random: &mut Rng) -> f64 {
        let v = F_MM * speed_m_s / HEIGHT_M;
        match self.run_up {
            RunUp::FromRest => v * v / 2000.0 + v * (0.005 + 1.0 / 600.0),
            RunUp::Centred => 1e-4 * (random.f64() - 0.5),
        }
    }

    /// Writes `camera.toml`, `image_points.csv`, `points.csv`, `images.csv` and `records.csv`.
    pub(crate) fn bench(&self) -> Bench {
        let mut random = Rng::with_seed(self.seed);
        let ground = ground();
        let mut rays: Vec<(u32, usize, [f64; 2])> = Vec::new();
        let mut images =
            "image,x_m,y_m,z_m,pitch_deg,roll_deg,yaw_deg,sigma_x_m,sigma_y_m,sigma_z_m,\
                          sigma_pitch_deg,sigma_roll_deg,sigma_yaw_deg,vx_m_s,vy_m_s,vz_m_s,strip\n"
                .to_owned();
        let mut records = "sequence,trigger_us,outcome,centroid_us,principal_point_x_mm,\
                           principal_point_y_mm,principal_point_sigma_mm,centroid_offset_mm,\
                           focus_shift_mm\n"
            .to_owned();
        for frame in 1..=40_u32 {
            let (strip, place) = ((frame - 1) / 10, f64::from((frame - 1) % 10));
            // Downwind and upwind; e = +y of the sensor points along the flight.
            let (sign, speed) = if strip % 2 == 0 {
                (1.0, 90.0)
            } else {
                (-1.0, 60.0)
            };
            let along = if sign > 0.0 { place } else { 9.0 - place };
            let centre = [224.0 * along, 523.0 * f64::from(strip), HEIGHT_M];
            let offset = self.offset_mm(speed, &mut random);
            let focus_shift = 0.004 * (random.f64() - 0.5);
            let enlarged = 1.0 + focus_shift / F_MM;
            for (number, [x, y, z]) in ground.iter().enumerate() {
                let depth = centre[2] - z;
                // Camera axes: y along the flight, x to its right.
                let ideal = [
                    -F_MM * sign * (y - centre[1]) / depth,
                    F_MM * sign * (x - centre[0]) / depth,
                ];
                let mut about = ideal;
                for _ in 0..30 {
                    let r2 = about[0] * about[0] + about[1] * about[1];
                    about = [0, 1].map(|axis| ideal[axis] + K1 * r2 * about[axis]);
                }
                let noise = [normal(&mut random), normal(&mut random)];
                let measured = [0, 1].map(|axis| {
                    let e = [0.0, 1.0][axis];
                    PRINCIPAL_POINT_MM[axis]
                        + (1.0 + self.scale) * offset * e
                        + enlarged * about[axis]
                        + SIGMA_MM * noise[axis]
                });
                if measured[0].abs() < HALF_MM[0] && measured[1].abs() < HALF_MM[1] {
                    rays.push((frame, number, measured));
                }
            }
            let velocity = sign * speed;
            let before = if self.at_trigger {
                velocity * CENTROID_S
            } else {
                0.0
            };
            let [x, y, z] = [0, 1, 2].map(|axis| centre[axis] + GNSS_M[axis] * normal(&mut random));
            let [pitch, roll, yaw] = ATTITUDE_DEG.map(|sigma| sigma * normal(&mut random));
            writeln!(
                images,
                "{frame},{},{y},{z},{pitch},{roll},{},0.03,0.03,0.04,0.003,0.003,0.006,{velocity},0,0,s{strip}",
                x - before,
                yaw - 90.0 * sign,
            )
            .unwrap();
            let recorded = offset + if frame == 18 { self.fault_mm } else { 0.0 };
            writeln!(
                records,
                "{frame},{},exposed,{},{},{},0.0005,{recorded},{focus_shift}",
                2_000_000 * frame,
                2_000_000 * frame + 12_000,
                PRINCIPAL_POINT_MM[0],
                PRINCIPAL_POINT_MM[1] + recorded,
            )
            .unwrap();
        }
        let [image_points, points] = point_tables(&ground, &rays);
        let bench = Bench::with(CAMERA, b"");
        for (name, text) in [
            ("image_points.csv", image_points),
            ("points.csv", points),
            ("images.csv", images),
            ("records.csv", records),
        ] {
            fs::write(bench.path(name), text).unwrap();
        }
        bench
    }
}

/// Returns points on a grid of 100 m, 60 m of relief, all of them the same for every seed.
fn ground() -> Vec<[f64; 3]> {
    let mut field = Rng::with_seed(11);
    (0..26 * 24)
        .map(|number| {
            let mut jitter = || 60.0 * (field.f64() - 0.5);

            let (column, row) = (f64::from(number % 26), f64::from(number / 26));
            [
                100.0 * column - 230.0 + jitter(),
                100.0 * row - 330.0 + jitter(),
                0.9 * jitter() + 28.0,
            ]
        })
        .collect()
}

/// Returns the text of `image_points.csv` and `points.csv`: a third of the inner points is check.
fn point_tables(ground: &[[f64; 3]], rays: &[(u32, usize, [f64; 2])]) -> [String; 2] {
    let mut seen = vec![0; ground.len()];
    for (_, number, _) in rays {
        seen[*number] += 1;
    }
    let mut image_points = "image,point,x_mm,y_mm,sigma_um\n".to_owned();
    for (frame, number, [x, y]) in rays.iter().filter(|(_, number, _)| seen[*number] > 1) {
        writeln!(image_points, "{frame},p{number},{x},{y},1.128").unwrap();
    }
    let mut points = "point,x_m,y_m,z_m,role\n".to_owned();
    for (number, [x, y, z]) in ground.iter().enumerate().filter(|(_, point)| {
        // The edge of the block has two rays alone.
        (100.0..1900.0).contains(&point[0]) && (0.0..1500.0).contains(&point[1])
    }) {
        if number % 3 == 0 && seen[number] > 1 {
            writeln!(points, "p{number},{x},{y},{z},check").unwrap();
        }
    }
    [image_points, points]
}
