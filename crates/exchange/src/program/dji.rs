//! DJI: `DewarpData` of an image's XMP.

use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;

use crate::found::{Formula, Found, Stated};
use crate::pinhole::Pinhole;
use crate::source::Source;

/// Reads `date;fx,fy,cx,cy,k1,k2,p1,p2,k3` from an image, its XMP or a text; cx and cy are from the
/// middle of the image.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    if source.bytes.is_empty() {
        return Err(source.invalid("the file is empty"));
    }
    let text = String::from_utf8_lossy(source.bytes);
    if property(&text, "DewarpFlag").is_some_and(|flag| flag.trim() == "1") {
        return Err(source
            .invalid("DewarpFlag is 1: the camera has taken the distortion off this image")
            .with_help("an image with DewarpFlag 0, or a camera without distortion"));
    }
    let data =
        property(&text, "DewarpData").or_else(|| (source.bytes.len() < 1000).then(|| text.trim()));
    let data = data.ok_or_else(|| source.invalid("DewarpData is missing"))?;
    let (_, numbers) = data
        .split_once(';')
        .ok_or_else(|| source.invalid("DewarpData: not of the form date;numbers"))?;
    let numbers = numbers
        .split(',')
        .map(|word| {
            finite(word).map_err(|fault| source.invalid(format!("DewarpData: {word:?} is {fault}")))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let &[fx, fy, cx, cy, k1, k2, p1, p2, k3] = numbers.as_slice() else {
        let fault = format!("DewarpData: {} numbers where 9 are expected", numbers.len());
        return Err(source.invalid(fault));
    };
    let size = stated
        .size_px
        .ok_or_else(|| source.invalid("no size of the image is stated, and DewarpData has none"))?;
    let [middle_col, middle_row] = size.map(|side| (f64::from(side) - 1.0) / 2.0);
    let pinhole = Pinhole {
        focal_px: [fx, fy],
        radial: [k1, k2, k3, 0.0],
        decentring: [p1, p2],
        ..Pinhole::ideal(1.0, [middle_col + cx, middle_row + cy])
    };
    Found::new("camera", Formula::Pinhole(pinhole)).checked(source)
}

/// Returns the value of a property of an XMP, an attribute or an element; `None` also where it has
/// no end.
fn property<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let ends = [("=\"", '"'), (">", '<')];
    ends.into_iter().find_map(|(begin, end)| {
        let (_, rest) = text.split_once(&format!("{name}{begin}"))?;
        Some(rest.split_once(end)?.0)
    })
}
