//! Cameras and their frames.

use fastrand::Rng;
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_camera_file::published::CAMERA_FILES;

/// A camera with one exposure.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) file: CameraFile,
    pub(crate) exposure: [f32; 2],
    pub(crate) correction: FrameCorrection,
    pub(crate) principal_point: SensorPoint,
}

impl Case {
    /// Returns a frame of a camera at a V/H, 1/s, with an exposure, s.
    pub(crate) fn new(name: &str, text: &str, [vh_per_s, exposure_s]: [f32; 2]) -> Option<Self> {
        let (file, camera) = CameraFile::parse(name, text).ok()?;
        let frame = camera.frame(&Exposure::new(vh_per_s, exposure_s)).ok()?;
        Some(Self {
            name: format!("{name}, {vh_per_s} 1/s, {exposure_s} s"),
            file,
            exposure: [vh_per_s, exposure_s],
            correction: frame.correction,
            principal_point: frame.interior.principal_point,
        })
    }
}

/// Returns the published cameras as they stand on their tripods.
pub(crate) fn published_at_rest() -> Vec<(String, FrameCorrection, SensorPoint)> {
    let at_rest = |(name, text): (&str, &str)| {
        let (_, camera) = CameraFile::parse(name, text).unwrap();
        let camera: Camera = camera;
        let calibration = camera.calibration();
        let point = calibration.parameters().principal_point;
        (
            name.to_owned(),
            FrameCorrection::without_motion(calibration),
            point,
        )
    };
    CAMERA_FILES.map(at_rest).into()
}

/// Returns the published cameras in flight, from rest and centred.
pub(crate) fn published_in_flight() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, text) in CAMERA_FILES {
        for strategy in ["centred", "from-rest"] {
            let text = format!("{text}\n[fmc]\nstrategy = \"{strategy}\"\n");
            for exposure in [[0.03, 0.002], [0.1, 0.005]] {
                cases.push(Case::new(name, &text, exposure).unwrap());
            }
        }
    }
    cases
}

/// Returns a camera of random format, distortion and motion whose longer side has about `side_px`
/// pixels.
pub(crate) fn random(rng: &mut Rng, side_px: u32) -> Case {
    let between = |rng: &mut Rng, low: f64, high: f64| low + (high - low) * rng.f64();
    loop {
        let width = side_px - rng.u32(0..side_px / 10);
        let height = rng.u32(side_px / 2..side_px);
        let half_mm = between(rng, 12.0, 60.0);
        let pixel_um = (2000.0 * half_mm / f64::from(width)).min(100.0);
        let radius = f64::from(width).hypot(f64::from(height)) * pixel_um / 2000.0;
        // Up to two per cent of the radius, shared out among the three terms.
        let share =
            |rng: &mut Rng, power: i32, part: f64| between(rng, -part, part) / radius.powi(power);
        let [k1, k2, k3] = [
            share(rng, 2, 0.02),
            share(rng, 4, 0.01),
            share(rng, 6, 0.005),
        ];
        let [p1, p2] = [share(rng, 1, 3e-4), share(rng, 1, 3e-4)];
        let axis = ["+x", "-x", "+y", "-y"][rng.usize(0..4)];
        let strategy = ["centred", "from-rest"][rng.usize(0..2)];
        let [x0, y0] = [between(rng, -0.3, 0.3), between(rng, -0.3, 0.3)];
        let f = between(rng, 1.2, 4.0) * half_mm;
        let text = format!(
            "name = \"random\"\nprincipal_distance_mm = {f:.4}\nprincipal_point_mm = [{x0:.4}, \
             {y0:.4}]\n[sensor]\nwidth_px = {width}\nheight_px = {height}\npixel_um = \
             {pixel_um:.3}\n[distortion]\nk1 = {k1:e}\nk2 = {k2:e}\nk3 = {k3:e}\np1 = {p1:e}\np2 = \
             {p2:e}\n[fmc]\naxis = \"{axis}\"\nstrategy = \"{strategy}\"\n"
        );
        let exposure = [0.02 + 0.08 * rng.f32(), 0.001 + 0.004 * rng.f32()];
        if let Some(case) = Case::new("random", &text, exposure) {
            return case;
        }
    }
}

/// Returns the published cameras in flight with so large pixels that their images are small.
pub(crate) fn reduced() -> Vec<Case> {
    let reduced = |(name, text): (&'static str, &str)| {
        let (file, _) = CameraFile::parse(name, text).unwrap();
        let times = file.sensor.width_px as f64 / 640.0;
        let mut lines = Vec::new();
        for line in text.lines() {
            let (key, value) = line.split_once('=').unwrap_or((line, ""));
            let number = value.trim().parse::<f64>().unwrap_or_default();
            lines.push(match key.trim() {
                "width_px" | "height_px" => format!("{key} = {}", (number / times).round()),
                "pixel_um" => format!("{key} = {:.3}", (number * times).min(100.0)),
                _ => line.to_owned(),
            });
        }
        let text = format!("{}\n[fmc]\nstrategy = \"from-rest\"\n", lines.join("\n"));
        Case::new(name, &text, [0.06, 0.003])
    };
    CAMERA_FILES.into_iter().filter_map(reduced).collect()
}
