//! Files of a calibration.

use fmc_adjustment::calibration::result::CalibrationResult;

use super::of_method::{Figure, OfMethod};
use super::summary::ResultSummary;
use super::{coverage_plot, csv_files, network_plot, page, profile_plot, residual_vectors};
use crate::figure::FigureError;
use crate::page::PageError;

/// A reason why the files cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// A figure or the page failed.
    #[error(transparent)]
    Page(#[from] PageError),
    /// A table failed.
    #[error("cannot write the table: {0}")]
    Csv(#[from] csv::Error),
    /// The summary failed.
    #[error("cannot write the summary: {0}")]
    Json(#[from] serde_json::Error),
}

impl From<FigureError> for FilesError {
    fn from(error: FigureError) -> Self {
        Self::Page(error.into())
    }
}

/// Returns names and contents of the files of a calibration: `summary.json`, `residuals.csv`,
/// `covariance.csv`, `points.csv` where there are object points, figures and `certificate.html`.
/// `date` is that of the calibration, as it is printed.
///
/// # Errors
/// [`FilesError`] if one of them cannot be made.
pub fn files(
    result: &CalibrationResult,
    date: Option<&str>,
    of_method: OfMethod,
) -> Result<Vec<(String, Vec<u8>)>, FilesError> {
    let OfMethod {
        summary: keys,
        tables,
        mut figures,
        files: mut all,
    } = of_method;
    figures.extend(common_figures(result)?);
    let summary = ResultSummary::of(result, keys);
    let page = page::page(result, &summary, date, &tables, &figures)?;
    let mut text = serde_json::to_vec_pretty(&summary)?;
    text.push(b'\n');
    all.push(("summary.json".to_owned(), text));
    let mut residuals = Vec::new();
    csv_files::residuals(result, &mut residuals)?;
    all.push(("residuals.csv".to_owned(), residuals));
    let mut covariance = Vec::new();
    csv_files::covariance(result, &mut covariance)?;
    all.push(("covariance.csv".to_owned(), covariance));
    if !result.points.is_empty() {
        let mut points = Vec::new();
        csv_files::points(result, &mut points)?;
        all.push(("points.csv".to_owned(), points));
    }
    for figure in figures {
        all.push((figure.file_name, figure.svg.into_bytes()));
    }
    all.push(("certificate.html".to_owned(), page.into_bytes()));
    Ok(all)
}

fn common_figures(result: &CalibrationResult) -> Result<Vec<Figure>, FigureError> {
    let figure = |file_name: &str, caption: &str, svg: String| Figure {
        file_name: file_name.to_owned(),
        caption: caption.to_owned(),
        svg,
    };
    let mut figures = vec![figure(
        "profile.svg",
        "Radial distortion about f (Gaussian) and about the balanced principal distance, and decentring distortion, with bands of one σ.",
        profile_plot::svg(result)?,
    )];
    if result.image_residuals.iter().any(|one| !one.is_rejected) {
        figures.push(figure(
            "residual-vectors.svg",
            "Residual vectors of all images over the sensor.",
            residual_vectors::stacked(result)?,
        ));
        if result.images.len() > 1 {
            figures.push(figure(
                "residual-vectors-by-image.svg",
                "Residual vectors image by image, all of one scale.",
                residual_vectors::by_image(result)?,
            ));
        }
        figures.push(figure(
            "coverage.svg",
            "Coverage of the format; the circle is 80 % of the format radius. Of many points, those that would lie on others are left out.",
            coverage_plot::svg(result)?,
        ));
    }
    if !result.images.is_empty() {
        figures.push(figure(
            "network.svg",
            "Projection centres and object points in plan.",
            network_plot::svg(result)?,
        ));
    }
    Ok(figures)
}
