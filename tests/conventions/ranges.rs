//! Ranges of section 10 that belong to one quantity.

use crate::conventions::document::{names, rows};
use fmc_camera::geometry::range::Quantity;

/// Returns the unit in which a name ends.
fn unit_in(name: &str) -> Option<&'static str> {
    let units = [
        ("_per_mm_s2", "1/(mm/s²)"),
        ("_per_mm_s", "1/(mm/s)"),
        ("_per_mm", "1/mm"),
        ("_n_s_m", "N·s/m"),
        ("_mm_s2", "mm/s²"),
        ("_mm_s3", "mm/s³"),
        ("_mm_s", "mm/s"),
        ("_deg_s", "°/s"),
        ("_deg", "°"),
        ("_percent", "%"),
        ("_per_s", "1/s"),
        ("_m_s", "m/s"),
        ("_mm", "mm"),
        ("_um", "µm"),
        ("_px", "px"),
        ("_ms", "ms"),
        ("_m", "m"),
        ("_s", "s"),
        ("_kg", "kg"),
        ("_hz", "Hz"),
        ("_c", "°C"),
        ("_n", "N"),
    ];
    let name = name.split('[').next()?;
    let (_, unit) = units
        .into_iter()
        .find(|(suffix, _)| name.ends_with(suffix))?;
    Some(unit)
}

fn printed(end: f32) -> String {
    if end.abs() < f32::MAX {
        end.to_string()
    } else {
        "any".to_owned()
    }
}

#[test]
fn documented_ranges_are_those_of_the_code() {
    let of_the_code: Vec<_> = Quantity::ALL
        .iter()
        .map(|quantity| {
            let (least, most) = quantity.range();
            (quantity.name(), printed(least), printed(most))
        })
        .collect();
    let rows = rows("quantity");
    let documented: Vec<_> = rows
        .iter()
        .flat_map(|row| names(row[0]).into_iter().map(move |name| (name, row)))
        .collect();
    for (name, row) in &documented {
        if let Some(unit) = unit_in(name) {
            assert_eq!(row[3], unit, "{name}");
        }
    }
    let documented: Vec<_> = documented
        .into_iter()
        .map(|(name, row)| (name, row[1].to_owned(), row[2].to_owned()))
        .collect();
    assert_eq!(
        documented, of_the_code,
        "every quantity once, in the order of the code"
    );
}
