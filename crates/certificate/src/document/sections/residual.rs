//! Residual grids.

use crate::content::Certificate;
use crate::document::block::{Block, Figure, Section, Table, numbers, words};
use crate::document::wording::{cell, with_unit};
use crate::figure::Drawing;

/// Residual grids of the camera; `None` without any.
pub(super) fn grids(certificate: &Certificate) -> Option<Section> {
    let residual = &certificate.residual_grids;
    if residual.grids.is_empty() {
        return None;
    }
    let rows = residual.grids.iter().map(|grid| {
        let [columns, rows] = grid.nodes;
        vec![
            grid.part.to_owned(),
            grid.file.clone(),
            grid.crc32.clone(),
            format!("{columns} x {rows}"),
            cell(grid.pitch_mm.as_ref()),
            cell(grid.largest_um.as_ref()),
            cell(grid.slope_um_per_mm.as_ref()),
        ]
    });
    let hashes = residual
        .grids
        .iter()
        .map(|grid| [format!("SHA-256 of {}", grid.file), grid.sha256.clone()]);
    Some(Section {
        title: "Residual grids".to_owned(),
        blocks: vec![
            Block::Text(format!(
                "What the polynomial leaves of the distortion is stated as uniform cubic \
                 B-splines, which the camera adds to the polynomial: that of the lens moves with \
                 the principal point, that of the sensor does not. With the stage at its \
                 calibrated position they add at most {} over the sensor. Profiles and tables at field angles and radii are \
                 those of the polynomial; the largest distortion, the motion, the comparison with \
                 the strict solver and the residual in other programs include the grids.",
                with_unit(residual.largest_um.as_ref(), "µm"),
            )),
            Block::Table(Table {
                title: "Files, which belong to the camera file".to_owned(),
                columns: vec![
                    words("part"),
                    words("file"),
                    words("CRC-32"),
                    words("nodes"),
                    numbers("pitch\nmm"),
                    numbers("largest\nµm"),
                    numbers("slope, at most\nµm/mm"),
                ],
                rows: rows.collect(),
            }),
            Block::Pairs(hashes.collect()),
            Block::Figures(vec![Figure {
                drawing: Drawing::residual(certificate),
                caption:
                    "What the residual grids add to the distortion of the polynomial, measured \
                          minus ideal, the stage at its calibrated position."
                        .to_owned(),
            }]),
        ],
    })
}
