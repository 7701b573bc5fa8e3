//! The residual smear as a table, files and figures.

use std::io::Write;

use fmc_camera_file::CameraFile;
use fmc_simulation::smear::field::{PointSmear, SmearField, SmearRequest};
use fmc_simulation::smear::term::Term;
use serde::Serialize;

use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::figure::FigureError;
use crate::terminal::{self, numbers, words};
use crate::{length, wording};

/// Name of all terms together in files.
const ALL: &str = "all";

/// A camera, an exposure and its smear.
#[derive(Debug, Clone, Copy)]
pub struct SmearReport<'a> {
    /// The camera.
    pub camera: &'a CameraFile,
    /// Request for the smear.
    pub request: &'a SmearRequest,
    /// Fields of every term, then of all together.
    pub fields: &'a [SmearField],
}

/// Content of `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Summary {
    camera: String,
    vh_per_s: f64,
    exposure_s: f64,
    compensated_um: f64,
    pixel_um: f64,
    lens_alone_um: f64,
    terms: Vec<SummaryRow>,
    all: Option<SummaryRow>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SummaryRow {
    #[serde(skip_serializing_if = "Option::is_none")]
    option: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    max_um: f64,
    max_px: f64,
    max_at_mm: [f64; 2],
    bound_um: f64,
    mean_um: f64,
    mean_px: f64,
    simulated_max_um: f64,
}

impl SmearReport<'_> {
    /// Writes the table for a terminal or a pipe.
    #[must_use]
    pub fn text(&self) -> String {
        let columns = [
            words("term"),
            numbers("max\nµm"),
            numbers("max\npx"),
            numbers("at x, y\nmm"),
            numbers("mean\nµm"),
            numbers("mean\npx"),
            numbers("simulated\nmax, µm"),
        ];
        let rows = self.fields.iter().map(|field| {
            let row = self.row(field);
            let [x, y] = row.max_at_mm;
            [
                self.label(field.term),
                format!("{:.3}", row.max_um),
                format!("{:.3}", row.max_px),
                if is_even(field) {
                    "everywhere".to_owned()
                } else {
                    format!("{x:.2}, {y:.2}")
                },
                format!("{:.3}", row.mean_um),
                format!("{:.3}", row.mean_px),
                format!("{:.3}", row.simulated_max_um),
            ]
        });
        [
            format!("camera: {}", self.camera.name),
            self.exposure(),
            terminal::table(columns, rows),
            format!(
                "length of the smear vector from first light to last, over 21 x 21 points of the sensor; px of {} µm",
                self.camera.sensor.pixel_um
            ),
            format!(
                "simulated: physical exposure through the lens of the camera file, which alone leaves {:.3} µm",
                self.request.lens_alone_um(self.camera)
            ),
        ]
        .join("\n")
            + "\n"
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write_summary(&self, mut sink: impl Write) -> std::io::Result<()> {
        let (all, terms): (Vec<&SmearField>, _) =
            self.fields.iter().partition(|field| field.term.is_none());
        let summary = Summary {
            camera: self.camera.name.clone(),
            vh_per_s: self.request.vh_per_s,
            exposure_s: self.request.exposure_s,
            compensated_um: 1e3 * self.compensated_mm(),
            pixel_um: self.camera.sensor.pixel_um,
            lens_alone_um: self.request.lens_alone_um(self.camera),
            terms: terms.into_iter().map(|field| self.row(field)).collect(),
            all: all.first().map(|field| self.row(field)),
        };
        serde_json::to_writer_pretty(&mut sink, &summary)?;
        writeln!(sink)
    }

    /// Writes `smear.csv`: a row per term and point.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write_points(&self, sink: impl Write) -> csv::Result<()> {
        let mut file = csv::Writer::from_writer(sink);
        file.write_record(["term", "x_mm", "y_mm", "smear_x_um", "smear_y_um"])?;
        for field in self.fields {
            for point in &field.points {
                let ([x, y], [smear_x, smear_y]) = (point.point_mm, point.smear_um);
                file.write_record([
                    field.term.map_or(ALL, Term::option).to_owned(),
                    format!("{x:.6}"),
                    format!("{y:.6}"),
                    // Adding zero turns -0 into 0.
                    format!("{:.6}", smear_x + 0.0),
                    format!("{:.6}", smear_y + 0.0),
                ])?;
            }
        }
        file.flush()?;
        Ok(())
    }

    /// Draws every figure, with its file name: all terms together in `smear.svg`, and each of
    /// several terms alone.
    ///
    /// # Errors
    /// [`FigureError`] if the drawing fails.
    pub fn figures(&self) -> Result<Vec<(String, String)>, FigureError> {
        let several = self.fields.len() > 2;
        self.fields
            .iter()
            .filter(|field| several || field.term.is_none())
            .map(|field| {
                let name = match field.term {
                    Some(term) => format!("smear-{}.svg", term.option()),
                    None => "smear.svg".to_owned(),
                };
                Ok((name, self.figure(field)?))
            })
            .collect()
    }

    fn figure(&self, field: &SmearField) -> Result<String, FigureError> {
        let terms = field
            .term
            .map_or_else(|| self.request.disturbances.terms(), |term| vec![term]);
        let causes: Vec<String> = terms.iter().map(|term| self.label(Some(*term))).collect();
        let causes = causes.join(", ");
        // The title has room for some of the terms only.
        let title = match causes.chars().count() {
            0 => "Residual smear: nothing disturbs".to_owned(),
            1..=48 => format!("Residual smear: {causes}"),
            _ => format!("Residual smear: {} terms together", terms.len()),
        };
        let row = self.row(field);
        let second = format!(
            "V/H {}, {}: max {}, mean {}",
            wording::vh(self.request.vh_per_s),
            wording::exposure(self.request.exposure_s),
            length::text(1e-3 * row.max_um),
            length::text(1e-3 * row.mean_um)
        );
        let arrow = |point: &PointSmear| Arrow {
            from_mm: point.point_mm,
            displacement_mm: point.smear_um.map(|um| 1e-3 * um),
        };
        let arrows: Vec<Arrow> = field.points.iter().map(arrow).collect();
        ArrowField {
            titles: [title, second],
            format_mm: self.camera.half_format_mm().map(|half| 2.0 * half),
            axis: self.camera.fmc.axis.name(),
            arrows: &arrows,
        }
        .svg()
    }

    fn row(&self, field: &SmearField) -> SummaryRow {
        let pixel_um = self.camera.sensor.pixel_um;
        let (max_um, max_at_mm) = field
            .largest()
            .map_or((0.0, [0.0; 2]), |point| (point.length_um(), point.point_mm));
        SummaryRow {
            option: field.term.map(Term::option),
            value: field.term.map(|term| self.request.disturbances.value(term)),
            max_um,
            max_px: max_um / pixel_um,
            max_at_mm,
            bound_um: field.bound_um,
            mean_um: field.mean_um(),
            mean_px: field.mean_um() / pixel_um,
            simulated_max_um: field.simulated_max_um,
        }
    }

    fn label(&self, term: Option<Term>) -> String {
        term.map_or_else(
            || "all together".to_owned(),
            |term| {
                let value = wording::decimals(self.request.disturbances.value(term), 4);
                let space = if term.unit() == "%" { " " } else { "" };
                format!("{} {value}{space}{}", term.label(), term.unit())
            },
        )
    }

    fn exposure(&self) -> String {
        format!(
            "exposure: V/H {}, {}, image motion to compensate {}",
            wording::vh(self.request.vh_per_s),
            wording::exposure(self.request.exposure_s),
            length::text(self.compensated_mm())
        )
    }

    /// Returns δ of the true V/H.
    fn compensated_mm(&self) -> f64 {
        self.camera.principal_distance_mm * self.request.vh_per_s * self.request.exposure_s
    }
}

/// Returns true if the smear is the same at every point, to 0.1 nm.
fn is_even(field: &SmearField) -> bool {
    let Some(largest) = field.largest() else {
        return true;
    };
    let [x, y] = largest.smear_um;
    field.points.iter().all(|point| {
        let [other_x, other_y] = point.smear_um;
        (other_x - x).hypot(other_y - y) < 1e-4
    })
}
