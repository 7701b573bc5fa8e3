//! Costs of the camera's work: the rows of `docs/instructions.csv` and `docs/footprint.csv`.

use std::{fmt, path::Path};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Row of the table of instructions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Instructions {
    pub(crate) core: String,
    pub(crate) kernel: String,
    /// Instructions per point, or per what `unit` says.
    #[serde(rename = "instructions_per_point")]
    pub(crate) count: f64,
    pub(crate) unit: String,
    /// Compiler; another one may need more or fewer instructions.
    pub(crate) compiler: String,
}

/// Row of the table of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Footprint {
    pub(crate) image: String,
    pub(crate) flash_bytes: u64,
    /// Bytes of variables, without the stack.
    pub(crate) static_ram_bytes: u64,
    /// Largest stack in use while `host-sim` verified a camera and flew a mission.
    pub(crate) stack_used_bytes: u64,
    /// Bound of the stack, from the code ([`crate::stack`]); not every image has one.
    pub(crate) stack_bound_bytes: Option<u64>,
    pub(crate) compiler: String,
}

/// Row of a table: one cost or several, of one compiler on one core or image.
pub(crate) trait Cost {
    /// Path of the table, from the root of the workspace.
    const TABLE: &'static str;
    /// Returns the compiler and the core or image, which are measured together; rows of one group
    /// are compared with each other.
    fn group(&self) -> (&str, &str);
    fn amounts(&self) -> Vec<Amount<'_>>;
}

/// One cost of a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Amount<'a> {
    pub(crate) table: &'static str,
    pub(crate) compiler: &'a str,
    /// Core or image.
    pub(crate) on: &'a str,
    /// Kernel, or column of an image.
    pub(crate) cost: &'a str,
    pub(crate) count: f64,
    pub(crate) unit: String,
}

impl Amount<'_> {
    /// Returns true if both are the same cost, by whichever compiler.
    pub(crate) fn is_of_same(&self, other: &Self) -> bool {
        (self.on, self.cost) == (other.on, other.cost)
    }

    /// Returns true if both are of the same compiler on the same core or image.
    pub(crate) fn is_of_group_of(&self, other: &Self) -> bool {
        (self.compiler, self.on) == (other.compiler, other.on)
    }
}

impl fmt::Display for Amount<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} on {}", self.cost, self.on)
    }
}

/// Returns all costs of the rows.
pub(crate) fn amounts<T: Cost>(rows: &[T]) -> Vec<Amount<'_>> {
    rows.iter().flat_map(T::amounts).collect()
}

impl Cost for Instructions {
    const TABLE: &'static str = "docs/instructions.csv";

    fn group(&self) -> (&str, &str) {
        (&self.compiler, &self.core)
    }

    fn amounts(&self) -> Vec<Amount<'_>> {
        vec![Amount {
            table: Self::TABLE,
            compiler: &self.compiler,
            on: &self.core,
            cost: &self.kernel,
            count: self.count,
            unit: format!("instructions per {}", self.unit),
        }]
    }
}

impl Cost for Footprint {
    const TABLE: &'static str = "docs/footprint.csv";

    fn group(&self) -> (&str, &str) {
        (&self.compiler, &self.image)
    }

    fn amounts(&self) -> Vec<Amount<'_>> {
        [
            ("flash_bytes", Some(self.flash_bytes)),
            ("static_ram_bytes", Some(self.static_ram_bytes)),
            ("stack_used_bytes", Some(self.stack_used_bytes)),
            ("stack_bound_bytes", self.stack_bound_bytes),
        ]
        .into_iter()
        .filter_map(|(cost, bytes)| {
            Some(Amount {
                table: Self::TABLE,
                compiler: &self.compiler,
                on: &self.image,
                cost,
                count: count(bytes?),
                unit: "bytes".to_owned(),
            })
        })
        .collect()
    }
}

/// Converts bytes of an image into a number that can be divided.
#[allow(
    clippy::cast_precision_loss,
    reason = "images are smaller than 2^52 bytes"
)]
fn count(bytes: u64) -> f64 {
    bytes as f64
}

/// Replaces the rows of the groups of `measured` in their table, which may be new; the rows of
/// other groups stay.
///
/// # Errors
/// An error if the table cannot be read or written.
pub(crate) fn replace<T: Cost + Serialize + DeserializeOwned>(
    root: &Path,
    measured: Vec<T>,
) -> Result<()> {
    let path = root.join(T::TABLE);
    let mut rows: Vec<T> = if path.is_file() { read(&path)? } else { vec![] };
    rows.retain(|row| measured.iter().all(|now| now.group() != row.group()));
    rows.extend(measured);
    std::fs::write(&path, text(&rows)?).with_context(|| format!("{}", path.display()))
}

/// Reads a table.
///
/// # Errors
/// An error if the file is missing or is not such a table.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let read = || -> csv::Result<Vec<T>> { csv::Reader::from_path(path)?.deserialize().collect() };
    read().with_context(|| format!("{}", path.display()))
}

/// Formats a table as text.
///
/// # Errors
/// An error if a row cannot be written.
pub(crate) fn text<T: Serialize>(rows: &[T]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
