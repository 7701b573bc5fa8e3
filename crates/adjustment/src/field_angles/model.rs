//! Area camera on a turntable, with its stage.

use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Rotation3, Vector2, Vector3};

use crate::bundle::interior::{Interior, InteriorElement};
use crate::calibration::least_squares::{Linearised, Model};

/// Terms of the run-out: those of the camera file.
pub(super) const RUN_OUT_TERMS: usize = fmc_camera::geometry::principal_distance::FLATNESS_TERMS;

/// Unknowns of the mount.
pub(super) const MOUNT: usize = 3;

/// A measured direction with its weight.
#[derive(Debug, Clone, Copy)]
pub(super) struct WeightedDirection {
    /// In the frame of the turntable.
    pub(super) direction: Vector3<f64>,
    /// Sensor frame, mm.
    pub(super) measured_mm: [f64; 2],
    /// c, mm.
    pub(super) stage_offset_mm: f64,
    /// σ of either component of the corrected point, mm.
    pub(super) sigma_mm: f64,
}

/// Distortion that the residual grids add at a measured point.
#[derive(Debug, Clone, Copy, Default)]
struct Grids {
    added_mm: Vector2<f64>,
    /// Place in the frame of the lens.
    place_mm: Vector2<f64>,
    /// Derivatives by x and y of that place.
    slopes: [Vector2<f64>; 2],
}

/// The camera of the moment, with its observations.
#[derive(Debug, Clone)]
pub(super) struct FieldCamera<'a> {
    pub(super) interior: Interior,
    /// (1+s)·cosα and (1+s)·sinα.
    pub(super) travel: [f64; 2],
    /// Δz, mm per power of mm of stage offset.
    pub(super) run_out: [f64; RUN_OUT_TERMS],
    /// `camera_from_turntable`.
    pub(super) mount: Rotation3<f64>,
    /// e of the camera file.
    pub(super) axis: [f64; 2],
    /// Residual grids of the camera file.
    pub(super) grids: &'a ResidualSplines,
    /// L, mm; `None` if it is f.
    pub(super) exit_pupil_mm: Option<f64>,
    pub(super) directions: &'a [WeightedDirection],
    pub(super) elements: &'a [InteriorElement],
    /// Terms of the run-out that are unknown, from the first power on: 0 without unknown stage.
    pub(super) run_out_unknowns: usize,
}

impl FieldCamera<'_> {
    /// Returns the number of unknowns of the stage.
    pub(super) const fn stage_unknowns(&self) -> usize {
        if self.run_out_unknowns == 0 {
            0
        } else {
            2 + self.run_out_unknowns
        }
    }

    /// Returns the motion of the principal point by the stage, mm.
    pub(super) fn motion_mm(&self, stage_offset_mm: f64) -> Vector2<f64> {
        let [ex, ey] = self.axis;
        let [along, across] = self.travel;
        stage_offset_mm * Vector2::new(along * ex - across * ey, along * ey + across * ex)
    }

    /// Returns κ = Δz/L at a stage offset.
    pub(super) fn enlargement(&self, stage_offset_mm: f64) -> f64 {
        let terms = self.run_out.iter().rev();
        terms.fold(0.0, |sum, term| sum * stage_offset_mm + term) / self.lever_mm()
    }

    /// Returns L, mm.
    fn lever_mm(&self) -> f64 {
        let f_mm = self.interior.principal_distance_mm;
        self.exit_pupil_mm.unwrap_or(f_mm)
    }

    /// Returns the measured point from the principal point of the moment, at the size that it has
    /// without run-out, mm.
    pub(super) fn shrunk(&self, measured_mm: [f64; 2], stage_offset_mm: f64) -> [f64; 2] {
        let point = Vector2::from(measured_mm)
            - Vector2::from(self.interior.principal_point_mm)
            - self.motion_mm(stage_offset_mm);
        (point / (1.0 + self.enlargement(stage_offset_mm))).into()
    }

    /// Returns what the residual grids add to the distortion of a measured point at a stage offset,
    /// mm, with its derivatives by the place of the lens, x and y.
    fn by_grids(&self, measured_mm: [f64; 2], stage_offset_mm: f64) -> Grids {
        if self.grids.is_empty() {
            return Grids::default();
        }
        let motion = self.motion_mm(stage_offset_mm);
        let scale = 1.0 + self.enlargement(stage_offset_mm);
        let place = (Vector2::from(measured_mm) - motion) / scale;
        let [by_x, by_y] = self.grids.slopes_of_lens(place.into());
        Grids {
            added_mm: self
                .grids
                .moved(measured_mm, motion.into(), scale - 1.0)
                .into(),
            place_mm: place,
            slopes: [by_x.into(), by_y.into()],
        }
    }

    /// Interior orientation about its own principal point.
    pub(super) const fn about_principal_point(&self) -> Interior {
        Interior {
            principal_point_mm: [0.0; 2],
            ..self.interior
        }
    }
}

/// Order of the unknowns: interior; (1+s)cosα, (1+s)sinα, z1, z2; rotation in camera axes.
impl Model<2> for FieldCamera<'_> {
    fn unknowns(&self) -> usize {
        self.elements.len() + self.stage_unknowns() + MOUNT
    }

    fn observations(&self) -> usize {
        self.directions.len()
    }

    fn sigma_mm(&self, index: usize) -> f64 {
        self.directions.get(index).map_or(1.0, |one| one.sigma_mm)
    }

    /// # Model
    /// `docs/calibration.md`: with ρ = (measured - PP)/(1+κ),
    /// `v = (1+κ)·(ρ - D(ρ) - G + f·(u1, u2)/u3)`, G what the residual grids add: that of the lens
    /// at `(measured - (1+s)·c·e(α))/(1+κ)`, that of the sensor at the measured point.
    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    fn linearised(&self, index: usize) -> Option<Linearised<2>> {
        let one = self.directions.get(index)?;
        let c = one.stage_offset_mm;
        let u = self.mount * one.direction;
        if u.z >= 0.0 {
            return None;
        }
        let tangent = u.xy() / u.z;
        let enlarged = 1.0 + self.enlargement(c);
        let point = self.shrunk(one.measured_mm, c);
        let corrected = self
            .about_principal_point()
            .corrected_with_derivatives(point);
        let f = self.interior.principal_distance_mm;
        let grids = self.by_grids(one.measured_mm, c);
        let [by_lens_x, by_lens_y] = grids.slopes;
        let of_point = corrected.ideal_mm - grids.added_mm + f * tangent;
        let residual = enlarged * of_point;
        let [_, by_x0, by_y0, ..] = corrected.by_element;
        let [x, y] = point;
        let by_enlargement = of_point
            + x * by_x0
            + y * by_y0
            + grids.place_mm.x * by_lens_x
            + grids.place_mm.y * by_lens_y;
        // κ = Δz/f falls with f.
        let by_lever = match self.exit_pupil_mm {
            Some(_) => Vector2::zeros(),
            None => by_enlargement * ((1.0 - enlarged) / f),
        };
        let mut columns: Vec<Vector2<f64>> = Vec::with_capacity(self.unknowns());
        for (element, by_element) in InteriorElement::ALL
            .into_iter()
            .zip(corrected.by_element)
            .filter(|(element, _)| self.elements.contains(element))
        {
            columns.push(match element {
                InteriorElement::PrincipalDistance => enlarged * tangent + by_lever,
                // The shrinking takes 1/(1+κ) of a motion of the principal point.
                InteriorElement::X0 | InteriorElement::Y0 => by_element,
                _ => enlarged * by_element,
            });
        }
        if self.run_out_unknowns > 0 {
            let [ex, ey] = self.axis;
            // The stage carries the grid of the lens, the principal point alone does not.
            let (by_x, by_y) = (by_x0 + by_lens_x, by_y0 + by_lens_y);
            columns.push(c * (ex * by_x + ey * by_y));
            columns.push(c * (ex * by_y - ey * by_x));
            let mut power = 1.0;
            for _ in 0..self.run_out_unknowns {
                power *= c;
                columns.push(power / self.lever_mm() * by_enlargement);
            }
        }
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let turned = axis.cross(&u);
            columns.push(enlarged * f / u.z * (turned.xy() - turned.z * tangent));
        }
        Some(Linearised {
            residual: residual.into(),
            derivatives: [
                columns.iter().map(|column| column.x).collect(),
                columns.iter().map(|column| column.y).collect(),
            ],
        })
    }

    fn moved(&self, step: &[f64]) -> Option<Self> {
        let (interior, rest) = step.split_at_checked(self.elements.len())?;
        let (stage, mount) = rest.split_at_checked(self.stage_unknowns())?;
        let mut next = self.clone();
        let elements = InteriorElement::ALL
            .into_iter()
            .filter(|element| self.elements.contains(element));
        for (element, change) in elements.zip(interior) {
            next.interior.add(element, *change);
        }
        let [along, across] = &mut next.travel;
        let [_, terms @ ..] = &mut next.run_out;
        let unknown = [along, across].into_iter().chain(terms);
        for (value, change) in unknown.zip(stage) {
            *value += change;
        }
        let turn = Rotation3::from_scaled_axis(Vector3::from_column_slice(mount));
        next.mount = turn * self.mount;
        next.mount.renormalize();
        (next.interior.principal_distance_mm > 0.0).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use fmc_reference::residual_spline::ResidualSpline;

    use super::*;

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let directions = [WeightedDirection {
            direction: Vector3::new(0.3, -0.2, -0.93),
            measured_mm: [17.0, -11.0],
            stage_offset_mm: 0.7,
            sigma_mm: 1e-3,
        }];
        // Steep ones, 30 µm of waves.
        let nodes = (0..400_u16).map(|node| {
            let [column, row] = [node % 20, node / 20].map(f64::from);
            [
                (0.9 * column + 0.4 * row).sin(),
                (0.7 * row - 0.5 * column).cos(),
            ]
            .map(|wave| 0.03 * wave)
        });
        let spline = ResidualSpline::new([-30.0; 2], 3.0, 20, nodes.collect());
        let grids = ResidualSplines::new(Some(spline.clone()), Some(spline));
        let mut model = FieldCamera {
            interior: Interior {
                principal_distance_mm: 51.4,
                principal_point_mm: [0.06, -0.02],
                k: [1e-4, -1.6e-5, 6e-9, -1.3e-12],
                p: [2e-6, 4.5e-6],
                b: [2e-3, -1e-3],
            },
            travel: [1.002, -0.003],
            run_out: [1e-3, 2e-3, -3e-3, 0.0, 1e-4],
            mount: Rotation3::from_euler_angles(0.01, -0.02, 0.04),
            axis: [0.0, -1.0],
            grids: &grids,
            exit_pupil_mm: Some(70.0),
            directions: &directions,
            elements: &InteriorElement::ALL,
            run_out_unknowns: 2,
        };
        let steps = [
            1e-4, 1e-4, 1e-4, 1e-9, 1e-12, 1e-15, 1e-9, 1e-9, 1e-6, 1e-6, 1e-5, 1e-5, 1e-5, 1e-5,
            1e-6, 1e-6, 1e-6,
        ];
        assert_eq!(steps.len(), model.unknowns());
        for (lever, grids) in [
            (Some(70.0), &grids),
            (None, &grids),
            (None, &ResidualSplines::NONE),
        ] {
            (model.exit_pupil_mm, model.grids) = (lever, grids);
            let row = model.linearised(0).unwrap();
            for (unknown, size) in steps.into_iter().enumerate() {
                let at = |sign: f64| {
                    let mut step = vec![0.0; steps.len()];
                    step[unknown] = sign * size;
                    let moved = model.moved(&step).unwrap();
                    moved.linearised(0).unwrap().residual
                };
                let (plus, minus) = (at(1.0), at(-1.0));
                for component in 0..2 {
                    let difference = (plus[component] - minus[component]) / (2.0 * size);
                    let exact = row.derivatives[component][unknown];
                    let tolerance = 1e-6 * exact.abs() + 1e-13 / size;
                    assert!(
                        (difference - exact).abs() < tolerance,
                        "{unknown} {difference} {exact}"
                    );
                }
            }
        }
    }
}
