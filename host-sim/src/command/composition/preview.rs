//! Images on a page, reduced.

use fmc_composition::image::Plane;
use fmc_report::composition::page::{Section, png_link};

use super::virtual_image::Composed;
use crate::failure::Failure;

/// Largest side of an image on the page, px.
const PREVIEW_PX: usize = 360;

/// Virtual image and labels, reduced.
pub(super) fn images(composed: &Composed) -> Result<Section, Failure> {
    let plane = &composed.composite.layer.plane;
    let most = plane.values().iter().copied().max().unwrap_or(1).max(1);
    let shade = |value: u16| u8::try_from(u32::from(value) * 255 / u32::from(most)).unwrap_or(255);
    let width = plane.width();
    let count = composed
        .composite
        .labels
        .iter()
        .copied()
        .max()
        .unwrap_or(1)
        .max(1);
    let labels = &composed.composite.labels;
    let images = [
        link(plane, |col, row| plane.at(col, row).map_or(0, shade))
            .map(|link| ("virtual image".to_owned(), link)),
        link(plane, |col, row| {
            let label = labels.get(row * width + col).copied().unwrap_or(0);
            u8::try_from(u16::from(label) * 255 / u16::from(count)).unwrap_or(255)
        })
        .map(|link| ("sub-image that each pixel is of".to_owned(), link)),
    ];
    let images: Result<Vec<_>, Failure> = images.into_iter().collect();
    Ok(Section {
        heading: "Images".to_owned(),
        images: images?,
        ..Section::default()
    })
}

/// Returns every so many pixels as a PNG in the form of a link.
pub(super) fn link(plane: &Plane, shade: impl Fn(usize, usize) -> u8) -> Result<String, Failure> {
    let step = plane.width().max(plane.height()).div_ceil(PREVIEW_PX);
    let columns = plane.width().div_ceil(step);
    let mut grey = Vec::with_capacity(columns * plane.height().div_ceil(step));
    for row in (0..plane.height()).step_by(step) {
        grey.extend((0..plane.width()).step_by(step).map(|col| shade(col, row)));
    }
    png_link(u32::try_from(columns).unwrap_or(1), &grey)
        .map_err(|error| Failure::device_or_io(format!("report.html: image: {error}")))
}
