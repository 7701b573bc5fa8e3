//! `mesh` for graphics processors: the files read back as their header describes.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use crate::command_line::mesh::{mesh_of, numbers};
use crate::command_line::support::{Bench, CAMERA, EXPOSURE, POINTS};

/// Returns recorded vertices and the displacements to their places in the corrected image, px.
fn pushed(bench: &Bench, header: &Value) -> Vec<([f64; 2], [f64; 2])> {
    let count = |key: &str| header[key].as_u64().unwrap();
    let spacing = header["spacing_px"].as_f64().unwrap();
    let origin = [0, 1].map(|axis| header["origin_px"][axis].as_f64().unwrap());
    let flat = numbers(bench, "mesh.bin", |q| f64::from(f32::from_le_bytes(q)));
    let (pairs, rest) = flat.as_chunks::<2>();
    assert!(rest.is_empty());
    assert_eq!(pairs.len() as u64, count("columns") * count("rows"));
    let mut pairs = pairs.iter();
    let mut vertices = Vec::new();
    for row in 0..u32::try_from(count("rows")).unwrap() {
        for column in 0..u32::try_from(count("columns")).unwrap() {
            let vertex = [
                origin[0] + spacing * f64::from(column),
                origin[1] + spacing * f64::from(row),
            ];
            vertices.push((vertex, *pairs.next().unwrap()));
        }
    }
    vertices
}

#[test]
fn vertices_of_a_graphics_processor_go_where_the_reference_has_their_pixels() {
    let part = ["--part", "7200,7400,1980,1800"];
    for (spacing, part, columns_and_rows) in [
        ("250", &[][..], (38, 38)),
        ("1024", &[], (10, 10)),
        ("43", &part, (48, 43)),
    ] {
        let bench = Bench::new();
        let more = [&["--format", "gpu", "--spacing", spacing], part].concat();
        let header = mesh_of(&bench, &more);
        assert_eq!(header["format"], "gpu");
        let found = (&header["columns"], &header["rows"]);
        let (columns, rows) = columns_and_rows;
        assert_eq!(found, (&columns.into(), &rows.into()));
        // The mesh has no sources, and its numbers are not quantised.
        assert!(header["quantisation_px"].is_null() && header["source_origin_px"].is_null());
        let vertices = pushed(&bench, &header);
        let mut points = "id,col_px,row_px\n".to_owned();
        let mut places = Vec::new();
        let mut farthest_px = 0.0_f64;
        for ([col, row], [cols, rows]) in vertices {
            if col <= 9215.0 && row <= 9215.0 {
                writeln!(points, "{},{col},{row}", places.len()).unwrap();
                places.push([col + cols, row + rows]);
                farthest_px = farthest_px.max(cols.hypot(rows));
            }
        }
        assert!(farthest_px > 5.0, "{farthest_px} px");
        fs::write(bench.path("points.csv"), points).unwrap();
        let answer = bench
            .run(&[&["reference"], &EXPOSURE[..], &["points.csv"]].concat())
            .ok();
        let rows = answer.rows();
        assert_eq!(rows.len(), places.len());
        let mut worst_px = 0.0_f64;
        for ((_, [col, row, ..]), place) in rows.iter().zip(&places) {
            worst_px = worst_px
                .max((col - place[0]).abs())
                .max((row - place[1]).abs());
        }
        let stated_px = header["rounding_bound_px"].as_f64().unwrap();
        assert!(stated_px > 0.0 && stated_px < 1e-3, "{stated_px} px");
        // The model leaves out 1.5 nm, given here in pixels of 8.75 µm.
        assert!(worst_px <= stated_px + 1.5 / 8750.0, "{worst_px} px");
    }
}

#[test]
fn header_of_a_graphics_processor_says_how_its_vertices_are_drawn() {
    let low = CAMERA.replace("height_px = 9216", "height_px = 6000");
    assert_ne!(low, CAMERA);
    let bench = Bench::with(&low, POINTS.as_bytes());
    let part = ["--part", "100,200,33,17"];
    let header = mesh_of(
        &bench,
        &[&["--format", "gpu", "--spacing", "16"], &part[..]].concat(),
    );
    assert_eq!(header["files"], serde_json::json!(["mesh.bin"]));
    let [columns, rows] = [4, 3];
    assert_eq!(
        (&header["columns"], &header["rows"]),
        (&columns.into(), &rows.into())
    );
    assert_eq!(header["origin_px"], serde_json::json!([100, 200]));
    let length = fs::metadata(bench.path("mesh/mesh.bin")).unwrap().len();
    assert_eq!(length, 8 * columns * rows);
    // The error of a triangle is small and grows with the square of its side.
    let coarse = mesh_of(&bench, &["--format", "gpu", "--spacing", "160"]);
    let [fine, coarse] =
        [&header, &coarse].map(|header| header["interpolation_bound_px"].as_f64().unwrap());
    assert!(fine > 0.0 && fine < 1e-3, "{fine} px");
    assert!((100.0..110.0).contains(&(coarse / fine)), "{coarse} {fine}");
    for (text, words) in [
        (
            &header["layout"],
            &["row by row", "little endian", "R32G32_SFLOAT", "px"][..],
        ),
        (&header["meaning"], &["corrected minus recorded", "(0, 0)"]),
        (
            &header["drawing"]["texture"],
            &["u = (col + 0.5)/9216", "v = (row + 0.5)/6000", "discard"],
        ),
        (&header["drawing"]["target"], &["9216 x 6000 px"]),
        (
            &header["drawing"]["position"],
            &[
                "x = 2 (col + 0.5)/9216 - 1 + 2 dcol/9216",
                "y = 2 (row + 0.5)/6000 - 1 + 2 drow/6000",
            ],
        ),
        (&header["drawing"]["orientation"], &["Vulkan", "OpenGL"]),
        (&header["drawing"]["cells"], &["columns (rows - 1)"]),
    ] {
        let text = text.as_str().unwrap();
        for word in words {
            assert!(text.contains(word), "{word}: {text}");
        }
    }
}

#[test]
fn neighbouring_parts_of_a_graphics_processor_leave_no_gap() {
    for (spacing, width) in [("1", 30), ("16", 33), ("16", 32), ("16", 1)] {
        let bench = Bench::new();
        let part = format!("0,0,{width},{width}");
        let header = mesh_of(
            &bench,
            &["--format", "gpu", "--spacing", spacing, "--part", &part],
        );
        let spacing: u64 = spacing.parse().unwrap();
        for vertices in ["columns", "rows"] {
            let count = header[vertices].as_u64().unwrap();
            let last = (count - 1) * spacing;
            assert!(count > 1 && last >= width, "{part}: {vertices} to {last}");
        }
    }
}
