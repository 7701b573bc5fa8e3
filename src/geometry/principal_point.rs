//! Motion of the principal point under the image while the shutter is open.

use core::fmt;

use heapless::Vec;

use super::moments::{CentralMoments, gauss_nodes};
use super::range::OutOfRange;
use super::shutter::Shutter;
use super::tdi::mean_transfers;

/// Number of stretches of a path whose nodes are kept from the centroid to the moments: those of 66
/// samples, and two more for the ramps of the shutter. Those of a longer path are computed twice.
const KEPT_STRETCHES: usize = 68;

/// Quadrature nodes of a stretch: weight, offset in mm.
type Nodes = [(f32, f32); 3];

/// Motion of the principal point during one exposure, with all numbers on which the image depends.
///
/// Offsets are counted along the FMC axis from the calibrated principal point, positive in the
/// axis' own direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PrincipalPointMotion {
    /// Δδ: offset when the shutter opens, mm.
    pub opening_offset_mm: f32,
    /// δ: travel while the shutter is open, mm.
    pub travel_mm: f32,
    /// E\[τ\]: centroid of the exposure after the shutter opens, s.
    pub centroid_time_s: f32,
    /// c̄: transmission-weighted mean offset, mm.
    pub centroid_mm: f32,
    /// μ₂, μ₃, μ₄ of the offset about c̄, mm², mm³, mm⁴.
    pub moments: CentralMoments,
}

/// An exposure at constant stage speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformTravel {
    /// Δδ: offset when the shutter opens, mm.
    pub opening_offset_mm: f32,
    /// v = ±f·η: speed along the FMC axis, mm/s; negative where the camera flies against it.
    pub speed_mm_s: f32,
    /// t: exposure time, the shutter's base, s.
    pub exposure_s: f32,
}

/// A measured position of the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageSample {
    /// Time after the shutter's first light, s; negative before it.
    pub time_s: f32,
    /// Offset along the FMC axis from the calibrated position, mm.
    pub offset_mm: f32,
}

impl PrincipalPointMotion {
    /// Returns the motion predicted for a stage at constant speed.
    ///
    /// # Model
    /// `δ = v·t`, `c(τ) = Δδ + v·τ`, `c̄ = Δδ + v·E[τ]`, `μₖ = δᵏ·μₖ(τ/t)` (Yuan et al. 2012,
    /// eq. 8; its printed integrand would give half of δ).
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
    /// use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
    /// // f = 128 mm, V/H = 1/8 1/s: 16 mm/s for 1/128 s.
    /// let exposure_s = 1.0 / 128.0;
    /// let travel = UniformTravel { opening_offset_mm: 0.0, speed_mm_s: 16.0, exposure_s };
    /// let shutter = Shutter::new(ShutterProfile::Uniform)?;
    /// let motion = PrincipalPointMotion::from_plan(travel, &shutter);
    /// assert_eq!((motion.travel_mm, motion.centroid_mm), (0.125, 0.0625));
    /// # Ok::<(), fmc_camera::geometry::range::OutOfRange>(())
    /// ```
    #[must_use]
    pub fn from_plan(travel: UniformTravel, shutter: &Shutter) -> Self {
        let travel_mm = travel.speed_mm_s * travel.exposure_s;
        Self {
            opening_offset_mm: travel.opening_offset_mm,
            travel_mm,
            centroid_time_s: travel.exposure_s * shutter.centroid(),
            centroid_mm: travel.opening_offset_mm + travel_mm * shutter.centroid(),
            moments: shutter.moments().scaled(travel_mm),
        }
    }

    /// Returns the motion of the charge of a TDI sensor, which follows this one of the image in
    /// rows of `pixel_mm`.
    ///
    /// # Model
    /// `c̄ = Δδ ± p·M` with M of [`mean_transfers`] and the sign of v; the moments are those of the
    /// smooth path of the image in the lens frame.
    ///
    /// # Errors
    /// As [`mean_transfers`].
    pub(crate) fn in_rows(
        self,
        pixel_mm: f32,
        first_transfer: f32,
        shutter: &Shutter,
    ) -> Result<Self, OutOfRange> {
        let rows = mean_transfers(self.travel_mm.abs() / pixel_mm, first_transfer, shutter)?;
        let row_mm = pixel_mm.copysign(self.travel_mm);
        Ok(Self {
            centroid_mm: self.opening_offset_mm + row_mm * rows,
            ..self
        })
    }

    /// Returns the motion as the encoder measured it.
    ///
    /// # Model
    /// The position runs linearly from sample to sample; c̄ and μₖ are its transmission-weighted
    /// mean and central moments over `[0, exposure_s]`, integrated exactly.
    ///
    /// # Units and frames
    /// Sample times in s after first light, offsets in mm along the FMC axis; the samples must
    /// begin at or before the opening and end at or after the closing.
    ///
    /// # Errors
    /// [`SampleError`] if the samples do not determine the path over the whole exposure.
    pub fn from_samples(
        samples: &[StageSample],
        exposure_s: f32,
        shutter: &Shutter,
    ) -> Result<Self, SampleError> {
        let path = MeasuredPath::new(samples, exposure_s)?;
        let (opening_offset_mm, closing_mm) = path.ends();
        let mut light = 0.0;
        let mut sum_mm = 0.0;
        let mut kept: Vec<Nodes, KEPT_STRETCHES> = Vec::new();
        path.for_each_stretch(shutter, |nodes| {
            for (weight, offset_mm) in nodes {
                light += weight;
                sum_mm += weight * (offset_mm - opening_offset_mm);
            }
            let _ = kept.push(nodes);
        });
        let centroid_mm = opening_offset_mm + sum_mm / light;
        let mut moments = CentralMoments::default();
        let add = |nodes: Nodes| {
            for (weight, offset_mm) in nodes {
                moments.add(weight / light, offset_mm - centroid_mm);
            }
        };
        if kept.is_full() {
            // There may be more.
            path.for_each_stretch(shutter, add);
        } else {
            kept.iter().copied().for_each(add);
        }
        Ok(Self {
            opening_offset_mm,
            travel_mm: closing_mm - opening_offset_mm,
            centroid_time_s: exposure_s * shutter.centroid(),
            centroid_mm,
            moments,
        })
    }
}

/// Encoder samples do not determine the path of the stage over the exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleError {
    /// The exposure time is not a positive number, s.
    Exposure(f32),
    /// A time or an offset is not a finite number: index of the sample.
    NotFinite(usize),
    /// Times do not increase: index of the sample that is not after the one before.
    NotIncreasing(usize),
    /// The samples leave the start or the end of the exposure uncovered.
    NotCovered {
        /// First sample, s after first light.
        first_s: f32,
        /// Last sample, s after first light.
        last_s: f32,
        /// End of the exposure, s after first light.
        exposure_s: f32,
    },
    /// Fewer than two samples.
    TooFew(usize),
}

impl fmt::Display for SampleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exposure(value) => write!(f, "exposure of {value} s is not positive"),
            Self::NotFinite(index) => write!(f, "stage sample {index} is not a finite number"),
            Self::NotIncreasing(index) => {
                write!(f, "stage sample {index} is not later than the one before")
            }
            Self::NotCovered {
                first_s,
                last_s,
                exposure_s,
            } => write!(
                f,
                "stage samples from {first_s} s to {last_s} s do not cover the exposure, 0 s to {exposure_s} s"
            ),
            Self::TooFew(count) => write!(f, "{count} stage samples; at least 2 are needed"),
        }
    }
}

impl core::error::Error for SampleError {}

/// Validated samples: finite, in time order, covering the exposure.
struct MeasuredPath<'a> {
    samples: &'a [StageSample],
    exposure_s: f32,
}

impl<'a> MeasuredPath<'a> {
    fn new(samples: &'a [StageSample], exposure_s: f32) -> Result<Self, SampleError> {
        if !(exposure_s > 0.0 && exposure_s.is_finite()) {
            return Err(SampleError::Exposure(exposure_s));
        }
        let ([first, _, ..], [.., last]) = (samples, samples) else {
            return Err(SampleError::TooFew(samples.len()));
        };
        // Times that increase are finite if the first and the last are.
        let is_in_order = |(before, after): (StageSample, StageSample)| {
            after.time_s > before.time_s && after.offset_mm.is_finite()
        };
        let are_ends_finite =
            first.time_s.is_finite() && first.offset_mm.is_finite() && last.time_s.is_finite();
        if !(are_ends_finite && Self::stretches(samples).all(is_in_order)) {
            return Err(Self::disorder(samples));
        }
        if first.time_s > 0.0 || last.time_s < exposure_s {
            return Err(SampleError::NotCovered {
                first_s: first.time_s,
                last_s: last.time_s,
                exposure_s,
            });
        }
        Ok(Self {
            samples,
            exposure_s,
        })
    }

    /// Returns what is wrong with samples that are not all finite, or not in order.
    #[cold]
    fn disorder(samples: &[StageSample]) -> SampleError {
        let is_finite = |it: &StageSample| it.time_s.is_finite() && it.offset_mm.is_finite();
        if let Some(index) = samples.iter().position(|it| !is_finite(it)) {
            return SampleError::NotFinite(index);
        }
        let mut stretches = Self::stretches(samples);
        let unordered = stretches.position(|(before, after)| after.time_s <= before.time_s);
        SampleError::NotIncreasing(unordered.map_or(0, |index| index + 1))
    }

    /// Returns pairs of neighbouring samples.
    fn stretches(samples: &[StageSample]) -> impl Iterator<Item = (StageSample, StageSample)> {
        samples.iter().copied().zip(samples.iter().copied().skip(1))
    }

    /// Returns the offsets at first and last light, mm.
    fn ends(&self) -> (f32, f32) {
        (
            self.offset_after(0.0, |began_s| began_s <= 0.0),
            self.offset_after(self.exposure_s, |began_s| began_s < self.exposure_s),
        )
    }

    /// Returns the offset at an instant of the last stretch that has begun, mm.
    fn offset_after(&self, time_s: f32, has_begun: impl Fn(f32) -> bool) -> f32 {
        let begun = self.samples.partition_point(|it| has_begun(it.time_s));
        let last = self.samples.len().saturating_sub(2);
        match self.samples.get(begun.saturating_sub(1).min(last)..) {
            Some([before, after, ..]) => interpolated(*before, *after, time_s),
            _ => 0.0,
        }
    }

    /// Visits the quadrature nodes of every stretch on which path and transmission are linear.
    fn for_each_stretch(&self, shutter: &Shutter, mut visit: impl FnMut(Nodes)) {
        let pieces = shutter
            .pieces()
            .map(|(open, close)| (open * self.exposure_s, close * self.exposure_s));
        for (before, after) in Self::stretches(self.samples) {
            for (open_s, close_s) in pieces {
                if before.time_s >= close_s {
                    continue;
                }
                if after.time_s <= open_s {
                    break;
                }
                // These are comparisons, because no value is a NaN and a call of `f32::max` takes
                // longer than the node.
                let from = if before.time_s > open_s {
                    before.time_s
                } else {
                    open_s
                };
                let to = if after.time_s < close_s {
                    after.time_s
                } else {
                    close_s
                };
                if to > from {
                    let nodes = gauss_nodes(from, to);
                    let transmissions =
                        shutter.transmissions(nodes.map(|(time_s, _)| time_s / self.exposure_s));
                    let [(s1, w1), (s2, w2), (s3, w3)] = nodes;
                    let weighted = match transmissions {
                        None => nodes,
                        Some([t1, t2, t3]) => [(s1, w1 * t1), (s2, w2 * t2), (s3, w3 * t3)],
                    };
                    visit(
                        weighted
                            .map(|(time_s, weight)| (weight, interpolated(before, after, time_s))),
                    );
                }
            }
        }
    }
}

fn interpolated(before: StageSample, after: StageSample, time_s: f32) -> f32 {
    let share = (time_s - before.time_s) / (after.time_s - before.time_s);
    before.offset_mm + (after.offset_mm - before.offset_mm) * share
}

#[cfg(test)]
mod tests;
