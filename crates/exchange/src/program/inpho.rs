//! Inpho: the camera of a project file (`.prj`).

use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;
use fmc_reference::lens::Lens;

use crate::correction::Correction;
use crate::fields::pixel_count;
use crate::found::{Formula, Found, Stated, chosen, unsupported};
use crate::source::Source;

/// Reads one camera of a project.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let text = source.text()?;
    let is_correction = stated.is_correction.ok_or_else(|| {
        source
            .invalid("the sign of Inpho's coefficients is not known, and --sign is not given")
            .with_help(
                "--sign correction: to be added to the measured point; --sign distortion: \
                 measured - ideal. The file does not say; a barrel lens has K1 > 0 as a correction",
            )
    })?;
    let mut cameras: Vec<(String, Vec<&str>)> = Vec::new();
    let mut is_inside = false;
    for line in text.lines().map(str::trim) {
        let word = line.split_whitespace().next().unwrap_or_default();
        if word == "$CAMERA" || word == "$CAMERA_DEFINITION" {
            let number = cameras.len() + 1;
            cameras.push((number.to_string(), Vec::new()));
            is_inside = true;
        } else if word == "$PHOTO" || word == "$AAT" {
            is_inside = false;
        }
        if is_inside && let Some((name, lines)) = cameras.last_mut() {
            if word == "$ID" || word == "$TYPE" {
                let value = line.split_once(':').map_or("", |(_, value)| value.trim());
                // The identifier stands before the type where there is one.
                if name.parse::<usize>().is_ok() && !value.is_empty() {
                    value.clone_into(name);
                }
            }
            lines.push(line);
        }
    }
    let (name, lines) = chosen(source, cameras, stated.id)?;
    camera(source, lines.join("\n"), name, is_correction, stated)
}

/// Lines of one camera.
struct Block<'a> {
    source: &'a Source<'a>,
    text: String,
}

impl Block<'_> {
    /// Returns the numbers behind a key, up to the next one.
    fn values(&self, key: &str) -> Result<Option<Vec<f64>>, InputError> {
        let Some(place) = self
            .text
            .find(&format!("{key} "))
            .or_else(|| self.text.find(key))
        else {
            return Ok(None);
        };
        let rest = self.text.get(place + key.len()..).unwrap_or_default();
        let rest = rest.split('$').next().unwrap_or_default();
        rest.split([' ', ':', '\n', '\r', '\t'])
            .filter(|word| !word.is_empty())
            .map(|word| {
                finite(word)
                    .map_err(|fault| self.source.invalid(format!("{key}: {word:?} is {fault}")))
            })
            .collect::<Result<Vec<_>, _>>()
            .map(Some)
    }

    /// Returns exactly `N` numbers behind a key.
    fn required<const N: usize>(&self, key: &str) -> Result<[f64; N], InputError> {
        let numbers = self
            .values(key)?
            .ok_or_else(|| self.source.invalid(format!("{key} is missing")))?;
        let count = numbers.len();
        numbers.try_into().map_err(|_| {
            self.source
                .invalid(format!("{key}: {count} numbers where {N} are expected"))
        })
    }

    /// Returns `N` numbers behind a key, of which none may be left out but zeros.
    fn first<const N: usize>(&self, key: &str) -> Result<[f64; N], InputError> {
        let mut numbers = self.values(key)?.unwrap_or_default();
        if numbers.iter().skip(N).any(|number| number.abs() > 0.0) {
            let fault = format!("{key}: more than {N} numbers are not 0");
            return Err(self.source.invalid(fault));
        }
        numbers.resize(N, 0.0);
        Ok(numbers.try_into().unwrap_or([0.0; N]))
    }

    fn word(&self, key: &str) -> Option<&str> {
        self.text.lines().find_map(|line| {
            let (name, value) = line.split_once(':')?;
            (name.trim() == key).then(|| value.trim())
        })
    }
}

fn camera(
    source: &Source<'_>,
    text: String,
    name: String,
    is_correction: bool,
    stated: &Stated<'_>,
) -> Result<Found, InputError> {
    let block = Block { source, text };
    for (key, read) in [
        ("$KIND", "CCDFrame"),
        ("$PIXEL_REFERENCE", "CenterTopLeft"),
        ("$DISTORTION_TYPE", "Polynomial"),
    ] {
        if let Some(found) = block.word(key)
            && found != read
        {
            return Err(unsupported(source, &format!("{key} {found}"), read));
        }
    }
    if !block.text.lines().any(|line| line.trim() == "$END") {
        return Err(source.invalid("the file ends within the camera: its $END is missing"));
    }
    let pixel_mm = stated
        .pixel_mm
        .ok_or_else(|| source.invalid("no pixel pitch is stated"))?;
    let [focal] = block.required("$FOCAL_LENGTH")?;
    let [a11, a12, col, a21, a22, row] = block.required("$CCD_INTERIOR_ORIENTATION")?;
    let [ppa_x, ppa_y] = block.required("$PRINCIPAL_POINT_PPA")?;
    if a12.abs() > 1e-6 * a11.abs() || a21.abs() > 1e-6 * a22.abs() || a11 <= 0.0 || a22 >= 0.0 {
        return Err(source.invalid(
            "$CCD_INTERIOR_ORIENTATION: a turned or mirrored array is not read (x right, y up)",
        ));
    }
    let [columns] = block.required("$CCD_COLUMNS")?;
    let [rows] = block.required("$CCD_ROWS")?;
    let [Some(width), Some(height)] = [columns, rows].map(pixel_count) else {
        return Err(source.invalid("$CCD_COLUMNS, $CCD_ROWS: not a number of pixels"));
    };
    let [middle_col, middle_row] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
    let [k0, k1, k2, k3, k4] = block.first("$RADIAL_COEFFS")?;
    let [p1, p2] = block.first("$DECENTRE_COEFFS")?;
    let sign = if is_correction { -1.0 } else { 1.0 };
    // The file's millimetres per pixel differ from the stated ones by parts in a million at most;
    // that is a scale along each axis.
    let [scale_x, scale_y] = [1.0 / (a11 * pixel_mm), -1.0 / (a22 * pixel_mm)];
    if [scale_x, scale_y]
        .iter()
        .any(|scale| (scale - 1.0).abs() > 1e-4)
    {
        return Err(source.invalid(format!(
            "$CCD_INTERIOR_ORIENTATION: pixels of {:.6} x {:.6} µm, {} of {} µm",
            1e3 / a11,
            -1e3 / a22,
            stated.pixel_stated_by(),
            1e3 * pixel_mm
        )));
    }
    let lens = Lens {
        k: [sign * k0 + 1.0 - scale_y, sign * k1, sign * k2, sign * k3],
        p: [sign * p1, sign * p2],
        b: [scale_y - scale_x, 0.0],
    };
    let correction = Correction {
        principal_distance_mm: focal,
        principal_point_mm: [
            (a11 * ppa_x + col - middle_col) * pixel_mm,
            (middle_row - row - a22 * ppa_y) * pixel_mm,
        ],
        lens,
        k4: sign * k4,
        divisor: [0.0; 3],
        offset_mm: [0.0; 2],
    };
    let found = Found::new(name, Formula::Correction(correction)).sized([width, height]);
    Found {
        notes: vec![
            "the sign of the coefficients is the one stated, not one of the file".to_owned(),
        ],
        ..found
    }
    .checked(source)
}
