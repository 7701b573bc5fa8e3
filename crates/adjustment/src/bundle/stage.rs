//! Stage of the detector as the images of a flight see it: scale, axis and run-out beside what the
//! records say.

use nalgebra::Vector2;

/// Number of unknowns of the stage.
pub const STAGE_ELEMENTS: usize = 3;

/// An unknown of the stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StageElement {
    /// s: scale of the encoder.
    Scale,
    /// α: axis turned from that of the camera file, rad.
    AxisAngle,
    /// z1: run-out, mm per mm of stage offset.
    RunOut,
}

impl StageElement {
    /// All elements, in the order of tables.
    pub const ALL: [Self; STAGE_ELEMENTS] = [Self::Scale, Self::AxisAngle, Self::RunOut];

    /// Symbol, as on the command line.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Scale => "stage_scale",
            Self::AxisAngle => "stage_axis_angle",
            Self::RunOut => "run_out",
        }
    }

    /// Name with unit, as in a summary.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scale => "stage_scale",
            Self::AxisAngle => "stage_axis_angle_rad",
            Self::RunOut => "run_out_mm_per_mm",
        }
    }

    /// Returns the element with a symbol.
    #[must_use]
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|element| element.symbol() == symbol)
    }
}

/// Stage of one exposure as its record has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageSetting {
    /// Calibrated principal point of the camera file, mm.
    pub principal_point_mm: [f64; 2],
    /// e: direction in which the principal point moves, sensor frame, of length 1.
    pub direction: [f64; 2],
    /// c̄, mm.
    pub offset_mm: f64,
    /// κ = Δz/L of the record.
    pub enlargement: f64,
    /// L, mm.
    pub lever_mm: f64,
}

/// Image point of a stage other than the recorded one, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagePoint {
    /// Point reduced to the calibrated principal point and principal distance, sensor frame, mm.
    pub reduced_mm: [f64; 2],
    /// Derivatives by the unknowns, in the order of [`StageElement::ALL`].
    pub by_element: [Vector2<f64>; STAGE_ELEMENTS],
}

/// Stage relative to that of the camera file: zero for one that the records describe.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stage {
    /// s.
    pub scale: f64,
    /// α, from +x towards +y, rad.
    pub axis_angle_rad: f64,
    /// z1, mm per mm of stage offset, positive away from the lens.
    pub run_out_mm_per_mm: f64,
}

impl Stage {
    /// Value of an element.
    #[must_use]
    pub const fn value(&self, element: StageElement) -> f64 {
        match element {
            StageElement::Scale => self.scale,
            StageElement::AxisAngle => self.axis_angle_rad,
            StageElement::RunOut => self.run_out_mm_per_mm,
        }
    }

    /// Changes an element by a step.
    pub const fn add(&mut self, element: StageElement, step: f64) {
        let value = match element {
            StageElement::Scale => &mut self.scale,
            StageElement::AxisAngle => &mut self.axis_angle_rad,
            StageElement::RunOut => &mut self.run_out_mm_per_mm,
        };
        *value += step;
    }

    /// Reduces an image point that was reduced by the record alone.
    ///
    /// # Model
    /// `PP = (x0, y0) + (1+s)·c̄·e(α)`, `Δz = record + z1·c̄`. A point `p` about the calibrated
    /// principal point that was reduced by the record is `p' = ((1+κ)p + c̄·e - (1+s)c̄·e(α)) /
    /// (1+κ+z1·c̄/L)`. σ stays that of the record's enlargement.
    ///
    /// # Accuracy
    /// Derivatives agree with central differences to 1e-9 relative
    /// (`derivatives_agree_with_central_differences`).
    #[must_use]
    pub fn reduced(&self, setting: &StageSetting, recorded_mm: [f64; 2]) -> StagePoint {
        let centre = Vector2::from(setting.principal_point_mm);
        let [e_x, e_y] = setting.direction;
        let (sin, cos) = self.axis_angle_rad.sin_cos();
        let turned = Vector2::new(cos * e_x - sin * e_y, sin * e_x + cos * e_y);
        let across = Vector2::new(-turned.y, turned.x);
        let (c, scale) = (setting.offset_mm, 1.0 + self.scale);
        let recorded = 1.0 + setting.enlargement;
        let enlarged = recorded + self.run_out_mm_per_mm * c / setting.lever_mm;
        let motion = c * (Vector2::new(e_x, e_y) - scale * turned);
        let point = (recorded * (Vector2::from(recorded_mm) - centre) + motion) / enlarged;
        StagePoint {
            reduced_mm: (centre + point).into(),
            by_element: [
                -c / enlarged * turned,
                -c * scale / enlarged * across,
                -c / setting.lever_mm / enlarged * point,
            ],
        }
    }

    /// Returns an image point reduced to the calibrated principal point and principal distance; as
    /// measured in an image without record.
    #[must_use]
    pub fn reduced_point(&self, setting: Option<&StageSetting>, recorded_mm: [f64; 2]) -> [f64; 2] {
        setting.map_or(recorded_mm, |setting| {
            self.reduced(setting, recorded_mm).reduced_mm
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTING: StageSetting = StageSetting {
        principal_point_mm: [0.05, -0.08],
        direction: [0.6, -0.8],
        offset_mm: 0.4,
        enlargement: 1.3e-4,
        lever_mm: 70.0,
    };

    #[test]
    fn derivatives_agree_with_central_differences() {
        let stage = Stage {
            scale: 0.03,
            axis_angle_rad: -0.2,
            run_out_mm_per_mm: 0.05,
        };
        let point = [17.0, -9.0];
        let exact = stage.reduced(&SETTING, point).by_element;
        for (element, column) in StageElement::ALL.into_iter().zip(exact) {
            let step = 1e-4;
            let at = |sign: f64| {
                let mut moved = stage;
                moved.add(element, sign * step);
                Vector2::from(moved.reduced(&SETTING, point).reduced_mm)
            };
            let numeric = (at(1.0) - at(-1.0)) / (2.0 * step);
            let difference = (numeric - column).norm();
            // Third order of the turn: step²/6; rounding of 17 mm over the step.
            assert!(difference < 1e-8 * column.norm() + 1e-11, "{element:?}");
        }
    }

    #[test]
    fn recorded_stage_leaves_points_where_they_are() {
        let point = [17.0, -9.0];
        let reduced = Stage::default().reduced(&SETTING, point).reduced_mm;
        for (a, b) in reduced.into_iter().zip(point) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn scale_moves_the_principal_point_along_the_axis_and_the_angle_across_it() {
        // Without enlargement: 1 % of 0.4 mm along (0.6, -0.8), and 10 mrad of it along (0.8, 0.6).
        let setting = StageSetting {
            enlargement: 0.0,
            ..SETTING
        };
        let moved = |stage: Stage| {
            let [x, y] = stage.reduced(&setting, [17.0, -9.0]).reduced_mm;
            [x - 17.0, y + 9.0]
        };
        let [x, y] = moved(Stage {
            scale: 0.01,
            ..Stage::default()
        });
        assert!((x + 0.0024).abs() < 1e-12 && (y - 0.0032).abs() < 1e-12);
        let [x, y] = moved(Stage {
            axis_angle_rad: 1e-6,
            ..Stage::default()
        });
        assert!((x + 0.32e-6).abs() < 1e-11 && (y + 0.24e-6).abs() < 1e-11);
    }

    #[test]
    fn symbols_are_read_back() {
        for element in StageElement::ALL {
            assert_eq!(StageElement::from_symbol(element.symbol()), Some(element));
        }
        assert_eq!(StageElement::from_symbol("stage"), None);
    }
}
