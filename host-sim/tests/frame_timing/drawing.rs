//! The timing diagram: states, trigger, shutter, and the stage, one above the other.

use std::ops::Range;

use fmc_camera::flight::controller::state::State;
use plotters::element::{PathElement, Rectangle, Text};
use plotters::prelude::{
    Color, DrawingArea, DrawingAreaErrorKind, IntoDrawingArea, IntoFont, IntoTextStyle, RGBColor,
    SVGBackend, ShapeStyle, TextStyle,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::frame_timing::flight::{Flight, Instant};

const SIZE: (u32, u32) = (1600, 980);
const LEFT: i32 = 250;
const RIGHT: i32 = 1570;
const STATES: Range<i32> = 70..110;
const TRIGGER: Range<i32> = 150..180;
const COMMAND: Range<i32> = 210..240;
const LIGHT: Range<i32> = 270..300;
const OFFSET: Range<i32> = 340..600;
const SPEED: Range<i32> = 640..900;
const FONT: u32 = 24;

const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(222, 226, 232);
const BLUE: RGBColor = RGBColor(0, 114, 178);
const ORANGE: RGBColor = RGBColor(213, 94, 0);
const YELLOW: RGBColor = RGBColor(250, 225, 150);
const WAITING: RGBColor = RGBColor(190, 197, 208);

type Canvas<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// A range of values over a range of pixels, growing upwards.
struct Scale {
    values: Range<f64>,
    pixels: Range<i32>,
}

impl Scale {
    #[expect(clippy::cast_possible_truncation, reason = "pixels of a figure")]
    fn y(&self, value: f64) -> i32 {
        let part = (value - self.values.start) / (self.values.end - self.values.start);
        let height = f64::from(self.pixels.end - self.pixels.start);
        self.pixels.end - (part * height).round() as i32
    }
}

/// Draws the diagram in SVG.
pub(crate) fn svg(flight: &Flight) -> Result<String, DrawingAreaErrorKind<std::io::Error>> {
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        canvas.fill(&plotters::style::WHITE)?;
        draw_time(&canvas, flight)?;
        draw_states(&canvas, flight)?;
        draw_signals(&canvas, flight)?;
        let offset = Scale {
            values: -200.0..100.0,
            pixels: OFFSET,
        };
        let offsets = ["stage offset, µm", "along the FMC axis"];
        let um = |it: &Instant| 1e3 * it.offset_mm;
        draw_curve(&canvas, flight, &offset, (offsets, 50), um)?;
        let speed = Scale {
            values: -20.0..15.0,
            pixels: SPEED,
        };
        let speeds = ["stage speed, mm/s", "f·V/H = 10 mm/s"];
        draw_curve(&canvas, flight, &speed, (speeds, 5), |it| it.speed_mm_s)?;
        canvas.present()?;
    }
    Ok(svg)
}

#[expect(clippy::cast_possible_truncation, reason = "pixels of a figure")]
fn x(flight: &Flight, ms: f64) -> i32 {
    let start_ms = flight.stage[0].ms;
    let part = (ms - start_ms) / (flight.end_ms - start_ms);
    LEFT + (part * f64::from(RIGHT - LEFT)).round() as i32
}

/// Draws the axis of time, and the exposure as a band behind everything.
fn draw_time(canvas: &Canvas<'_>, flight: &Flight) -> Drawn {
    let [opened, closed] = [flight.opened_ms, flight.closed_ms].map(|ms| x(flight, ms));
    fill(canvas, opened..closed, STATES.end..SPEED.end, YELLOW)?;
    for ms in (0..=75).step_by(5) {
        let x = x(flight, f64::from(ms));
        let line = [(x, STATES.end), (x, SPEED.end)];
        canvas.draw(&PathElement::new(line, GRID.stroke_width(1)))?;
        write(canvas, ms.to_string(), (x, SPEED.end + 22), HPos::Center)?;
    }
    let words = "ms after the trigger".to_owned();
    write(
        canvas,
        words,
        (i32::midpoint(LEFT, RIGHT), SPEED.end + 56),
        HPos::Center,
    )
}

fn draw_states(canvas: &Canvas<'_>, flight: &Flight) -> Drawn {
    label(canvas, "state", &STATES)?;
    let ends = flight.states.iter().skip(1).map(|(ms, _)| *ms);
    for ((from, state), to) in flight.states.iter().zip(ends.chain([flight.end_ms])) {
        let [left, right] = [*from, to].map(|ms| x(flight, ms));
        fill(canvas, left..right, STATES, colour(*state))?;
        let frame = [(left, STATES.start), (right, STATES.end)];
        canvas.draw(&Rectangle::new(
            frame,
            ShapeStyle::from(INK).stroke_width(1),
        ))?;
        // The names alternate between two lines, so that neighbours do not touch.
        let line = if *state == State::Tracking { 20 } else { 48 };
        let name = state.name().to_owned();
        write(
            canvas,
            name,
            (i32::midpoint(left, right), line),
            HPos::Center,
        )?;
    }
    Ok(())
}

const fn colour(state: State) -> RGBColor {
    match state {
        State::RunUp => RGBColor(170, 205, 230),
        State::Tracking => RGBColor(110, 170, 210),
        State::Exposing => RGBColor(240, 190, 60),
        State::FlyBack => RGBColor(215, 220, 228),
        _ => plotters::style::WHITE,
    }
}

fn draw_signals(canvas: &Canvas<'_>, flight: &Flight) -> Drawn {
    for (name, rows) in [
        ("trigger", TRIGGER),
        ("shutter command", COMMAND),
        ("light", LIGHT),
    ] {
        label(canvas, name, &rows)?;
        let line = [(LEFT, rows.end), (RIGHT, rows.end)];
        canvas.draw(&PathElement::new(line, INK.stroke_width(1)))?;
    }
    edge(canvas, x(flight, 0.0), TRIGGER)?;
    let [handed_over, command, opened, closed] = [
        flight.handed_over_ms,
        flight.command_ms,
        flight.opened_ms,
        flight.closed_ms,
    ]
    .map(|ms| x(flight, ms));
    fill(canvas, handed_over..command, COMMAND, WAITING)?;
    edge(canvas, command, COMMAND)?;
    fill(canvas, opened..closed, LIGHT, ORANGE)?;
    let words = "grey: the board has it and waits".to_owned();
    let beside = (closed + 14, i32::midpoint(COMMAND.start, COMMAND.end));
    write(canvas, words, beside, HPos::Left)
}

/// Draws a rising edge.
fn edge(canvas: &Canvas<'_>, x: i32, rows: Range<i32>) -> Drawn {
    let line = [(x, rows.end), (x, rows.start), (x + 16, rows.start)];
    canvas.draw(&PathElement::new(line, BLUE.stroke_width(4)))
}

/// Draws a curve with its axis: two lines of words, and a grid line every so many units.
fn draw_curve(
    canvas: &Canvas<'_>,
    flight: &Flight,
    scale: &Scale,
    (words, step): ([&str; 2], usize),
    value: impl Fn(&Instant) -> f64,
) -> Drawn {
    let middle = i32::midpoint(scale.pixels.start, scale.pixels.end);
    for (line, words) in (0..).zip(words) {
        let place = (12, middle + 30 * line - 15);
        write(canvas, words.to_owned(), place, HPos::Left)?;
    }
    for tick in (-200_i32..=150).step_by(step) {
        let tick = f64::from(tick);
        if !(scale.values.start..=scale.values.end).contains(&tick) {
            continue;
        }
        let y = scale.y(tick);
        let width = if tick == 0.0 { 2 } else { 1 };
        let line = [(LEFT, y), (RIGHT, y)];
        canvas.draw(&PathElement::new(line, GRID.stroke_width(width)))?;
        write(canvas, tick.to_string(), (LEFT - 10, y), HPos::Right)?;
    }
    let curve: Vec<_> = flight
        .stage
        .iter()
        .map(|it| (x(flight, it.ms), scale.y(value(it))))
        .collect();
    canvas.draw(&PathElement::new(curve, BLUE.stroke_width(4)))
}

fn label(canvas: &Canvas<'_>, words: &str, rows: &Range<i32>) -> Drawn {
    let middle = i32::midpoint(rows.start, rows.end);
    write(canvas, words.to_owned(), (12, middle), HPos::Left)
}

fn fill(canvas: &Canvas<'_>, columns: Range<i32>, rows: Range<i32>, colour: RGBColor) -> Drawn {
    let corners = [(columns.start, rows.start), (columns.end, rows.end)];
    canvas.draw(&Rectangle::new(corners, colour.filled()))
}

fn write(canvas: &Canvas<'_>, words: String, place: (i32, i32), side: HPos) -> Drawn {
    let style: TextStyle<'_> = ("sans-serif", FONT)
        .into_font()
        .color(&INK)
        .pos(Pos::new(side, VPos::Center))
        .into_text_style(&(0, 0));
    canvas.draw(&Text::new(words, place, style))
}
