//! Geometry of rectified images against exactly rectified ones.

use fastrand::Rng;
use fmc_rectification::comparison::{BLOCK_PX, Plane, ShiftSummary, shifts};
use fmc_rectification::pattern::Waves;
use fmc_rectification::{Centre, Rectification, Request, Resampling, SourceBand, Window};

use crate::cameras::{Case, random, reduced};
use crate::comparison::waves;
use crate::truth::truth;

/// Longest shift of a block and the root of their mean square, px.
const LIMITS: [(Resampling, f64, f64); 4] = [
    (Resampling::Bilinear, 0.035, 0.012),
    (Resampling::Bicubic, 0.004, 0.0025),
    (Resampling::Keys6, 0.0015, 0.0008),
    (Resampling::Lanczos3, 0.038, 0.027),
];

/// Returns what the camera sees of a pattern that lies about the principal point.
fn seen(case: &Case, waves: &Waves) -> Vec<u16> {
    let truth = truth(case);
    let sensor = case.correction.sensor();
    let pixel_mm = case.file.sensor.pixel_um / 1000.0;
    let [x0, y0] = truth.principal_point_mm();
    let mut samples = Vec::new();
    for row in 0..sensor.height_px() {
        for col in 0..sensor.width_px() {
            let measured = case
                .file
                .sensor_from_pixel([f64::from(col), f64::from(row)]);
            let [x, y] = truth.ideal_mm(measured);
            let place = [(x - x0) / pixel_mm, (y0 - y) / pixel_mm];
            samples.push(waves.value(place, 0).round() as u16);
        }
    }
    samples
}

/// Returns the exactly rectified pattern.
fn exact(size_px: [u32; 2], waves: &Waves) -> Vec<f32> {
    let [width, height] = size_px;
    let mut values = Vec::new();
    for row in 0..height {
        for col in 0..width {
            let centre = size_px.map(|side| (f64::from(side) - 1.0) / 2.0);
            let place = [f64::from(col) - centre[0], f64::from(row) - centre[1]];
            values.push(waves.value(place, 0) as f32);
        }
    }
    values
}

#[test]
fn rectified_waves_lie_where_the_exactly_rectified_ones_do() {
    let mut rng = Rng::with_seed(23);
    let mut cases: Vec<Case> = (0..6).map(|_| random(&mut rng, 600)).collect();
    cases.extend(reduced());
    let mut sums = LIMITS.map(|_| ShiftSummary::default());
    let windows = [Window::Same, Window::Inside, Window::Full];
    for (number, case) in cases.iter().enumerate() {
        let waves = waves(&mut rng);
        let seen = seen(case, &waves);
        let sensor = case.correction.sensor();
        let size_px = [sensor.width_px(), sensor.height_px()];
        let rows: Vec<&[u16]> = seen.chunks(size_px[0] as usize).collect();
        for ((resampling, longest_px, _), sum) in LIMITS.into_iter().zip(&mut sums) {
            let request = Request {
                window: windows[number % 3],
                centre: Centre::PrincipalPoint,
                resampling,
            };
            let made = Rectification::new(&case.correction, case.principal_point, &request);
            let made = made.unwrap();
            let output_px = made.output_size_px();
            let width = output_px[0] as usize;
            let mut values = Vec::new();
            let mut masks = Vec::new();
            for row in 0..output_px[1] {
                let needed = made.source_rows(row..row + 1);
                let band = &rows[needed.start as usize..needed.end as usize];
                let band = SourceBand::new(size_px, 1, needed.start, band).unwrap();
                let (mut out, mut mask) = (vec![0; width], vec![0; width]);
                made.row(row, &band, &mut out, &mut mask).unwrap();
                values.extend(out.into_iter().map(f32::from));
                masks.extend(mask);
            }
            let expected = exact(output_px, &waves);
            let expected = Plane::new(width, &expected, None).unwrap();
            let found = Plane::new(width, &values, Some(&masks)).unwrap();
            let blocks = shifts(&expected, &found);
            for block in &blocks {
                sum.add(block);
                if let Some([dx, dy]) = block.shift_px {
                    let shift = dx.hypot(dy);
                    let name = &case.name;
                    assert!(
                        shift <= longest_px,
                        "{name}, {resampling}, {:?}: {shift} px",
                        block.first_px
                    );
                }
            }
            assert!(blocks.len() >= width / BLOCK_PX);
        }
    }
    for ((resampling, _, rms_px), sum) in LIMITS.into_iter().zip(sums) {
        let rms = sum.rms_px().unwrap();
        let (found, not_found) = (sum.found, sum.not_found);
        println!(
            "{resampling}: {:.5} px, rms {rms:.5}, {found} blocks",
            sum.largest_px
        );
        assert!(
            found >= 300 && not_found <= found / 5,
            "{found}, {not_found}"
        );
        assert!(rms <= rms_px, "{resampling}: rms {rms}");
    }
}
