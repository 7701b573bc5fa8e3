//! Inverse of a correction with residual grids.

use super::evaluation_form::Displacement;
use super::exposure_distortion::ExposureDistortion;
use super::frame_correction::{Corrected, Terms};
use super::gridded_correction::GriddedCorrection;
use super::inverse::{DistortError, DistortSliceError, FREE_STEPS, kept_on_sensor, shifted};
use super::newton_step::newton_step;
use super::sensor::SensorPoint;

impl GriddedCorrection<'_> {
    /// Returns the measured point of an ideal one: the inverse of [`Self::correct`].
    ///
    /// # Model
    /// As [`FrameCorrection::distort`], `d - D(ideal + d) - G(ideal + d) = 0` by Newton's method
    /// with the derivatives of the polynomial alone: beside its quadratic convergence every step
    /// leaves the share of the residual that the grids' slope is of the least scale, for 3 µm in
    /// waves of 10 mm 3 µm → 5 nm → 10 pm. It starts from the first step of the polynomial alone. A
    /// step is the last if the polynomial's curvature lets it be and if the grids leave at most
    /// [`LEFT_BY_GRIDS_NM`] of it, or the slope's share of four units in the last place of the
    /// farthest coordinate: as a rule the second.
    ///
    /// [`FrameCorrection::distort`]: super::frame_correction::FrameCorrection::distort
    /// [`LEFT_BY_GRIDS_NM`]: super::gridded_correction::LEFT_BY_GRIDS_NM
    ///
    /// # Units and frames
    /// Sensor frame, mm; the domain is that of [`FrameCorrection::distort`].
    ///
    /// # Accuracy
    /// That of [`FrameCorrection::distort`]; at most two evaluations more
    /// (`tests/geometry/gridded.rs`).
    ///
    /// # Errors
    /// [`DistortError`], as there.
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        if self.is_polynomial() {
            return self.polynomial().distort(ideal);
        }
        match self.free_steps(ideal) {
            Some((measured, _)) => Ok(measured),
            None => kept_on_sensor(self, ideal),
        }
    }

    /// Replaces every ideal point of a slice by its measured point: [`Self::distort`], bit for bit,
    /// point by point, or [`FrameCorrection::distort_slice`] where there are no grids.
    ///
    /// [`FrameCorrection::distort_slice`]: super::frame_correction::FrameCorrection::distort_slice
    ///
    /// # Errors
    /// [`DistortSliceError`] for the first point that has no measured one. The points before it
    /// have been replaced; it and those behind it are unchanged.
    pub fn distort_slice(&self, points: &mut [SensorPoint]) -> Result<(), DistortSliceError> {
        if self.is_polynomial() {
            return self.polynomial().distort_slice(points);
        }
        for (index, point) in points.iter_mut().enumerate() {
            *point = self
                .distort(*point)
                .map_err(|error| DistortSliceError { index, error })?
                .point;
        }
        Ok(())
    }

    /// Takes up to [`FREE_STEPS`] steps that may leave the sensor, and returns the result if one of
    /// them is the last, with its number.
    fn free_steps(&self, ideal: SensorPoint) -> Option<(Corrected, u8)> {
        let coefficients = self.polynomial().coefficients();
        let pair = [ideal.x_mm, ideal.y_mm];
        let [dx_mm, dy_mm] = match self.polynomial().terms() {
            Terms::Short => coefficients.first_step::<false>(pair).distortion,
            Terms::Full => coefficients.first_step::<true>(pair).distortion,
        };
        let last_mm = 1e-6 * self.last_residual_nm(f32::INFINITY);
        let longest2_mm2 = (last_mm * last_mm).min(self.polynomial().longest_last_step2());
        let mut d = Displacement { dx_mm, dy_mm };
        for number in 1..=FREE_STEPS {
            let measured = shifted(ideal, d);
            let distortion = self.distortion(measured);
            let residual = Displacement {
                dx_mm: d.dx_mm - distortion.dx_mm,
                dy_mm: d.dy_mm - distortion.dy_mm,
            };
            let step = newton_step(self.polynomial().jacobian(measured), residual);
            d = Displacement {
                dx_mm: d.dx_mm - step.dx_mm,
                dy_mm: d.dy_mm - step.dy_mm,
            };
            let step2_mm2 = step.dx_mm * step.dx_mm + step.dy_mm * step.dy_mm;
            let point = shifted(ideal, d);
            if step2_mm2 <= longest2_mm2 && self.polynomial().contains(point) {
                let distortion = d;
                return Some((Corrected { point, distortion }, number));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::{Calibration, CalibrationParameters};
    use crate::geometry::camera_grids::CameraGrids;
    use crate::geometry::frame_correction::FrameCorrection;
    use crate::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
    use std::vec::Vec;

    const SIDE: u8 = 33;

    /// Returns a file of waves of 10 mm and the given amplitude over the sensor.
    fn waves(carrier: GridCarrier, amplitude_um: f32) -> Vec<u8> {
        let header = GridHeader {
            carrier,
            columns: u16::from(SIDE),
            rows: u16::from(SIDE),
            first_node: SensorPoint::new(-32.0, -32.0),
            pitch_mm: 2.0,
            scale_mm: 1e-3 * amplitude_um / 30_000.0,
        };
        let mut bytes = header.to_bytes().to_vec();
        for row in 0..SIDE {
            for column in 0..SIDE {
                // The spline takes a tenth off waves of five nodes.
                let phase = |node: u8| f64::from(node) * 0.4 * core::f64::consts::PI;
                for wave in [
                    libm::sin(phase(column)),
                    libm::cos(phase(column) + phase(row)),
                ] {
                    #[expect(clippy::cast_possible_truncation, reason = "at most 32767")]
                    bytes.extend(((32_767.0 * wave) as i16).to_le_bytes());
                }
            }
        }
        bytes.extend(GridHeader::checksum(&bytes).to_le_bytes());
        bytes
    }

    #[test]
    fn grids_take_at_most_two_evaluations_more_than_the_polynomial() {
        let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
        parameters.distortion = Brown {
            k1: -1.6056e-5,
            k2: 6.18966e-9,
            k3: -1.31329e-12,
            p1: 2e-6,
            p2: -4.5e-6,
            ..Brown::NONE
        };
        let calibration = Calibration::new(parameters).unwrap();
        let polynomial = FrameCorrection::without_motion(&calibration);
        // 3 µm in all.
        for amplitudes_um in [[3.0, 0.0], [0.0, 3.0], [1.5, 1.5]] {
            let [lens_um, sensor_um]: [f32; 2] = amplitudes_um;
            let lens = waves(GridCarrier::Lens, lens_um.max(1e-6));
            let sensor = waves(GridCarrier::Sensor, sensor_um.max(1e-6));
            let [lens, sensor] = [&lens, &sensor].map(|file| ResidualGrid::parse(file).ok());
            let grids = CameraGrids::new(&calibration, lens, sensor).unwrap();
            let correction = GriddedCorrection::calibrated(polynomial, &grids);
            let mut largest_nm = 0.0_f32;
            for row in -39_i8..=39 {
                for column in -53_i8..=53 {
                    let measured = SensorPoint::new(0.5 * f32::from(column), 0.5 * f32::from(row));
                    let ideal = correction.correct(measured).point;
                    // The first step of the polynomial alone is its last and evaluates it once.
                    let (_, steps) = correction.free_steps(ideal).unwrap();
                    assert!(steps <= 2, "{steps} steps at {measured:?}");
                    let residual = correction.residual(measured);
                    largest_nm = largest_nm.max(1e6 * residual.dx_mm.abs());
                }
            }
            assert!(
                largest_nm > 2500.0,
                "no structure was tried: {largest_nm} nm"
            );
        }
    }
}
