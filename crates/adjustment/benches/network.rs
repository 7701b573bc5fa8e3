//! Time and memory of a self-calibrating bundle of aerial images: 60 % overlap along the strips,
//! 30 % across, positions and attitudes observed on board, eight shared unknowns.
//!
//! `cargo bench -p fmc-adjustment --bench network [-- IMAGES POINTS_PER_IMAGE [PERCENT]]`, as
//! defaults 1,000 images and 250 points each. With PERCENT that part of the image points is 5 to
//! 50 σ wrong, and they are searched for. Prints CSV: what, seconds, and the largest memory.

use std::time::Instant;

use fastrand::Rng;
use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::image::{NetworkImage, ObservedPose};
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network::{ImagePoint, Network, ObjectPoint, PointRole};
use fmc_adjustment::bundle::parameters::{Parameter, SharedValues};
use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::snooping::snooped;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;
use fmc_adjustment::bundle::tested::Tests;
use nalgebra::{Rotation3, Vector3};

/// Flying height, m, principal distance, mm, half format, mm.
const HEIGHT_M: f64 = 1000.0;
const F_MM: f64 = 50.0;
const HALF_MM: [f64; 2] = [26.7, 20.0];
const SIGMA_MM: f64 = 1e-3;

fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap_or(u32::MAX))
}

fn normal(random: &mut Rng) -> f64 {
    let (u, v) = (1.0 - random.f64(), random.f64());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn block(images: usize, points_per_image: usize) -> Network {
    let mut random = Rng::with_seed(1);
    let [width, height] = HALF_MM.map(|half| 2.0 * half * HEIGHT_M / F_MM);
    let (base, spacing) = (0.4 * height, 0.7 * width);
    // Strips such that the block is about square.
    let strip_count = (1..=images)
        .find(|strips| count(*strips) * spacing * count(*strips) >= count(images) * base)
        .unwrap_or(1);
    let place_count = images.div_ceil(strip_count);
    let (strips, per_strip) = (count(strip_count), count(place_count));
    let (list, truth) = flown(images, [base, spacing], per_strip, &mut random);
    let area = [strips * spacing + width, per_strip * base + height];
    let density = count(points_per_image) / (width * height);
    let mut remaining = density * area[0] * area[1];
    let (mut points, mut image_points) = (Vec::new(), Vec::new());
    let reach = 1.3;
    while remaining > 0.0 {
        remaining -= 1.0;
        let ground = Vector3::new(
            random.f64() * area[0] - 0.5 * width,
            random.f64() * area[1] - 0.5 * height,
            80.0 * (random.f64() - 0.5),
        );
        let mut rays = Vec::new();
        let near = |value: f64, step: f64, half: f64| {
            (value - reach * half) / step..=(value + reach * half) / step
        };
        let strip_range = near(ground.x, spacing, 0.5 * width);
        let place_range = near(ground.y, base, 0.5 * height);
        for strip in 0..strip_count {
            if !strip_range.contains(&count(strip)) {
                continue;
            }
            for place in 0..place_count {
                let image = strip * place_count + place;
                if place_range.contains(&count(place))
                    && let Some(pose) = truth.get(image)
                {
                    let u = pose.in_camera(&ground);
                    let [x, y] = [-F_MM * u.x / u.z, -F_MM * u.y / u.z];
                    let [half_x, half_y] = HALF_MM;
                    if x.abs() < half_x && y.abs() < half_y {
                        rays.push((image, [x, y]));
                    }
                }
            }
        }
        if rays.len() < 2 {
            continue;
        }
        let point = points.len();
        points.push(ObjectPoint {
            name: point.to_string(),
            given_m: ground + Vector3::from_fn(|_, _| 0.05 * normal(&mut random)),
            sigmas_m: [None; 3],
            role: PointRole::Tie,
        });
        for (image, [x, y]) in rays {
            image_points.push(ImagePoint {
                image,
                point,
                measured_mm: [
                    x + SIGMA_MM * normal(&mut random),
                    y + SIGMA_MM * normal(&mut random),
                ],
                by_grids_mm: [0.0; 2],
                sigma_mm: SIGMA_MM,
                additional: None,
                accepted: true,
            });
        }
    }
    network(list, points, image_points)
}

/// Returns the images with observed poses, and the true ones.
fn flown(
    images: usize,
    [base, spacing]: [f64; 2],
    per_strip: f64,
    random: &mut Rng,
) -> (Vec<NetworkImage>, Vec<Pose>) {
    let mut list = Vec::new();
    let mut truth = Vec::new();
    let mut noisy = |sigma: f64| Vector3::from_fn(|_, _| sigma * normal(random));
    for number in 0..images {
        let strip = (count(number) / per_strip).floor();
        let place = count(number) - strip * per_strip;
        let position = Vector3::new(strip * spacing, place * base, HEIGHT_M) + noisy(10.0);
        let pose = Pose {
            position_m: position,
            rotation: Rotation3::from_scaled_axis(noisy(0.01)),
        };
        let start = Pose {
            position_m: position + noisy(0.04),
            rotation: Rotation3::from_scaled_axis(noisy(5e-5)) * pose.rotation,
        };
        let angle = Some(5e-5);
        truth.push(pose);
        list.push(NetworkImage {
            name: number.to_string(),
            pose: start,
            observed: Some(ObservedPose {
                pose: start,
                sigmas: [Some(0.04), Some(0.04), Some(0.04), angle, angle, angle],
                velocity_m_s: None,
                strip: None,
            }),
            stage: None,
        });
    }
    (list, truth)
}

fn network(
    images: Vec<NetworkImage>,
    points: Vec<ObjectPoint>,
    image_points: Vec<ImagePoint>,
) -> Network {
    let mut network = Network {
        images,
        points,
        image_points,
        additional: Vec::new(),
        scale_bars: Vec::new(),
        strips: Vec::new(),
        parameters: SharedValues::new(
            Interior {
                principal_distance_mm: F_MM,
                principal_point_mm: [0.0; 2],
                k: [0.0; 4],
                p: [0.0; 2],
                b: [0.0; 2],
            },
            0,
        ),
        estimated: InteriorElement::ALL
            .into_iter()
            .take(8)
            .map(Parameter::Interior)
            .collect(),
        priors: Vec::new(),
    };
    network.sort();
    network
}

/// Largest resident memory of the process, MB; 0 where the system does not tell.
fn memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.trim().split(' ').next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) / 1024.0
}

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .filter_map(|text| text.parse().ok())
        .collect();
    let images = numbers.first().copied().unwrap_or(1000);
    let points = numbers.get(1).copied().unwrap_or(250);
    let network = block(images, points);
    println!(
        "images,points,observations,{memory:.0} MB",
        memory = memory_mb()
    );
    println!(
        "{},{},{}",
        network.images.len(),
        network.points.len(),
        2 * network.image_points.len()
    );
    println!("what,seconds,memory_mb");
    let start = Instant::now();
    let solution = match adjust(&network, DatumChoice::Auto, &State::initial(&network)) {
        Ok(solution) => solution,
        Err(error) => {
            println!("{error}");
            return;
        }
    };
    println!(
        "adjustment of {} iterations,{:.1},{:.0}",
        solution.iterations,
        start.elapsed().as_secs_f64(),
        memory_mb()
    );
    if let Ok(cofactors) = Cofactors::of(&network, &solution) {
        println!(
            "with cofactors,{:.1},{:.0}",
            start.elapsed().as_secs_f64(),
            memory_mb()
        );
        let tests = Tests::of(&network, &solution, &cofactors);
        println!(
            "with tests (exact: {}),{:.1},{:.0}",
            tests.exact,
            start.elapsed().as_secs_f64(),
            memory_mb()
        );
    }
    println!("σ0 {:.4}", solution.sigma0());
    if let Some(percent) = numbers.get(2) {
        search(network, count(*percent) / 100.0);
    }
}

/// Makes a part of the image points wrong, and searches for them.
fn search(mut network: Network, part: f64) {
    let mut random = Rng::with_seed(2);
    let mut wrong = 0;
    for observed in &mut network.image_points {
        if random.f64() < part {
            let [x, y] = &mut observed.measured_mm;
            let by = SIGMA_MM * (5.0 + 45.0 * random.f64());
            let angle = std::f64::consts::TAU * random.f64();
            *x += by * angle.cos();
            *y += by * angle.sin();
            wrong += 1;
        }
    }
    let start = Instant::now();
    match snooped(&network, DatumChoice::Auto, &State::initial(&network)) {
        Ok(found) => {
            let points = &found.network.image_points;
            let rejected = points.iter().filter(|observed| !observed.accepted).count();
            println!(
                "search ({rejected} rejected of {wrong}),{:.1},{:.0}",
                start.elapsed().as_secs_f64(),
                memory_mb()
            );
            println!("σ0 {:.4}", found.solution.sigma0());
        }
        Err(error) => println!("{error}"),
    }
}
