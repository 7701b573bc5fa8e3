//! Colours of the models in figures.

use fmc_adjustment::model::Model;
use plotters::prelude::RGBColor;

/// Colour of a model (Okabe and Ito's palette, safe for the colour-blind).
pub(super) const fn colour(model: Model) -> RGBColor {
    match model {
        Model::Uncorrected => RGBColor(95, 95, 95),
        Model::Static => RGBColor(0, 114, 178),
        Model::Printed => RGBColor(213, 94, 0),
        Model::Focus => RGBColor(190, 130, 0),
        Model::Scale => RGBColor(86, 180, 233),
        Model::FiveCoefficient => RGBColor(204, 121, 167),
        Model::Exact => RGBColor(0, 140, 100),
    }
}
