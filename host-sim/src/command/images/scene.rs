//! A pattern before a camera: what an exposure records of it, and what it is when rectified.

use std::f64::consts::TAU;

use fmc_camera_file::CameraFile;
use fmc_rectification::pattern::{PatternImage, Wave, Waves};
use fmc_rectification::truth::TrueGeometry;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::residual_splines::ResidualSplines;

/// The part of a turn that no small fraction comes near: (3 - √5)/2 of it.
const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;

/// Content of the scene, in pixels of the rectified image.
#[derive(Debug)]
pub(in crate::command) enum Pattern {
    Waves(Waves),
    Image {
        width: usize,
        bands: usize,
        values: Vec<f32>,
    },
}

impl Pattern {
    /// Returns waves of these periods, pixels, with phases and a first direction from a seed, over
    /// four fifths of the range of grey values. From wave to wave the direction turns by the golden
    /// angle, so that every block has texture in all directions.
    pub(in crate::command) fn waves(periods_px: &[f64], seed: u64, bits: u8) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let range = f64::from(bits).exp2() - 1.0;
        let count = f64::from(u32::try_from(periods_px.len()).unwrap_or(u32::MAX));
        let mut direction_rad = random.f64() * TAU;
        let waves = periods_px.iter().map(|period_px| {
            direction_rad += GOLDEN_ANGLE_RAD;
            Wave {
                period_px: *period_px,
                direction_rad,
                phase_rad: random.f64() * TAU,
                amplitude: 0.4 * range / count.max(1.0),
            }
        });
        Self::Waves(Waves {
            mean: range / 2.0,
            waves: waves.collect(),
        })
    }

    fn value(&self, place_px: [f64; 2], band: u8) -> f64 {
        match self {
            Self::Waves(waves) => waves.value(place_px, band),
            Self::Image {
                width,
                bands,
                values,
            } => PatternImage::new(*width, *bands, values)
                .map_or(f64::NAN, |image| image.value(place_px, band)),
        }
    }
}

/// A pattern, a camera and an exposure.
#[derive(Debug)]
pub(in crate::command) struct Scene {
    geometry: TrueGeometry,
    pattern: Pattern,
    pub(in crate::command) size_px: [u32; 2],
    pub(in crate::command) bands: u8,
    pub(in crate::command) bits: u8,
    pixel_mm: f64,
    half_mm: [f64; 2],
}

impl Scene {
    pub(in crate::command) fn new(
        camera: &CameraFile,
        splines: ResidualSplines,
        request: &ExposureRequest,
        pattern: Pattern,
        [bands, bits]: [u8; 2],
    ) -> Self {
        let calibration = camera.parameters().calibration;
        Self {
            geometry: TrueGeometry::with_splines(camera, splines, request),
            pattern,
            size_px: [calibration.width_px, calibration.height_px],
            bands,
            bits,
            pixel_mm: camera.sensor.pixel_um / 1000.0,
            half_mm: camera.half_format_mm(),
        }
    }

    /// Principal point of the exposure, sensor frame, mm.
    pub(in crate::command) const fn principal_point_mm(&self) -> [f64; 2] {
        self.geometry.principal_point_mm()
    }

    /// Returns a row as the camera records it, interleaved grey values.
    pub(in crate::command) fn recorded_row(&self, row: u32) -> Vec<f64> {
        let [width, _] = self.size_px;
        let [x0, y0] = self.geometry.principal_point_mm();
        let pixels = (0..width).flat_map(|col| {
            let [x, y] = self.geometry.ideal_mm(self.place_mm([col, row]));
            self.values(self.pixel([x - x0, y - y0]))
        });
        pixels.collect()
    }

    /// Returns a row of the exactly rectified image, about the principal point of the exposure;
    /// 0 where the camera sees nothing.
    pub(in crate::command) fn rectified_row(&self, row: u32) -> Vec<f64> {
        let [width, _] = self.size_px;
        let [x0, y0] = self.geometry.principal_point_mm();
        let pixels = (0..width).flat_map(|col| {
            let [x, y] = self.place_mm([col, row]);
            let [x, y] = self.geometry.measured_mm([x + x0, y + y0]);
            let [half_x, half_y] = self.half_mm;
            let is_seen = x.abs() <= half_x && y.abs() <= half_y;
            let place = [f64::from(col), f64::from(row)];
            self.values(place)
                .map(move |value| if is_seen { value } else { 0.0 })
        });
        pixels.collect()
    }

    fn values(&self, place_px: [f64; 2]) -> impl Iterator<Item = f64> {
        let most = f64::from(self.bits).exp2() - 1.0;
        (0..self.bands).map(move |band| self.pattern.value(place_px, band).round().clamp(0.0, most))
    }

    /// Place of a pixel's centre from that of the image, mm.
    fn place_mm(&self, [col, row]: [u32; 2]) -> [f64; 2] {
        let [width, height] = self.size_px.map(f64::from);
        [
            (f64::from(col) - (width - 1.0) / 2.0) * self.pixel_mm,
            ((height - 1.0) / 2.0 - f64::from(row)) * self.pixel_mm,
        ]
    }

    /// Column and row of a place from the centre of the image, mm.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size_px.map(f64::from);
        [
            (width - 1.0) / 2.0 + x / self.pixel_mm,
            (height - 1.0) / 2.0 - y / self.pixel_mm,
        ]
    }
}
