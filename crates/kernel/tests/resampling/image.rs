//! Images, runs, and the exact result of resampling.

use fastrand::Rng;
use fmc_camera_kernel::resampling::{Band, Kernel, PLACE_BITS, Resampler, Run, Sample, weights};

/// An image of interleaved samples.
pub(crate) struct Image<S> {
    pub(crate) size_px: [u32; 2],
    pub(crate) bands: usize,
    pub(crate) samples: Vec<S>,
}

impl<S: Sample> Image<S> {
    pub(crate) fn new(size_px: [u32; 2], bands: usize, sample: impl FnMut() -> S) -> Self {
        let [width, height] = size_px.map(|side| side as usize);
        let mut samples = Vec::new();
        samples.resize_with(width * height * bands, sample);
        Self {
            size_px,
            bands,
            samples,
        }
    }

    /// Resamples one row; returns samples, mask and the number of border pixels.
    pub(crate) fn row(&self, resampler: &Resampler, runs: &[Run]) -> (Vec<S>, Vec<u8>, u32) {
        let length = self.size_px[0] as usize * self.bands;
        let rows: Vec<&[S]> = self.samples.chunks(length).collect();
        let band = Band::new(self.size_px, self.bands, 0, &rows).unwrap();
        let count: usize = runs.iter().map(|run| usize::from(run.count)).sum();
        let mut out = vec![S::saturated(77); count * self.bands];
        let mut mask = vec![7; count];
        let border = resampler.row(&band, runs, &mut out, &mut mask);
        (out, mask, border)
    }

    /// Returns a sample as a number; beyond the edge, that of the edge.
    pub(crate) fn at(&self, [col, row]: [i64; 2], band: usize) -> f64 {
        let [width, height] = self.size_px.map(i64::from);
        let pixel = row.clamp(0, height - 1) * width + col.clamp(0, width - 1);
        let sample = self.samples[usize::try_from(pixel).unwrap() * self.bands + band];
        f64::from(sample.centred() + if S::BITS == 16 { 1 << 15 } else { 0 })
    }

    /// Returns the exact value at a place, in double precision, within the range of samples.
    pub(crate) fn exact(&self, kernel: Kernel, [x, y]: [f64; 2], band: usize) -> f64 {
        let sides = self.size_px.map(|side| f64::from(side) - 1.0);
        let (x, y) = (x.clamp(0.0, sides[0]), y.clamp(0.0, sides[1]));
        if kernel == Kernel::Nearest {
            let nearest = [x, y].map(|place| (place + 0.5).floor() as i64);
            return self.at(nearest, band);
        }
        let (along, down) = (
            weights(kernel, x - x.floor()),
            weights(kernel, y - y.floor()),
        );
        let before = i64::from(kernel.half_taps()) - 1;
        let mut sum = 0.0;
        for (j, down) in (0..).zip(down) {
            for (i, along) in (0..).zip(along) {
                let place = [x.floor() as i64 - before + i, y.floor() as i64 - before + j];
                sum += along * down * self.at(place, band);
            }
        }
        sum.clamp(0.0, f64::from((1_u32 << S::BITS) - 1))
    }
}

/// Returns runs of a row that begins at a place, pixels, with a way between pixels, as places of
/// single pixels and as runs.
pub(crate) fn runs(rng: &mut Rng, start: [f64; 2], step: [f64; 2], count: u32) -> Vec<Run> {
    let unit = f64::from(1 << PLACE_BITS);
    let mut runs = Vec::new();
    let mut done = 0;
    while done < count {
        let length = [16, 16, 16, 1 + rng.u32(0..16)][rng.usize(0..4)].min(count - done);
        let place = [0, 1].map(|axis| start[axis] + f64::from(done) * step[axis]);
        runs.push(Run {
            base_px: place.map(|place| place.floor() as i32),
            start: place.map(|place| ((place - place.floor()) * unit).floor() as i32),
            step: step.map(|step| (step * unit).round() as i32),
            count: length as u8,
            border: false,
        });
        done += length;
    }
    runs
}

/// Returns the places of all pixels of runs.
pub(crate) fn places(runs: &[Run]) -> Vec<[f64; 2]> {
    let unit = f64::from(1 << PLACE_BITS);
    let of_run = |run: &Run| {
        let run = *run;
        (0..run.count).map(move |t| {
            [0, 1].map(|axis| {
                let way = f64::from(run.start[axis]) + f64::from(t) * f64::from(run.step[axis]);
                f64::from(run.base_px[axis]) + way / unit
            })
        })
    };
    runs.iter().flat_map(of_run).collect()
}
