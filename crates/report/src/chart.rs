//! Charts: axes with labels and grid lines around the room for curves.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};

use crate::figure::{Area, Backend, FigureError, GRID, OUTLINE, text};

/// A chart whose axes have been drawn.
pub type Chart<'a, B, X, Y> = ChartContext<
    'a,
    B,
    Cartesian2d<<X as AsRangedCoord>::CoordDescType, <Y as AsRangedCoord>::CoordDescType>,
>;

/// Room around axes and their labels, pixels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Margins {
    /// Above the room for curves.
    pub top: u32,
    /// To the right of it.
    pub right: u32,
    /// Below the names of the axes.
    pub bottom: u32,
    /// To the left of them.
    pub left: u32,
}

/// One axis of a chart.
#[derive(Clone, Copy)]
#[expect(missing_debug_implementations, reason = "it holds a writer of numbers")]
pub struct Axis<'a> {
    /// Room for its labels and its name, pixels.
    pub room: u32,
    /// Approximate number of labels; `None` leaves it to plotters.
    pub labels: Option<usize>,
    /// Writer of the numbers.
    pub write: &'a dyn Fn(&f64) -> String,
    /// Quantity with its unit; empty if the figure names it elsewhere.
    pub name: &'a str,
}

/// The two axes of a chart.
#[derive(Clone, Copy)]
#[expect(
    missing_debug_implementations,
    reason = "its axes hold writers of numbers"
)]
pub struct Axes<'a> {
    /// Room around the axes.
    pub margins: Margins,
    /// Size of labels and names, pixels.
    pub font: u32,
    /// Horizontal axis.
    pub x: Axis<'a>,
    /// Vertical axis.
    pub y: Axis<'a>,
}

impl Axes<'_> {
    /// Draws the axes of these ranges, with grid lines at their labels.
    ///
    /// # Errors
    /// [`FigureError`] if the drawing fails.
    pub fn draw<'b, B: Backend + 'b, X, Y>(
        &self,
        area: &Area<B>,
        x_range: X,
        y_range: Y,
    ) -> Result<Chart<'b, B, X, Y>, FigureError>
    where
        X: AsRangedCoord<Value = f64, CoordDescType: ValueFormatter<f64>>,
        Y: AsRangedCoord<Value = f64, CoordDescType: ValueFormatter<f64>>,
    {
        let Self {
            margins,
            font,
            x,
            y,
        } = *self;
        let mut chart = ChartBuilder::on(area)
            .margin_top(margins.top)
            .margin_right(margins.right)
            .margin_bottom(margins.bottom)
            .margin_left(margins.left)
            .x_label_area_size(x.room)
            .y_label_area_size(y.room)
            .build_cartesian_2d(x_range, y_range)?;
        let mut mesh = chart.configure_mesh();
        mesh.light_line_style(plotters::style::TRANSPARENT)
            .bold_line_style(GRID)
            .axis_style(OUTLINE)
            .label_style(text(font))
            .axis_desc_style(text(font))
            .x_label_formatter(x.write)
            .y_label_formatter(y.write);
        if let Some(labels) = x.labels {
            mesh.x_labels(labels);
        }
        if let Some(labels) = y.labels {
            mesh.y_labels(labels);
        }
        if !x.name.is_empty() {
            mesh.x_desc(x.name);
        }
        if !y.name.is_empty() {
            mesh.y_desc(y.name);
        }
        mesh.draw()?;
        drop(mesh);
        Ok(chart)
    }
}
