//! Sets of flats: those of all sub-images together, and the light of each.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fmc_composition::rig::Rig;

use crate::failure::Failure;
use crate::formats::named_columns::NamedColumns;

/// Name of the file beside the flats with the light of every set.
const LEVELS: &str = "levels.csv";

/// Returns the light of the sets, exposure time times irradiance, from `levels.csv` beside the
/// flats; `None` without one.
pub(super) fn light(folder: &Path, sets: &[(u32, PathBuf)]) -> Result<Option<Vec<f64>>, Failure> {
    let path = folder.join(LEVELS);
    if !path.exists() {
        return Ok(None);
    }
    let table = NamedColumns::read(&path, &["set", "exposure_s"])?;
    let mut known: BTreeMap<u32, f64> = BTreeMap::new();
    for row in table.rows() {
        let text = row.optional("set").unwrap_or_default();
        let set = text.parse().map_err(|_| {
            row.failure(format!(
                "set = {text} is no number of a set, NN of ID_NN.tif"
            ))
        })?;
        let mut light = 1.0;
        for (column, value) in [
            ("exposure_s", Some(row.number("exposure_s")?)),
            ("irradiance", row.optional_number("irradiance")?),
        ] {
            let value = value.unwrap_or(1.0);
            if value <= 0.0 {
                return Err(row.failure(format!("{column} = {value}; allowed: above 0")));
            }
            light *= value;
        }
        if known.insert(set, light).is_some() {
            return Err(row.failure(format!("set {set} appears twice")));
        }
    }
    let each = sets.iter().map(|(set, _)| {
        known.get(set).copied().ok_or_else(|| {
            Failure::bad_input(format!(
                "{}: no set {set}; it needs a row of every set of flats",
                path.display()
            ))
        })
    });
    each.collect::<Result<_, _>>().map(Some)
}

/// Checks that all sub-images have flats of the same sets.
pub(super) fn check(rig: &Rig, files: &[[Vec<(u32, PathBuf)>; 2]]) -> Result<(), Failure> {
    let numbers =
        |list: &[(u32, PathBuf)]| -> Vec<u32> { list.iter().map(|(set, _)| *set).collect() };
    let Some([first, _]) = files.first() else {
        return Ok(());
    };
    let first = numbers(first);
    for (sub, [flats, _]) in rig.sub.iter().zip(files) {
        let own = numbers(flats);
        let missing = first.iter().find(|set| !own.contains(set));
        let more = own.iter().find(|set| !first.contains(set));
        if let Some(set) = missing.or(more) {
            let of = rig.sub.first().map_or("", |sub| sub.id.as_str());
            return Err(Failure::bad_input(format!(
                "flats: set {set} of sub-images {of} and {} has one flat only; every sub-image needs the same sets, exposed together",
                sub.id
            )));
        }
    }
    Ok(())
}
