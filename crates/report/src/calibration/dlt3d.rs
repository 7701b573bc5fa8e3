//! Reports of a 3-D direct linear transformation.

use fmc_adjustment::calibration::dlt3d::Dlt3d;
use serde_json::{Map, json};

use super::result::of_method::{OfMethod, PageTable};

/// Returns the content of the reports that belongs to this method alone.
#[must_use]
pub fn of_method(found: &Dlt3d) -> OfMethod {
    let mut summary = Map::new();
    summary.insert("l".to_owned(), json!(found.eleven));
    let rows = found.eleven.map_or_else(Vec::new, |eleven| {
        let numbers = (1..).zip(eleven);
        numbers
            .map(|(index, value)| vec![format!("l{index}"), format!("{value:.9e}")])
            .collect()
    });
    let caption = if rows.is_empty() {
        "The origin of the object frame lies in the principal plane: l1 to l11 do not exist."
            .to_owned()
    } else {
        "x + (l1·X + l2·Y + l3·Z + l4)/(l9·X + l10·Y + l11·Z + 1) = 0, y with l5 to l8; mm and m, of points corrected for radial and decentring distortion.".to_owned()
    };
    OfMethod {
        summary,
        tables: vec![PageTable {
            title: "Coefficients of the transformation".to_owned(),
            columns: vec![String::new(), "value".to_owned()],
            rows,
            caption,
        }],
        ..OfMethod::default()
    }
}
