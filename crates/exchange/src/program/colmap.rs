//! COLMAP: cameras as text and as binary.

use fmc_camera_file::InputError;

use crate::calibrated::Calibrated;
use crate::coefficient::Coefficient::Radial;
use crate::decimal::number;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_2, Model, RATIONAL, TWO_FOCALS};
use crate::source::Source;

/// Models, the smallest first.
pub(crate) const MODELS: &[Model] = &[
    Model::new("SIMPLE_PINHOLE", &[], &[]),
    Model::new("PINHOLE", &[], TWO_FOCALS),
    Model::new("SIMPLE_RADIAL", &[Radial(0)], &[]),
    Model::new("RADIAL", &[Radial(0), Radial(1)], &[]),
    Model::new("OPENCV", BROWN_2, TWO_FOCALS),
    Model::new("FULL_OPENCV", RATIONAL, TWO_FOCALS),
];

/// Identifier and number of parameters of each model of [`MODELS`].
const BINARY: [(&str, i32, usize); 6] = [
    ("SIMPLE_PINHOLE", 0, 3),
    ("PINHOLE", 1, 4),
    ("SIMPLE_RADIAL", 2, 4),
    ("RADIAL", 3, 5),
    ("OPENCV", 4, 8),
    ("FULL_OPENCV", 6, 12),
];

/// Models that are not read, with their identifiers.
const OTHERS: [(i32, &str); 6] = [
    (5, "OPENCV_FISHEYE"),
    (7, "FOV"),
    (8, "SIMPLE_RADIAL_FISHEYE"),
    (9, "RADIAL_FISHEYE"),
    (10, "THIN_PRISM_FISHEYE"),
    (11, "RAD_TAN_THIN_PRISM_FISHEYE"),
];

const SUPPORTED: &str = "SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV";

/// Most cameras of a file.
const MAX_CAMERAS: u64 = 1_000_000;

/// Returns the parameters in COLMAP's order. Its first pixel centre is at (½, ½).
fn parameters(pinhole: &Pinhole, model: &str) -> Vec<f64> {
    let [fx, fy] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px.map(|centre| centre + 0.5);
    let [k1, k2, k3, _] = pinhole.radial;
    let [k4, k5, k6] = pinhole.divisor;
    let [p1, p2] = pinhole.decentring;
    match model {
        "SIMPLE_PINHOLE" => vec![fy, cx, cy],
        "PINHOLE" => vec![fx, fy, cx, cy],
        "SIMPLE_RADIAL" => vec![fy, cx, cy, k1],
        "RADIAL" => vec![fy, cx, cy, k1, k2],
        "OPENCV" => vec![fx, fy, cx, cy, k1, k2, p1, p2],
        _ => vec![fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6],
    }
}

/// Returns the camera of parameters; `None` for another number of them.
fn pinhole(model: &str, parameters: &[f64]) -> Option<Pinhole> {
    let (focal_px, [cx, cy], radial, divisor, decentring) = match (model, parameters) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], [0.0; 4], [0.0; 3], [0.0; 2]),
        ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], [0.0; 4], [0.0; 3], [0.0; 2]),
        ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => {
            ([f, f], [cx, cy], [k1, 0.0, 0.0, 0.0], [0.0; 3], [0.0; 2])
        }
        ("RADIAL", &[f, cx, cy, k1, k2]) => {
            ([f, f], [cx, cy], [k1, k2, 0.0, 0.0], [0.0; 3], [0.0; 2])
        }
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => {
            ([fx, fy], [cx, cy], [k1, k2, 0.0, 0.0], [0.0; 3], [p1, p2])
        }
        ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => (
            [fx, fy],
            [cx, cy],
            [k1, k2, k3, 0.0],
            [k4, k5, k6],
            [p1, p2],
        ),
        _ => return None,
    };
    Some(Pinhole {
        focal_px,
        radial,
        divisor,
        decentring,
        ..Pinhole::ideal(1.0, [cx - 0.5, cy - 0.5])
    })
}

/// Writes cameras, images and points, the last two empty, as text or as binary.
pub(crate) fn write(
    camera: &Calibrated,
    pinhole: &Pinhole,
    model: &Model,
    is_binary: bool,
) -> Vec<(String, Vec<u8>)> {
    if is_binary {
        let mut bytes = 1_u64.to_le_bytes().to_vec();
        bytes.extend(binary_camera(camera, pinhole, model.name, 1));
        let none = 0_u64.to_le_bytes().to_vec();
        return vec![
            ("cameras.bin".to_owned(), bytes),
            ("images.bin".to_owned(), none.clone()),
            ("points3D.bin".to_owned(), none),
        ];
    }
    [
        (
            "cameras.txt",
            CAMERAS_HEAD.to_owned()
                + "# Number of cameras: 1\n"
                + &camera_line(camera, pinhole, model.name, 1),
        ),
        (
            "images.txt",
            IMAGES_HEAD.to_owned() + "# Number of images: 0\n",
        ),
        ("points3D.txt", points_head(0)),
    ]
    .map(|(name, text)| (name.to_owned(), text.into_bytes()))
    .into()
}

/// Head of `cameras.txt`.
pub(crate) const CAMERAS_HEAD: &str = "# Camera list with one line of data per camera:\n\
                                       #   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";

/// Head of `images.txt`.
pub(crate) const IMAGES_HEAD: &str = "# Image list with two lines of data per image:\n\
     #   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n\
     #   POINTS2D[] as (X, Y, POINT3D_ID)\n";

/// Returns the head of `points3D.txt`.
pub(crate) fn points_head(count: usize) -> String {
    format!(
        "# 3D point list with one line of data per point:\n\
         #   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n\
         # Number of points: {count}\n"
    )
}

/// Returns the line of a camera in `cameras.txt`.
pub(crate) fn camera_line(camera: &Calibrated, pinhole: &Pinhole, model: &str, id: u32) -> String {
    let [width, height] = camera.size_px;
    let words: Vec<_> = parameters(pinhole, model).into_iter().map(number).collect();
    format!("{id} {model} {width} {height} {}\n", words.join(" "))
}

/// Returns the bytes of a camera in `cameras.bin`.
pub(crate) fn binary_camera(
    camera: &Calibrated,
    pinhole: &Pinhole,
    model: &str,
    id: u32,
) -> Vec<u8> {
    let number = BINARY
        .iter()
        .find(|(name, ..)| *name == model)
        .map_or(0, |(_, number, _)| *number);
    let [width, height] = camera.size_px.map(u64::from);
    let mut bytes = id.to_le_bytes().to_vec();
    bytes.extend(number.to_le_bytes());
    bytes.extend(width.to_le_bytes());
    bytes.extend(height.to_le_bytes());
    let parameters = parameters(pinhole, model);
    bytes.extend(parameters.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

/// One camera of a file: model, width, height, parameters.
type Listed = (String, [u32; 2], Vec<f64>);

/// Reads `cameras.txt` or `cameras.bin`.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    // The binary file begins with a count, whose upper bytes are zero.
    let is_binary = source.bytes.iter().take(8).any(|byte| *byte == 0);
    let cameras = if is_binary {
        from_binary(source)?
    } else {
        from_text(source)?
    };
    let (id, (model, size, parameters)) = chosen(source, cameras, stated.id)?;
    if !BINARY.iter().any(|(name, ..)| *name == model) {
        return Err(unsupported(source, &model, SUPPORTED));
    }
    let camera = pinhole(&model, &parameters)
        .ok_or_else(|| source.invalid(format!("{} parameters for {model}", parameters.len())))?;
    Found::new(format!("camera {id}"), Formula::Pinhole(camera))
        .sized(size)
        .checked(source)
}

fn from_text(source: &Source<'_>) -> Result<Vec<(String, Listed)>, InputError> {
    let mut cameras = Vec::new();
    for (line, text) in (1..).zip(source.text()?.lines()) {
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let refuse = |fault: String| source.invalid(format!("line {line}: {fault}"));
        let mut words = text.split_whitespace();
        let mut next = |what: &str| {
            words
                .next()
                .ok_or_else(|| refuse(format!("{what} is missing")))
        };
        let id = next("the camera's id")?.to_owned();
        let model = next("the model")?.to_owned();
        let mut side = |what: &str| {
            let word = next(what)?;
            let side = word.parse::<u32>().ok().filter(|side| *side > 0);
            side.ok_or_else(|| refuse(format!("{what} {word} is not a number of pixels")))
        };
        let size = [side("the width")?, side("the height")?];
        let parameters = words
            .map(|word| {
                fmc_camera_file::number::finite(word)
                    .map_err(|fault| refuse(format!("{word}: {fault}")))
            })
            .collect::<Result<_, _>>()?;
        cameras.push((id, (model, size, parameters)));
    }
    Ok(cameras)
}

/// Takes the next eight or four bytes of a binary file.
struct Bytes<'a, 'b> {
    rest: &'a [u8],
    source: &'b Source<'a>,
}

impl Bytes<'_, '_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], InputError> {
        match self.rest.split_first_chunk::<N>() {
            Some((taken, rest)) => {
                self.rest = rest;
                Ok(*taken)
            }
            None => Err(self.source.invalid("the file ends within a camera")),
        }
    }

    fn side(&mut self) -> Result<u32, InputError> {
        let side = u64::from_le_bytes(self.take()?);
        u32::try_from(side)
            .ok()
            .filter(|side| *side > 0)
            .ok_or_else(|| {
                self.source
                    .invalid(format!("{side} is not a number of pixels"))
            })
    }
}

fn from_binary(source: &Source<'_>) -> Result<Vec<(String, Listed)>, InputError> {
    let mut bytes = Bytes {
        rest: source.bytes,
        source,
    };
    let count = u64::from_le_bytes(bytes.take()?);
    if count > MAX_CAMERAS {
        return Err(source.invalid(format!("{count} cameras, more than {MAX_CAMERAS}")));
    }
    let mut cameras = Vec::new();
    for _ in 0..count {
        let id = i32::from_le_bytes(bytes.take()?);
        let model = i32::from_le_bytes(bytes.take()?);
        let size = [bytes.side()?, bytes.side()?];
        let Some((name, _, count)) = BINARY.iter().find(|(_, number, _)| *number == model) else {
            let name = OTHERS
                .iter()
                .find(|(number, _)| *number == model)
                .map_or_else(|| format!("number {model}"), |(_, name)| (*name).to_owned());
            return Err(unsupported(source, &name, SUPPORTED));
        };
        let parameters = (0..*count)
            .map(|_| Ok(f64::from_le_bytes(bytes.take()?)))
            .collect::<Result<_, InputError>>()?;
        cameras.push((id.to_string(), ((*name).to_owned(), size, parameters)));
    }
    Ok(cameras)
}
