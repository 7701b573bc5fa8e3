//! Sketch of the network: projection centres and object points in plan.

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::calibration::result::network::{ObjectPoint, PointRole};
use plotters::element::{Cross, Text, TriangleMarker};
use plotters::prelude::{Color, RGBColor};

use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, TITLE, WIDTH, pixels, text};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 860);
/// Colours of stations and of points by role (Okabe and Ito's palette).
const STATION: RGBColor = RGBColor(213, 94, 0);
const NEW: RGBColor = RGBColor(0, 114, 178);
const CONTROL: RGBColor = RGBColor(0, 158, 115);
const CHECK: RGBColor = RGBColor(204, 121, 167);
/// Most new points that are drawn; all points of control are.
const MOST_POINTS: usize = 5000;
/// Images up to which a triangle has its full size, and the sizes, px.
const FULL_SIZE: usize = 300;
const TRIANGLE: [i32; 2] = [3, 10];

/// Draws projection centres and object points in plan, X and Y of the object frame, in SVG.
///
/// # Errors
/// [`FigureError`] without images or if the drawing fails.
pub fn svg(result: &CalibrationResult) -> Result<String, FigureError> {
    let stations = result.images.iter().map(|one| one.position_m);
    let points = result.points.iter().map(|one| one.position_m);
    let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for [x, y, _] in stations.chain(points) {
        for ((least, most), value) in least.iter_mut().zip(&mut most).zip([x, y]) {
            *least = least.min(value);
            *most = most.max(value);
        }
    }
    let ([x_least, y_least], [x_most, y_most]) = (least, most);
    if result.images.is_empty() || !x_least.is_finite() {
        return Err(FigureError::NothingToDraw);
    }
    // The same scale along both axes.
    let half = 0.55 * (x_most - x_least).max(y_most - y_least).max(1e-3);
    let (x, y) = (
        f64::midpoint(x_least, x_most),
        f64::midpoint(y_least, y_most),
    );
    let of_role = |role| result.points.iter().filter(move |one| one.role == role);
    let step = of_role(PointRole::New).count().div_ceil(MOST_POINTS).max(1);
    let [least_size, full_size] = TRIANGLE;
    // As large as the area for each allows.
    let count = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX));
    let share = (count(FULL_SIZE) / count(result.images.len()))
        .sqrt()
        .min(1.0);
    let size = pixels(f64::from(full_size) * share).max(least_size);
    figure::svg(SIZE, |canvas| {
        let title = format!(
            "Network in plan: {}, {}",
            wording::counted(result.images.len(), "image"),
            wording::counted(result.points.len(), "object point")
        );
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let entries = [
            ("image", STATION, Mark::Triangle),
            ("point", NEW, Mark::Cross),
            ("control", CONTROL, Mark::Cross),
            ("check point", CHECK, Mark::Cross),
        ];
        let entries = entries.map(|(words, colour, mark)| Entry {
            mark,
            colour,
            words,
        });
        legend::draw(canvas, [legend::LEFT, 66], &entries)?;
        let write = |metres: &f64| wording::decimals(*metres, 3);
        let axes = Axes {
            margins: Margins {
                top: 92,
                right: 30,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: 76,
                labels: None,
                write: &write,
                name: "X, m",
            },
            y: Axis {
                room: 120,
                labels: None,
                write: &write,
                name: "Y, m",
            },
        };
        let mut chart = axes.draw(canvas, x - half..x + half, y - half..y + half)?;
        let cross = |colour: RGBColor| {
            move |one: &ObjectPoint| {
                let [x, y, _] = one.position_m;
                Cross::new((x, y), 6, colour.stroke_width(2))
            }
        };
        chart.draw_series(of_role(PointRole::New).step_by(step).map(cross(NEW)))?;
        chart.draw_series(result.images.iter().map(|one| {
            let [x, y, _] = one.position_m;
            TriangleMarker::new((x, y), size, STATION.filled())
        }))?;
        // Above the others: they are few, and what is looked for.
        for (role, colour) in [(PointRole::Control, CONTROL), (PointRole::Check, CHECK)] {
            chart.draw_series(of_role(role).map(cross(colour)))?;
        }
        Ok(())
    })
}
