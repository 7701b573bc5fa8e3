//! Charts: axes with labels and grid lines around the room for curves.

use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};

use crate::figure::{Area, Backend, FigureError, GRID, OUTLINE, text};

/// A chart whose axes have been drawn.
pub(crate) type Chart<'a, B, X, Y> = ChartContext<
    'a,
    B,
    Cartesian2d<<X as AsRangedCoord>::CoordDescType, <Y as AsRangedCoord>::CoordDescType>,
>;

/// Room around axes and their labels, pixels.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Margins {
    pub(crate) top: u32,
    pub(crate) right: u32,
    pub(crate) bottom: u32,
    pub(crate) left: u32,
}

/// One axis of a chart.
#[derive(Clone, Copy)]
pub(crate) struct Axis<'a> {
    /// Room for its labels and its name, pixels.
    pub(crate) room: u32,
    /// Approximate number of labels; `None` leaves it to plotters.
    pub(crate) labels: Option<usize>,
    /// Writer of the numbers.
    pub(crate) write: &'a dyn Fn(&f64) -> String,
    /// Quantity with its unit; empty if the figure names it elsewhere.
    pub(crate) name: &'a str,
}

/// The two axes of a chart.
#[derive(Clone, Copy)]
pub(crate) struct Axes<'a> {
    pub(crate) margins: Margins,
    pub(crate) font: u32,
    pub(crate) x: Axis<'a>,
    pub(crate) y: Axis<'a>,
}

impl Axes<'_> {
    /// Draws the axes of these ranges, with grid lines at their labels.
    ///
    /// # Errors
    /// [`FigureError`] if the drawing fails.
    pub(crate) fn draw<'b, B: Backend + 'b, X, Y>(
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
