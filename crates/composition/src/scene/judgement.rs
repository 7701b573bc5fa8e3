//! A calibrated rig against the true one.

use super::detector::Detector;
use super::exposure::Scene;
use crate::mosaic::registration::{Pair, Registration};
use crate::number::{real, rms};
use crate::radiometry::Correction;
use crate::rig::polynomial::normalised;
use crate::rig::{Rig, gauge};

/// Columns and rows of the places of a sub-image at which it is judged: 30.
const PLACES: [usize; 2] = [5, 6];

/// Differences of a calibrated rig from the true one over 30 places of each sub-image, px of the
/// virtual image, root mean square of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Judgement {
    /// Less shift, turn, scale and keystone of all sub-images together, which orientations take up.
    pub rig_px: f64,
    /// Less one cubic over the frame, as a registration takes it off.
    pub after_cubic_px: f64,
    /// Largest distance that is left after the cubic.
    pub largest_px: f64,
    /// Step at the seams: difference of two polynomials at the same true place, no cubic needed.
    pub seams_px: f64,
}

impl Scene {
    /// Judges a calibrated rig; `None` if it has other sub-images.
    #[must_use]
    pub fn judge(&self, rig: &Rig) -> Option<Judgement> {
        let (mut pairs, mut differences) = (Vec::new(), Vec::new());
        for (number, sub) in rig.sub.iter().enumerate() {
            let polynomial = rig.polynomial(sub);
            let [columns, rows] = PLACES;
            for index in 0..columns * rows {
                let part = |number: usize, count: usize, side: usize| {
                    (real(number) + 0.5) / real(count) * real(side) - 0.5
                };
                let pixel = [
                    part(index % columns, columns, sub.width_px),
                    part(index / columns, rows, sub.height_px),
                ];
                let found = polynomial.value(normalised(sub.size_px(), pixel));
                let truth = self.truth.virtual_px(number, pixel)?;
                differences.push([found[0] - truth[0], found[1] - truth[1]]);
                pairs.push(Pair {
                    from_px: found,
                    to_px: truth,
                });
            }
        }
        let places: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.to_px).collect();
        let left = gauge::without_movements(rig, &places, &differences)?;
        let size = [rig.frame.width_px, rig.frame.height_px];
        let cubic = Registration::unweighted(size, 3, &pairs)?;
        let distances = pairs.iter().map(|pair| {
            let [u, v] = cubic.at(pair.from_px);
            (u - pair.to_px[0]).hypot(v - pair.to_px[1])
        });
        Some(Judgement {
            rig_px: rms(left.into_iter().flatten())?,
            after_cubic_px: cubic.residual_px,
            largest_px: distances.fold(0.0, f64::max),
            seams_px: self.seam_step_px(rig)?,
        })
    }

    /// Returns what a correction leaves of a flat without noise at a mean level, part of the full
    /// scale: root mean square of the deviations from the mean, part of it, defects left out.
    /// `None` of a correction of another size.
    #[must_use]
    pub fn uniformity(
        &self,
        number: usize,
        detector: &Detector,
        correction: &Correction,
        level: f64,
    ) -> Option<f64> {
        let sub = self.rig.sub.get(number)?;
        let [width, height] = sub.size_px();
        if correction.width != width || correction.gain.len() != width * height {
            return None;
        }
        let light = |index: usize| {
            let pixel = [real(index % width), real(index / width)];
            self.falloff(self.truth.field(number, pixel))
        };
        let lights: Vec<f64> = (0..width * height).map(light).collect();
        let mean = lights.iter().sum::<f64>() / real(lights.len());
        let signal_dn = level * super::detector::FULL_SCALE_DN / mean;
        let defects = detector.defects();
        let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (index, light) in lights.iter().enumerate() {
            let place = [index % width, index / width];
            if defects.contains(&place) {
                continue;
            }
            let expected_dn = detector.expected_dn(place, light * signal_dn);
            let value = correction.value(index, expected_dn);
            sum += value;
            squares += value * value;
            count += 1.0;
        }
        let mean = sum / count;
        Some((squares / count - mean * mean).max(0.0).sqrt() / mean)
    }

    /// Root mean square of a coordinate's step over all overlaps.
    fn seam_step_px(&self, rig: &Rig) -> Option<f64> {
        let mut steps = Vec::new();
        for first in 0..rig.sub.len() {
            for second in first + 1..rig.sub.len() {
                for place in self.overlap_places(first, second, 20) {
                    let mut found = Vec::new();
                    for number in [first, second] {
                        let sub = rig.sub.get(number)?;
                        let pixel = self.truth.pixel(sub, number, place)?;
                        let polynomial = rig.polynomial(sub);
                        found.push(polynomial.value(normalised(sub.size_px(), pixel)));
                    }
                    if let [a, b] = found.as_slice() {
                        steps.extend([a[0] - b[0], a[1] - b[1]]);
                    }
                }
            }
        }
        rms(steps)
    }
}
