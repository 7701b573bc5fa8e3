//! Adjustment of the five coefficients over the link.

#[cfg(feature = "estimation")]
pub(super) use with_estimation::Fitting;
#[cfg(not(feature = "estimation"))]
pub(super) use without_estimation::Fitting;

/// Adjustment of a firmware that has it.
#[cfg(feature = "estimation")]
mod with_estimation {
    use crate::flight::camera::Camera;
    use crate::geometry::estimation::adjustment::Adjustment;
    use crate::geometry::estimation::fit::Fit;
    use crate::geometry::estimation::known_lens::KnownLens;
    use crate::geometry::estimation::options::FitOptions;
    use crate::geometry::sensor::SensorPoint;
    use crate::io::link::message::{Observations, Refusal};

    /// The adjustment, if one has been started.
    #[derive(Debug)]
    pub(in crate::io::link) struct Fitting {
        adjustment: Option<Adjustment<f32>>,
    }

    impl Fitting {
        pub(in crate::io::link) const NONE: Self = Self { adjustment: None };

        /// Forgets the adjustment.
        pub(in crate::io::link) fn end(&mut self) {
            self.adjustment = None;
        }

        /// Starts an adjustment; ends another.
        pub(in crate::io::link) fn start(
            &mut self,
            camera: Option<&Camera>,
            options: FitOptions,
        ) -> Result<u32, Refusal> {
            let camera = camera.ok_or(Refusal::NoCalibration)?;
            let adjustment = Adjustment::new(KnownLens::of(camera.calibration()), options);
            let points = adjustment.points();
            self.adjustment = Some(adjustment);
            Ok(points)
        }

        /// Takes all observations of a batch, or none.
        pub(in crate::io::link) fn observe(
            &mut self,
            camera: Option<&Camera>,
            observations: &Observations,
        ) -> Result<u32, Refusal> {
            let camera = camera.ok_or(Refusal::NoCalibration)?;
            let adjustment = self.adjustment.as_mut().ok_or(Refusal::NoFit)?;
            let calibration = camera.calibration();
            let lens = KnownLens::of(calibration);
            for (index, observation) in (0..).zip(observations) {
                let point = SensorPoint::new(observation.x_mm, observation.y_mm);
                if !calibration.sensor().contains(point) {
                    return Err(Refusal::OffSensor { index });
                }
                observation
                    .checked(&lens)
                    .map_err(|error| Refusal::Observation { index, error })?;
            }
            for (index, observation) in (0..).zip(observations) {
                adjustment
                    .observe(*observation)
                    .map_err(|error| Refusal::Observation { index, error })?;
            }
            Ok(adjustment.points())
        }

        /// Returns the coefficients of all observations so far.
        pub(in crate::io::link) fn fit(&self) -> Result<Fit<f32>, Refusal> {
            let adjustment = self.adjustment.as_ref().ok_or(Refusal::NoFit)?;
            adjustment.fit().map_err(Refusal::Fit)
        }
    }
}

/// Refusal of the adjustment by a firmware that lacks it.
#[cfg(any(test, not(feature = "estimation")))]
mod without_estimation {
    use crate::flight::camera::Camera;
    use crate::geometry::estimation::fit::Fit;
    use crate::geometry::estimation::options::FitOptions;
    use crate::io::link::message::{Observations, Refusal};

    /// No adjustment.
    #[derive(Debug)]
    pub(in crate::io::link) struct Fitting;

    #[allow(clippy::unused_self, reason = "as with the feature")]
    impl Fitting {
        pub(in crate::io::link) const NONE: Self = Self;

        pub(in crate::io::link) const fn end(&mut self) {}

        pub(in crate::io::link) const fn start(
            &mut self,
            _: Option<&Camera>,
            _: FitOptions,
        ) -> Result<u32, Refusal> {
            Err(Refusal::NoEstimation)
        }

        pub(in crate::io::link) const fn observe(
            &mut self,
            _: Option<&Camera>,
            _: &Observations,
        ) -> Result<u32, Refusal> {
            Err(Refusal::NoEstimation)
        }

        pub(in crate::io::link) const fn fit(&self) -> Result<Fit<f32>, Refusal> {
            Err(Refusal::NoEstimation)
        }
    }
    #[cfg(test)]
    mod tests {
        use std::string::ToString as _;

        use super::*;

        #[test]
        fn every_request_of_an_adjustment_is_refused_by_that_name() {
            let mut fitting = Fitting::NONE;
            let refused = Refusal::NoEstimation;
            let options = FitOptions::default();
            assert_eq!(fitting.start(None, options), Err(refused));
            assert_eq!(fitting.observe(None, &Observations::new()), Err(refused));
            fitting.end();
            assert_eq!(fitting.fit(), Err(refused));
            assert_eq!(
                refused.to_string(),
                "its firmware was built without the adjustment of coefficients"
            );
        }
    }
}
