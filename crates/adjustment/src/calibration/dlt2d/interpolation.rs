//! Interpolation of a distortion table between its targets.

use delaunator::{Point, triangulate};
use nalgebra::{DMatrix, DVector};

/// Targets of a moving quadric.
const QUADRIC_TARGETS: usize = 12;

/// Targets among which triangles are formed around a point.
const TRIANGULATED: usize = 30;

/// Targets of a mean.
const MEAN_TARGETS: usize = 4;

/// Iterations of the inverse bilinear mapping.
const STEPS: usize = 30;

/// Tolerance of a place inside a cell or a triangle, as a share of it.
const INSIDE: f64 = 1e-9;

/// A way to interpolate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolator {
    /// Bilinear in the cells of the target's lattice.
    Bilinear,
    /// Quadric through the 12 nearest targets, with weights that fall to zero.
    MovingQuadric,
    /// Linear in the triangles of Delaunay.
    Triangles,
    /// Mean of the 4 nearest targets.
    NearestMean,
}

impl Interpolator {
    /// All of them, in the order of the reports.
    pub const ALL: [Self; 4] = [
        Self::Bilinear,
        Self::MovingQuadric,
        Self::Triangles,
        Self::NearestMean,
    ];

    /// Returns the name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear",
            Self::MovingQuadric => "moving quadric",
            Self::Triangles => "triangles",
            Self::NearestMean => "mean of 4 nearest",
        }
    }
}

/// A table with the lattice of its targets.
#[derive(Debug, Clone)]
pub struct InterpolatedTable {
    points: Vec<[f64; 2]>,
    values: Vec<[f64; 2]>,
    /// Target in each place of the lattice, by row and column.
    lattice: Vec<Vec<Option<usize>>>,
}

impl InterpolatedTable {
    /// Creates the table from measured points (mm), their values, and their places in the plane,
    /// of which the lattice is made.
    #[must_use]
    pub fn new(points: Vec<[f64; 2]>, values: Vec<[f64; 2]>, plane: &[[f64; 2]]) -> Self {
        Self {
            lattice: lattice(plane),
            points,
            values,
        }
    }

    /// Returns the same table with other values.
    #[must_use]
    pub fn with_values(&self, values: Vec<[f64; 2]>) -> Self {
        Self {
            values,
            ..self.clone()
        }
    }

    /// Interpolates at a point; `None` outside of the targets.
    #[must_use]
    pub fn at(&self, interpolator: Interpolator, point: [f64; 2]) -> Option<[f64; 2]> {
        match interpolator {
            Interpolator::Bilinear => self.bilinear(point),
            _ => self.scattered(interpolator, point, None),
        }
    }

    /// Interpolates at a target from the others; `None` at the border.
    #[must_use]
    pub fn without(&self, interpolator: Interpolator, target: usize) -> Option<[f64; 2]> {
        let point = *self.points.get(target)?;
        match interpolator {
            Interpolator::Bilinear => self.bilinear_without(target),
            _ => self.scattered(interpolator, point, Some(target)),
        }
    }

    /// Returns largest and root mean square error of the interpolation at every target from the
    /// others, over both components, with the number of targets that could be judged.
    #[must_use]
    pub fn cross_validation(&self, interpolator: Interpolator) -> Option<CrossValidation> {
        let mut found = CrossValidation::default();
        let mut squares = 0.0;
        for (target, [x, y]) in self.values.iter().enumerate() {
            if let Some([u, v]) = self.without(interpolator, target) {
                found.targets += 1;
                for error in [u - x, v - y] {
                    squares += error * error;
                    found.largest_mm = found.largest_mm.max(error.abs());
                }
            }
        }
        let count = super::super::snooping::count(2 * found.targets);
        found.rms_mm = (squares / count).sqrt();
        (found.targets > 0).then_some(found)
    }

    fn scattered(
        &self,
        interpolator: Interpolator,
        point: [f64; 2],
        without: Option<usize>,
    ) -> Option<[f64; 2]> {
        let count = match interpolator {
            Interpolator::MovingQuadric => QUADRIC_TARGETS + 1,
            Interpolator::NearestMean => MEAN_TARGETS,
            _ => TRIANGULATED,
        };
        let near = self.nearest(point, count, without);
        match interpolator {
            Interpolator::MovingQuadric => self.quadric(point, &near),
            Interpolator::NearestMean => {
                let values: Vec<[f64; 2]> = near
                    .iter()
                    .filter_map(|(_, index)| self.values.get(*index).copied())
                    .collect();
                let share = 1.0 / super::super::snooping::count(values.len());
                (values.len() == MEAN_TARGETS).then(|| {
                    values
                        .iter()
                        .fold([0.0; 2], |[x, y], [u, v]| [x + share * u, y + share * v])
                })
            }
            _ => self.triangle(point, &near),
        }
    }

    /// Returns squared distance and index of the nearest targets, nearest first.
    fn nearest(&self, [x, y]: [f64; 2], count: usize, without: Option<usize>) -> Vec<(f64, usize)> {
        let mut all: Vec<(f64, usize)> = self
            .points
            .iter()
            .enumerate()
            .filter(|(index, _)| Some(*index) != without)
            .map(|(index, [u, v])| ((u - x).powi(2) + (v - y).powi(2), index))
            .collect();
        if count < all.len() {
            all.select_nth_unstable_by(count, |(a, _), (b, _)| a.total_cmp(b));
            all.truncate(count);
        }
        all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        all
    }

    fn quadric(&self, [x, y]: [f64; 2], near: &[(f64, usize)]) -> Option<[f64; 2]> {
        // The weights are zero at the next target.
        let (limit, _) = *near.get(QUADRIC_TARGETS)?;
        let scale = limit.sqrt().recip();
        let (mut rows, mut right) = (Vec::new(), Vec::new());
        for (square, index) in near.iter().take(QUADRIC_TARGETS) {
            let weight = 1.0 - square / limit;
            let [u, v] = *self.points.get(*index)?;
            let [u, v] = [(u - x) * scale, (v - y) * scale];
            rows.extend([1.0, u, v, u * u, u * v, v * v].map(|one| weight * one));
            right.extend(self.values.get(*index)?.map(|one| weight * one));
        }
        let design = DMatrix::from_row_slice(QUADRIC_TARGETS, 6, &rows);
        let right = DMatrix::from_row_slice(QUADRIC_TARGETS, 2, &right);
        let solution = design.svd(true, true).solve(&right, 1e-9).ok()?;
        Some([*solution.get((0, 0))?, *solution.get((0, 1))?])
    }

    fn triangle(&self, point: [f64; 2], near: &[(f64, usize)]) -> Option<[f64; 2]> {
        let places: Vec<Point> = near
            .iter()
            .filter_map(|(_, index)| self.points.get(*index))
            .map(|[x, y]| Point { x: *x, y: *y })
            .collect();
        let triangles = triangulate(&places).triangles;
        triangles.chunks_exact(3).find_map(|corners| {
            let mut targets = [0; 3];
            for (target, corner) in targets.iter_mut().zip(corners) {
                *target = near.get(*corner)?.1;
            }
            let [a, b, c] = targets.map(|index| self.points.get(index).copied());
            let [a, b, c] = [a?, b?, c?];
            let area = cross(a, b, c);
            let shares = [cross(point, b, c), cross(a, point, c), cross(a, b, point)]
                .map(|part| part / area);
            (area.abs() > 0.0 && shares.iter().all(|share| *share >= -INSIDE))
                .then(|| self.weighted(targets, shares))
                .flatten()
        })
    }

    fn weighted<const N: usize>(&self, targets: [usize; N], shares: [f64; N]) -> Option<[f64; 2]> {
        let mut sum = [0.0; 2];
        for (target, share) in targets.into_iter().zip(shares) {
            let [x, y] = self.values.get(target)?;
            sum = [sum[0] + share * x, sum[1] + share * y];
        }
        Some(sum)
    }

    fn bilinear(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let rows = self.lattice.iter().zip(self.lattice.iter().skip(1));
        rows.into_iter().find_map(|(lower, upper)| {
            let lower = lower.iter().zip(lower.iter().skip(1));
            let upper = upper.iter().zip(upper.iter().skip(1));
            lower
                .zip(upper)
                .find_map(|((a, b), (c, d))| self.in_cell(point, [(*a)?, (*b)?, (*c)?, (*d)?]))
        })
    }

    fn bilinear_without(&self, target: usize) -> Option<[f64; 2]> {
        let (row, column) = self.lattice.iter().enumerate().find_map(|(row, targets)| {
            let column = targets.iter().position(|one| *one == Some(target))?;
            Some((row, column))
        })?;
        let node = |row: usize, column: usize| *self.lattice.get(row)?.get(column)?;
        let (below, left) = (row.checked_sub(1)?, column.checked_sub(1)?);
        let corners = [
            node(below, left)?,
            node(below, column + 1)?,
            node(row + 1, left)?,
            node(row + 1, column + 1)?,
        ];
        self.in_cell(*self.points.get(target)?, corners)
    }

    /// Interpolates in the cell of four targets, the last two over the first two; `None` outside.
    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    fn in_cell(&self, [x, y]: [f64; 2], corners: [usize; 4]) -> Option<[f64; 2]> {
        let [a, b, c, d] = corners.map(|index| self.points.get(index).copied());
        let (a, b, c, d) = (a?, b?, c?, d?);
        let (mut s, mut t) = (0.5, 0.5);
        for _ in 0..STEPS {
            let at = |axis: usize| {
                let [a, b, c, d] =
                    [a, b, c, d].map(|corner| corner.get(axis).copied().unwrap_or(0.0));
                let value =
                    (1.0 - s) * (1.0 - t) * a + s * (1.0 - t) * b + (1.0 - s) * t * c + s * t * d;
                let by_s = (1.0 - t) * (b - a) + t * (d - c);
                let by_t = (1.0 - s) * (c - a) + s * (d - b);
                (value, by_s, by_t)
            };
            let ((u, us, ut), (v, vs, vt)) = (at(0), at(1));
            let determinant = us * vt - ut * vs;
            if determinant.abs() <= f64::MIN_POSITIVE {
                return None;
            }
            let [du, dv] = [x - u, y - v];
            let [ds, dt] = [
                (vt * du - ut * dv) / determinant,
                (us * dv - vs * du) / determinant,
            ];
            s += ds;
            t += dt;
            if s.abs() > 10.0 || t.abs() > 10.0 {
                return None;
            }
            if ds.abs() + dt.abs() < 1e-14 {
                break;
            }
        }
        let inside = -INSIDE..=1.0 + INSIDE;
        (inside.contains(&s) && inside.contains(&t)).then(|| {
            let shares = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
            self.weighted(corners, shares)
        })?
    }
}

/// Errors of an interpolation at targets that it did not know.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CrossValidation {
    /// Targets that could be judged: none at the border.
    pub targets: usize,
    /// Largest error of a component, mm.
    pub largest_mm: f64,
    /// Root of the mean square of both components, mm.
    pub rms_mm: f64,
}

fn cross([ax, ay]: [f64; 2], [bx, by]: [f64; 2], [cx, cy]: [f64; 2]) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Returns the targets by rows and columns of their lattice; places without target are `None`. A
/// coordinate that differs from the last by less than a tenth of the mean spacing is of one row.
fn lattice(plane: &[[f64; 2]]) -> Vec<Vec<Option<usize>>> {
    let [columns, rows] = [0, 1].map(|axis| {
        let coordinate = |point: &[f64; 2]| point.get(axis).copied().unwrap_or(0.0);
        let mut order: Vec<(f64, usize)> = plane
            .iter()
            .enumerate()
            .map(|(index, point)| (coordinate(point), index))
            .collect();
        order.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let extent = match (order.first(), order.last()) {
            (Some((first, _)), Some((last, _))) => last - first,
            _ => 0.0,
        };
        let least = 0.1 * extent / super::super::snooping::count(plane.len()).sqrt();
        let mut lines = vec![0_usize; plane.len()];
        let (mut line, mut before) = (0, f64::NAN);
        for (value, index) in order {
            if value - before > least {
                line += 1;
            }
            before = value;
            if let Some(of_target) = lines.get_mut(index) {
                *of_target = line;
            }
        }
        (lines, line + 1)
    });
    let ((columns, width), (rows, height)) = (columns, rows);
    // Targets without lattice would make it as large as the square of their number.
    if width * height > 4 * plane.len() {
        return Vec::new();
    }
    let mut lattice = vec![vec![None; width]; height];
    for (index, (column, row)) in columns.into_iter().zip(rows).enumerate() {
        if let Some(place) = lattice.get_mut(row).and_then(|row| row.get_mut(column)) {
            *place = Some(index);
        }
    }
    lattice
}

/// Returns k0, k1, k2 of (9) fitted to a table by least squares about a principal point, and what
/// they leave; `None` if the targets do not determine them.
///
/// # Model
/// Feng et al. (9): `Δx = x̄(k0 + k1·r² + k2·r⁴)`, Δy likewise.
#[must_use]
pub fn main_term(
    points: &[[f64; 2]],
    values: &[[f64; 2]],
    [x0, y0]: [f64; 2],
) -> Option<([f64; 3], Vec<[f64; 2]>)> {
    let radius = points
        .iter()
        .map(|[x, y]| (x - x0).hypot(y - y0))
        .fold(0.0, f64::max);
    if radius <= 0.0 {
        return None;
    }
    let terms = |[x, y]: [f64; 2]| {
        let [x, y] = [(x - x0) / radius, (y - y0) / radius];
        let square = x * x + y * y;
        [x, y].map(|one| [one, one * square, one * square * square])
    };
    let rows: Vec<f64> = points
        .iter()
        .flat_map(|point| terms(*point))
        .flatten()
        .collect();
    let right: Vec<f64> = values.iter().flatten().copied().collect();
    let design = DMatrix::from_row_slice(right.len(), 3, &rows);
    let right = DVector::from_vec(right);
    let solution = design.clone().svd(true, true).solve(&right, 1e-12).ok()?;
    let left = right - design * &solution;
    let remainder = left
        .as_slice()
        .chunks_exact(2)
        .filter_map(|pair| <[f64; 2]>::try_from(pair).ok())
        .collect();
    let [k0, k1, k2] = [0, 1, 2].map(|index| solution.get(index).copied().unwrap_or(0.0));
    let k = [k0 / radius, k1 / radius.powi(3), k2 / radius.powi(5)];
    Some((k, remainder))
}
