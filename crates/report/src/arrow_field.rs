//! Displacements as arrows on the sensor.

use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{ChartBuilder, Color, RGBColor};

use crate::arrow::{Arrow, length_of};
use crate::arrow_scale::ArrowScale;
use crate::figure::{self, Area, Backend, FigureError, GRID, INK, OUTLINE, pixels, text};
use crate::{length, wording};

/// Colour of the arrows.
const ARROW: RGBColor = RGBColor(0, 90, 160);
const WIDTH: u32 = 1200;
const TITLE_HEIGHT: u32 = 125;
const AXIS_WIDTH: u32 = 120;
const AXIS_HEIGHT: u32 = 110;
const EDGE: u32 = 20;
const LEGEND_HEIGHT: u32 = 150;
const FONT: u32 = 36;

/// A field of arrows on the sensor.
#[derive(Debug, Clone)]
pub struct ArrowField<'a> {
    /// Lines above the field.
    pub titles: [String; 2],
    /// Width and height of the sensor, mm.
    pub format_mm: [f64; 2],
    /// The FMC axis as the camera file spells it.
    pub axis: &'a str,
    /// Displacements; none is an error.
    pub arrows: &'a [Arrow],
}

impl ArrowField<'_> {
    /// Draws the figure in SVG.
    ///
    /// # Errors
    /// [`FigureError`] without arrows or if the drawing fails.
    pub(crate) fn svg(&self) -> Result<String, FigureError> {
        figure::svg(self.size(), |canvas| self.draw(canvas))
    }

    /// Width and height of the figure, pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (WIDTH, self.chart_height() + LEGEND_HEIGHT)
    }

    fn scale(&self) -> ArrowScale {
        let lengths = self
            .arrows
            .iter()
            .map(|arrow| length_of(arrow.displacement_mm));
        ArrowScale::fitting(self.format_mm, lengths)
    }

    /// Half of the ranges of the axes, mm.
    fn half_mm(&self) -> [f64; 2] {
        let spacing_mm = self.scale().spacing_mm;
        self.format_mm.map(|format| format / 2.0 + spacing_mm)
    }

    fn pixels_per_mm(&self) -> f64 {
        let [half_x, _] = self.half_mm();
        f64::from(WIDTH - AXIS_WIDTH - 2 * EDGE) / (2.0 * half_x)
    }

    fn chart_height(&self) -> u32 {
        let [_, half_y] = self.half_mm();
        let plot_height = pixels(2.0 * half_y * self.pixels_per_mm()).unsigned_abs();
        TITLE_HEIGHT + plot_height + AXIS_HEIGHT
    }

    /// Draws the figure on an area of its [`size`](Self::size).
    ///
    /// # Errors
    /// [`FigureError`] without arrows or if the drawing fails.
    pub fn draw<B: Backend>(&self, area: &Area<B>) -> Result<(), FigureError> {
        let Self {
            titles,
            format_mm,
            axis,
            arrows,
        } = self;
        if arrows.is_empty() {
            return Err(FigureError::NothingToDraw);
        }
        let scale = self.scale();
        let [half_x, half_y] = self.half_mm();
        for (title, (y, font)) in titles.iter().zip([(36, FONT + 2), (88, FONT - 2)]) {
            area.draw(&Text::new(title.clone(), (20, y), text(font)))?;
        }
        let (upper, legend) = area.split_vertically(self.chart_height());
        let mut chart = ChartBuilder::on(&upper)
            .margin_top(TITLE_HEIGHT)
            .margin_right(EDGE)
            .margin_left(EDGE)
            .x_label_area_size(AXIS_HEIGHT)
            .y_label_area_size(AXIS_WIDTH)
            .build_cartesian_2d(-half_x..half_x, -half_y..half_y)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .axis_style(GRID)
            .label_style(text(FONT - 4))
            .axis_desc_style(text(FONT - 2))
            .x_label_formatter(&|mm| wording::decimals(*mm, 1))
            .y_label_formatter(&|mm| wording::decimals(*mm, 1))
            .x_desc("x, mm")
            .y_desc("y, mm")
            .draw()?;
        let [x, y] = format_mm.map(|format| format / 2.0);
        chart.draw_series([Rectangle::new([(-x, -y), (x, y)], OUTLINE.stroke_width(3))])?;
        let head_mm = 0.28 * scale.spacing_mm;
        let dots = arrows.iter().filter(|arrow| !scale.shows(arrow));
        chart.draw_series(dots.map(|arrow| Circle::new(arrow.from(), 2, ARROW.filled())))?;
        let drawn = arrows.iter().filter(|arrow| scale.shows(arrow));
        chart.draw_series(drawn.map(|arrow| {
            let to = scale.drawn_mm(arrow.displacement_mm);
            PathElement::new(path(arrow.from_mm, to, head_mm), ARROW.stroke_width(3))
        }))?;
        draw_legend(&legend, &scale, self.pixels_per_mm(), axis)
    }
}

/// Returns shaft and head of an arrow in one stroke.
fn path([x, y]: [f64; 2], [dx, dy]: [f64; 2], head: f64) -> Vec<(f64, f64)> {
    let length = length_of([dx, dy]);
    let head = head.min(0.4 * length) / length;
    let tip = (x + dx, y + dy);
    let barb = |side: f64| {
        (
            tip.0 - head * (dx - 0.5 * side * dy),
            tip.1 - head * (dy + 0.5 * side * dx),
        )
    };
    vec![(x, y), tip, barb(1.0), tip, barb(-1.0)]
}

/// Draws length of the arrows and direction of flight, below the axes.
fn draw_legend<B: Backend>(
    legend: &Area<B>,
    scale: &ArrowScale,
    pixels_per_mm: f64,
    axis: &str,
) -> Result<(), FigureError> {
    let left = f64::from(AXIS_WIDTH + EDGE);
    // Pixels count downwards.
    let arrow = |from: [f64; 2], by: [f64; 2], colour: RGBColor| {
        let corners = path(from, by, 18.0);
        let corners: Vec<(i32, i32)> = corners
            .iter()
            .map(|(x, y)| (pixels(*x), pixels(*y)))
            .collect();
        PathElement::new(corners, colour.stroke_width(4))
    };
    let note = |text_at: f64, y: i32, words: String| {
        Text::new(words, (pixels(text_at), y), text(FONT - 4))
    };
    if let Some((sample_mm, drawn_mm)) = scale.sample() {
        let drawn = drawn_mm * pixels_per_mm;
        legend.draw(&arrow([left, 35.0], [drawn, 0.0], ARROW))?;
        let words = format!(
            "= {}, {}",
            length::round(sample_mm),
            scale.exaggeration_text()
        );
        legend.draw(&note(left + drawn + 20.0, 35, words))?;
    } else {
        legend.draw(&note(left, 35, "zero at every point".to_owned()))?;
    }
    let (centre, half) = ([left + 35.0, 105.0], 28.0);
    let direction = match axis {
        "+x" => [1.0, 0.0],
        "-x" => [-1.0, 0.0],
        "-y" => [0.0, 1.0],
        _ => [0.0, -1.0],
    };
    let [x, y] = centre;
    let [dx, dy] = direction.map(|part| part * half);
    legend.draw(&arrow([x - dx, y - dy], [2.0 * dx, 2.0 * dy], INK))?;
    let words = format!("flight: the principal point moves this way ({axis})");
    legend.draw(&note(left + 85.0, 105, words))?;
    Ok(())
}
