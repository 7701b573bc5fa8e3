//! `stereo`: a bundle of two virtual images over control and check points.

use std::path::Path;

use fmc_composition::image::Plane;
use fmc_composition::mosaic::registration::Pair;
use fmc_composition::rig::Rig;
use fmc_composition::stereo::{
    Layout, StereoPoint, StereoRequest, StereoResult, adjust, matched_ties,
};
use serde::Serialize;

use super::files::{read_plane, read_rig};
use crate::cli::StereoArgs;
use crate::failure::{Failure, note};
use crate::formats::named_columns::NamedColumns;
use crate::formats::output::{self, OutputFolder};

/// Runs `stereo`.
pub(in crate::command) fn run(args: &StereoArgs) -> Result<(), Failure> {
    let rig = read_rig(&args.rig)?;
    let size = [rig.frame.width_px, rig.frame.height_px];
    let images = [
        read_plane(&args.first, size)?,
        read_plane(&args.second, size)?,
    ];
    let marks = read_marks(&rig, &args.marks)?;
    let (points, ties) = with_ties(&rig, &images, marks);
    let mut results = Vec::new();
    for layout in Layout::ALL {
        let request = StereoRequest {
            principal_distance_px: rig.principal_distance_px(),
            sigma_px: args.sigma_px,
            control_sigma_m: args.control_sigma,
            layout,
        };
        results.push((layout.name(), adjust(&points, &request)?));
    }
    if let Some(out) = &args.out {
        let folder = OutputFolder::create(out)?;
        let summary: Vec<LayoutResult> = results
            .iter()
            .map(|(layout, result)| LayoutResult {
                layout,
                result: *result,
            })
            .collect();
        folder.write_json("summary.json", &summary)?;
        note(format_args!("{}: summary.json", folder.path().display()));
    }
    output::write(None, |sink| {
        writeln!(sink, "{ties} ties matched")?;
        for (layout, result) in &results {
            writeln!(sink, "{}", line(layout, result))?;
        }
        Ok(())
    })
}

/// A layout with its result.
#[derive(Debug, Serialize)]
struct LayoutResult<'a> {
    layout: &'a str,
    result: StereoResult,
}

/// Returns what a layout gave, in a line.
fn line(layout: &str, result: &StereoResult) -> String {
    let [x, y, z] = result.control_m;
    let check = match (result.check_m, result.check_plane_m()) {
        (Some([x, y, z]), Some(plane)) => format!(
            "{} check points X {x:.3}, Y {y:.3}, plane {plane:.3}, height {z:.3} m",
            result.check
        ),
        _ => "no check point: what control leaves is a residual, no accuracy".to_owned(),
    };
    format!(
        "{layout}: σ0 {:.2}, B/H {:.2}; {} control points X {x:.3}, Y {y:.3}, Z {z:.3} m; {check}",
        result.sigma0, result.base_over_height, result.control
    )
}

/// Adds matched ties to marks, and returns their number.
pub(super) fn with_ties(
    rig: &Rig,
    [first, second]: &[Plane; 2],
    marks: Vec<StereoPoint>,
) -> (Vec<StereoPoint>, usize) {
    let [u, v] = rig.frame.centre_px();
    let known: Vec<Pair> = marks
        .iter()
        .map(|mark| {
            let [a, b] = mark.places_px.map(|[x, y]| [u + x, v - y]);
            Pair {
                from_px: a,
                to_px: b,
            }
        })
        .collect();
    let ties = matched_ties(first, second, &known);
    let count = ties.len();
    let mut points = marks;
    points.extend((1..).zip(ties).map(|(number, places)| StereoPoint {
        id: format!("tie {number}"),
        places_px: places.map(|[col, row]| [col - u, v - row]),
        ground_m: None,
    }));
    (points, count)
}

/// Name of a mark, its places in the two images, and its place on the ground, m.
type OpenMark = (String, [Option<[f64; 2]>; 2], [f64; 3]);

/// Reads the marks of both images: those of one image alone are left out.
fn read_marks(rig: &Rig, path: &Path) -> Result<Vec<StereoPoint>, Failure> {
    let table = NamedColumns::read(
        path,
        &["id", "image", "col_px", "row_px", "x_m", "y_m", "z_m"],
    )?;
    let [u, v] = rig.frame.centre_px();
    let mut found: Vec<OpenMark> = Vec::new();
    for row in table.rows() {
        let id: String = row.name("id")?;
        let image: String = row.name("image")?;
        let number = match image.as_str() {
            "1" => 0,
            "2" => 1,
            _ => return Err(row.failure(format!("image = {image}; allowed: 1, 2"))),
        };
        let (col, line) = (row.number("col_px")?, row.number("row_px")?);
        if !(-0.5..=2.0 * u + 0.5).contains(&col) || !(-0.5..=2.0 * v + 0.5).contains(&line) {
            return Err(row.failure(format!(
                "mark {id}: col_px,row_px = {col}, {line} is outside the virtual image; allowed: -0.5 to {}, -0.5 to {}",
                2.0 * u + 0.5,
                2.0 * v + 0.5
            )));
        }
        let ground_m = [row.number("x_m")?, row.number("y_m")?, row.number("z_m")?];
        let known = found.iter().position(|(one, _, _)| *one == id);
        let index = known.unwrap_or(found.len());
        if known.is_none() {
            found.push((id.clone(), [None; 2], ground_m));
        }
        let slot = found
            .get_mut(index)
            .and_then(|(_, places, _)| places.get_mut(number));
        if let Some(slot) = slot
            && slot.replace([col - u, v - line]).is_some()
        {
            return Err(row.failure(format!("mark {id} appears twice in image {image}")));
        }
    }
    let marks = found
        .into_iter()
        .filter_map(|(id, places, ground_m)| match places {
            [Some(first), Some(second)] => Some(StereoPoint {
                id,
                places_px: [first, second],
                ground_m: Some(ground_m),
            }),
            _ => None,
        });
    Ok(marks.collect())
}
