//! `docs/camera-file.md` against the format: its keys, defaults and ranges.

use std::collections::BTreeSet;

use crate::CameraFile;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::geometry::range::Quantity;

const DOCUMENT: &str = include_str!("../../../docs/camera-file.md");

/// Tables of the file; `""` is its top.
const TABLES: [&str; 9] = [
    "",
    "sensor",
    "distortion",
    "fmc",
    "shutter",
    "limits",
    "fitted",
    "focus",
    "grid",
];

/// A row of the table of keys.
#[derive(Debug)]
struct Row {
    table: &'static str,
    key: &'static str,
    default: &'static str,
    range: [&'static str; 2],
}

fn rows() -> Vec<Row> {
    let rows: Vec<Row> = DOCUMENT
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            assert_eq!(cells.len(), 6, "{line}");
            let path = cells[0].trim_matches('`');
            let (table, key) = path.split_once('.').unwrap_or(("", path));
            Row {
                table,
                key,
                default: cells[2].trim_matches('`'),
                range: [cells[3], cells[4]],
            }
        })
        .collect();
    assert!(!rows.is_empty());
    rows
}

/// Returns the example of the document.
fn example() -> &'static str {
    let (_, rest) = DOCUMENT.split_once("```toml\n").unwrap();
    rest.split_once("```").unwrap().0
}

/// Returns the example with one more line in a table, which is written at the end if the example
/// does not have it.
fn with(table: &str, line: &str) -> String {
    let heading = format!("[{table}]\n");
    match table {
        "" => format!("{line}\n{}", example()),
        _ if example().contains(&heading) => {
            example().replace(&heading, &format!("{heading}{line}\n"))
        }
        _ => format!("{}{heading}{line}\n", example()),
    }
}

fn read(text: &str) -> CameraParameters {
    CameraFile::parse("camera.toml", text)
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .0
        .parameters()
}

/// Returns the keys that a table may have: those that the refusal of another one names.
fn keys(table: &str) -> BTreeSet<String> {
    let error = CameraFile::parse("camera.toml", &with(table, "nonsense = 1")).unwrap_err();
    let text = error.to_string();
    let (_, expected) = text.split_once("expected").expect(&text);
    let keys = expected.split('`').skip(1).step_by(2);
    keys.map(str::to_owned).collect()
}

#[test]
fn every_key_of_the_format_stands_in_the_document() {
    let documented: BTreeSet<(String, String)> = rows()
        .iter()
        .map(|row| (row.table.to_owned(), row.key.to_owned()))
        .collect();
    assert_eq!(documented.len(), rows().len(), "every key once");
    let of_the_format: BTreeSet<_> = TABLES
        .iter()
        .flat_map(|table| {
            keys(table)
                .into_iter()
                .map(|key| ((*table).to_owned(), key))
        })
        .filter(|(table, key)| !(table.is_empty() && TABLES.contains(&key.as_str())))
        .collect();
    assert_eq!(documented, of_the_format);
    let tables: BTreeSet<String> = keys("");
    let named = TABLES.iter().skip(1).map(|table| (*table).to_owned());
    let top = rows().into_iter().filter(|row| row.table.is_empty());
    let all: BTreeSet<String> = named.chain(top.map(|row| row.key.to_owned())).collect();
    assert_eq!(tables, all, "every table");
}

#[test]
fn required_keys_are_those_of_the_document() {
    let required = rows().into_iter().filter(|row| row.default == "required");
    let documented: Vec<&str> = required.map(|row| row.key).collect();
    let written: Vec<&str> = example()
        .lines()
        .filter_map(|line| line.split_once(" = "))
        .map(|(key, _)| key)
        .collect();
    assert_eq!(documented, written);
    for line in example().lines().filter(|line| line.contains(" = ")) {
        let without = example().replace(line, "");
        let error = CameraFile::parse("camera.toml", &without).unwrap_err();
        assert!(error.to_string().contains("missing"), "{error}");
    }
}

#[test]
fn defaults_are_those_of_the_format() {
    // Every default shows in one of these cameras: with a distortion, with ramps, with charge that
    // moves, with fitted coefficients.
    let cameras = [
        ("distortion", "k1 = 1e-7"),
        ("fmc", "mechanism = \"tdi\""),
        ("shutter", "profile = \"trapezoid\""),
        ("fitted", "kd1 = 1e-9"),
        ("fitted", "km0 = 1e-9"),
    ];
    for row in rows() {
        let value = match row.default {
            "required" | "none" => continue,
            "principal_distance_mm" => "150.0",
            "1/5000 to 1/30" => "[2e-4, 0.033333333333333333]",
            default => default,
        };
        let line = format!("{} = {value}", row.key);
        if row.table != "fitted" {
            assert_eq!(read(&with(row.table, &line)), read(example()), "{row:?}");
        }
        for (table, other) in cameras {
            let (other_key, _) = other.split_once(" = ").unwrap();
            if table != row.table || other_key == row.key {
                continue;
            }
            let both = with(table, &format!("{other}\n{line}"));
            assert_eq!(read(&both), read(&with(table, other)), "{row:?}");
        }
    }
}

#[test]
fn ranges_are_those_of_the_code() {
    for row in rows() {
        let named = |quantity: &&Quantity| {
            let name = quantity.name();
            name == row.key || name.strip_suffix("[0]") == Some(row.key)
        };
        let Some(quantity) = Quantity::ALL.iter().find(named) else {
            let words = [
                "name",
                "serial",
                "sign",
                "axis",
                "mechanism",
                "strategy",
                "profile",
                "per",
                "lens",
                "lens_crc32",
                "sensor",
                "sensor_crc32",
            ];
            assert!(words.contains(&row.key) || row.key == "version", "{row:?}");
            continue;
        };
        let (least, most) = quantity.range();
        let ends = [least, most].map(|end| {
            if end.abs() < f32::MAX {
                end.to_string()
            } else {
                "any".to_owned()
            }
        });
        assert_eq!(row.range, ends, "{row:?}");
    }
    for (version, is_valid) in [
        ("0", true),
        ("4294967295", true),
        ("-1", false),
        ("4294967296", false),
    ] {
        let text = with("", &format!("version = {version}"));
        assert_eq!(CameraFile::parse("camera.toml", &text).is_ok(), is_valid);
    }
}
