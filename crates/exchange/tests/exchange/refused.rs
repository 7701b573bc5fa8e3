//! Files that cannot be used, each refused by name.

use fmc_exchange::export::{Choices, export};
use fmc_exchange::found::Stated;
use fmc_exchange::import::import;
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;

use crate::support::{camera, ixm, text, written};

const STATED: Stated<'static> = Stated {
    pixel_mm: Some(0.00376),
    pixel_from: Some("--pixel-um"),
    size_px: None,
    size_from: Some("--size"),
    id: None,
    is_correction: None,
};

/// Returns the message, with the help, of a file that is refused.
fn refused(program: Program, bytes: &[u8], stated: &Stated<'_>) -> String {
    let source = Source {
        file: "a.file",
        bytes,
    };
    let error = import(program, &source, stated).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("a.file: "), "{message}");
    format!("{message} {}", error.help().unwrap_or_default())
}

fn assert_refused(program: Program, file: &str, stated: &Stated<'_>, words: &[&str]) {
    let message = refused(program, file.as_bytes(), stated);
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

const COLMAP: &str = "1 PINHOLE 14204 10652 13662.5 13662.5 7102.0 5326.0\n";

#[test]
fn pitch_and_size_must_be_known_and_agree() {
    let nothing = Stated::default();
    assert_refused(
        Program::Colmap,
        COLMAP,
        &nothing,
        &["pixel pitch", "--pixel-um"],
    );
    let opf = text(&written(&ixm(), Program::Opf, ""));
    assert_refused(Program::Opf, &opf, &STATED, &["no size", "--size"]);
    let other = Stated {
        size_px: Some([9216, 9216]),
        ..STATED
    };
    assert_refused(
        Program::Colmap,
        COLMAP,
        &other,
        &["14204 x 10652 px, --size of 9216 x 9216 px"],
    );
    let sample = text(&written(&ixm(), Program::OpenTrackIo, ""));
    let other = Stated {
        pixel_mm: Some(0.0046),
        ..STATED
    };
    assert_refused(
        Program::OpenTrackIo,
        &sample,
        &other,
        &["3.760000 µm, --pixel-um of 4.6"],
    );
    let cam = text(&written(&ixm(), Program::Pix4d, ""));
    assert_refused(Program::Pix4d, &cam, &nothing, &["pixel pitch"]);
    let dewarp = "2022-06-08;3713.29,3713.29,7.0,-5.0,-0.1,0.01,0.0,0.0,0.0";
    assert_refused(Program::Dji, dewarp, &STATED, &["no size"]);
}

#[test]
fn other_projections_are_refused_by_name() {
    let ros = text(&written(&ixm(), Program::Ros, ""));
    let kalibr = text(&written(&ixm(), Program::Kalibr, ""));
    let opensfm = text(&written(&ixm(), Program::OpenSfm, ""));
    let opf = text(&written(&ixm(), Program::Opf, ""));
    let metashape = text(&written(&ixm(), Program::Metashape, ""));
    let opencv = text(&written(&ixm(), Program::OpenCv, "opencv5"));
    let micmac = text(&written(&ixm(), Program::MicMac, ""));
    let sample = text(&written(&ixm(), Program::OpenTrackIo, ""));
    let fisheye = "1 OPENCV_FISHEYE 14204 10652 13662.5 13662.5 7102.0 5326.0 0 0 0 0\n";
    for (program, file, name) in [
        (
            Program::Ros,
            ros.replace("rational_polynomial", "equidistant"),
            "equidistant",
        ),
        (
            Program::Kalibr,
            kalibr.replace("model: pinhole", "model: omni"),
            "omni",
        ),
        (Program::Kalibr, kalibr.replace("radtan", "fov"), "fov"),
        (
            Program::OpenSfm,
            opensfm.replace("\"brown\"", "\"spherical\""),
            "spherical",
        ),
        (
            Program::Opf,
            opf.replace("\"perspective\"", "\"fisheye\""),
            "fisheye",
        ),
        (
            Program::Metashape,
            metashape.replace(">frame<", ">fisheye<"),
            "fisheye",
        ),
        (
            Program::OpenCv,
            format!("{opencv}fisheye_model: 1\n"),
            "fisheye",
        ),
        (
            Program::OpenCv,
            format!("{opencv}xi: 1.2\n"),
            "omnidirectional (xi)",
        ),
        (
            Program::MicMac,
            micmac.replace("ModPhgrStd", "ModUnif"),
            "ModUnif",
        ),
        (
            Program::MicMac,
            micmac.replace("DistC2M", "OriLib"),
            "eConvApero_OriLib",
        ),
        (
            Program::OpenTrackIo,
            sample.replace("D-U", "U-D"),
            "Brown-Conrady U-D",
        ),
        (Program::Colmap, fisheye.to_owned(), "OPENCV_FISHEYE"),
    ] {
        assert_refused(
            program,
            &file,
            &STATED,
            &[&format!("model {name} is not read")],
        );
    }
    let xmp = String::from_utf8(written(&ixm(), Program::Pix4d, "").files[1].1.clone()).unwrap();
    let xmp = xmp.replace(">perspective<", ">fisheye<");
    let sized = Stated {
        size_px: Some([14204, 10652]),
        ..STATED
    };
    assert_refused(Program::Pix4d, &xmp, &sized, &["fisheye", "perspective"]);
}

#[test]
fn binary_of_colmap_with_a_fisheye_and_cut_short_is_refused() {
    let choices = Choices {
        is_binary: true,
        ..Choices::default()
    };
    let mut bytes = export(&ixm(), Program::Colmap, &choices).unwrap().files[0]
        .1
        .clone();
    for length in [0, 7, 8, 12, 31, bytes.len() - 1] {
        let message = refused(Program::Colmap, &bytes[..length], &STATED);
        let is_named = ["ends within", "empty", "no camera", "missing"];
        assert!(
            is_named.iter().any(|word| message.contains(word)),
            "{length}: {message}"
        );
    }
    bytes[12..16].copy_from_slice(&5_i32.to_le_bytes());
    assert!(refused(Program::Colmap, &bytes, &STATED).contains("OPENCV_FISHEYE"));
    bytes[..8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
    assert!(refused(Program::Colmap, &bytes, &STATED).contains("1099511627776 cameras"));
}

#[test]
fn older_file_of_photoscan_is_refused_for_its_order_of_p() {
    let file = "<calibration><projection>frame</projection><width>14204</width>\
                <height>10652</height><fx>13662</fx><fy>13662</fy><cx>7102</cx><cy>5326</cy>\
                <k1>-0.04</k1><p1>1e-4</p1><p2>2e-4</p2></calibration>";
    assert_refused(
        Program::Metashape,
        file,
        &STATED,
        &["PhotoScan", "p1 and p2 exchanged"],
    );
}

#[test]
fn numbers_that_are_none_are_refused_with_their_field() {
    let opencv = text(&written(&ixm(), Program::OpenCv, "opencv5"));
    for word in [".nan", "nan", "1e999", ".inf"] {
        let file = opencv.replacen("0.0, 7117", &format!("{word}, 7117"), 1);
        assert_refused(
            Program::OpenCv,
            &file,
            &STATED,
            &["camera_matrix.data.1", "not a finite"],
        );
    }
    let metashape = text(&written(&ixm(), Program::Metashape, ""));
    let file = metashape.replace("<b1>0.0<", "<b1>nan<");
    assert_refused(Program::Metashape, &file, &STATED, &["b1", "nan"]);
    let file = COLMAP.replace("7102.0", "NaN");
    assert_refused(Program::Colmap, &file, &STATED, &["line 1", "NaN"]);
    let cam = text(&written(&ixm(), Program::Pix4d, "")).replace("K3 ", "K3 x");
    assert_refused(
        Program::Pix4d,
        &cam,
        &STATED,
        &["K3", "not a finite number"],
    );
    let zero = COLMAP.replace("13662.5 13662.5", "0 0");
    assert_refused(
        Program::Colmap,
        &zero,
        &STATED,
        &["principal distance is not positive"],
    );
}

#[test]
fn one_of_many_cameras_must_be_named() {
    let cameras: String = (1..=100)
        .map(|id| COLMAP.replacen('1', &id.to_string(), 1))
        .collect();
    let many = ["100 cameras", "--id", "1, 2, 3", "90 more"];
    assert_refused(Program::Colmap, &cameras, &STATED, &many);
    let other = Stated {
        id: Some("101"),
        ..STATED
    };
    assert_refused(
        Program::Colmap,
        &cameras,
        &other,
        &["no camera 101", "90 more"],
    );
    let hundredth = Stated {
        id: Some("100"),
        ..STATED
    };
    let source = Source {
        file: "a.file",
        bytes: cameras.as_bytes(),
    };
    let found = import(Program::Colmap, &source, &hundredth).unwrap().found;
    assert_eq!(found.name, "camera 100");
    for (program, file) in [
        (Program::Colmap, "# no camera\n"),
        (Program::OpenSfm, "{}"),
        (Program::Kalibr, "{}\n"),
        (Program::Metashape, "<document><chunk/></document>"),
        (Program::Pix4d, "nothing\n"),
    ] {
        assert_refused(program, file, &STATED, &["no camera"]);
    }
}

#[test]
fn empty_files_and_halves_of_files_are_refused() {
    for program in [
        Program::OpenCv,
        Program::Ros,
        Program::Kalibr,
        Program::Colmap,
        Program::Metashape,
        Program::OpenSfm,
        Program::Opf,
        Program::Pix4d,
        Program::OpenTrackIo,
        Program::MicMac,
        Program::Australis,
        Program::PhotoModeler,
        Program::Usgs,
        Program::Dji,
    ] {
        assert_refused(program, "", &STATED, &["empty"]);
        assert_refused(program, "\u{1}\n", &STATED, &[]);
        if !program.models().is_empty() || program.name() == "micmac" {
            let whole = text(&written(&ixm(), program, ""));
            let half = &whole[..whole.len() / 2];
            assert_refused(program, half, &STATED, &[]);
        }
    }
}

#[test]
fn entities_anchors_and_the_binary_are_refused() {
    let metashape = text(&written(&ixm(), Program::Metashape, ""));
    let bomb = metashape.replace(
        "<calibration>",
        "<!DOCTYPE a [<!ENTITY b \"1\"><!ENTITY c \"&b;&b;\">]>\n<calibration>",
    );
    assert_refused(Program::Metashape, &bomb, &STATED, &["document type"]);
    let kalibr = text(&written(&ixm(), Program::Kalibr, ""));
    let anchor = kalibr.replace("resolution: [", "resolution: &a [");
    assert_refused(Program::Kalibr, &anchor, &STATED, &["anchor", "line 6"]);
    assert_refused(Program::OpenCv, "\0\0\0\0", &STATED, &["bytes of zero"]);
    let latin = [0x61, 0x3a, 0x20, 0xe4, 0x0a];
    assert!(refused(Program::OpenCv, &latin, &STATED).contains("UTF-8"));
}

#[test]
fn model_that_folds_or_has_a_pole_within_the_sensor_is_refused() {
    let line = |k: &str| format!("1 FULL_OPENCV 14204 10652 13662.5 13662.5 7102 5326 {k}\n");
    // The corner is at 0.65: r + k1 r³ turns back at 0.58.
    assert_refused(
        Program::Colmap,
        &line("-1 0 0 0 0 0 0 0"),
        &STATED,
        &["fold"],
    );
    assert_refused(
        Program::Colmap,
        &line("0 0 0 0 0 -5 0 0"),
        &STATED,
        &["the model"],
    );
    // As an export: a lens that the camera's own polynomial allows.
    let error = export(
        &ixm(),
        Program::Colmap,
        &Choices {
            model: Some("NONE"),
            ..Choices::default()
        },
    );
    let error = error.unwrap_err();
    assert!(error.to_string().contains("no such model"));
    assert!(error.help().unwrap().contains("FULL_OPENCV"));
}

#[test]
fn strong_lens_whose_fit_would_fold_is_not_written() {
    // 20 % of pincushion: a polynomial of rays with two terms still follows it, none at all does
    // not fold, and every model that is written is one-to-one.
    let strong = camera(
        "name = \"strong\"\nprincipal_distance_mm = 20\n[sensor]\nwidth_px = 6000\n\
         height_px = 4000\npixel_um = 6\n[distortion]\nk1 = 4e-4\n[fmc]\nstroke_mm = 1\n",
    );
    for model in ["PINHOLE", "RADIAL", "FULL_OPENCV"] {
        let exported = written(&strong, Program::Colmap, model);
        assert!(exported.residual.largest_um > 0.0);
    }
}

#[test]
fn australis_with_affinity_and_inpho_without_sign_are_refused() {
    let report = text(&written(&ixm(), Program::Australis, "")).replace("B1   0.0", "B1   1e-4");
    assert_refused(
        Program::Australis,
        &report,
        &STATED,
        &["B1 is not 0", "sign"],
    );
    let project = "$CAMERA\n  $TYPE : x\n$END\n";
    assert_refused(Program::Inpho, project, &STATED, &["--sign"]);
}
