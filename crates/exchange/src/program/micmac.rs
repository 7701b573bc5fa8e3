//! `MicMac`: the interior calibration, `DistC2M` measured -> ideal and `DistM2C` ideal -> measured.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;
use roxmltree::Node;

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::decimal::number;
use crate::elements::{child, children, number_or, number_text, numbers};
use crate::fields::pixel_count;
use crate::found::{Formula, Found, Stated, unsupported};
use crate::pinhole::Pinhole;
use crate::source::Source;

const MEASURED_TO_IDEAL: &str = "eConvApero_DistC2M";
const IDEAL_TO_MEASURED: &str = "eConvApero_DistM2C";

/// Returns the name of the file: `AutoCal_Foc-<f in µm>_Cam-<name>.xml`.
#[must_use]
pub(crate) fn file(camera: &Calibrated) -> String {
    let letters = camera.name.chars().map(|letter| {
        if letter.is_ascii_alphanumeric() {
            letter
        } else {
            '_'
        }
    });
    format!(
        "AutoCal_Foc-{:.0}_Cam-{}.xml",
        1000.0 * camera.principal_distance_without_k0_mm(),
        letters.collect::<String>()
    )
}

/// Writes the file: pixels, y down.
pub(crate) fn write(camera: &Calibrated) -> String {
    let pixel_mm = camera.pixel_mm;
    let camera = camera.without_k0();
    let [_, k1, k2, k3] = camera.lens.k;
    let [p1, p2] = camera.lens.p;
    let [b1, b2] = camera.lens.b;
    let [cx, cy] = camera.principal_point_px().map(number);
    let [width, height] = camera.size_px;
    let radial = [(k1, 2), (k2, 4), (k3, 6)]
        .map(|(k, power)| {
            let pixels = -k * pixel_mm.powi(power);
            format!(
                "                         <CoeffDist>{}</CoeffDist>\n",
                number(pixels)
            )
        })
        .concat();
    format!(
        "<?xml version=\"1.0\" ?>\n<ExportAPERO>\n     <CalibrationInternConique>\n          \
         <KnownConv>{MEASURED_TO_IDEAL}</KnownConv>\n          <PP>{cx} {cy}</PP>\n          \
         <F>{}</F>\n          <SzIm>{width} {height}</SzIm>\n          <CalibDistortion>\n               \
         <ModPhgrStd>\n                    <RadialePart>\n                         \
         <CDist>{cx} {cy}</CDist>\n{radial}                         \
         <PPaEqPPs>true</PPaEqPPs>\n                    </RadialePart>\n                    \
         <P1>{}</P1>\n                    <P2>{}</P2>\n                    <b1>{}</b1>\n                    \
         <b2>{}</b2>\n               </ModPhgrStd>\n          </CalibDistortion>\n     \
         </CalibrationInternConique>\n</ExportAPERO>\n",
        number(camera.principal_distance_mm / pixel_mm),
        number(-p1 * pixel_mm),
        number(p2 * pixel_mm),
        number(-b1),
        number(b2),
    )
}

/// Reads the file, of either direction.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let document = source.xml()?;
    let calibration = document
        .descendants()
        .find(|node| node.has_tag_name("CalibrationInternConique"))
        .ok_or_else(|| source.invalid("CalibrationInternConique is missing"))?;
    // Affine transformations of a scan, and of a crop.
    for (name, identity) in [
        ("I00", [0.0, 0.0]),
        ("V10", [1.0, 0.0]),
        ("V01", [0.0, 1.0]),
    ] {
        for node in document
            .descendants()
            .filter(|node| node.has_tag_name(name))
        {
            let found = numbers(source, name, node.text().unwrap_or_default())?;
            let differs = |(a, b): (&f64, f64)| (a - b).abs() > 0.0;
            if found.len() != 2 || found.iter().zip(identity).any(differs) {
                let what = format!("with an affine transformation ({name} {found:?})");
                return Err(unsupported(source, &what, "I00 0 0, V10 1 0, V01 0 1"));
            }
        }
    }
    let word = |name: &str| {
        child(calibration, name)
            .and_then(|one| one.text())
            .map(str::trim)
            .ok_or_else(|| source.invalid(format!("{name} is missing")))
    };
    let pair = |name: &str, text: &str| -> Result<[f64; 2], InputError> {
        let found = numbers(source, name, text)?;
        <[f64; 2]>::try_from(found)
            .map_err(|_| source.invalid(format!("{name}: 2 numbers are expected")))
    };
    let direction = word("KnownConv")?;
    let centre_px = pair("PP", word("PP")?)?;
    let focal_px = number_text(source, calibration, "F")?;
    let size = pair("SzIm", word("SzIm")?)?.map(pixel_count);
    let [Some(width), Some(height)] = size else {
        return Err(source.invalid("SzIm: not a number of columns and rows"));
    };
    let distortions: Vec<_> = children(calibration, "CalibDistortion").collect();
    if distortions.len() > 1 {
        return Err(source.invalid("more than one CalibDistortion"));
    }
    let terms = distortions
        .first()
        .map_or_else(|| Ok(Polynomial::default()), |one| polynomial(source, *one))?;
    let offset_px = match &terms.centre {
        Some(text) => {
            let [x, y] = pair("CDist", text)?;
            [x - centre_px[0], y - centre_px[1]]
        }
        None => [0.0; 2],
    };
    let formula = match direction {
        MEASURED_TO_IDEAL => {
            let pixel_mm = stated.pixel_mm.ok_or_else(|| {
                source.invalid("lengths are in pixels, and the pixel pitch is not stated")
            })?;
            let middle = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
            Formula::Correction(terms.correction(focal_px, centre_px, offset_px, middle, pixel_mm))
        }
        IDEAL_TO_MEASURED => Formula::Pinhole(terms.pinhole(focal_px, centre_px, offset_px)),
        other => {
            let supported = format!("{MEASURED_TO_IDEAL}, {IDEAL_TO_MEASURED}");
            return Err(unsupported(source, other, &supported));
        }
    };
    Found::new("camera", formula)
        .sized([width, height])
        .checked(source)
}

/// Coefficients of a file, in pixels.
#[derive(Debug, Default)]
struct Polynomial {
    centre: Option<String>,
    radial: [f64; 4],
    decentring: [f64; 2],
    affine: [f64; 2],
}

fn polynomial(source: &Source<'_>, distortion: Node<'_, '_>) -> Result<Polynomial, InputError> {
    let Some(model) = distortion.children().find(Node::is_element) else {
        return Err(source.invalid("CalibDistortion is empty"));
    };
    let name = model.tag_name().name();
    let radial_part = match name {
        "ModNoDist" => return Ok(Polynomial::default()),
        "ModRad" => model,
        "ModPhgrStd" => {
            child(model, "RadialePart").ok_or_else(|| source.invalid("RadialePart is missing"))?
        }
        other => return Err(unsupported(source, other, "ModPhgrStd, ModRad, ModNoDist")),
    };
    let mut radial = [0.0; 4];
    let coefficients: Vec<_> = children(radial_part, "CoeffDist").collect();
    if coefficients.len() > radial.len() {
        let fault = format!("{} CoeffDist where at most 4 are read", coefficients.len());
        return Err(source.invalid(fault));
    }
    for (cell, node) in radial.iter_mut().zip(&coefficients) {
        let text = node.text().unwrap_or_default();
        match numbers(source, "CoeffDist", text)?.as_slice() {
            [one] => *cell = *one,
            _ => return Err(source.invalid("CoeffDist: 1 number is expected")),
        }
    }
    let optional = |name: &str| number_or(source, model, name, 0.0);
    Ok(Polynomial {
        centre: child(radial_part, "CDist").and_then(|one| one.text().map(str::to_owned)),
        radial,
        decentring: [optional("P1")?, optional("P2")?],
        affine: [optional("b1")?, optional("b2")?],
    })
}

impl Polynomial {
    fn correction(
        &self,
        focal_px: f64,
        centre_px: [f64; 2],
        offset_px: [f64; 2],
        [middle_col, middle_row]: [f64; 2],
        pixel_mm: f64,
    ) -> Correction {
        let [c1, c2, c3, c4] = self.radial;
        let [p1, p2] = self.decentring;
        let [b1, b2] = self.affine;
        let [cx, cy] = centre_px;
        let [offset_x, offset_y] = offset_px;
        Correction {
            principal_distance_mm: focal_px * pixel_mm,
            principal_point_mm: [(cx - middle_col) * pixel_mm, (middle_row - cy) * pixel_mm],
            lens: Lens {
                k: [
                    0.0,
                    -c1 / pixel_mm.powi(2),
                    -c2 / pixel_mm.powi(4),
                    -c3 / pixel_mm.powi(6),
                ],
                p: [-p1 / pixel_mm, p2 / pixel_mm],
                b: [-b1, b2],
            },
            k4: -c4 / pixel_mm.powi(8),
            divisor: [0.0; 3],
            offset_mm: [offset_x * pixel_mm, -offset_y * pixel_mm],
        }
    }

    fn pinhole(&self, focal_px: f64, centre_px: [f64; 2], offset_px: [f64; 2]) -> Pinhole {
        let [c1, c2, c3, c4] = self.radial;
        let [p1, p2] = self.decentring;
        Pinhole {
            radial: [
                c1 * focal_px.powi(2),
                c2 * focal_px.powi(4),
                c3 * focal_px.powi(6),
                c4 * focal_px.powi(8),
            ],
            // P1 goes with u².
            decentring: [p2 * focal_px, p1 * focal_px],
            affine: self.affine,
            offset: offset_px.map(|offset| offset / focal_px),
            ..Pinhole::ideal(focal_px, centre_px)
        }
    }
}
