//! Response of every pixel, and what EMVA 1288 asks of a detector.

use fmc_camera_file::InputError;

use super::correction::Correction;
use super::falloff::{Falloff, Sample, cos_fourth};
use super::figures::DetectorFigures;
use super::flats::{SampleRows, dark_row};
use crate::number::{median, real, single};
use crate::rig::{Rig, SubImage};

/// Side of the blocks in which pixels are compared with their neighbours, px.
const BLOCK_PX: usize = 16;
/// Deviation of a defective pixel, in standard deviations of its kind.
const DEFECT: f64 = 6.0;
/// Residual of a set beyond its noise, part of its level, from which it is not flat.
const NOT_FLAT: f64 = 0.02;
/// Largest misfit of the falloff in blocks, part of the axis.
const NO_FALLOFF: f64 = 0.05;

/// Method of the correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Offset and gain of every pixel.
    OffsetAndGain,
    /// Zhao et al. 2013: falloff by a formula, and the mean corrected flat less its mean as a
    /// template that is subtracted.
    Template,
}

/// Response of a detector.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    width: usize,
    offset_dn: Vec<f32>,
    slope: Vec<f32>,
    samples: Vec<Sample>,
    /// Mean level of all sets, DN: offset + slope x level is their mean.
    mean_level_dn: f64,
    /// Deviations of the responses, part of them, and of the offsets, DN, with their noise.
    spread: [f64; 2],
    figures: DetectorFigures,
}

/// Finds offset and slope of every pixel of a detector.
///
/// # Model
/// `DN = o + s·E`: o the mean of the darks (the dark signal of their exposure time in it), s by
/// least squares of the unsaturated flats, weighted by 1/E as photon noise asks,
/// `s = Σ(DN - o)/ΣE`. The gain comes from the residuals of all levels, whose variance is a
/// straight line over the signal (photon transfer); dark noise from the darks, or of one dark from
/// where that line ends.
///
/// # Errors
/// [`InputError`] naming a set that is not flat, or what the reader refuses.
pub fn response<R: SampleRows>(
    rig: &Rig,
    sub: &SubImage,
    levels_dn: &[f64],
    flats: &mut [R],
    darks: &mut [R],
    saturation_dn: u16,
) -> Result<Response, InputError> {
    let [width, height] = sub.size_px();
    let count = width * height;
    let mut found = Response {
        width,
        offset_dn: Vec::with_capacity(count),
        slope: Vec::with_capacity(count),
        samples: Vec::new(),
        mean_level_dn: levels_dn.iter().sum::<f64>() / real(levels_dn.len().max(1)),
        spread: [0.0; 2],
        figures: DetectorFigures::default(),
    };
    let mut transfer = vec![Transfer::default(); flats.len()];
    let mut rows = vec![vec![0_u16; width]; flats.len()];
    let mut dark = vec![0.0; width];
    let mut dark_variances = 0.0;
    for _ in 0..height {
        dark_variances += dark_row(darks, &mut dark)?;
        for (flat, row) in flats.iter_mut().zip(&mut rows) {
            flat.read_row(row)?;
        }
        for (col, offset) in dark.iter().enumerate() {
            let samples: Vec<(usize, f64, f64)> = rows
                .iter()
                .zip(levels_dn)
                .enumerate()
                .filter_map(|(set, (row, level))| {
                    let sample = row
                        .get(col)
                        .copied()
                        .filter(|sample| *sample < saturation_dn)?;
                    Some((set, f64::from(sample), *level))
                })
                .collect();
            let sum_of_levels: f64 = samples.iter().map(|(_, _, level)| level).sum();
            let sum: f64 = samples.iter().map(|(_, sample, _)| sample - offset).sum();
            let slope = if sum_of_levels > 0.0 {
                sum / sum_of_levels
            } else {
                0.0
            };
            for (set, sample, level) in &samples {
                if let Some(transfer) = transfer.get_mut(*set) {
                    let redundancy = 1.0 - level / sum_of_levels;
                    transfer.add(slope * level, sample - offset - slope * level, redundancy);
                }
            }
            found.offset_dn.push(single(*offset));
            found.slope.push(single(slope));
        }
    }
    Response::check_flats(flats, &transfer)?;
    let at_zero = found.photon_transfer(&transfer);
    let dark_variance = if darks.len() > 1 {
        dark_variances / real(count)
    } else {
        at_zero
    };
    found.samples = found.blocks(rig, sub, height);
    found.without_noise(&transfer, dark_variance / real(darks.len().max(1)));
    let signal_dn = f64::from(saturation_dn) - found.figures.dark_dn;
    found.figures.complete(dark_variance, signal_dn);
    Ok(found)
}

/// Sums of a set: what photon transfer needs.
#[derive(Debug, Clone, Copy, Default)]
struct Transfer {
    count: f64,
    signal_dn: f64,
    squares: f64,
}

impl Transfer {
    fn add(&mut self, signal_dn: f64, residual_dn: f64, redundancy: f64) {
        self.count += 1.0;
        self.signal_dn += signal_dn;
        self.squares += residual_dn * residual_dn / redundancy.max(0.01);
    }

    fn mean_dn(&self) -> f64 {
        self.signal_dn / self.count.max(1.0)
    }

    fn variance(&self) -> f64 {
        self.squares / self.count.max(1.0)
    }
}

impl Response {
    fn check_flats<R: SampleRows>(flats: &[R], transfer: &[Transfer]) -> Result<(), InputError> {
        for (flat, set) in flats.iter().zip(transfer) {
            // No detector has fewer than 1000 electrons of a full scale of 14 bits.
            let noise = 16.0 * set.mean_dn() + 400.0;
            let left = (set.variance() - noise).max(0.0).sqrt();
            if set.count > 0.0 && left > NOT_FLAT * set.mean_dn() {
                return Err(InputError::invalid(format!(
                    "{}: not flat: {:.1} % of its level ({:.0} DN) differ from what the other sets say of each pixel; allowed: {:.0} %",
                    flat.name(),
                    100.0 * left / set.mean_dn(),
                    set.mean_dn(),
                    100.0 * NOT_FLAT
                )));
            }
        }
        Ok(())
    }

    /// Fits the straight line of variance over signal, and returns the variance without signal.
    fn photon_transfer(&mut self, transfer: &[Transfer]) -> f64 {
        let sets: Vec<&Transfer> = transfer.iter().filter(|set| set.count > 0.0).collect();
        let count = real(sets.len().max(1));
        let mean = sets.iter().map(|set| set.mean_dn()).sum::<f64>() / count;
        let variance = sets.iter().map(|set| set.variance()).sum::<f64>() / count;
        let (mut products, mut squares) = (0.0, 0.0);
        for set in &sets {
            products += (set.mean_dn() - mean) * (set.variance() - variance);
            squares += (set.mean_dn() - mean).powi(2);
        }
        let gain = if squares > 0.0 {
            products / squares
        } else {
            0.0
        };
        self.figures.gain_dn_per_e = gain;
        (variance - gain * mean).max(0.0)
    }

    /// Takes the temporal noise of offsets, DN², and of slopes off the non-uniformities.
    fn without_noise(&mut self, transfer: &[Transfer], of_offset: f64) {
        let signals: f64 = transfer.iter().map(Transfer::mean_dn).sum();
        let variances: f64 = transfer.iter().map(Transfer::variance).sum();
        let sets = real(transfer.len());
        let of_slope = (variances + sets * sets * of_offset) / signals.max(1.0).powi(2);
        let less = |deviation: f64, variance: f64| (deviation.powi(2) - variance).max(0.0).sqrt();
        let [slopes, offsets] = self.spread;
        self.figures.prnu_percent = 100.0 * less(slopes, of_slope);
        self.figures.dsnu_dn = less(offsets, of_offset);
    }

    /// Compares pixels with their blocks: deviations, defects excluded; samples of the falloff.
    fn blocks(&mut self, rig: &Rig, sub: &SubImage, height: usize) -> Vec<Sample> {
        let f_px = rig.principal_distance_px();
        let [centre_col, centre_row] = sub.centre_px();
        let field = |[x, y]: [f64; 2]| (sub.place_px[0] + x).hypot(sub.place_px[1] + y) / f_px;
        let mut samples = Vec::new();
        let (mut of_slope, mut of_offset) = (Vec::new(), Vec::new());
        for first_row in (0..height).step_by(BLOCK_PX) {
            for first_col in (0..self.width).step_by(BLOCK_PX) {
                let (mut slopes, mut offsets) = (Vec::new(), Vec::new());
                for row in first_row..(first_row + BLOCK_PX).min(height) {
                    for col in first_col..(first_col + BLOCK_PX).min(self.width) {
                        let index = row * self.width + col;
                        let place = [real(col) - centre_col, real(row) - centre_row];
                        let light = cos_fourth(field(place));
                        slopes.extend(self.slope.get(index).map(|slope| f64::from(*slope) / light));
                        offsets.extend(self.offset_dn.get(index).copied().map(f64::from));
                    }
                }
                let (Some(slope), Some(offset)) = (median(slopes.clone()), median(offsets.clone()))
                else {
                    continue;
                };
                let half = real(BLOCK_PX) / 2.0 - 0.5;
                let col = (real(first_col) + half).min(real(self.width));
                let row = (real(first_row) + half).min(real(height));
                let field = field([col - centre_col, row - centre_row]);
                samples.push(Sample {
                    field,
                    response: slope * cos_fourth(field),
                });
                // Median of absolute deviations: 0.6745 σ.
                let ways = slopes
                    .iter()
                    .map(|value| (value / slope - 1.0).abs())
                    .collect();
                of_slope.extend(median(ways).map(|way| way / 0.6745));
                let ways = offsets.iter().map(|value| (value - offset).abs()).collect();
                of_offset.extend(median(ways).map(|way| way / 0.6745));
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / real(values.len().max(1));
        self.spread = [mean(&of_slope), mean(&of_offset)];
        let offsets = self.offset_dn.iter().copied().map(f64::from);
        self.figures.dark_dn = offsets.sum::<f64>() / real(self.offset_dn.len().max(1));
        samples
    }

    /// Columns and rows of pixels that differ from the falloff, or from the median offset of their
    /// surroundings, by more than six standard deviations of their kind.
    fn defects(&self, falloff: &Falloff, field: impl Fn(usize) -> f64) -> Vec<[usize; 2]> {
        let [prnu, dsnu] = [self.spread[0].max(1e-4), self.spread[1].max(0.1)];
        // Two taps may have offsets apart: each pixel is compared with those of its own row.
        let around = |list: &[f32], index: usize| {
            let first = index.saturating_sub(BLOCK_PX / 2);
            let near = list
                .iter()
                .skip(first)
                .take(BLOCK_PX + 1)
                .copied()
                .map(f64::from);
            median(near.collect())
        };
        let pixels = self.slope.iter().zip(&self.offset_dn).enumerate();
        let defects = pixels.filter_map(|(index, (slope, offset))| {
            let expected = falloff.on_axis * falloff.at(field(index));
            let response = f64::from(*slope) / expected - 1.0;
            let by_offset = f64::from(*offset) - self.figures.dark_dn;
            // Only pixels that stand out at all are looked at closely.
            let is_suspect = response.abs() > DEFECT * prnu || by_offset.abs() > DEFECT * dsnu;
            let is_defect = is_suspect && {
                let near = around(&self.slope, index)?;
                let near_offset = around(&self.offset_dn, index)?;
                (f64::from(*slope) / near - 1.0).abs() > DEFECT * prnu
                    || (f64::from(*offset) - near_offset).abs() > DEFECT * dsnu
            };
            is_defect.then(|| [index % self.width, index / self.width])
        });
        defects.collect()
    }
}

/// Makes the corrections of all detectors behind one lens, in the order of the rig.
///
/// # Errors
/// [`InputError`] if the responses together are no falloff: the flats are not flat.
pub fn correction(
    rig: &Rig,
    responses: Vec<Response>,
    method: Method,
) -> Result<(Falloff, Vec<(Correction, DetectorFigures)>), InputError> {
    let samples: Vec<Sample> = responses
        .iter()
        .flat_map(|response| &response.samples)
        .copied()
        .collect();
    let falloff = Falloff::fit(&samples).filter(|falloff| falloff.misfit <= NO_FALLOFF);
    let falloff = falloff.ok_or_else(|| {
        let found = Falloff::fit(&samples).map_or(f64::NAN, |falloff| falloff.misfit);
        InputError::invalid(format!(
            "flats: not flat: blocks differ by {:.1} % (root mean square) from any falloff of a lens; allowed: {:.0} %",
            100.0 * found,
            100.0 * NO_FALLOFF
        ))
    })?;
    let f_px = rig.principal_distance_px();
    let made = rig.sub.iter().zip(responses).map(|(sub, response)| {
        let [centre_col, centre_row] = sub.centre_px();
        let width = response.width;
        let field = |index: usize| {
            let x = sub.place_px[0] + real(index % width) - centre_col;
            let y = sub.place_px[1] + real(index / width) - centre_row;
            x.hypot(y) / f_px
        };
        let defects = response.defects(&falloff, field);
        let mut figures = response.figures;
        figures.defects = defects.len();
        let correction = match method {
            Method::OffsetAndGain => {
                let mut gain = response.slope;
                for slope in &mut gain {
                    *slope = single(f64::from(*slope) / falloff.on_axis);
                }
                Correction {
                    width: response.width,
                    offset_dn: response.offset_dn,
                    gain,
                    defects,
                }
            }
            Method::Template => template(&response, &falloff, field),
        };
        (correction, figures)
    });
    Ok((falloff, made.collect()))
}

/// The publication's template: (DN/V - T) is (DN - T·V)/V.
fn template(response: &Response, falloff: &Falloff, field: impl Fn(usize) -> f64) -> Correction {
    let lights: Vec<f64> = (0..response.slope.len())
        .map(|index| falloff.at(field(index)))
        .collect();
    let pixels = response.offset_dn.iter().zip(&response.slope);
    let flats = pixels.zip(&lights).map(|((offset, slope), light)| {
        (f64::from(*offset) + f64::from(*slope) * response.mean_level_dn) / light
    });
    let mean = flats.clone().sum::<f64>() / real(lights.len().max(1));
    Correction {
        width: response.width,
        offset_dn: flats
            .zip(&lights)
            .map(|(flat, light)| single((flat - mean) * light))
            .collect(),
        gain: lights.iter().map(|light| single(*light)).collect(),
        defects: Vec::new(),
    }
}
