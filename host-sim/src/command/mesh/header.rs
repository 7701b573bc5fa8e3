//! mesh.json: the description of a mesh's numbers.

use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::pixel_correction::CorrectionMesh;
use fmc_camera_file::CameraFile;
use serde::Serialize;

use super::{Content, Layout, MeshFrame};
use crate::cli::{MeshArgs, MeshFormatName};

/// Accuracy of the files against the camera's model, pixels per axis.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(untagged)]
pub(super) enum Accuracy {
    /// Sources in the number format of a warp engine.
    Quantised {
        /// Largest difference from the camera's number.
        quantisation_px: f32,
    },
    /// Corrections as the camera computes them.
    Rounded {
        /// Upper bound of their rounding.
        rounding_bound_px: f32,
        /// Upper bound of the error of linear interpolation between vertices.
        interpolation_bound_px: f32,
    },
}

impl Accuracy {
    /// Accuracy of a mesh as the camera gave it, with its largest correction.
    pub(super) fn of(layout: &Layout, correction: &FrameCorrection, largest_px: f32) -> Self {
        match layout.content {
            Content::Sources(format) => {
                let [width, height] = layout.size_px;
                let longest_px = width.max(height) + u32::from(layout.spacing_px);
                Self::Quantised {
                    quantisation_px: format.quantisation_px(pixels(longest_px)),
                }
            }
            Content::Corrections => {
                let bound = CorrectionMesh::new(correction, layout.spacing_px);
                Self::Rounded {
                    rounding_bound_px: bound.rounding_bound_px(largest_px),
                    interpolation_bound_px: bound.interpolation_bound_px(),
                }
            }
        }
    }
}

/// Content of mesh.json.
#[derive(Debug, Serialize)]
pub(super) struct Header {
    camera: String,
    /// Number of the frame, if it is one of a flight.
    #[serde(skip_serializing_if = "Option::is_none")]
    sequence: Option<u32>,
    format: &'static str,
    files: Vec<&'static str>,
    layout: &'static str,
    meaning: &'static str,
    /// Rules for drawing the vertices on a graphics processor.
    #[serde(skip_serializing_if = "Option::is_none")]
    drawing: Option<Drawing>,
    /// Vertices along a row.
    columns: u32,
    rows: u32,
    spacing_px: u16,
    /// First column and row of the part of the image.
    origin_px: [u32; 2],
    size_px: [u32; 2],
    /// Pixel of the recorded image from which sources count.
    #[serde(skip_serializing_if = "Option::is_none")]
    source_origin_px: Option<[u32; 2]>,
    #[serde(flatten)]
    accuracy: Accuracy,
    vh_per_s: f32,
    exposure_s: f32,
    direction: &'static str,
    /// The same in the corrected image and in the recorded image.
    principal_point_mm: [f32; 2],
    principal_distance_mm: f32,
}

/// Rules for drawing the vertices, with the recorded image as the texture.
#[derive(Debug, Serialize)]
struct Drawing {
    place: &'static str,
    texture: String,
    target: String,
    position: String,
    orientation: &'static str,
    cells: &'static str,
}

impl Drawing {
    fn of(camera: &CameraFile) -> Self {
        let calibration = camera.parameters().calibration;
        let [width, height] = [calibration.width_px, calibration.height_px];
        Self {
            place: "vertex i of the file, counted from 0, stands at col = origin_px[0] + (i mod columns) spacing_px, row = origin_px[1] + (i div columns) spacing_px; its two numbers are dcol and drow",
            texture: format!(
                "u = (col + 0.5)/{width}, v = (row + 0.5)/{height}: the texture is the whole recorded image with its first row first in memory, one mipmap level, linear filter, clamped to the edge; discard fragments with u or v below 0 or above 1, which lie outside the image"
            ),
            target: format!(
                "the whole corrected image, a viewport of {width} x {height} px; to draw a part of it, subtract its first column and row from col and row in position, and replace {width} and {height} by its width and height"
            ),
            position: format!(
                "x = 2 (col + 0.5)/{width} - 1 + 2 dcol/{width}, y = 2 (row + 0.5)/{height} - 1 + 2 drow/{height}"
            ),
            orientation: "with Vulkan and a viewport of positive height, the first row is at the top and first in memory; with OpenGL it is first when the image is read back, but at the bottom of a window: negate y there",
            cells: "each i below columns (rows - 1), except where i + 1 is a multiple of columns, has a cell with the vertices i, i + 1, i + columns and i + columns + 1; draw it as two triangles, along either diagonal, with depth test and face culling off; the cells begin at the centre of the first pixel, so that the outer half of the first column and row is not drawn",
        }
    }
}

impl Header {
    pub(super) fn new(
        args: &MeshArgs,
        camera: &CameraFile,
        frame: &MeshFrame<'_>,
        layout: &Layout,
        accuracy: Accuracy,
        files: &[&'static str],
    ) -> Self {
        let record = frame.interior;
        let pushes = matches!(layout.content, Content::Corrections);
        Self {
            camera: camera.name.clone(),
            sequence: frame.sequence,
            format: args.format.name(),
            files: files.to_vec(),
            layout: numbers(args.format),
            meaning: meaning(args.format),
            drawing: pushes.then(|| Drawing::of(camera)),
            columns: layout.vertices[0],
            rows: layout.vertices[1],
            spacing_px: layout.spacing_px,
            origin_px: layout.origin_px,
            size_px: layout.size_px,
            source_origin_px: (!pushes).then_some(layout.source_px),
            accuracy,
            vh_per_s: record.vh_per_s,
            exposure_s: record.exposure_s,
            direction: frame.direction.name(),
            principal_point_mm: [record.principal_point.x_mm, record.principal_point.y_mm],
            principal_distance_mm: record.principal_distance_mm,
        }
    }
}

/// Describes the order and type of the numbers in the files.
const fn numbers(format: MeshFormatName) -> &'static str {
    match format {
        MeshFormatName::TiLdc => {
            "row by row, little endian: signed 16 bits for columns, then signed 16 bits for rows, in 1/8 px"
        }
        MeshFormatName::Dw100 => {
            "row by row, little endian: 32 bits for each vertex, the source column in the low half, the source row in the high half, both unsigned in 1/16 px"
        }
        MeshFormatName::Vitis => {
            "row by row, little endian: signed 32 bits for the source column, then signed 32 bits for the source row, in 2^-20 px"
        }
        MeshFormatName::Vpi => {
            "row by row, little endian: single-precision source column, then source row, px"
        }
        MeshFormatName::Opencv => {
            "one file has the source columns, the other the source rows; each is row by row, little endian, single precision, px"
        }
        MeshFormatName::Gpu => {
            "row by row from the top, little endian, 8 bytes a vertex: single-precision columns to the right, then rows downwards, px (VK_FORMAT_R32G32_SFLOAT; two of GL_FLOAT)"
        }
    }
}

/// Describes the meaning of a number.
const fn meaning(format: MeshFormatName) -> &'static str {
    match format {
        MeshFormatName::TiLdc => {
            "source pixel minus output pixel, for the output pixels at the vertices; the centre of the first pixel is (0, 0)"
        }
        MeshFormatName::Gpu => {
            "corrected minus recorded place, for the pixels of the recorded image at the vertices, which are drawn at their corrected places; the centre of the first pixel is (0, 0)"
        }
        MeshFormatName::Dw100
        | MeshFormatName::Vitis
        | MeshFormatName::Vpi
        | MeshFormatName::Opencv => {
            "place in the source image, for the output pixels at the vertices; the centre of the first pixel is (0, 0)"
        }
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "exact: a side has fewer than 2^24 pixels"
)]
fn pixels(count: u32) -> f32 {
    count as f32
}
