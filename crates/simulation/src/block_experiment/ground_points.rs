//! Ground points of the block: tie, check and control points.

use fmc_adjustment::bundle::tables::RowRole;

use super::scenario::Scenario;
use crate::noise::Noise;
use crate::range::whole;

/// Greatest departure of a point from its place in the grid, as a part of the grid's spacing.
const JITTER: f64 = 0.3;
/// One of so many points is a check point.
const CHECKED: usize = 3;

/// A ground point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GroundPoint {
    /// Place, m.
    pub(super) place_m: [f64; 3],
    /// Part that it plays.
    pub(super) role: RowRole,
}

/// Returns the points of a scenario, the same in every run of a seed: a grid with jitter over all
/// that the frames show. Check and control points lie within the rectangle of the stations, as the
/// edge of a block is known less well.
pub(super) fn ground_points(scenario: &Scenario, seed: u64) -> Vec<GroundPoint> {
    let [along, across] = scenario.plan.footprint_m;
    let [length, width] = scenario.plan.size_m;
    let spacing = (along * across / whole(scenario.written.block.points_per_frame)).sqrt();
    let margin = 0.5 * along.max(across);
    let terrain = scenario.terrain();
    // Runs count from 1.
    let mut noise = Noise::new(seed, 0);
    let mut points = Vec::new();
    for row in places(width, margin, spacing) {
        for column in places(length, margin, spacing) {
            let mut jitter = || spacing * noise.between(-JITTER, JITTER);
            let place = [column + jitter(), row + jitter()];
            let [x, y] = place;
            points.push(GroundPoint {
                place_m: [x, y, terrain.height_at(place)],
                role: RowRole::Approximate,
            });
        }
    }
    let is_inner = |point: &GroundPoint| {
        let [x, y, _] = point.place_m;
        (0.0..=length).contains(&x) && (0.0..=width).contains(&y)
    };
    let inner = points.iter_mut().filter(|point| is_inner(point));
    for (_, point) in inner
        .enumerate()
        .filter(|(number, _)| number % CHECKED == 0)
    {
        point.role = RowRole::Check;
    }
    for _ in 0..scenario.written.control.points {
        let Some(farthest) = farthest(&points, is_inner) else {
            break;
        };
        if let Some(point) = points.get_mut(farthest) {
            point.role = RowRole::Control;
        }
    }
    points
}

/// Returns the places of a grid from before 0 to beyond a length, m.
fn places(length: f64, margin: f64, spacing: f64) -> impl Iterator<Item = f64> {
    (0_u32..)
        .map(move |number| f64::from(number) * spacing - margin)
        .take_while(move |place| *place <= length + margin)
}

/// Returns the tie point that is farthest from the control points; without any, the one farthest
/// from the middle of all.
fn farthest(points: &[GroundPoint], is_inner: impl Fn(&GroundPoint) -> bool) -> Option<usize> {
    let place = |point: &GroundPoint| {
        let [x, y, _] = point.place_m;
        [x, y]
    };
    let mut known: Vec<[f64; 2]> = points
        .iter()
        .filter(|point| point.role == RowRole::Control)
        .map(place)
        .collect();
    if known.is_empty() {
        known.push(points.get(points.len() / 2).map(place)?);
    }
    let distance = |point: &GroundPoint| {
        let [x, y] = place(point);
        let from = known.iter().map(|[u, v]| (x - u).hypot(y - v));
        from.fold(f64::INFINITY, f64::min)
    };
    points
        .iter()
        .enumerate()
        .filter(|(_, point)| point.role == RowRole::Approximate && is_inner(point))
        .max_by(|(_, one), (_, other)| distance(one).total_cmp(&distance(other)))
        .map(|(number, _)| number)
}
