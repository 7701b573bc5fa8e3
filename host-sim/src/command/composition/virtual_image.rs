//! `virtual`: the sub-images of an exposure as one image.

mod composed;
mod summary;

use std::borrow::Cow;
use std::path::Path;

use fmc_composition::image::Plane;
use fmc_composition::mosaic::registration::{Pair, Registration};
use fmc_composition::mosaic::{
    Composite, Geometry, GreenMatch, Layer, SeamStep, compose, green_pairs, memory_bytes, steps,
};
use fmc_composition::radiometry::Correction;
use fmc_composition::real;
use fmc_composition::rig::control::{Place, Tie};
use fmc_composition::rig::{Heights, Rig, SubImage};
use fmc_report::composition::page::CompositionPage;

pub(super) use self::composed::{Choices, Composed};
pub(super) use self::summary::Summary;
use super::files::{read_plane, read_rig, write_plane, write_rows};
use super::preview;
use super::radiometry::RadiometryFolder;
use super::scene::write_ties;
use crate::cli::{OrderName, VirtualArgs};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Least part of the windows that must match green.
const LEAST_GREEN_PART: f64 = 0.2;
/// Degree of a polynomial over the frame.
const DEGREE: usize = 3;
/// Images of an exposure, corrected.
#[derive(Debug)]
pub(super) struct Frames {
    pub(super) subs: Vec<Plane>,
    pub(super) green: Option<Plane>,
}

/// Radiometric corrections of the sub-images.
#[derive(Debug, Clone, Copy)]
pub(super) enum Corrections<'a> {
    /// Grey values stay as recorded.
    Without,
    /// In the order of the rig.
    Known(&'a [Correction]),
    /// Read one after the other.
    Folder(&'a RadiometryFolder),
}

impl<'a> Corrections<'a> {
    fn of(self, number: usize, sub: &SubImage) -> Result<Option<Cow<'a, Correction>>, Failure> {
        Ok(match self {
            Self::Without => None,
            Self::Known(list) => list.get(number).map(Cow::Borrowed),
            Self::Folder(folder) => folder.correction(number, sub)?.map(Cow::Owned),
        })
    }
}

/// Runs `virtual`.
pub(in crate::command) fn run(args: &VirtualArgs) -> Result<(), Failure> {
    let rig = read_rig(&args.rig)?;
    if let Some(sub) = rig.sub.iter().find(|sub| sub.polynomial.is_none()) {
        return Err(Failure::bad_input(format!(
            "{}: sub-image {} has no polynomial; calibrate the rig first with `calibrate rig`",
            args.rig.display(),
            sub.id
        )));
    }
    for name in ["virtual.tif", "mask.tif", "labels.tif"] {
        for sub in &rig.sub {
            let input = args.exposure.join(format!("{}.tif", sub.id));
            output::check_not_an_input(&args.out.join(name), &input)?;
        }
    }
    check_memory(&rig, args)?;
    let radiometry = args.radiometry.as_deref();
    let radiometry = radiometry
        .map(|folder| RadiometryFolder::open(&rig, folder))
        .transpose()?;
    let method = radiometry.as_ref().map(|folder| folder.method);
    let corrections = radiometry
        .as_ref()
        .map_or(Corrections::Without, Corrections::Folder);
    let frames = read_frames(&rig, &args.exposure, corrections)?;
    let choices = Choices {
        order: args.order,
        kernel: args.resample.kernel(),
        feather_px: args.feather.into(),
    };
    let name = args
        .exposure
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    let name = name.unwrap_or_else(|| "exposure".to_owned());
    let composed = compose_frames(&rig, &frames, choices, &name)?;
    let summary = Summary::of(&rig, &composed, choices, method);
    let page = page(&rig, &composed, &summary, &name)?;
    let folder = OutputFolder::create(&args.out)?;
    write(&rig, &composed, &folder)?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))?;
    folder.write_json("summary.json", &summary)?;
    output::write(None, |sink| {
        for line in summary.lines() {
            writeln!(sink, "{line}")?;
        }
        Ok(())
    })?;
    note(format_args!(
        "{}: virtual.tif, mask.tif, labels.tif, ties.csv, report.html, summary.json",
        folder.path().display()
    ));
    Ok(())
}

/// Checks that the images of an exposure, which are all held, fit into the memory that is allowed.
fn check_memory(rig: &Rig, args: &VirtualArgs) -> Result<(), Failure> {
    let needed = memory_bytes(rig).div_ceil(1 << 20);
    if needed > u64::from(args.memory) {
        return Err(Failure::bad_input(format!(
            "{}: {} sub-images and a virtual image of {} x {} px need about {needed} MiB of memory; allowed: {} MiB (--memory)",
            args.rig.display(),
            rig.sub.len(),
            rig.frame.width_px,
            rig.frame.height_px,
            args.memory
        )));
    }
    Ok(())
}

/// Reads the images of an exposure and corrects their radiometry.
pub(super) fn read_frames(
    rig: &Rig,
    folder: &Path,
    corrections: Corrections,
) -> Result<Frames, Failure> {
    let mut subs = Vec::new();
    for (number, sub) in rig.sub.iter().enumerate() {
        let path = folder.join(format!("{}.tif", sub.id));
        let mut plane = read_plane(&path, sub.size_px())?;
        match corrections.of(number, sub)? {
            Some(correction) if !correction.apply(&mut plane) => {
                return Err(Failure::bad_input(format!(
                    "{}: the radiometry is of another size; calibrate it with the same rig file",
                    path.display()
                )));
            }
            Some(_) => {}
            // 0 means no content.
            None => plane
                .values_mut()
                .iter_mut()
                .for_each(|value| *value = (*value).max(1)),
        }
        subs.push(plane);
    }
    let green = match &rig.green {
        None => None,
        Some(green) => {
            let size = [green.width_px, green.height_px];
            Some(read_plane(&folder.join("green.tif"), size)?)
        }
    };
    Ok(Frames { subs, green })
}

/// Composes the images of an exposure.
pub(super) fn compose_frames(
    rig: &Rig,
    frames: &Frames,
    choices: Choices,
    exposure: &str,
) -> Result<Composed, Failure> {
    let common = match choices.order {
        OrderName::RectifyFirst => None,
        OrderName::MosaicFirst => Some(common_polynomial(rig)?),
    };
    let ignored = rig
        .calibration
        .is_some_and(|table| table.heights == Heights::Ignore);
    let geometries = |registration: Option<&Registration>| -> Vec<Geometry> {
        let each = rig.sub.iter().map(|sub| Geometry {
            size_px: sub.size_px(),
            polynomial: match choices.order {
                OrderName::RectifyFirst => rig.polynomial(sub),
                OrderName::MosaicFirst => sub.nominal(rig.frame),
            },
            registration: registration.cloned(),
        });
        each.collect()
    };
    let first = geometries(common.as_ref());
    let (mut found, mut composite) = composed(rig, frames, &first, choices)?;
    let mut geometry = first;
    let mut green = registered(rig, frames, &composite)?;
    if let Some((_, registration)) = &mut green
        && ignored
        && choices.order == OrderName::RectifyFirst
    {
        // Zhao et al. 2013: the mosaic of the ground becomes an image by registration to green.
        geometry = geometries(Some(registration));
        drop(composite);
        (found, composite) = composed(rig, frames, &geometry, choices)?;
    }
    let ties = ties(&geometry, &found, exposure);
    Ok(Composed {
        composite,
        steps: found,
        green,
        ties,
    })
}

fn composed(
    rig: &Rig,
    frames: &Frames,
    geometries: &[Geometry],
    choices: Choices,
) -> Result<(Vec<SeamStep>, Composite), Failure> {
    let mut layers = Vec::new();
    for ((sub, image), geometry) in rig.sub.iter().zip(&frames.subs).zip(geometries) {
        let layer = Layer::resampled(rig.frame, image, geometry, choices.kernel);
        layers.push(layer.ok_or_else(|| {
            Failure::bad_input(format!(
                "sub-image {}: its polynomial leads outside the virtual image",
                sub.id
            ))
        })?);
    }
    let found = steps(&layers);
    let composite = compose(rig, layers, choices.feather_px)
        .ok_or_else(|| Failure::bad_input("no sub-image to compose"))?;
    Ok((found, composite))
}

/// Returns one polynomial over the frame, from the nominal mosaic to the virtual image: what the
/// polynomials of all sub-images have in common.
fn common_polynomial(rig: &Rig) -> Result<Registration, Failure> {
    let mut pairs = Vec::new();
    for sub in &rig.sub {
        let (nominal, own) = (sub.nominal(rig.frame), rig.polynomial(sub));
        for number in 0..100_u32 {
            let part = |number: u32| 2.0 * f64::from(number) / 9.0 - 1.0;
            let [col, row] = sub.centre_px();
            let place = [part(number % 10) * col / row, part(number / 10)];
            pairs.push(Pair {
                from_px: nominal.value(place),
                to_px: own.value(place),
            });
        }
    }
    let size = [rig.frame.width_px, rig.frame.height_px];
    Registration::unweighted(size, DEGREE, &pairs)
        .ok_or_else(|| Failure::bad_input("the sub-images determine no polynomial over the frame"))
}

/// Registers a mosaic to green.
fn registered(
    rig: &Rig,
    frames: &Frames,
    composite: &Composite,
) -> Result<Option<(GreenMatch, Registration)>, Failure> {
    let (Some(green), Some(recorded)) = (&rig.green, &frames.green) else {
        return Ok(None);
    };
    let size = [rig.frame.width_px, rig.frame.height_px];
    let found = green_pairs(rig, green, recorded, &composite.layer.plane);
    let windows = found.as_ref().map_or(0, |found| found.windows);
    let enough = found.filter(|found| real(found.pairs.len()) >= LEAST_GREEN_PART * real(windows));
    let fitted = enough.and_then(|found| {
        let registration = Registration::fit(size, DEGREE, &found.pairs)?;
        Some((found, registration))
    });
    let Some(fitted) = fitted else {
        return Err(Failure::bad_input(
            "green.tif: its windows do not match the sub-images; allowed: a fifth of 400 windows or more; green without contrast, of another exposure, or too far from its place",
        ));
    };
    Ok(Some(fitted))
}

/// Returns the matches in the overlaps as ties of the sub-images.
fn ties(geometries: &[Geometry], steps: &[SeamStep], exposure: &str) -> Vec<Tie> {
    let mut ties = Vec::new();
    for step in steps {
        for places in &step.ties {
            let mut found = Vec::new();
            for (sub, place) in step.layers.into_iter().zip(places) {
                let pixel = geometries
                    .get(sub)
                    .and_then(|geometry| geometry.pixel(*place));
                found.extend(pixel.map(|pixel| Place { sub, pixel }));
            }
            if let [first, second] = found.as_slice() {
                ties.push(Tie {
                    id: format!("{exposure}-{}", ties.len() + 1),
                    exposure: exposure.to_owned(),
                    places: [*first, *second],
                });
            }
        }
    }
    ties
}

/// Writes the images and ties of a composition.
pub(super) fn write(rig: &Rig, composed: &Composed, folder: &OutputFolder) -> Result<(), Failure> {
    let plane = &composed.composite.layer.plane;
    let size = [plane.width(), plane.height()];
    write_plane(&folder.path().join("virtual.tif"), plane)?;
    let labels = &composed.composite.labels;
    let row_of = |row: usize, value: &(dyn Fn(u8) -> f64 + Sync)| -> Vec<f64> {
        let labels = labels.iter().skip(row * size[0]).take(size[0]);
        labels.map(|label| value(*label)).collect()
    };
    write_rows(&folder.path().join("labels.tif"), size, 8, |row| {
        row_of(row, &f64::from)
    })?;
    let is_content = |label: u8| if label == 0 { 0.0 } else { 255.0 };
    write_rows(&folder.path().join("mask.tif"), size, 8, |row| {
        row_of(row, &is_content)
    })?;
    folder.write("ties.csv", |sink| write_ties(rig, &composed.ties, sink))
}

fn page(rig: &Rig, composed: &Composed, summary: &Summary, name: &str) -> Result<String, Failure> {
    let failed =
        |error: &dyn std::fmt::Display| Failure::device_or_io(format!("report.html: {error}"));
    let page = CompositionPage {
        title: format!("Virtual image {name} of {}", rig.name),
        findings: summary.lines(),
        sections: vec![summary.section(), preview::images(composed)?],
        passed: None,
    };
    page.html().map_err(|error| failed(&error))
}
