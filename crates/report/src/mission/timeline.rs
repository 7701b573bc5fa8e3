//! One frame, round by round: stage, V/H, shutter and state.

use fmc_simulation::mission::trace::{Round, Trace};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::prelude::{ChartBuilder, Color, RGBColor};

use super::MissionReport;
use super::style::{ALARM, CAMERA, LABELS, TRUTH, WANTED, around, tick};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, Canvas, FONT, FigureError, OUTLINE, SMALL, TITLE, WIDTH, text};
use crate::legend::{self, Entry, Mark};

const SIZE: (u32, u32) = (WIDTH, 1180);
/// Longest time that is drawn, ms after the trigger.
const LONGEST_MS: f64 = 400.0;

/// One curve of a panel.
struct Curve {
    colour: RGBColor,
    width: u32,
    name: &'static str,
    places: Vec<(f64, f64)>,
}

/// One panel of the figure.
struct Panel<'a> {
    title: &'a str,
    unit: &'a str,
    least_width: f64,
    decimals: usize,
    curves: Vec<Curve>,
}

/// Draws the frame whose rounds were kept, in SVG.
///
/// # Errors
/// [`FigureError`] if there is no such frame or the drawing fails.
pub fn timeline(report: &MissionReport<'_>) -> Result<String, FigureError> {
    let trace = report
        .flown
        .trace
        .as_ref()
        .filter(|trace| !trace.rounds.is_empty())
        .ok_or(FigureError::NothingToDraw)?;
    let settings = report.scenario.flight_settings();
    let age_s = f64::from(settings.drive.velocity_loop.reading_age_s);
    let view = View::of(trace, age_s);
    figure::svg(SIZE, |canvas| {
        let title = format!("Trigger {}", trace.sequence);
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let (_, below) = canvas.split_vertically(44);
        let (states, charts) = below.split_vertically(70);
        view.draw_states(&states)?;
        let panels = view.panels();
        let rows = charts.split_evenly((panels.len(), 1));
        for (index, (area, panel)) in rows.iter().zip(&panels).enumerate() {
            view.draw(area, panel, index + 1 == panels.len())?;
        }
        Ok(())
    })
}

/// Rounds that are drawn.
struct View<'a> {
    rounds: Vec<(f64, &'a Round, f64)>,
    from_ms: f64,
    to_ms: f64,
    /// Age of the encoder's readings, s: its curve is drawn at their own times.
    age_s: f64,
}

impl<'a> View<'a> {
    fn of(trace: &'a Trace, age_s: f64) -> Self {
        let rounds: Vec<(f64, &Round, f64)> = trace
            .rounds
            .iter()
            .zip(&trace.true_vh_per_s)
            .map(|(round, vh)| (after_ms(round.time_us, trace.trigger_us), round, *vh))
            .filter(|(ms, ..)| *ms <= LONGEST_MS)
            .collect();
        let time = |round: Option<&(f64, &Round, f64)>| round.map_or(0.0, |(ms, ..)| *ms);
        Self {
            from_ms: time(rounds.first()),
            to_ms: time(rounds.last()) + 1.0,
            age_s,
            rounds,
        }
    }

    fn curve(
        &self,
        colour: RGBColor,
        width: u32,
        name: &'static str,
        value: impl Fn(&Round, f64) -> Option<f64>,
    ) -> Curve {
        let places = self
            .rounds
            .iter()
            .filter_map(|(ms, round, vh)| Some((*ms, value(round, *vh)?)))
            .filter(|(_, value)| value.is_finite());
        Curve {
            colour,
            width,
            name,
            places: places.collect(),
        }
    }

    /// Returns a curve of the encoder, each value at the time at which the stage was there.
    fn encoder(&self, value: impl Fn(&Round) -> Option<f64>) -> Curve {
        let mut curve = self.curve(CAMERA, 2, "encoder", |round, _| value(round));
        for (ms, _) in &mut curve.places {
            *ms = (*ms - 1e3 * self.age_s).max(self.from_ms);
        }
        curve
    }

    /// Returns the set point at the time of a reading, mm.
    fn wanted_at_reading(&self, round: &Round) -> Option<f64> {
        let setpoint = round.setpoint?;
        let [offset_mm, speed_mm_s, acceleration_mm_s2] = [
            setpoint.offset_mm,
            setpoint.speed_mm_s,
            setpoint.acceleration_mm_s2,
        ]
        .map(f64::from);
        let age_s = self.age_s;
        Some(offset_mm - speed_mm_s * age_s + 0.5 * acceleration_mm_s2 * age_s * age_s)
    }

    fn panels(&self) -> Vec<Panel<'static>> {
        let wanted = |round: &Round| round.setpoint.map(|setpoint| f64::from(setpoint.offset_mm));
        vec![
            Panel {
                title: "Stage along the FMC axis",
                unit: "mm",
                least_width: 0.02,
                decimals: 3,
                curves: vec![
                    self.curve(WANTED, 7, "set point", move |round, _| wanted(round)),
                    self.curve(TRUTH, 4, "true", |round, _| Some(round.true_mm)),
                    self.encoder(|round| Some(round.encoder_mm)),
                ],
            },
            Panel {
                title: "Stage less set point",
                unit: "µm",
                least_width: 1.0,
                decimals: 1,
                curves: vec![
                    self.curve(TRUTH, 3, "true", move |round, _| {
                        Some(1e3 * (round.true_mm - wanted(round)?))
                    }),
                    self.encoder(|round| {
                        Some(1e3 * (round.encoder_mm - self.wanted_at_reading(round)?))
                    }),
                ],
            },
            Panel {
                title: "Motor",
                unit: "% duty",
                least_width: 10.0,
                decimals: 0,
                curves: vec![self.curve(CAMERA, 2, "pulse width", |round, _| {
                    Some(100.0 * round.duty)
                })],
            },
            Panel {
                title: "V/H",
                unit: "1/s",
                least_width: 0.002,
                decimals: 4,
                curves: vec![
                    self.curve(TRUTH, 4, "true", |_, vh| Some(vh)),
                    self.curve(CAMERA, 2, "first source", |round, _| {
                        (round.told_vh_per_s != 0.0).then_some(round.told_vh_per_s)
                    }),
                ],
            },
        ]
    }

    /// Draws the open shutter as a shaded band and the beginnings of states as lines.
    fn draw_states(&self, area: &Canvas<'_>) -> Result<(), FigureError> {
        let chart = ChartBuilder::on(area)
            .margin_left(10)
            .margin_right(30)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(self.from_ms..self.to_ms, 0.0..1.0)?;
        area.draw(&Text::new("state", (20, 34), text(FONT)))?;
        let mut last = None;
        let mut names = Vec::new();
        for (ms, round, _) in &self.rounds {
            if last == Some(round.state) {
                continue;
            }
            last = Some(round.state);
            let (x, _) = chart.backend_coord(&(*ms, 0.0));
            let (base_x, _) = area.get_base_pixel();
            let x = x - base_x;
            let line = [(x, 4), (x, 70)];
            area.draw(&PathElement::new(line, OUTLINE.stroke_width(1)))?;
            let name = round.state.to_string();
            let letters = i32::try_from(name.chars().count()).unwrap_or(0);
            let is_late = *ms > self.from_ms + 0.85 * (self.to_ms - self.from_ms);
            let x = if is_late { x - 10 * letters } else { x + 6 };
            names.push((x, name, round.state.name() == "fault"));
        }
        // The names of short states alternate between three lines, so that they do not overlap.
        for ((x, name, is_fault), y) in names.iter().zip([16, 38, 60].into_iter().cycle()) {
            let colour = if *is_fault { ALARM } else { OUTLINE };
            figure::draw_plate(area, name, (*x, y), &text(SMALL).color(&colour))?;
        }
        Ok(())
    }

    fn draw(&self, area: &Canvas<'_>, panel: &Panel<'_>, is_last: bool) -> Result<(), FigureError> {
        let values = panel
            .curves
            .iter()
            .flat_map(|curve| curve.places.iter().map(|(_, value)| *value));
        let [low, high] = around(values, panel.least_width);
        let decimals = panel.decimals;
        let axes = Axes {
            margins: Margins {
                top: 36,
                right: 30,
                left: 10,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: if is_last { 64 } else { 8 },
                labels: if is_last { None } else { Some(0) },
                write: &|ms| tick(*ms, 0),
                name: if is_last { "ms after the trigger" } else { "" },
            },
            y: Axis {
                room: LABELS,
                labels: Some(5),
                write: &|value| tick(*value, decimals),
                name: panel.unit,
            },
        };
        let mut chart = axes.draw(area, self.from_ms..self.to_ms, low..high)?;
        chart.draw_series(
            self.rounds
                .iter()
                .filter(|(_, round, _)| round.is_open)
                .map(|(ms, ..)| {
                    Rectangle::new([(*ms, low), (*ms + 1.0, high)], WANTED.mix(0.18).filled())
                }),
        )?;
        for curve in &panel.curves {
            let style = curve.colour.mix(0.85).stroke_width(curve.width);
            chart.draw_series([PathElement::new(curve.places.clone(), style)])?;
        }
        area.draw(&Text::new(panel.title, (20, 18), text(FONT)))?;
        let mut entries: Vec<Entry<'_>> = panel
            .curves
            .iter()
            .map(|curve| Entry {
                mark: Mark::Line(curve.width),
                colour: curve.colour,
                words: curve.name,
            })
            .collect();
        if area.get_base_pixel().1 < 200 {
            entries.push(Entry {
                mark: Mark::Shade,
                colour: WANTED,
                words: "shutter open",
            });
        }
        legend::draw(area, [270, 18], &entries)?;
        Ok(())
    }
}

/// Returns the milliseconds from one instant to another.
fn after_ms(time_us: u64, since_us: u64) -> f64 {
    let ms = |us: u64| f64::from(u32::try_from(us).unwrap_or(u32::MAX)) / 1000.0;
    if time_us >= since_us {
        ms(time_us - since_us)
    } else {
        -ms(since_us - time_us)
    }
}
