//! Output of the examples, with numbers that can be checked by hand.

#[expect(dead_code, reason = "its `main` prints what is compared here")]
#[path = "../../examples/correct_points.rs"]
mod correct_points;
#[expect(dead_code, reason = "its `main` prints what is compared here")]
#[path = "../../examples/fit_coefficients.rs"]
mod fit_coefficients;
#[expect(dead_code, reason = "its `main` prints what is compared here")]
#[path = "../../examples/gpu_mesh.rs"]
mod gpu_mesh;
#[expect(dead_code, reason = "its `main` prints what is compared here")]
#[path = "../../examples/read_records.rs"]
mod read_records;

/// The last point can be checked by hand: K1·r³ + K2·r⁵ + K3·r⁷ at r = 26 mm is -219.207 µm, and
/// the mean principal point of a centred exposure is the calibrated one.
#[test]
fn points_of_a_file_are_corrected() {
    let points = include_str!("../../examples/data/points.csv");
    let expected = "\
id,x_mm,y_mm,dx_um,dy_um
centre,0.000000,0.000000,0.0000,0.0000
upper right,20.158756,15.119067,-158.7559,-119.0669
lower right,20.158756,-15.119067,-158.7559,119.0669
edge,26.219206,0.000000,-219.2068,0.0000
";
    assert_eq!(correct_points::corrected(points).unwrap(), expected);
}

#[test]
fn rows_that_are_no_points_of_the_sensor_are_named_by_their_line() {
    for (row, named) in [
        ("far,30.0,0.0", "line 3: (30, 0) mm is not on the sensor"),
        ("text,1.0,north", "line: 3"),
        ("short,1.0", "line: 3"),
    ] {
        let table = format!("id,x_mm,y_mm\ncentre,0.0,0.0\n{row}\n");
        let error = correct_points::corrected(&table).unwrap_err().to_string();
        assert!(error.contains(named), "{error}");
    }
}

#[test]
fn mesh_of_a_graphics_processor_has_its_size_its_corrections_and_its_bounds() {
    let expected = "\
(7104, 0) px goes 0.014 columns, -29.436 rows
(14208, 0) px goes 85.472 columns, -64.052 rows
(7104, 5120) px goes 0.000 columns, -0.002 rows
(14208, 5120) px goes 62.480 columns, -1.807 rows
(7104, 10240) px goes 0.012 columns, 23.654 rows
(14208, 10240) px goes 82.401 columns, 56.985 rows
37464 vertices, the longest way 107.4 px
at a vertex right to 0.00114 px, between vertices to 0.0458 px
";
    assert_eq!(gpu_mesh::mesh().unwrap(), expected);
}

/// K1 is -1e-5 mm⁻², so that Kd1 = 2e-5 and Pm1 = 1e-5 mm⁻² for a short travel
/// (`docs/conventions.md`, section 13); rounding to whole micrometres has a standard deviation of
/// 1/√12 = 0.29 µm.
#[test]
fn coefficients_are_those_that_the_distortion_of_k1_demands() {
    let expected = "\
Km0    5.6256e-6 ± 2.0e-6
Km1   -1.0007e-5 ± 2.3e-9
Km2   1.6371e-12 ± 6.4e-13
Kd1    2.0087e-5 ± 6.9e-8
Pm1    9.9514e-6 ± 4.9e-8
405 points, σ0 0.28 µm
";
    assert_eq!(fit_coefficients::fit().unwrap(), expected);
}

#[test]
fn records_give_an_orientation_for_every_image_and_a_reason_for_every_other_trigger() {
    let records = include_str!("../../examples/data/records.csv");
    let text = read_records::orientations(records).unwrap();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 16);
    assert_eq!(
        lines[0],
        "  1 at 2027074 us: x0 0.000 um, y0 0.273 um, sigma 0.031 um, f 100 mm"
    );
    assert_eq!(lines[8], "  9 refused: overlap");
    assert_eq!(lines[15], "14 images of 15 triggers");

    let cut = &records[..records.len() - 60];
    let error = read_records::orientations(cut).unwrap_err().to_string();
    assert!(error.contains("line: 16"), "{error}");
}
