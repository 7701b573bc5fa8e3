//! Files as the programs themselves write them.

#![expect(
    clippy::unreadable_literal,
    reason = "numbers are compared digit by digit with those of the files"
)]

use fmc_exchange::found::{Formula, Stated};
use fmc_exchange::import::{Imported, import};
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;

fn read(program: Program, file: &str, stated: &Stated<'_>) -> Imported {
    let source = Source {
        file: "file",
        bytes: file.as_bytes(),
    };
    import(program, &source, stated).unwrap()
}

fn stated(pixel_um: f64, size_px: [u32; 2]) -> Stated<'static> {
    Stated {
        pixel_mm: Some(pixel_um / 1000.0),
        size_px: Some(size_px),
        ..Stated::default()
    }
}

fn assert_close(found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(
        off <= 1e-9 * expected.abs().max(1.0),
        "{found}, not {expected}"
    );
}

/// A USGS report's text, with numbers of report OSL/3030.
pub(crate) const USGS: &str = "\
I.  Calibrated Focal Length:  153.247 mm
II. Lens Distortion
   Field angle:              7.5°   15°   22.7°   30°   35°   40°
   Symmetric Radial (um)      -1     -1     -1     0     1     1
   Decentering Tangential (um) 0      0      0     1     1     1
   Symmetric radial    Decentering         Calibrated
   distortion          distortion          principal point
   K0 =  0.3285E-04    P1 = -0.1218E-07    xp =  0.006 mm
   K1 = -0.5215E-08    P2 = -0.4426E-07    yp = -0.001 mm
   K2 =  0.1642E-12    P3 =  0.0000
   K3 =  0.0000        P4 =  0.0000
   K4 =  0.0000
";

#[test]
fn usgs_report_is_converted_and_its_table_shows_the_sign() {
    let size = stated(12.7, [18000, 18000]);
    let imported = read(Program::Usgs, USGS, &size);
    assert!(imported.is_exact);
    assert_close(imported.camera.principal_distance_mm, 153.247);
    assert_close(imported.camera.principal_point_mm[1], -0.001);
    let expected = crate::support::rc30();
    let difference = crate::support::difference_um(&imported.camera, &expected);
    assert!(difference < 1e-9, "{difference} µm");
    assert!(
        imported.found.notes[0].contains("6 printed values"),
        "{:?}",
        imported.found.notes
    );
    // The other sign contradicts the table, and so does a misread digit.
    let refused = |text: String, is_correction| {
        let source = Source {
            file: "report.txt",
            bytes: text.as_bytes(),
        };
        let stated = Stated {
            is_correction,
            ..size
        };
        import(Program::Usgs, &source, &stated)
            .unwrap_err()
            .to_string()
    };
    assert!(refused(USGS.to_owned(), Some(false)).contains("contradicts"));
    let misread = USGS.replace("-0.5215E-08", "-0.8215E-08");
    assert!(refused(misread, None).contains("differs by"));
    let more = USGS.replace("K4 =  0.0000", "K4 =  0.1E-20");
    assert!(refused(more, None).contains("K4"));
}

#[test]
fn usgs_table_of_all_reports_agrees_as_printed() {
    // The signs are the reports': each K is a correction and each table a distortion.
    let distortions = USGS
        .replace("0.3285E-04", "-0.3285E-04")
        .replace("-0.5215E-08", "0.5215E-08")
        .replace(" 0.1642E-12", "-0.1642E-12");
    let imported = read(Program::Usgs, &distortions, &stated(12.7, [18000, 18000]));
    assert!(imported.found.notes[0].contains("distortions"));
    assert!(imported.camera.lens.k[0] < 0.0);
}

/// The camera of an Inpho project, iXU-RS1000 50 mm.
pub(crate) const INPHO: &str = "\
$PROJECT 15.0.0
$END
$CAMERA
  $TYPE : iXU-RS1000_(50mm)
  $DATE : 19:07:49 17/08/2018
  $KIND : CCDFrame
  $CCD_INTERIOR_ORIENTATION :
     217.3913043478260900       -0.0000000000000000    5803.5000000000000000
       0.0000000000    -217.3913043478260900    4353.5000000000000000
  $CCD_COLUMNS : 11608
  $CCD_ROWS : 8708
  $PIXEL_REFERENCE : CenterTopLeft
  $FOCAL_LENGTH :    51.6829425480000000
  $PRINCIPAL_POINT_PPA :     0.100000     -0.200000
  $DISTORTION_TYPE :  Polynomial
  $RADIAL_COEFFS :
      0.0000000000000000  -0.0000145693931767  0.0000000040590362  -0.0000000000000411
      0.0000000000000000   0.0000000000000000  0.0000000000000000   0.0000000000000000
  $DECENTRE_COEFFS :
      0.0000034332895555   0.0000043572785450  0.0000000000000000   0.0000000000000000
  $GPS_ANTENNA_OFFSET : 0 0 0
$END
";

#[test]
fn inpho_project_is_converted_with_the_stated_sign() {
    let with_sign = |is_correction| Stated {
        is_correction: Some(is_correction),
        ..stated(4.6, [11608, 8708])
    };
    let distortion = read(Program::Inpho, INPHO, &with_sign(false));
    assert!(distortion.is_exact);
    assert_close(distortion.camera.principal_distance_mm, 51.682942548);
    assert_close(distortion.camera.principal_point_mm[0], 0.1);
    assert_close(distortion.camera.principal_point_mm[1], -0.2);
    assert_close(1e5 * distortion.camera.lens.k[1], -1.45693931767);
    assert_close(1e6 * distortion.camera.lens.p[1], 4.357278545);
    let correction = read(Program::Inpho, INPHO, &with_sign(true));
    assert_close(correction.camera.lens.k[1], -distortion.camera.lens.k[1]);
    // K4 has no place: it is fitted, and the residual is stated.
    let fifth = INPHO.replacen(
        "0.0000000000000000   0.0000",
        "-0.0000000000000001   0.0000",
        1,
    );
    let fitted = read(Program::Inpho, &fifth, &with_sign(false));
    assert!(
        !fitted.is_exact && fitted.residual.largest_um > 0.01,
        "{:?}",
        fitted.residual
    );
    // The principal point of the affine transformation counts, not only the PPA.
    let shifted = INPHO.replace("5803.5", "5798.5");
    let shifted = read(Program::Inpho, &shifted, &with_sign(false));
    assert_close(shifted.camera.principal_point_mm[0], 0.1 - 5.0 * 0.0046);
    let turned = INPHO.replace("     217.39130434782", "    -217.39130434782");
    let source = Source {
        file: "turned.prj",
        bytes: turned.as_bytes(),
    };
    let error = import(Program::Inpho, &source, &with_sign(true)).unwrap_err();
    assert!(error.to_string().contains("turned or mirrored"), "{error}");
}

#[test]
fn dewarp_data_of_an_image_is_fitted() {
    let xmp = "<rdf:Description drone-dji:DewarpData=\"2022-06-08;3713.29,3713.29,7.02,-8.72,\
               -0.11257524,0.01487443,-0.00008572,0.00000010,-0.02706411\" />";
    let imported = read(Program::Dji, xmp, &stated(3.3, [5280, 3956]));
    let Formula::Pinhole(formula) = imported.found.formula else {
        panic!("a correction");
    };
    assert_close(formula.centre_px[0], 2639.5 + 7.02);
    assert_close(formula.centre_px[1], 1977.5 - 8.72);
    assert_close(imported.camera.principal_point_mm[0], 7.02 * 0.0033);
    assert_close(imported.camera.principal_point_mm[1], 8.72 * 0.0033);
    // 11 % at the corner, where the formula is near its fold: the polynomial leaves 50 µm there,
    // and says so.
    let residual = imported.residual;
    assert!(!imported.is_exact && residual.rms_um < 3.0, "{residual:?}");
    assert!((30.0..70.0).contains(&residual.largest_um), "{residual:?}");
}

#[test]
fn sensor_of_a_metashape_chunk_is_chosen_by_id_or_label() {
    let sensor = |id: u32, label: &str, f: f64| {
        format!(
            "<sensor id=\"{id}\" label=\"{label}\" type=\"frame\">\
             <resolution width=\"14204\" height=\"10652\"/>\
             <property name=\"pixel_width\" value=\"0.00376\"/>\
             <property name=\"pixel_height\" value=\"0.00376\"/>\
             <calibration type=\"frame\" class=\"initial\"><resolution width=\"14204\" \
             height=\"10652\"/><f>1</f></calibration>\
             <calibration type=\"frame\" class=\"adjusted\"><resolution width=\"14204\" \
             height=\"10652\"/><f>{f}</f><k1>-0.04</k1><p1>1e-4</p1></calibration>\
             <covariance><params>f k1</params><coeffs>4 -1e-6 -1e-6 1e-12</coeffs></covariance>\
             </sensor>"
        )
    };
    let chunk = format!(
        "<?xml version=\"1.0\"?>\n<document version=\"2.0.0\"><chunk><sensors>{}{}</sensors></chunk></document>",
        sensor(0, "nadir", 13662.5),
        sensor(1, "oblique", 20000.0)
    );
    for (id, f) in [("0", 13662.5), ("1", 20000.0), ("oblique", 20000.0)] {
        let stated = Stated {
            id: Some(id),
            ..Stated::default()
        };
        let imported = read(Program::Metashape, &chunk, &stated);
        // Elements of zero are left out, p1 goes with x², the pitch is the file's.
        assert_close(imported.camera.principal_distance_mm, f * 0.00376);
        let Formula::Pinhole(formula) = imported.found.formula else {
            panic!("a correction");
        };
        assert_close(formula.decentring[1], 1e-4);
        assert_close(formula.centre_px[0], 7101.5);
        let uncertainty = imported.found.uncertainty.unwrap();
        assert_close(uncertainty.sigma[0], 2.0);
        assert_close(uncertainty.correlations.unwrap()[0][1], -0.5);
    }
}

/// `MicMac`'s own direction, ideal -> measured, with a centre of distortion apart.
const TAPAS: &str = "<ExportAPERO><CalibrationInternConique><KnownConv>eConvApero_DistM2C</KnownConv>\
    <PP>7150 5300</PP><F>13660</F><SzIm>14204 10652</SzIm><CalibDistortion><ModPhgrStd>\
    <RadialePart><CDist>7160 5290</CDist><CoeffDist>-2.2e-10</CoeffDist><CoeffDist>1.2e-18</CoeffDist>\
    <CoeffDist>-3e-27</CoeffDist><PPaEqPPs>true</PPaEqPPs></RadialePart><P1>1e-8</P1><P2>-2e-8</P2>\
    <b1>1e-5</b1><b2>-2e-5</b2></ModPhgrStd></CalibDistortion></CalibrationInternConique></ExportAPERO>";

#[test]
fn formula_of_tapas_is_evaluated_as_its_source_has_it() {
    let imported = read(Program::MicMac, TAPAS, &stated(3.76, [14204, 10652]));
    let Formula::Pinhole(formula) = imported.found.formula else {
        panic!("a correction");
    };
    for ray in [[0.4, -0.3], [-0.5, 0.1]] {
        let point = [7150.0 + 13660.0 * ray[0], 5300.0 + 13660.0 * ray[1]];
        let (u, v) = (point[0] - 7160.0, point[1] - 5290.0);
        let r2 = u * u + v * v;
        let radial = -2.2e-10 * r2 + 1.2e-18 * r2 * r2 - 3e-27 * r2 * r2 * r2;
        let x = 1e-8 * (r2 + 2.0 * u * u) - 4e-8 * u * v + 1e-5 * u - 2e-5 * v;
        let y = -2e-8 * (r2 + 2.0 * v * v) + 2e-8 * u * v;
        let [col, row] = formula.pixel_from_ray(ray);
        assert!((col - (point[0] + u * radial + x)).abs() < 1e-8, "{col}");
        assert!((row - (point[1] + v * radial + y)).abs() < 1e-8, "{row}");
    }
    // Another centre of distortion is not convertible without a residual, which is stated.
    assert!(!imported.is_exact);
    assert!(
        (0.01..20.0).contains(&imported.residual.largest_um),
        "{:?}",
        imported.residual
    );
}

#[test]
fn report_of_australis_gives_final_values() {
    let report = "\
Camera 1: test
Sensor Size (pixels)  H 3008  V 2000
Pixel Size (mm)  0.0078 0.0078
Camera    Initial   Total       Final     Initial     Final
Variable  Value     Adjustment  Value     Std. Error  Std. Error
C   28.0000  0.97160  28.97160  1.0e+003  1.2e-003 (mm)
XP  0.0000   0.10300  0.10300   1.0e+003  1.0e-003 (mm)
YP  0.0000  -0.05000  -0.05000  1.0e+003  1.0e-003 (mm)
K1  0.0  1.3e-004  1.30000e-004  1.0  1.0e-007
K2  0.0 -1.6e-007 -1.60000e-007  1.0  1.0e-009
P1  0.0  1.0e-005  1.00000e-005  1.0  1.0e-007
P2  0.0 -2.0e-005 -2.00000e-005  1.0  1.0e-007
B1  0.0  0.0  0.0  1.0e-020  1.0e-020
";
    let imported = read(Program::Australis, report, &stated(7.8, [3008, 2000]));
    assert_close(imported.camera.principal_distance_mm, 28.9716);
    assert_close(imported.camera.principal_point_mm[0], 0.103);
    assert_close(imported.camera.lens.k[1], -1.3e-4);
    assert_close(imported.camera.lens.k[2], 1.6e-7);
    assert_close(imported.camera.lens.p[0], -1e-5);
    assert!(imported.is_exact);
    let uncertainty = imported.found.uncertainty.unwrap();
    assert_eq!(uncertainty.parameters[..4], ["C", "XP", "YP", "K1"]);
    assert_close(uncertainty.sigma[0], 1.2e-3);
    assert_close(1e7 * uncertainty.sigma[3], 1.0);
    assert_eq!(uncertainty.correlations, None);
}

#[test]
fn sample_of_opentrackio_with_a_denominator_is_fitted() {
    let sample = r#"{"lens": {"pinholeFocalLength": 24.305, "distortion": [
        {"model": "Brown-Conrady U-D", "radial": [0.1]},
        {"radial": [1e-5, 2e-5, 1e-9], "tangential": [1e-6, -2e-6]}],
        "projectionOffset": {"x": 0.1, "y": 0.2}}}"#;
    let imported = read(Program::OpenTrackIo, sample, &stated(6.0, [6000, 4000]));
    let Formula::Correction(formula) = imported.found.formula else {
        panic!("a distortion");
    };
    let [x, y] = formula.ideal_from_measured([10.1, -5.2]);
    // ε = (10, 5), y down.
    let quotient = (1.0 + 1e-5 * 125.0 + 1e-9 * 125.0 * 125.0) / (1.0 + 2e-5 * 125.0);
    assert_close(x, 10.0 * quotient + 2e-6 * 50.0 - 2e-6 * (125.0 + 200.0));
    assert_close(-y, 5.0 * quotient - 4e-6 * 50.0 + 1e-6 * (125.0 + 50.0));
    assert!(
        !imported.is_exact && imported.residual.largest_um < 0.1,
        "{:?}",
        imported.residual
    );
}

#[test]
fn cameras_of_odm_and_of_ros_are_read_in_other_spellings() {
    let odm = r#"{"v2 dji fc300s 4000 3000 perspective 0.6666": {"projection_type": "perspective",
        "width": 4000, "height": 3000, "focal": 0.61, "k1": -0.01, "k2": 0.005}}"#;
    let imported = read(Program::OpenSfm, odm, &stated(1.56, [4000, 3000]));
    assert_close(
        imported.camera.principal_distance_mm,
        0.61 * 4000.0 * 0.00156,
    );
    let ros = "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo\ncamera_matrix:\n  \
               rows: 3\n  cols: 3\n  data: [438.783367, 0.000000, 305.593336, 0.000000, 437.302876, \
               243.738352, 0.000000, 0.000000, 1.000000]\ndistortion_model: plumb_bob\n\
               distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.361976, 0.110510, \
               0.001014, 0.000505, 0.000000]\n";
    let imported = read(Program::Ros, ros, &stated(6.0, [640, 480]));
    assert_eq!(imported.found.name, "narrow_stereo");
    assert_close(imported.camera.principal_distance_mm, 437.302876 * 0.006);
    // fx ≠ fy is B1: the ray is longer by fy/fx along x.
    let b1 = 1.0 - 437.302876 / 438.783367;
    assert!(
        (imported.camera.lens.b[0] - b1).abs() < 3e-3,
        "{:?}",
        imported.camera.lens
    );
}
