//! A point with the bits to which its correction has to lead.

use serde::{Deserialize, Serialize};

use crate::flight::camera::{Camera, Frame, FrameError};
use crate::flight::exposure::Exposure;
use crate::flight::gridded_frame::GriddedFrame;
use crate::geometry::camera_grids::CameraGrids;
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use crate::geometry::sensor::SensorPoint;

/// Opening offset of the probe point's exposure, in strokes.
const OPENING_STROKES: f32 = -0.125;

/// Travel of the principal point in it, in strokes.
const TRAVEL_STROKES: f32 = 0.25;

/// Place of the probe point, in half widths and half heights from the centre.
const PLACE: [f32; 2] = [0.7, -0.6];

/// A point, the motion in its exposure, and the correction of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProbePoint {
    /// Measured point, sensor frame, mm.
    point: SensorPoint,
    /// Motion of the principal point: Δδ, mm along the FMC axis.
    opening_offset_mm: f32,
    /// v, mm/s along the FMC axis.
    speed_mm_s: f32,
    /// t, s.
    exposure_s: f32,
    /// Bits of x', y', dx and dy.
    bits: [u32; 4],
}

impl ProbePoint {
    /// Returns the probe point of a camera: a point toward a corner, in an exposure of the longest
    /// time that the camera accepts, in which the principal point moves a quarter of the stroke.
    ///
    /// # Errors
    /// [`FrameError`] for a camera that cannot correct in such an exposure.
    pub fn of(camera: &Camera, grids: Option<&CameraGrids<'_>>) -> Result<Self, FrameError> {
        let stroke_mm = camera.calibration().parameters().stroke_mm;
        let [_, exposure_s] = camera.limits().exposure_s;
        let sensor = camera.calibration().sensor();
        let [right, up] = PLACE;
        let mut probe = Self {
            point: SensorPoint::new(right * sensor.half_width_mm(), up * sensor.half_height_mm()),
            opening_offset_mm: OPENING_STROKES * stroke_mm,
            speed_mm_s: TRAVEL_STROKES * stroke_mm / exposure_s,
            exposure_s,
            bits: [0; 4],
        };
        probe.bits = probe.computed(camera, grids)?;
        Ok(probe)
    }

    /// Bits of x', y', dx and dy as they were computed when the calibration was stored.
    #[must_use]
    pub const fn bits(&self) -> [u32; 4] {
        self.bits
    }

    /// Bits of x', y', dx and dy as a camera computes them now.
    ///
    /// # Errors
    /// [`FrameError`] for a motion that the camera cannot correct.
    pub fn computed(
        &self,
        camera: &Camera,
        grids: Option<&CameraGrids<'_>>,
    ) -> Result<[u32; 4], FrameError> {
        let travel = UniformTravel {
            opening_offset_mm: self.opening_offset_mm,
            speed_mm_s: self.speed_mm_s,
            exposure_s: self.exposure_s,
        };
        let motion = PrincipalPointMotion::from_plan(travel, camera.shutter());
        let exposure = Exposure::new(0.0, self.exposure_s);
        let frame: Frame = camera.frame_of(&exposure, &motion)?;
        let corrected = match grids {
            Some(grids) => GriddedFrame::new(&frame, grids)
                .correction
                .correct(self.point),
            None => frame.correction.correct(self.point),
        };
        let [x, y] = [corrected.point.x_mm, corrected.point.y_mm];
        let [dx, dy] = [corrected.distortion.dx_mm, corrected.distortion.dy_mm];
        Ok([x, y, dx, dy].map(f32::to_bits))
    }
}
