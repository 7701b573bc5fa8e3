//! `mesh`: the mesh for a warp engine or a graphics processor, computed by the camera.

mod header;

use std::path::Path;

use fmc_camera::Camera;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::io::link::MAX_POINTS;
use fmc_camera_file::CameraFile;
use indicatif::{ProgressBar, ProgressStyle};

use self::header::{Accuracy, Header};
use crate::cli::{DirectionName, ImagePart, MeshArgs, MeshFormatName};
use crate::device::{Device, DeviceError};
use crate::failure::{Failure, note};
use crate::formats::output::OutputFolder;

/// Largest number of vertices of a mesh: half a gigabyte of the longest words.
const MAX_VERTICES: u64 = 1 << 26;

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
    let camera = request.read_camera()?;
    let layout = Layout::new(args, &camera)?;
    let mut device = args.device.open()?;
    let record = device
        .load(&camera.parameters())
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
    let mesh = fetch(device, layout).map_err(|error| match error {
        DeviceError::Mesh(error) => refused(error, args),
        error => args.exposure.refused(camera, &error),
    })?;
    let accuracy = Accuracy::of(layout, frame.correction, &mesh);
    let files = files(args.format, mesh);
    let header = Header::new(args, camera, frame, layout, accuracy, &files);
    let folder = OutputFolder::create(out)?;
    for (name, bytes) in &files {
        folder.write(name, |sink| sink.write_all(bytes))?;
    }
    // The header is written last: if it exists, the mesh is complete.
    folder.write_json("mesh.json", &header)?;
    let names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    note(format_args!(
        "{}: {}, mesh.json",
        folder.path().display(),
        names.join(", ")
    ));
    Ok(())
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
        let count = u64::from(vertices[0]) * u64::from(vertices[1]);
        if count > MAX_VERTICES {
            return Err(Failure::bad_input(format!(
                "--spacing {spacing}: {} x {} vertices are more than {MAX_VERTICES}",
                vertices[0], vertices[1]
            ))
            .with_help("a larger --spacing, or the image part by part with --part"));
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

    /// Returns the requests of one row of vertices, each as long as the link can carry.
    fn requests(&self, row: u32) -> impl Iterator<Item = VertexRow> {
        let spacing = u32::from(self.spacing_px);
        let [columns, _] = self.vertices;
        (0..columns)
            .step_by(MAX_POINTS)
            .map(move |first| VertexRow {
                first_col_px: self.origin_px[0] + first * spacing,
                row_px: self.origin_px[1] + row * spacing,
                spacing_px: self.spacing_px,
                count: u16::try_from(MAX_POINTS).map_or(u16::MAX, |most| {
                    u16::try_from(columns - first).map_or(most, |left| left.min(most))
                }),
                origin_px: self.source_px,
            })
    }
}

/// Fetches all rows from the camera.
fn fetch(device: &mut dyn Device, layout: &Layout) -> Result<Vec<u8>, DeviceError> {
    let bar = ProgressBar::new(u64::from(layout.vertices[1]));
    if let Ok(style) = ProgressStyle::with_template("mesh {wide_bar} {pos}/{len} rows, {eta}") {
        bar.set_style(style);
    }
    let mut mesh = Vec::new();
    for row in 0..layout.vertices[1] {
        for request in layout.requests(row) {
            match layout.content {
                Content::Sources(format) => mesh.extend(device.mesh(&request, format)?),
                Content::Corrections => {
                    mesh.extend(device.corrections(&request)?.iter().flat_map(stored));
                }
            }
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(mesh)
}

/// Bytes of a correction as graphics processors read it.
fn stored(correction: &PixelCorrection) -> impl Iterator<Item = u8> + use<> {
    [correction.cols_px, correction.rows_px]
        .into_iter()
        .flat_map(f32::to_le_bytes)
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

/// Returns the mesh as files: names and contents.
fn files(format: MeshFormatName, mesh: Vec<u8>) -> Vec<(&'static str, Vec<u8>)> {
    if format != MeshFormatName::Opencv {
        return vec![("mesh.bin", mesh)];
    }
    let (pairs, _) = mesh.as_chunks::<8>();
    let columns = pairs
        .iter()
        .flat_map(|[x0, x1, x2, x3, ..]| [*x0, *x1, *x2, *x3]);
    let rows = pairs
        .iter()
        .flat_map(|[.., y0, y1, y2, y3]| [*y0, *y1, *y2, *y3]);
    vec![
        ("map-x.bin", columns.collect()),
        ("map-y.bin", rows.collect()),
    ]
}
