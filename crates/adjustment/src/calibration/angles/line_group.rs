//! Methods side by side, with the distortions, for the observations of one band.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::budget::{BudgetRow, Uncertainty, budget, paraxial_distortions};
use super::exact::LineCamera;
use super::methods::{DistancePoint, Ray, both, direct, distance_alone, point_alone, quartic};
use super::request::{AngleObservation, AnglesRequest, line_angles, rays, weighted};
use crate::calibration::least_squares::{AdjustmentError, adjust};
use crate::calibration::snooping::count;

/// Largest number of observations of which σ is computed by differences.
const MOST_BY_DIFFERENCES: usize = 1000;

/// A number of a method, mm, with its σ for the given uncertainties, not multiplied by σ0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodParameter {
    /// Name.
    pub name: &'static str,
    /// Value.
    pub value: f64,
    /// σ; `None` for more observations than differences are taken of.
    pub sigma: Option<f64>,
}

/// Numbers of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Name, with the number of the equation in Li et al.
    pub name: &'static str,
    /// Parameters.
    pub parameters: Vec<MethodParameter>,
}

/// Distortion at one angle, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct DistortionRow {
    /// W, degrees.
    pub angle_deg: f64,
    /// L, mm.
    pub l_mm: f64,
    /// D of (1) about f and p of (2).
    pub best_fit_mm: f64,
    /// D of (1) about f0 of the quartic and p of (2).
    pub paraxial_mm: f64,
    /// Distortion of the exact model at the measured place.
    pub exact_mm: f64,
    /// σ of D.
    pub budget: BudgetRow,
}

/// Observations of one band, or of all.
#[derive(Debug, Clone, PartialEq)]
pub struct LineGroup {
    /// Name of the band; `None` for all.
    pub band: Option<Arc<str>>,
    /// Methods.
    pub methods: Vec<Method>,
    /// Distortions in the order of the angles.
    pub rows: Vec<DistortionRow>,
    /// Largest |D|/(f0·|tanW|) about the paraxial f0, as in table 1 of Li et al.
    pub largest_relative: f64,
    /// σ of D of one measurement, from the repetitions, mm; `None` without them.
    pub repeatability_mm: Option<f64>,
}

/// Returns the methods and distortions of observations.
pub(super) fn line_group(
    request: &AnglesRequest<'_>,
    band: Option<Arc<str>>,
    observations: &[&AngleObservation],
) -> Result<LineGroup, AdjustmentError> {
    let rays = rays(observations);
    let uncertainty = request.uncertainty;
    let best = both(&rays);
    let nominal = request.camera.principal_distance_mm;
    let start = best.unwrap_or(DistancePoint {
        f_mm: nominal,
        p_mm: 0.0,
    });
    let first = line_angles(request, observations, start.f_mm, |_| 0.0);
    let model = LineCamera {
        unknowns: [start.f_mm, start.p_mm, 0.0, 0.0, 0.0],
        angles: &first,
    };
    let all = vec![true; first.len()];
    let found = adjust(&model, &all)?.model;
    let weighted = weighted(request, observations, &found);
    let model = LineCamera {
        angles: &weighted,
        ..found
    };
    let exact = adjust(&model, &all)?;
    let [f, p, k1, k2, offset] = exact.model.unknowns;
    let distortion = exact.model.distortion();
    let mut methods = formulas(&rays, uncertainty, nominal);
    let names = [
        "principal_distance_mm",
        "p_mm",
        "k1",
        "k2",
        "angle_offset_rad",
    ];
    let values = [f, p, k1, k2, offset];
    methods.push(Method {
        name: "exact",
        parameters: names
            .into_iter()
            .zip(values)
            .enumerate()
            .map(|(index, (name, value))| MethodParameter {
                name,
                value,
                sigma: exact.cofactors.get((index, index)).map(|one| one.sqrt()),
            })
            .collect(),
    });
    let mut rows = distortion_rows(observations, &rays, uncertainty, |l_mm| {
        distortion.value(l_mm - p)
    });
    let f0 = quartic(&rays).unwrap_or(f);
    let largest_relative = rows
        .iter()
        .filter(|row| row.angle_deg.abs() > 0.1)
        .map(|row| (row.paraxial_mm / (f0 * row.angle_deg.to_radians().tan())).abs())
        .fold(0.0, f64::max);
    let repeatability_mm = repeatability(observations, &rows);
    rows.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg));
    Ok(LineGroup {
        band,
        methods,
        rows,
        largest_relative,
        repeatability_mm,
    })
}

/// Returns the methods of formulas, without those that the angles do not determine.
fn formulas(rays: &[Ray], uncertainty: Uncertainty, nominal: f64) -> Vec<Method> {
    let mut methods = Vec::new();
    let formulas: [(&'static str, &[Formula]); 5] = [
        (
            "(2)",
            &[
                ("principal_distance_mm", |rays, _| Some(both(rays)?.f_mm)),
                ("p_mm", |rays, _| Some(both(rays)?.p_mm)),
            ],
        ),
        (
            "(3)",
            &[("principal_distance_mm", |rays, _| distance_alone(rays))],
        ),
        ("(4)", &[("p_mm", point_alone)]),
        (
            "quartic (6)",
            &[("principal_distance_mm", |rays, _| quartic(rays))],
        ),
        (
            "direct",
            &[
                ("principal_distance_mm", |rays, _| Some(direct(rays)?.f_mm)),
                ("p_mm", |rays, _| Some(direct(rays)?.p_mm)),
            ],
        ),
    ];
    for (name, formulas) in formulas {
        let parameters: Vec<MethodParameter> = formulas
            .iter()
            .filter_map(|(name, formula)| {
                Some(MethodParameter {
                    name,
                    value: formula(rays, nominal)?,
                    sigma: sigma(rays, uncertainty, |rays| formula(rays, nominal)),
                })
            })
            .collect();
        if !parameters.is_empty() {
            methods.push(Method { name, parameters });
        }
    }
    methods
}

/// Returns the distortions in the order of the observations.
fn distortion_rows(
    observations: &[&AngleObservation],
    rays: &[Ray],
    uncertainty: Uncertainty,
    exact: impl Fn(f64) -> f64,
) -> Vec<DistortionRow> {
    let best = both(rays);
    let paraxial = paraxial_distortions(rays);
    let budget = (rays.len() <= MOST_BY_DIFFERENCES)
        .then(|| budget(rays, uncertainty))
        .flatten();
    observations
        .iter()
        .zip(rays)
        .enumerate()
        .map(|(index, (one, (l, t)))| {
            let of_list = |list: &Option<Vec<f64>>| {
                list.as_ref()
                    .and_then(|list| list.get(index).copied())
                    .unwrap_or(f64::NAN)
            };
            DistortionRow {
                angle_deg: one.angle_deg,
                l_mm: *l,
                best_fit_mm: best.map_or(f64::NAN, |best| l - best.f_mm * t + best.p_mm * t * t),
                paraxial_mm: of_list(&paraxial),
                exact_mm: exact(*l),
                budget: budget
                    .as_ref()
                    .and_then(|rows| rows.get(index).copied())
                    .unwrap_or_default(),
            }
        })
        .collect()
}

/// A number of a formula: its name, and its value from the rays and f of the camera file.
type Formula = (&'static str, fn(&[Ray], f64) -> Option<f64>);

/// Returns σ of a number from the uncertainties of places and angles, by differences.
fn sigma(
    rays: &[Ray],
    uncertainty: Uncertainty,
    number: impl Fn(&[Ray]) -> Option<f64>,
) -> Option<f64> {
    if rays.len() > MOST_BY_DIFFERENCES {
        return None;
    }
    let mut variance = 0.0;
    let mut changed = rays.to_vec();
    for (index, (l, t)) in rays.iter().enumerate() {
        let mut half_difference = |plus: Ray, minus: Ray| {
            *changed.get_mut(index)? = plus;
            let above = number(&changed)?;
            *changed.get_mut(index)? = minus;
            let below = number(&changed)?;
            *changed.get_mut(index)? = (*l, *t);
            Some(0.5 * (above - below))
        };
        let place = uncertainty.place_mm;
        let turned = |sign: f64| (t.atan() + sign * uncertainty.angle_rad).tan();
        let by_place = half_difference((l + place, *t), (l - place, *t))?;
        let by_angle = half_difference((*l, turned(1.0)), (*l, turned(-1.0)))?;
        variance += by_place.powi(2) + by_angle.powi(2);
    }
    Some(variance.sqrt())
}

/// Returns σ of D of one measurement from those of the same band and angle.
fn repeatability(observations: &[&AngleObservation], rows: &[DistortionRow]) -> Option<f64> {
    let mut places: BTreeMap<(Option<Arc<str>>, i64), Vec<f64>> = BTreeMap::new();
    for (one, row) in observations.iter().zip(rows) {
        if one.repeat.is_some() {
            #[expect(clippy::cast_possible_truncation, reason = "at most 89,000 m°")]
            let angle = (1e3 * one.angle_deg).round() as i64;
            let key = (one.band.clone(), angle);
            places.entry(key).or_default().push(row.paraxial_mm);
        }
    }
    let (mut squares, mut freedom) = (0.0, 0.0);
    for values in places.values().filter(|values| values.len() > 1) {
        let number = count(values.len());
        let mean = values.iter().sum::<f64>() / number;
        squares += values.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
        freedom += number - 1.0;
    }
    (freedom > 0.0).then(|| f64::sqrt(squares / freedom))
}
