//! `mesh`: the mesh for a warp engine or a graphics processor, computed by the camera.

mod files;
mod header;
mod rows;

use std::fs;
use std::path::Path;

use fmc_camera::Camera;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera_file::CameraFile;

use self::header::{Accuracy, Header};
use self::rows::Rows;
use crate::cli::{DirectionName, ImagePart, MeshArgs, MeshFormatName};
use crate::device::{Device, DeviceError};
use crate::failure::{Failure, note};
use crate::formats::output::OutputFolder;

/// Largest spacing of the vertices of TI's LDC, pixels: 2⁷.
const LARGEST_LDC_SPACING_PX: u16 = 128;
/// Spacing of the vertices of the DW100, pixels.
const DW100_SPACING_PX: u16 = fmc_camera::geometry::mesh::format::uq12_4::SPACING_PX;

pub(super) fn run(args: &MeshArgs) -> Result<(), Failure> {
    if args.frames.are_given() {
        return super::frames::meshes::run(args);
    }
    let request = &args.exposure;
    check_spacing(args)?;
    let (camera, grids) = request.read_camera_with_grids()?;
    let layout = Layout::new(args, &camera)?;
    let mut device = args.device.open()?;
    let record = device
        .load_grids(&grids)
        .and_then(|()| device.load(&camera.parameters()))
        .and_then(|()| device.expose(&request.exposure()))
        .map_err(|error| request.refused(&camera, &error))?;
    let frame = Camera::new(camera.parameters())
        .map_err(DeviceError::Calibration)
        .and_then(|checked| {
            checked
                .frame(&request.exposure())
                .map_err(DeviceError::Frame)
        })
        .map_err(|error| request.refused(&camera, &error))?;
    let frame = MeshFrame {
        interior: &record,
        correction: &frame.correction,
        direction: request.direction,
        sequence: None,
    };
    write(args, &camera, &layout, &mut *device, &frame, &args.out)
}

/// A frame whose mesh is written.
pub(super) struct MeshFrame<'a> {
    pub(super) interior: &'a InteriorOrientation,
    pub(super) correction: &'a FrameCorrection,
    pub(super) direction: DirectionName,
    /// Number of the frame, if it is one of a flight.
    pub(super) sequence: Option<u32>,
}

/// Fetches the mesh of the device's frame, and writes it into a folder.
pub(super) fn write(
    args: &MeshArgs,
    camera: &CameraFile,
    layout: &Layout,
    device: &mut dyn Device,
    frame: &MeshFrame<'_>,
    out: &Path,
) -> Result<(), Failure> {
    let refused = |error: DeviceError| match error {
        DeviceError::Mesh(error) => refused(error, args),
        error => args.exposure.refused(camera, &error),
    };
    let mut rows = Rows::new(device, layout);
    // Numbers that the engine cannot take are mostly refused before there is a folder.
    let mut left = rows.advance().map_err(refused)?;
    let is_new = !out.exists();
    let folder = OutputFolder::create(out)?;
    let names = files(args.format);
    let written = files::write(&folder, names, |sinks| {
        let mut largest_px = 0.0_f32;
        while left {
            if let Content::Corrections = layout.content {
                largest_px = largest_px.max(largest(rows.bytes()));
            }
            sinks.write(rows.bytes())?;
            left = rows.advance().map_err(refused)?;
        }
        Ok(largest_px)
    });
    let largest_px = written.inspect_err(|_| {
        if is_new {
            // It goes if nothing is in it.
            let _ = fs::remove_dir(out);
        }
    })?;
    let accuracy = Accuracy::of(layout, frame.correction, largest_px);
    let header = Header::new(args, camera, frame, layout, accuracy, names);
    // The header is written last: if it exists, the mesh is complete.
    folder.write_json("mesh.json", &header)?;
    note(format_args!(
        "{}: {}, mesh.json",
        folder.path().display(),
        names.join(", ")
    ));
    Ok(())
}

/// Returns the largest of numbers in single precision, without their signs.
fn largest(bytes: &[u8]) -> f32 {
    let (numbers, _) = bytes.as_chunks::<4>();
    numbers
        .iter()
        .map(|number| f32::from_le_bytes(*number).abs())
        .fold(0.0, f32::max)
}

/// Checks that the engine supports the spacing.
pub(super) fn check_spacing(args: &MeshArgs) -> Result<(), Failure> {
    let spacing = args.spacing;
    let allowed = match args.format {
        MeshFormatName::Dw100 if spacing != DW100_SPACING_PX => "16 px for dw100",
        MeshFormatName::TiLdc if !spacing.is_power_of_two() || spacing > LARGEST_LDC_SPACING_PX => {
            "1, 2, 4, 8, 16, 32, 64 or 128 px for ti-ldc"
        }
        MeshFormatName::Vpi if !spacing.is_power_of_two() => "a power of two for vpi",
        _ => return Ok(()),
    };
    Err(Failure::bad_input(format!(
        "--spacing {spacing}: must be {allowed}"
    )))
}

/// Meaning of a vertex's numbers.
#[derive(Debug, Clone, Copy)]
enum Content {
    /// Source of an output pixel.
    Sources(MeshFormat),
    /// Displacement of a recorded pixel.
    Corrections,
}

/// Places of the vertices.
#[derive(Debug)]
pub(super) struct Layout {
    content: Content,
    spacing_px: u16,
    origin_px: [u32; 2],
    size_px: [u32; 2],
    source_px: [u32; 2],
    /// Vertices along a row, and number of rows.
    vertices: [u32; 2],
}

impl Layout {
    pub(super) fn new(args: &MeshArgs, camera: &CameraFile) -> Result<Self, Failure> {
        let calibration = camera.parameters().calibration;
        let image = [calibration.width_px, calibration.height_px];
        let ImagePart { origin_px, size_px } = args.part.unwrap_or(ImagePart {
            origin_px: [0, 0],
            size_px: image,
        });
        let ([col, row], [width, height]) = (origin_px, size_px);
        let fits = |first: u32, length: u32, side: u32| {
            length > 0 && first.checked_add(length).is_some_and(|end| end <= side)
        };
        if !fits(col, width, image[0]) || !fits(row, height, image[1]) {
            return Err(Failure::bad_input(format!(
                "--part {col},{row},{width},{height}: must be a part of the image of {} x {} px ({})",
                image[0],
                image[1],
                args.exposure.camera.display()
            )));
        }
        let spacing = u32::from(args.spacing);
        let vertices = [width, height].map(|side| match args.format {
            // A map has its last vertex at the last pixel or beyond it.
            MeshFormatName::Opencv | MeshFormatName::Vitis => (side - 1).div_ceil(spacing) + 1,
            // A mesh of cells has its last vertex at the end of the last cell.
            _ => side.div_ceil(spacing) + 1,
        });
        let source_px = args.source.unwrap_or(origin_px);
        if args.source.is_some()
            && matches!(args.format, MeshFormatName::TiLdc | MeshFormatName::Gpu)
        {
            return Err(Failure::bad_input(format!(
                "--source: must be left out for {}, whose displacements do not depend on it",
                args.format.name()
            )));
        }
        if source_px[0] >= image[0] || source_px[1] >= image[1] {
            return Err(Failure::bad_input(format!(
                "--source {},{}: must be a pixel of the image of {} x {} px ({})",
                source_px[0],
                source_px[1],
                image[0],
                image[1],
                args.exposure.camera.display()
            )));
        }
        Ok(Self {
            content: match args.format {
                MeshFormatName::TiLdc => Content::Sources(MeshFormat::S16Q3),
                MeshFormatName::Dw100 => Content::Sources(MeshFormat::Uq12Q4),
                MeshFormatName::Vitis => Content::Sources(MeshFormat::Q12Q20),
                MeshFormatName::Vpi | MeshFormatName::Opencv => {
                    Content::Sources(MeshFormat::Single)
                }
                MeshFormatName::Gpu => Content::Corrections,
            },
            spacing_px: args.spacing,
            origin_px,
            size_px,
            source_px,
            vertices,
        })
    }

    /// Returns the requests of one row of vertices, each of at most `most`.
    fn requests(&self, row: u32, most: u16) -> impl Iterator<Item = VertexRow> {
        let spacing = u32::from(self.spacing_px);
        let [columns, _] = self.vertices;
        (0..columns)
            .step_by(usize::from(most))
            .map(move |first| VertexRow {
                first_col_px: self.origin_px[0] + first * spacing,
                row_px: self.origin_px[1] + row * spacing,
                spacing_px: self.spacing_px,
                count: u16::try_from(columns - first).map_or(most, |left| left.min(most)),
                origin_px: self.source_px,
            })
    }
}

/// Turns a refusal by the camera into a failure: the input is at fault.
fn refused(error: MeshError, args: &MeshArgs) -> Failure {
    let text = format!("--format {}: {error}", args.format.name());
    let failure = Failure::bad_input(text);
    match error {
        MeshError::Format(_) => {
            failure.with_help("a smaller --part, another --source, or another --format")
        }
        MeshError::OffImage { .. } | MeshError::Distort { .. } | MeshError::Spacing { .. } => {
            failure
        }
    }
}

/// Returns the names of the mesh's files.
const fn files(format: MeshFormatName) -> &'static [&'static str] {
    match format {
        MeshFormatName::Opencv => &["map-x.bin", "map-y.bin"],
        _ => &["mesh.bin"],
    }
}
