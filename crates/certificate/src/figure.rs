//! Figures of a certificate, drawn from its numbers.

use fmc_reference::lens::Lens;
use fmc_report::arrow::Arrow;
use fmc_report::arrow_field::ArrowField;
use fmc_report::chart::{Axes, Axis, Margins};
use fmc_report::figure::{self, Area, Backend, FigureError, text};
use plotters::element::{PathElement, Polygon, Text};
use plotters::prelude::{Color, RGBColor};

use crate::content::Certificate;
use crate::content::distortion::StaticDistortion;
use crate::content::radial::RadialRow;
use crate::stated::Stated;

/// Arrows along x and along y.
const ARROWS: [u32; 2] = [15, 11];
const GAUSSIAN: RGBColor = RGBColor(0, 90, 160);
const BALANCED: RGBColor = RGBColor(200, 90, 0);
const DECENTRING: RGBColor = RGBColor(0, 130, 90);
const FONT: u32 = 36;
const SIZE: (u32, u32) = (1000, 1000);

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawing {
    /// Distortion as arrows on the sensor.
    Vectors(VectorField),
    /// Radial distortion and decentring over the radius.
    Radial(Vec<[f64; 5]>),
}

/// A field of arrows.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorField {
    titles: [&'static str; 2],
    format_mm: [f64; 2],
    axis: &'static str,
    /// Points and displacements, mm.
    arrows: Vec<[[f64; 2]; 2]>,
}

fn value(stated: Option<&Stated>) -> f64 {
    stated.map_or(0.0, Stated::value)
}

impl Drawing {
    /// Returns the field of the static distortion, from the parameters that the certificate states.
    pub(crate) fn vectors(certificate: &Certificate) -> Self {
        let parameters = &certificate.parameters;
        let of = |name: &str| {
            let line = parameters.values.iter().find(|line| line.name == name);
            line.map_or(0.0, |line| value(line.value.as_ref()))
        };
        let lens = Lens {
            k: ["k0", "k1", "k2", "k3"].map(of),
            p: ["p1", "p2"].map(of),
            b: ["b1", "b2"].map(of),
        };
        let [x0, y0] = ["x0_mm", "y0_mm"].map(of);
        let format_mm = parameters
            .format_mm
            .each_ref()
            .map(|side| value(side.as_ref()));
        let [width, height] = format_mm;
        // A higher sensor than wide has more arrows along y.
        let [along_x, along_y] = if width >= height {
            ARROWS
        } else {
            let [more, fewer] = ARROWS;
            [fewer, more]
        };
        let part = |index: u32, count: u32| f64::from(index) / f64::from(count - 1) - 0.5;
        let places = (0..along_y).flat_map(|row| {
            (0..along_x).map(move |column| [part(column, along_x), part(row, along_y)])
        });
        let arrows = places.map(|[right, up]| {
            let point = [width * right, height * up];
            let [x, y] = point;
            [point, lens.displacement([x - x0, y - y0])]
        });
        Self::Vectors(VectorField {
            titles: [
                "Distortion at rest, measured − ideal",
                "at the calibrated principal point",
            ],
            format_mm,
            axis: certificate.motion.axis,
            arrows: arrows.collect(),
        })
    }

    /// Returns the field of the residual grids.
    pub(crate) fn residual(certificate: &Certificate) -> Self {
        let pair = |stated: &[Option<Stated>; 2]| stated.each_ref().map(|one| value(one.as_ref()));
        let arrows = certificate.residual_grids.field.iter().map(|point| {
            [
                pair(&point.at_mm),
                pair(&point.added_um).map(|um| um / 1000.0),
            ]
        });
        Self::Vectors(VectorField {
            titles: [
                "Residual grids, measured − ideal",
                "the stage at its calibrated position",
            ],
            format_mm: certificate
                .parameters
                .format_mm
                .each_ref()
                .map(|side| value(side.as_ref())),
            axis: certificate.motion.axis,
            arrows: arrows.collect(),
        })
    }

    /// Returns the radial profile.
    pub(crate) fn radial(distortion: &StaticDistortion) -> Self {
        let row = |row: &RadialRow| {
            [
                &row.radius_mm,
                &row.gaussian_um,
                &row.balanced_um,
                &row.decentring_um,
                &row.sigma_um,
            ]
            .map(|stated| value(stated.as_ref()))
        };
        Self::Radial(distortion.profile.iter().map(row).collect())
    }

    /// Width and height, pixels of the drawing.
    #[must_use]
    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method's own lifetime is not general enough"
    )]
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Vectors(field) => field.with(|field| field.size()),
            Self::Radial(_) => SIZE,
        }
    }

    /// Returns its share of the width beside other figures.
    #[must_use]
    pub const fn share(&self) -> f32 {
        match self {
            Self::Vectors(_) => 1.25,
            Self::Radial(_) => 1.0,
        }
    }

    /// Draws the figure on an area of its size.
    ///
    /// # Errors
    /// [`FigureError`] if the drawing fails.
    pub fn draw<B: Backend>(&self, area: &Area<B>) -> Result<(), FigureError> {
        match self {
            Self::Vectors(field) => field.with(|field| field.draw(area)),
            Self::Radial(rows) => radial(area, rows),
        }
    }

    /// Draws the figure in SVG.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn svg(&self) -> Result<String, FigureError> {
        figure::svg(self.size(), |canvas| self.draw(canvas))
    }
}

impl VectorField {
    fn with<T>(&self, run: impl FnOnce(&ArrowField<'_>) -> T) -> T {
        let arrow = |[from_mm, displacement_mm]: &[[f64; 2]; 2]| Arrow {
            from_mm: *from_mm,
            displacement_mm: *displacement_mm,
        };
        let arrows: Vec<Arrow> = self.arrows.iter().map(arrow).collect();
        run(&ArrowField {
            titles: self.titles.map(str::to_owned),
            format_mm: self.format_mm,
            axis: self.axis,
            arrows: &arrows,
        })
    }
}

/// Draws radial distortion and decentring over the radius.
fn radial<B: Backend>(area: &Area<B>, rows: &[[f64; 5]]) -> Result<(), FigureError> {
    let curve = |of: fn(&[f64; 5]) -> f64| -> Vec<(f64, f64)> {
        rows.iter().map(|row| (row[0], of(row))).collect()
    };
    let curves = [
        (
            "radial, Gaussian",
            GAUSSIAN,
            curve(|[_, gaussian, ..]| *gaussian),
        ),
        (
            "radial, balanced",
            BALANCED,
            curve(|[_, _, balanced, ..]| *balanced),
        ),
        (
            "decentring P(r)",
            DECENTRING,
            curve(|[_, _, _, decentring, _]| *decentring),
        ),
    ];
    let upper = curve(|[_, gaussian, _, _, sigma]| gaussian + sigma);
    let lower = curve(|[_, gaussian, _, _, sigma]| gaussian - sigma);
    let values = || {
        let all = curves.iter().flat_map(|(_, _, curve)| curve);
        all.chain(&upper).chain(&lower).map(|(_, um)| *um)
    };
    let (least, most) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    let room = (0.06 * (most - least)).max(1e-3);
    let longest = rows.iter().map(|[r, ..]| *r).fold(0.0, f64::max);
    if longest <= 0.0 {
        return Err(FigureError::NothingToDraw);
    }
    let decimals = if most - least > 5.0 { 0 } else { 2 };
    let axes = Axes {
        margins: Margins {
            top: 125,
            right: 30,
            left: 20,
            bottom: 10,
        },
        font: FONT,
        x: Axis {
            room: 100,
            labels: Some(8),
            write: &|mm| format!("{mm:.0}"),
            name: "radius of the measured point, mm",
        },
        y: Axis {
            room: 150,
            labels: Some(9),
            write: &|um| format!("{:.decimals$}", um + 0.0),
            name: "µm",
        },
    };
    area.draw(&Text::new(
        "Radial distortion and decentring",
        (20, 36),
        text(FONT + 4),
    ))?;
    let mut chart = axes.draw(area, 0.0..longest, (least - room)..(most + room))?;
    let band: Vec<(f64, f64)> = upper.iter().chain(lower.iter().rev()).copied().collect();
    if rows.iter().any(|[.., sigma]| *sigma > 0.0) {
        chart.draw_series([Polygon::new(band, GAUSSIAN.mix(0.25).filled())])?;
    }
    for ((name, colour, curve), x) in curves.into_iter().zip([80, 400, 710]) {
        chart.draw_series([PathElement::new(curve, colour.stroke_width(4))])?;
        let line = vec![(x - 60, 92), (x - 12, 92)];
        area.draw(&PathElement::new(line, colour.stroke_width(5)))?;
        area.draw(&Text::new(name, (x, 92), text(FONT - 2)))?;
    }
    Ok(())
}
