//! Files whose numbers would not all be read: refused, never read in part.

use fmc_camera_file::InputError;
use fmc_exchange::found::Stated;
use fmc_exchange::import::{Imported, import};
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;

use crate::others::{INPHO, USGS};
use crate::support::{ixm, text, written};

/// A file of a program, with what its reader is to be told.
struct Whole {
    program: Program,
    file: String,
    stated: Stated<'static>,
}

impl Whole {
    fn imported(&self, file: &str) -> Result<Imported, InputError> {
        let source = Source {
            file: "a.file",
            bytes: file.as_bytes(),
        };
        let mut imported = import(self.program, &source, &self.stated)?;
        // Its number may be any word.
        imported.camera.name.clear();
        Ok(imported)
    }
}

fn stated(pixel_mm: f64, size_px: [u32; 2]) -> Stated<'static> {
    Stated {
        pixel_mm: Some(pixel_mm),
        size_px: Some(size_px),
        is_correction: Some(true),
        ..Stated::default()
    }
}

/// Every file that is read: those that are written, and those of programs that are only read.
fn whole() -> Vec<Whole> {
    let mut all = Vec::new();
    for program in Program::WRITTEN {
        for (_, bytes) in written(&ixm(), program, "").files {
            if let Ok(file) = String::from_utf8(bytes) {
                let stated = stated(0.003_76, [14204, 10652]);
                all.push(Whole {
                    program,
                    file,
                    stated,
                });
            }
        }
    }
    let dewarp = "<x drone-dji:DewarpData=\"2022-06-08;3713.29,3713.29,7.02,-8.72,-0.1126,0.01487,\
                  -0.0000857,0.0000001,-0.02706\" drone-dji:DewarpFlag=\"0\"/>\n";
    for (program, file, pixel_mm, size_px) in [
        (Program::Usgs, USGS, 0.0127, [18000, 18000]),
        (Program::Inpho, INPHO, 0.0046, [11608, 8708]),
        (Program::Dji, dewarp, 0.0033, [5280, 3956]),
    ] {
        all.push(Whole {
            program,
            file: file.to_owned(),
            stated: stated(pixel_mm, size_px),
        });
    }
    all.retain(|whole| whole.imported(&whole.file).is_ok());
    all
}

/// Returns the places of the numbers that stand alone.
fn numbers(file: &str) -> Vec<std::ops::Range<usize>> {
    let is_inside = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | '_');
    let mut places = Vec::new();
    let mut first = 0;
    for word in file.split(|c| !is_inside(c)) {
        if word.parse::<f64>().is_ok_and(f64::is_finite) {
            places.push(first..first + word.len());
        }
        // Each separator is one byte, or the word behind it begins later and is no number.
        first += word.len()
            + file[first + word.len()..]
                .chars()
                .next()
                .map_or(0, char::len_utf8);
    }
    places
}

#[test]
fn number_that_is_not_finite_is_refused_or_none_of_the_camera() {
    let mut programs = Vec::new();
    for whole in whole() {
        let expected = whole.imported(&whole.file).unwrap();
        let (mut refused, mut unused) = (0, 0);
        for place in numbers(&whole.file) {
            for word in ["nan", "inf", "1e999"] {
                let mut file = whole.file.clone();
                file.replace_range(place.clone(), word);
                match whole.imported(&file) {
                    Err(_) => refused += 1,
                    Ok(found) => {
                        assert_eq!(found.camera, expected.camera, "{file}");
                        unused += 1;
                    }
                }
            }
        }
        let name = whole.program.name();
        assert!(refused >= 24, "{name}: {refused} refused, {unused} unused");
        programs.push(name);
    }
    programs.dedup();
    assert_eq!(programs.len(), Program::WRITTEN.len() + 3, "{programs:?}");
}

#[test]
fn file_that_ends_behind_any_of_its_lines_is_refused_or_has_the_whole_camera() {
    let mut ended = 0;
    for whole in whole() {
        let expected = whole.imported(&whole.file).unwrap();
        let ends = whole.file.match_indices('\n').map(|(place, _)| place + 1);
        for end in ends.filter(|end| *end < whole.file.len()) {
            let file = &whole.file[..end];
            if let Ok(found) = whole.imported(file) {
                assert_eq!(found.camera, expected.camera, "{file}");
            }
            ended += 1;
        }
    }
    assert!(ended > 100, "{ended}");
}

#[test]
fn terms_and_kinds_without_a_place_are_refused_by_name() {
    let of = |program| text(&written(&ixm(), program, ""));
    let dji = "<x DewarpData=\"a;3713,3713,0,0,-0.1,0,0,0,0\" DewarpFlag=\"1\"/>";
    let cam = of(Program::Pix4d).replace("#Focal", "#Fisheye\n#Focal");
    let turned = "<I00>0 0</I00><V10>0 1</V10><V01>-1 0</V01></CalibrationInternConique>";
    let micmac = of(Program::MicMac).replace("</CalibrationInternConique>", turned);
    for (program, file, words) in [
        (
            Program::Australis,
            of(Program::Australis) + "  K4 1e-16\n",
            "K4",
        ),
        (
            Program::PhotoModeler,
            of(Program::PhotoModeler) + "P3 1e-9\n",
            "P3",
        ),
        (
            Program::Metashape,
            of(Program::Metashape).replace("<k1>", "<k5>0.1</k5><k1>"),
            "model k5 is not read",
        ),
        (Program::MicMac, micmac, "affine transformation (V10"),
        (Program::Dji, dji.to_owned(), "DewarpFlag is 1"),
        (Program::Pix4d, cam, "model fisheye is not read"),
        (
            Program::Inpho,
            INPHO.replace("CCDFrame", "CCDLine"),
            "$KIND CCDLine is not read",
        ),
        (
            Program::Inpho,
            INPHO.replace("Polynomial", "Grid"),
            "$DISTORTION_TYPE Grid is not read",
        ),
    ] {
        let whole = Whole {
            program,
            file,
            stated: stated(0.003_76, [14204, 10652]),
        };
        let message = whole.imported(&whole.file).unwrap_err().to_string();
        assert!(message.contains(words), "{words:?} is not in: {message}");
    }
}
