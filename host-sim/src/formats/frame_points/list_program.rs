//! Image-coordinate lists of other programs, line by line.

use std::io::{self, Write};

use clap::ValueEnum;
use fmc_camera_file::number::clipped;

/// Program whose list of image coordinates is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ListProgram {
    /// BINGO: image and camera, points in mm, -99.
    Bingo,
    /// PAT-B: number of the photo and principal distance, points in µm, -99.
    Patb,
    /// Inpho: $PHOTO blocks for a project file, points in mm.
    Inpho,
}

/// Characters of an identifier at most.
const WIDTH: usize = 15;

/// Line that ends an image of BINGO and PAT-B.
const END: &str = "-99";

impl ListProgram {
    /// Returns the identifier of an image: of PAT-B its number, else its name without folder and
    /// extension.
    ///
    /// # Errors
    /// The sentence for the user: an identifier that the format cannot hold.
    pub(super) fn image_id(self, sequence: u32, image: Option<&str>) -> Result<String, String> {
        let id = match (self, image) {
            (Self::Patb, _) | (_, None) => return Ok(sequence.to_string()),
            (Self::Bingo | Self::Inpho, Some(image)) => stem(image),
        };
        self.check(id, "image")?;
        Ok(id.to_owned())
    }

    /// Checks the identifier of a point.
    ///
    /// # Errors
    /// The sentence for the user.
    pub(super) fn check_point(self, id: &str) -> Result<(), String> {
        self.check(id, "point")
    }

    fn check(self, id: &str, what: &str) -> Result<(), String> {
        let refused = |fault: &str| {
            let id = clipped(id).escape_debug().to_string();
            Err(format!("{what} = \"{id}\": {fault}"))
        };
        if id.is_empty() || !id.bytes().all(|byte| byte.is_ascii_graphic()) {
            return refused("must be letters, digits and signs of ASCII, without blanks");
        }
        if id.starts_with('-') || id.contains(['$', '{', '}']) {
            return refused("must not begin with - nor hold $, { or }, which mean something else");
        }
        if self != Self::Inpho && id.len() > WIDTH {
            return refused(&format!(
                "is longer than the {WIDTH} characters of the format"
            ));
        }
        let is_number = id.bytes().all(|byte| byte.is_ascii_digit()) && !id.starts_with('0');
        if self == Self::Patb && !is_number {
            return refused("must be a whole number from 1 on, without leading zeros");
        }
        Ok(())
    }

    /// Writes what begins an image.
    pub(super) fn begin(self, id: &str, list: &ListHead, sink: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bingo => writeln!(sink, "{id} {}", list.camera),
            Self::Patb => writeln!(
                sink,
                "{id:>15} {:>15.3}",
                1000.0 * list.principal_distance_mm
            ),
            Self::Inpho => writeln!(sink, "$PHOTO\n  $PHOTO_NUM : {id}\n  $PHOTO_POINTS :"),
        }
    }

    /// Writes a point, mm.
    pub(super) fn point(self, id: &str, [x, y]: [f64; 2], sink: &mut dyn Write) -> io::Result<()> {
        let [x, y] = [x + 0.0, y + 0.0];
        match self {
            Self::Bingo => writeln!(sink, "{id:>15} {x:>14.6} {y:>14.6}"),
            Self::Patb => writeln!(sink, "{id:>15} {:>15.3} {:>15.3}", 1000.0 * x, 1000.0 * y),
            Self::Inpho => writeln!(sink, "    {id}\t{x:.6}\t{y:.6}\t1.00\t2 {{ * }}"),
        }
    }

    /// Writes what ends an image.
    pub(super) fn end(self, sink: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bingo => writeln!(sink, "{END}"),
            Self::Patb => writeln!(sink, "{END:>15}"),
            Self::Inpho => writeln!(sink, "  $END_POINTS\n$END"),
        }
    }
}

/// Values at the head of each image.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ListHead {
    /// Name of the camera, without blanks and as short as an identifier.
    pub(super) camera: String,
    pub(super) principal_distance_mm: f64,
}

impl ListHead {
    pub(super) fn new(camera: &str, principal_distance_mm: f64) -> Self {
        let name = camera.chars().filter(char::is_ascii_alphanumeric);
        let name: String = name.take(WIDTH).collect();
        Self {
            camera: if name.is_empty() {
                "camera".to_owned()
            } else {
                name
            },
            principal_distance_mm,
        }
    }
}

/// Returns the name of an image without folder and extension.
fn stem(image: &str) -> &str {
    let name = image.rsplit(['/', '\\']).next().unwrap_or(image);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}
