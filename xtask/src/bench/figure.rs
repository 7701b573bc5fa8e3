//! Figure of the comparison: instructions per point on the microcontrollers, time per point on a
//! PC.

use anyhow::{Result, anyhow};
use plotters::{
    coord::Shift,
    element::{Circle, EmptyElement, PathElement, Rectangle, Text},
    prelude::{
        ChartBuilder, Color, DrawingArea, IntoDrawingArea, IntoFont, IntoLogRange, IntoTextStyle,
        RGBColor, SVGBackend, TextStyle, WHITE,
    },
    style::text_anchor::{HPos, Pos, VPos},
};

use super::comparison::{OURS_ON_A_PC, Row};
use crate::cores::CORES;

const SIZE: (u32, u32) = (1500, 720);
const INK: RGBColor = RGBColor(40, 44, 52);
const GRID: RGBColor = RGBColor(222, 226, 232);

/// Colours of the cores, in their order.
const SHADES: [RGBColor; 3] = [
    RGBColor(31, 78, 121),
    RGBColor(91, 143, 199),
    RGBColor(217, 130, 43),
];

/// Bars from top to bottom: rows of the table with their labels.
const BARS: [(&str, &str); 9] = [
    ("correct_slice", "correct_slice, short"),
    ("correct_slice_full", "correct_slice, full"),
    ("correct", "correct, point by point"),
    ("mesh_row", "mesh row, K3 = 0"),
    ("mesh_row_k3", "mesh row, K3"),
    ("distort_slice", "distort_slice, short"),
    ("opencv_ros_camera_undistort", "opencv-ros-camera undistort"),
    ("opencv_ros_camera_distort", "opencv-ros-camera distort"),
    ("opencv_ros_camera_project", "opencv-ros-camera project"),
];

/// Ratio of two lines below which their labels would overlap.
const CLOSE: f64 = 2.0;

/// Times of one contender by number of points.
struct Line {
    /// End of the name of its rows; of instruction sets the widest comes first.
    rows: &'static str,
    name: &'static str,
    colour: RGBColor,
}

const LINES: [Line; 5] = [
    Line {
        rows: "undistortPoints",
        name: "OpenCV undistortPoints",
        colour: RGBColor(150, 60, 60),
    },
    Line {
        rows: "opencv-ros-camera undistort",
        name: "opencv-ros-camera undistort, f64",
        colour: RGBColor(200, 110, 110),
    },
    Line {
        rows: "portable short pairs in place",
        name: "short, no vectors",
        colour: RGBColor(150, 150, 150),
    },
    Line {
        rows: OURS_ON_A_PC,
        name: "short, widest vectors",
        colour: RGBColor(31, 78, 121),
    },
    Line {
        rows: "memcpy x, y",
        name: "copying x and y",
        colour: RGBColor(60, 150, 90),
    },
];

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws the figure as SVG.
///
/// # Errors
/// An error if the drawing fails.
pub(super) fn svg(rows: &[Row]) -> Result<String> {
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        canvas.fill(&WHITE).map_err(|error| anyhow!("{error}"))?;
        let (left, right) = canvas.split_horizontally(820);
        bars(&left, rows)?;
        lines(&right, rows)?;
        canvas.present().map_err(|error| anyhow!("{error}"))?;
    }
    Ok(svg)
}

fn text(size: u32, horizontal: HPos) -> TextStyle<'static> {
    let style = ("sans-serif", size).into_font().color(&INK);
    style
        .pos(Pos::new(horizontal, VPos::Center))
        .into_text_style(&(0, 0))
}

/// Draws instructions per point on the cores, with the modelled cycles where there are any.
fn bars(canvas: &Canvas<'_>, rows: &[Row]) -> Result<()> {
    let find = |kernel: &str, core: &str| {
        let is_it = |row: &&Row| row.kernel == kernel && row.core == core;
        let row = rows.iter().find(is_it)?;
        Some((row.instructions?, row.cycles))
    };
    let all = BARS
        .iter()
        .flat_map(|(kernel, _)| CORES.map(|core| find(kernel, core.name)));
    let most = 1.12 * all.flatten().fold(1.0, |most, (count, _)| count.max(most));
    let height = 4 * BARS.len();
    let mut chart = ChartBuilder::on(canvas)
        .caption(
            "Instructions per point, counted in QEMU; cycles of the loop, modelled",
            text(20, HPos::Center),
        )
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(230)
        .build_cartesian_2d(0.0..most, 0.0..place(height))?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .y_labels(0)
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(WHITE)
        .x_label_formatter(&|count| format!("{count:.0}"))
        .label_style(text(15, HPos::Center))
        .draw()?;
    let area = chart.plotting_area();
    for (index, (kernel, name)) in BARS.iter().enumerate() {
        let top = height - 4 * index;
        let beside = EmptyElement::at((0.0, place(top) - 2.0));
        area.draw(&(beside + Text::new(*name, (-10, 0), text(16, HPos::Right))))?;
        for (below, (core, shade)) in CORES.iter().zip(SHADES).enumerate() {
            let Some((count, cycles)) = find(kernel, core.name) else {
                continue;
            };
            let from = place(top - below) - 0.5;
            let bar = [(0.0, from - 0.92), (count, from)];
            area.draw(&Rectangle::new(bar, shade.filled()))?;
            let cycles = cycles.map(|cycles| format!("; {cycles:.1} cycles"));
            let costs = format!("{count:.1}{}", cycles.unwrap_or_default());
            let behind = EmptyElement::at((count, from - 0.46));
            area.draw(&(behind + Text::new(costs, (6, 0), text(13, HPos::Left))))?;
        }
    }
    for (below, (core, shade)) in CORES.iter().zip(SHADES).enumerate() {
        let middle = place(height - below) - 1.0;
        let key = [(0.72 * most, middle - 0.4), (0.75 * most, middle + 0.4)];
        area.draw(&Rectangle::new(key, shade.filled()))?;
        area.draw(&Text::new(
            core.name,
            (0.76 * most, middle),
            text(16, HPos::Left),
        ))?;
    }
    Ok(())
}

/// Converts an index into a position on the axis of bars.
fn place(index: usize) -> f64 {
    u32::try_from(index).map_or(f64::MAX, f64::from)
}

/// Draws time per point on a PC.
fn lines(canvas: &Canvas<'_>, rows: &[Row]) -> Result<()> {
    let series: Vec<(&Line, Vec<(f64, f64)>)> = LINES
        .iter()
        .filter_map(|line| {
            let is_it = |row: &&Row| row.ns.is_some() && row.kernel.ends_with(line.rows);
            let first = rows.iter().find(is_it)?;
            let same = rows.iter().filter(|row| row.kernel == first.kernel);
            let dots = same.filter_map(|row| Some((f64::from(row.points?), row.ns?)));
            Some((line, dots.collect()))
        })
        .collect();
    let dots = || series.iter().flat_map(|(_, dots)| dots);
    let extent = |of: fn(&(f64, f64)) -> f64| {
        dots()
            .map(of)
            .fold((f64::MAX, 0.0), |(least, most): (f64, f64), value| {
                (least.min(value), most.max(value))
            })
    };
    let ((fewest, most), (fastest, slowest)) = (extent(|dot| dot.0), extent(|dot| dot.1));
    if series.is_empty() {
        return Ok(());
    }
    let (along, up) = (0.6 * fewest..1.7 * most, 0.6 * fastest..2.0 * slowest);
    let mut chart = ChartBuilder::on(canvas)
        .caption("ns per point on a PC, one thread", text(20, HPos::Center))
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(along.log_scale(), up.log_scale())?;
    chart
        .configure_mesh()
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(WHITE)
        .x_desc("points to a call")
        .x_label_formatter(&|points| format!("1e{:.0}", points.log10()))
        .label_style(text(15, HPos::Center))
        .draw()?;
    let area = chart.plotting_area();
    // The label goes above a dot, or below it if another line runs close above.
    let all: Vec<_> = dots().copied().collect();
    let side = |(points, ns): (f64, f64)| {
        let is_close = |other: &&(f64, f64)| {
            other.0.to_bits() == points.to_bits() && other.1 > ns && other.1 < CLOSE * ns
        };
        if all.iter().any(|other| is_close(&other)) {
            1
        } else {
            -1
        }
    };
    for (line, dots) in series {
        area.draw(&PathElement::new(dots.clone(), line.colour.stroke_width(2)))?;
        for dot in &dots {
            area.draw(&Circle::new(*dot, 4, line.colour.filled()))?;
            let offset = (0, 14 * side(*dot));
            let time = Text::new(format!("{:.2}", dot.1), offset, text(12, HPos::Center));
            area.draw(&(EmptyElement::at(*dot) + time))?;
        }
        if let Some(dot) = dots.get(1) {
            let style = text(15, HPos::Center).color(&line.colour);
            let name = Text::new(line.name, (0, 32 * side(*dot)), style);
            area.draw(&(EmptyElement::at(*dot) + name))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::{comparison::Row, documented};

    #[test]
    fn committed_figure_is_that_of_the_committed_table() {
        let rows: Vec<Row> = documented::table("docs/performance.csv");
        let drawn = super::svg(&rows).unwrap();

        let committed = include_str!("../../../docs/figures/performance.svg");
        assert!(drawn == committed, "cargo xtask bench --update draws it");
    }
}
