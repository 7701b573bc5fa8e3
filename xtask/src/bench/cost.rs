//! What the camera's work costs: the rows of `docs/instructions.csv` and `docs/footprint.csv`, and what makes one worse
//! than another.

use std::{collections::BTreeSet, fmt, path::Path};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// By how much a cost may exceed that of the table before the table has to change.
const MAX_RISE: f64 = 0.01;

/// Kernels with a limit of their own: core, kernel, instructions per point.
const LIMITS: [(&str, &str, f64); 34] = [
    ("cortex-m4f", "correct_slice", 25.0),
    ("cortex-m4f", "correct_slice_xy", 25.0),
    ("cortex-m4f", "correct_slice_full", 29.0),
    ("cortex-m4f", "correct_slice_xy_full", 29.0),
    ("cortex-m4f", "correct_slice_256", 25.0),
    ("cortex-m4f", "correct_slice_full_256", 29.0),
    ("cortex-m4f", "distort", 150.0),
    ("cortex-m4f", "distort_full", 150.0),
    ("cortex-m4f", "mesh_row", 16.0),
    ("cortex-m4f", "mesh_row_k3", 20.0),
    ("cortex-m4f", "mesh_row_k3_16px", 20.0),
    ("cortex-m4f", "mesh_row_k3_32px", 20.0),
    ("cortex-m4f", "mesh_row_k3_64px", 20.0),
    ("cortex-m4f", "mesh_row_k3_128px", 20.0),
    ("cortex-m4f", "mesh_row_k3_64px_104mm", 20.0),
    ("cortex-m7", "correct_slice", 25.0),
    ("cortex-m7", "correct_slice_xy", 25.0),
    ("cortex-m7", "correct_slice_full", 29.0),
    ("cortex-m7", "correct_slice_xy_full", 29.0),
    ("cortex-m7", "correct_slice_256", 25.0),
    ("cortex-m7", "correct_slice_full_256", 29.0),
    ("cortex-m7", "distort", 150.0),
    ("cortex-m7", "distort_full", 150.0),
    ("cortex-m7", "mesh_row", 16.0),
    ("cortex-m7", "mesh_row_k3", 20.0),
    ("cortex-m7", "mesh_row_k3_16px", 20.0),
    ("cortex-m7", "mesh_row_k3_32px", 20.0),
    ("cortex-m7", "mesh_row_k3_64px", 20.0),
    ("cortex-m7", "mesh_row_k3_128px", 20.0),
    ("cortex-m7", "mesh_row_k3_64px_104mm", 20.0),
    ("cortex-m55", "correct_slice", 7.1),
    ("cortex-m55", "correct_slice_xy", 7.1),
    ("cortex-m55", "correct_slice_full", 9.9),
    ("cortex-m55", "correct_slice_xy_full", 9.9),
];

/// A row of the table of instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Instructions {
    pub(crate) core: String,
    pub(crate) kernel: String,
    /// Per point, or per what `unit` says.
    #[serde(rename = "instructions_per_point")]
    pub(crate) count: f64,
    pub(crate) unit: String,
    /// Instructions are the compiler's: another one may need more or fewer.
    pub(crate) compiler: String,
}

/// A row of the table of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Footprint {
    pub(crate) image: String,
    pub(crate) flash_bytes: u64,
    /// Of variables: without the stack.
    pub(crate) static_ram_bytes: u64,
    /// Most that was in use while `host-sim verify` ran.
    pub(crate) stack_used_bytes: u64,
    pub(crate) compiler: String,
}

/// Something that has a cost: named, comparable where the group is the same.
pub(crate) trait Cost {
    /// What costs it.
    fn name(&self) -> String;
    /// What is measured together: rows of one compiler and core compare with each other.
    fn group(&self) -> (&str, &str);
    /// What it costs, each with its unit.
    fn costs(&self) -> Vec<(f64, String)>;
    /// What it may cost at most, whatever the table says.
    fn limit(&self) -> Option<f64> {
        None
    }
}

impl Cost for Instructions {
    fn name(&self) -> String {
        format!("{} on {}", self.kernel, self.core)
    }

    fn group(&self) -> (&str, &str) {
        (&self.compiler, &self.core)
    }

    fn costs(&self) -> Vec<(f64, String)> {
        vec![(self.count, format!("instructions per {}", self.unit))]
    }

    fn limit(&self) -> Option<f64> {
        LIMITS
            .iter()
            .find(|(core, kernel, _)| *core == self.core && *kernel == self.kernel)
            .map(|(_, _, limit)| *limit)
    }
}

impl Cost for Footprint {
    fn name(&self) -> String {
        format!("image {}", self.image)
    }

    fn group(&self) -> (&str, &str) {
        (&self.compiler, &self.image)
    }

    fn costs(&self) -> Vec<(f64, String)> {
        [
            (self.flash_bytes, "bytes of flash"),
            (self.static_ram_bytes, "bytes of static RAM"),
            (self.stack_used_bytes, "bytes of stack"),
        ]
        .map(|(bytes, unit)| (count(bytes), unit.to_owned()))
        .to_vec()
    }
}

/// Bytes of an image, as a number that can be divided.
#[allow(
    clippy::cast_precision_loss,
    reason = "images are smaller than 2^52 bytes"
)]
fn count(bytes: u64) -> f64 {
    bytes as f64
}

/// What has become worse, or cannot be told.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Finding {
    /// It costs more than the table says.
    Dearer {
        name: String,
        unit: String,
        table: f64,
        now: f64,
    },
    /// It costs more than it ever may.
    OverLimit { name: String, limit: f64, now: f64 },
    /// It is measured and not in the table, or the other way round.
    Unmatched { name: String },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dearer {
                name,
                unit,
                table,
                now,
            } => write!(f, "{name}: {now} {unit}, the table says {table}"),
            Self::OverLimit { name, limit, now } => {
                write!(f, "{name}: {now}, the limit is {limit}")
            }
            Self::Unmatched { name } => {
                write!(f, "{name}: it is not both in the table and measured")
            }
        }
    }
}

/// Compares what was measured with the rows of the same group. Where the table has none of that group, the limits alone
/// hold; groups that were not measured are passed over.
pub(crate) fn compare<T: Cost>(table: &[T], measured: &[T]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for row in measured {
        for (now, unit) in row.costs() {
            if let Some(limit) = row.limit().filter(|limit| now > *limit) {
                let name = format!("{}, {unit}", row.name());
                findings.push(Finding::OverLimit { name, limit, now });
            }
        }
    }
    let is_in = |rows: &[T], row: &T| rows.iter().any(|other| other.group() == row.group());
    let known = measured.iter().filter(|row| is_in(table, row));
    let table: Vec<&T> = table.iter().filter(|row| is_in(measured, row)).collect();
    for row in known {
        let name = row.name();
        let Some(known) = table.iter().find(|known| known.name() == name) else {
            findings.push(Finding::Unmatched { name });
            continue;
        };
        for ((table, unit), (now, _)) in known.costs().into_iter().zip(row.costs()) {
            if now > table * (1.0 + MAX_RISE) {
                let name = name.clone();
                findings.push(Finding::Dearer {
                    name,
                    unit,
                    table,
                    now,
                });
            }
        }
    }
    for row in table {
        let name = row.name();
        if !measured.iter().any(|now| now.name() == name) {
            findings.push(Finding::Unmatched { name });
        }
    }
    findings
}

/// The groups of which the table has no row.
pub(crate) fn new_groups<'a, T: Cost>(
    table: &[T],
    measured: &'a [T],
) -> BTreeSet<(&'a str, &'a str)> {
    let known: BTreeSet<_> = table.iter().map(T::group).collect();
    let groups = measured.iter().map(T::group);
    groups.filter(|group| !known.contains(group)).collect()
}

/// Replaces the rows of the groups of `measured` in a table, which may be new.
///
/// # Errors
/// Where the table cannot be read or written.
pub(crate) fn replace<T: Cost + Serialize + DeserializeOwned>(
    path: &Path,
    measured: Vec<T>,
) -> Result<()> {
    let mut rows: Vec<T> = if path.is_file() { read(path)? } else { vec![] };
    rows.retain(|row| measured.iter().all(|now| now.group() != row.group()));
    rows.extend(measured);
    std::fs::write(path, text(&rows)?).with_context(|| format!("{}", path.display()))
}

/// Reads a table.
///
/// # Errors
/// Where the file is missing or no such table.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let read = || -> csv::Result<Vec<T>> { csv::Reader::from_path(path)?.deserialize().collect() };
    read().with_context(|| format!("{}", path.display()))
}

/// A table as text.
///
/// # Errors
/// Where a row cannot be written.
pub(crate) fn text<T: Serialize>(rows: &[T]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Finding, Instructions, compare, new_groups, read};

    fn row(kernel: &str, instructions: f64, compiler: &str) -> Instructions {
        Instructions {
            core: "cortex-m4f".to_owned(),
            kernel: kernel.to_owned(),
            count: instructions,
            unit: "point".to_owned(),
            compiler: compiler.to_owned(),
        }
    }

    #[test]
    fn readme_quotes_the_table() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let table: Vec<Instructions> = read(&root.join("docs/instructions.csv")).unwrap();
        let is_quoted =
            |row: &&Instructions| row.core == "cortex-m4f" && row.kernel == "correct_slice";
        let row = table.iter().find(is_quoted).unwrap();
        let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
        let quoted = format!("{:.0} instructions per point on a Cortex-M4F", row.count);
        assert!(readme.contains(&quoted), "README: {quoted}");
    }

    #[test]
    fn one_percent_more_is_let_pass_and_two_are_not() {
        let table = [row("distort", 100.0, "1.96")];
        for (now, passes) in [(50.0, true), (101.0, true), (101.1, false), (200.0, false)] {
            let findings = compare(&table, &[row("distort", now, "1.96")]);
            assert_eq!(findings.is_empty(), passes, "{now}");
        }
    }

    #[test]
    fn other_compiler_is_held_to_the_limits_alone() {
        let table = [row("correct_slice", 20.0, "1.96")];
        assert_eq!(compare(&table, &[row("correct_slice", 25.0, "1.95")]), []);
        // Where there are rows of both, each has its own.
        let both = [table[0].clone(), row("correct_slice", 24.0, "1.95")];
        assert_eq!(compare(&both, &[row("correct_slice", 24.1, "1.95")]), []);
        let findings = compare(&both, &[row("correct_slice", 24.4, "1.95")]);
        assert!(matches!(findings[..], [Finding::Dearer { .. }]));
        let findings = compare(&table, &[row("correct_slice", 25.1, "1.95")]);
        assert!(matches!(findings[..], [Finding::OverLimit { .. }]));
    }

    #[test]
    fn cores_that_were_not_counted_are_passed_over() {
        let m4f = [row("correct_slice", 24.0, "1.96")];
        let m55 = Instructions {
            core: "cortex-m55".to_owned(),
            ..row("correct_slice", 7.0, "1.96")
        };
        let both = [m4f[0].clone(), m55];
        assert_eq!(compare(&both, &m4f), []);
        // Nor does a table without them say anything but the limit.
        assert_eq!(compare(&m4f, &both), []);
        assert_eq!(new_groups(&m4f, &both), [("1.96", "cortex-m55")].into());
        let [m4f_now, mut dear] = both;
        dear.count = 7.2;
        let findings = compare(&m4f, &[m4f_now, dear]);
        assert!(matches!(findings[..], [Finding::OverLimit { .. }]));
    }

    #[test]
    fn rows_without_a_counterpart_are_named() {
        let found = compare(&[row("a", 1.0, "")], &[row("b", 1.0, "")]);
        let names: Vec<_> = found.iter().map(ToString::to_string).collect();
        assert!(names[0].starts_with("b on cortex-m4f: it is not both"));
        assert!(names[1].starts_with("a on cortex-m4f: it is not both"));
    }
}
