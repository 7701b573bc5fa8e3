//! Flats and darks of a detector, row by row.

use fmc_camera_file::InputError;

use super::figures::Linearity;
use crate::number::real;

/// Sample from which on a pixel of a converter of 14 bits counts as saturated, DN.
pub const SATURATION_DN: u16 = 16_100;
/// Part of the pixels that must be below saturation in all flats.
const LEAST_UNSATURATED: f64 = 0.01;
/// Least ratio of the brightest level to the darkest.
const LEAST_RATIO: f64 = 1.2;
/// Least number of sets of flats.
const LEAST_SETS: usize = 3;

/// A frame that is read row by row.
pub trait SampleRows {
    /// Name for messages.
    fn name(&self) -> &str;

    /// Fills a row.
    ///
    /// # Errors
    /// [`InputError`] naming the file.
    fn read_row(&mut self, row: &mut [u16]) -> Result<(), InputError>;
}

/// Sums over the pixels of a detector that no flat saturates.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// Sum of flat less dark, DN, of each set.
    pub sums_dn: Vec<f64>,
    /// Pixels in the sums.
    pub pixels: usize,
}

impl Levels {
    /// Returns the linearity of the detector from the light of each set, in any unit, and the
    /// signal at saturation, DN.
    #[must_use]
    pub fn linearity(&self, light: &[f64], saturation_dn: f64) -> Option<Linearity> {
        let count = real(self.pixels.max(1));
        let signals: Vec<f64> = self.sums_dn.iter().map(|sum| sum / count).collect();
        Linearity::of(light, &signals, saturation_dn)
    }

    /// Returns the level of each set, DN, from the sums of all detectors behind one lens: what one
    /// exposure gave to all of them.
    ///
    /// # Errors
    /// [`InputError`] for detectors with other numbers of sets, for one level in all sets, and for
    /// flats that are no brighter than darks.
    pub fn joined(of_detectors: &[Self]) -> Result<Vec<f64>, InputError> {
        let sets = of_detectors
            .first()
            .map_or(0, |levels| levels.sums_dn.len());
        if let Some(other) = of_detectors
            .iter()
            .find(|levels| levels.sums_dn.len() != sets)
        {
            return Err(InputError::invalid(format!(
                "flats: {sets} sets of one sub-image and {} of another; every sub-image needs the same sets",
                other.sums_dn.len()
            )));
        }
        let pixels: f64 = of_detectors.iter().map(|levels| real(levels.pixels)).sum();
        let joined: Vec<f64> = (0..sets)
            .map(|set| {
                let sums = of_detectors
                    .iter()
                    .filter_map(|levels| levels.sums_dn.get(set));
                sums.sum::<f64>() / pixels.max(1.0)
            })
            .collect();
        let (least, most) = joined
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(least, most), level| {
                (least.min(*level), most.max(*level))
            });
        if least <= 0.0 {
            return Err(InputError::invalid(
                "flats: the mean of a set is no brighter than the dark frames".to_owned(),
            ));
        }
        if most < LEAST_RATIO * least {
            return Err(InputError::invalid(format!(
                "flats: all {sets} sets have one level, {least:.0} to {most:.0} DN above dark; gain and offset need levels that differ by a factor of {LEAST_RATIO} or more"
            )));
        }
        Ok(joined)
    }
}

/// Sums the flats of a detector over the pixels that none of them saturates.
///
/// # Errors
/// [`InputError`] naming the files: fewer than 3 flats or no dark, saturated flats, a dark brighter
/// than a flat, or what the reader refuses.
pub fn levels<R: SampleRows>(
    [width, height]: [usize; 2],
    flats: &mut [R],
    darks: &mut [R],
    saturation_dn: u16,
) -> Result<Levels, InputError> {
    if flats.len() < LEAST_SETS || darks.is_empty() {
        return Err(InputError::invalid(format!(
            "{} flats and {} darks of a sub-image; at least {LEAST_SETS} flats and 1 dark are needed",
            flats.len(),
            darks.len()
        )));
    }
    let mut sums_dn = vec![0.0; flats.len()];
    let mut saturated = vec![0_usize; flats.len()];
    let mut pixels = 0;
    let mut rows = vec![vec![0_u16; width]; flats.len()];
    let mut dark = vec![0.0; width];
    for _ in 0..height {
        dark_row(darks, &mut dark)?;
        for (flat, row) in flats.iter_mut().zip(&mut rows) {
            flat.read_row(row)?;
        }
        for (col, dark) in dark.iter().enumerate() {
            let samples = || {
                rows.iter()
                    .map(|row| row.get(col).copied().unwrap_or(u16::MAX))
            };
            for (count, sample) in saturated.iter_mut().zip(samples()) {
                *count += usize::from(sample >= saturation_dn);
            }
            if samples().all(|sample| sample < saturation_dn) {
                pixels += 1;
                for (sum, sample) in sums_dn.iter_mut().zip(samples()) {
                    *sum += f64::from(sample) - dark;
                }
            }
        }
    }
    let all = width * height;
    if real(pixels) < LEAST_UNSATURATED * real(all) {
        let worst = flats
            .iter()
            .zip(&saturated)
            .max_by_key(|(_, count)| **count);
        let (name, count) = worst.map_or(("flats", 0), |(flat, count)| (flat.name(), *count));
        return Err(InputError::invalid(format!(
            "{name}: {:.0} % of the pixels at or above {saturation_dn} DN are saturated; 1 % of the pixels must be below it in all flats",
            100.0 * real(count) / real(all)
        ))
        .with_help(
            "the sample from which on pixels count as saturated is an option (--saturation)".to_owned(),
        ));
    }
    for (flat, sum) in flats.iter().zip(&sums_dn) {
        if *sum <= 0.0 {
            return Err(InputError::invalid(format!(
                "{}: its mean is {:.0} DN below that of the dark frames ({}); a flat must be brighter",
                flat.name(),
                -sum / real(pixels),
                darks.first().map_or("darks", |dark| dark.name())
            )));
        }
    }
    Ok(Levels { sums_dn, pixels })
}

/// Reads the mean of the next row of all darks, and returns the sum of the pixels' variances
/// between them; 0 of one dark.
pub(super) fn dark_row<R: SampleRows>(
    darks: &mut [R],
    mean: &mut [f64],
) -> Result<f64, InputError> {
    let mut row = vec![0; mean.len()];
    let mut squares = vec![0.0; mean.len()];
    mean.fill(0.0);
    let count = real(darks.len().max(1));
    for dark in darks {
        dark.read_row(&mut row)?;
        for ((mean, square), sample) in mean.iter_mut().zip(&mut squares).zip(&row) {
            *mean += f64::from(*sample) / count;
            *square += f64::from(*sample).powi(2);
        }
    }
    let sums = squares.iter().zip(mean.iter());
    let deviations = sums.map(|(square, mean)| square - count * mean * mean);
    Ok(deviations.sum::<f64>().max(0.0) / (count - 1.0).max(1.0))
}
