//! Arguments of meshes for warp engines and graphics processors.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::frames::{FRAMES, optional_group, optional_with_frames};
use super::{ADVANCED, DeviceArgs, ExposureArgs, FramesArgs};

/// Arguments of `mesh`.
#[derive(Debug, Args)]
#[command(
    mut_arg("exposure", optional_with_frames),
    mut_group("vh_or_speed", optional_group)
)]
pub struct MeshArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Reader of the mesh.
    #[arg(long, value_name = "FORMAT")]
    pub format: MeshFormatName,
    /// Pixels from one vertex to the next, both ways; 1 has a vertex at every pixel. 1 to 1024;
    /// dw100 has 16, ti-ldc and vpi a power of two, for ti-ldc of at most 128.
    #[arg(long, value_name = "PX", default_value = "16", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = ADVANCED)]
    pub spacing: u16,
    /// Part of the corrected image that the engine makes, for gpu the part of the recorded image
    /// that is drawn: first column, first row, width and height, pixels. Without it the whole
    /// image.
    #[arg(
        long,
        value_name = "COL,ROW,WIDTH,HEIGHT",
        value_parser = image_part,
        help_heading = ADVANCED
    )]
    pub part: Option<ImagePart>,
    /// First column and row of the part of the recorded image that the engine is given; sources
    /// count from there. Without it that of --part. Not for ti-ldc and gpu, whose numbers do not
    /// depend on it.
    #[arg(long, value_name = "COL,ROW", value_parser = image_pixel, help_heading = ADVANCED)]
    pub source: Option<[u32; 2]>,
    /// Folder for mesh.json and the mesh, mesh.bin or map-x.bin and map-y.bin; made if it does not
    /// exist.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The frames of a flight in place of one exposure.
    #[command(flatten)]
    pub frames: FramesArgs,
    /// Frame whose mesh is written, of those of --records or --frames; without it that of every
    /// frame is, each in a folder of DIR with its number as name.
    #[arg(long, value_name = "N", requires = "frame_source", help_heading = FRAMES)]
    pub sequence: Option<u32>,
    /// Device on which the camera runs.
    #[command(flatten, next_help_heading = ADVANCED)]
    pub device: DeviceArgs,
}

/// Part of an image, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImagePart {
    /// Column and row of its first pixel.
    pub origin_px: [u32; 2],
    /// Width and height.
    pub size_px: [u32; 2],
}

fn image_pixel(text: &str) -> Result<[u32; 2], String> {
    let numbers: Result<Vec<u32>, _> = text
        .split(',')
        .map(|number| number.trim().parse())
        .collect();
    match numbers.as_deref() {
        Ok([col, row]) => Ok([*col, *row]),
        _ => Err("two whole numbers with a comma between them: column, row".to_owned()),
    }
}

fn image_part(text: &str) -> Result<ImagePart, String> {
    let numbers: Result<Vec<u32>, _> = text
        .split(',')
        .map(|number| number.trim().parse())
        .collect();
    match numbers.as_deref() {
        Ok([col, row, width, height]) => Ok(ImagePart {
            origin_px: [*col, *row],
            size_px: [*width, *height],
        }),
        _ => Err(
            "four whole numbers with commas between them: first column, first row, width, height"
                .to_owned(),
        ),
    }
}

/// Readers of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MeshFormatName {
    /// Lens distortion correction (LDC) of TI's TDA and AM6 processors: displacements in 1/8 px,
    /// S16Q3, at most 4096 px.
    TiLdc,
    /// Dewarp engine DW100 of NXP's i.MX 8M Plus: sources in 1/16 px, UQ12.4, from 0 to below 4096
    /// px.
    Dw100,
    /// Q12.20, the type `ap_fixed<32, 12>` of Vitis Vision: sources in 2^-20 px, below 2048 px. The
    /// `remap` of Vitis Vision itself reads what `opencv` writes.
    Vitis,
    /// Control points of NVIDIA VPI: sources in single precision, x and y interleaved.
    Vpi,
    /// Maps for `cv::remap`: sources in single precision, x and y in separate files.
    Opencv,
    /// Vertices for OpenGL and Vulkan, which draw the recorded image: for each vertex the
    /// displacement to its place in the corrected image, columns and rows, in single precision.
    Gpu,
}

impl MeshFormatName {
    /// Returns the name that the command line uses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TiLdc => "ti-ldc",
            Self::Dw100 => "dw100",
            Self::Vitis => "vitis",
            Self::Vpi => "vpi",
            Self::Opencv => "opencv",
            Self::Gpu => "gpu",
        }
    }
}
