//! Cells of a table in memory, as a file has them.

use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::error;

/// Column whose cells are eight digits, which readers of tables may have taken for a number.
const CRC: &str = "calibration_crc32";

/// Names of columns, and their cells as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TableCells {
    names: Vec<String>,
    columns: Vec<Vec<String>>,
}

impl TableCells {
    /// Reads a table: pandas, Polars, whatever exports Arrow, or a dictionary of columns.
    ///
    /// # Errors
    /// `fmc_camera.InvalidFile`-like sentences for what is no table.
    pub(crate) fn of(table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let dictionary = dictionary(table)?;
        let items = dictionary.call_method0("items").map_err(|_| {
            let kind = table.get_type();
            error::of_text(format!(
                "records of the type {kind}: must be the path of a file, a table of pandas, Polars or \
                 Arrow, or a dictionary of columns"
            ))
        })?;
        let (mut names, mut columns) = (Vec::new(), Vec::new());
        for item in items.try_iter()? {
            let (name, cells): (String, Bound<'_, PyAny>) = item?.extract()?;
            columns.push(cells_of(&name, &cells)?);
            names.push(name);
        }
        let rows = columns.first().map_or(0, Vec::len);
        for (name, column) in names.iter().zip(&columns) {
            if column.len() != rows {
                return Err(error::of_text(format!(
                    "records: column {name} has {} rows, the first column has {rows}",
                    column.len()
                )));
            }
        }
        Ok(Self { names, columns })
    }

    /// Returns the table as a file of CSV.
    ///
    /// # Errors
    /// That of the writer.
    pub(crate) fn csv(&self) -> PyResult<Vec<u8>> {
        let failed = |error: csv::Error| error::of_text(format!("records: {error}"));
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(&self.names).map_err(failed)?;
        for row in 0..self.columns.first().map_or(0, Vec::len) {
            let cells = self
                .columns
                .iter()
                .map(|column| column.get(row).map_or("", String::as_str));
            writer.write_record(cells).map_err(failed)?;
        }
        writer
            .into_inner()
            .map_err(|error| error::of_text(format!("records: {error}")))
    }
}

/// Returns a table as a dictionary of columns.
fn dictionary<'py>(table: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let module: String = table.get_type().module()?.extract()?;
    match module.split('.').next() {
        Some("pandas") => table.call_method1("to_dict", ("list",)),
        Some("pyarrow") => table.call_method0("to_pydict"),
        Some("polars") => {
            let options = pyo3::types::PyDict::new(table.py());
            options.set_item("as_series", false)?;
            table.call_method("to_dict", (), Some(&options))
        }
        _ if table.hasattr("__arrow_c_stream__")? || table.hasattr("__arrow_c_array__")? => {
            of_arrow(table)
        }
        _ => Ok(table.clone()),
    }
}

/// Returns a table of a library that is known by the methods of Arrow's `PyCapsule` interface.
fn of_arrow<'py>(table: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let kind = table.get_type();
    let pyarrow = table.py().import("pyarrow").map_err(|cause| {
        error::of_text(format!(
            "records of the type {kind}: pyarrow reads tables with Arrow's PyCapsule interface, and \
             cannot be imported: {cause}"
        ))
    })?;
    pyarrow
        .call_method1("table", (table,))
        .and_then(|table| table.call_method0("to_pydict"))
        .map_err(|cause| error::of_text(format!("records of the type {kind}: {cause}")))
}

/// Returns the cells of a column.
fn cells_of(name: &str, column: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    // Numbers of NumPy become those of Python.
    let column = if column.hasattr("tolist")? {
        column.call_method0("tolist")?
    } else {
        column.clone()
    };
    let cells = column
        .try_iter()
        .map_err(|_| error::of_text(format!("records: column {name} is no list of cells")))?;
    cells
        .enumerate()
        .map(|(row, value)| {
            let value = value?;
            text(name, &value).ok_or_else(|| {
                let kind = value.get_type();
                error::of_text(format!(
                    "records: column {name}, row {row}: a value of the type {kind}"
                ))
            })
        })
        .collect()
}

/// Returns a cell as text; `None` for what no cell can be.
fn text(name: &str, value: &Bound<'_, PyAny>) -> Option<String> {
    if value.is_none() {
        return Some(String::new());
    }
    if let Ok(text) = value.extract::<String>() {
        return Some(text);
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Some(flag.is_true().to_string());
    }
    let text = if let Ok(number) = value.extract::<i64>() {
        number.to_string()
    } else if let Ok(number) = value.extract::<u64>() {
        number.to_string()
    } else {
        let number = value.extract::<f64>().ok()?;
        if number.is_nan() {
            return Some(String::new());
        }
        number.to_string()
    };
    Some(if name == CRC {
        format!("{text:0>8}")
    } else {
        text
    })
}
