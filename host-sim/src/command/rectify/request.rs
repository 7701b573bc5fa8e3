//! The options, as the libraries take them.

use fmc_raster::{Chunks, Compression, PlanOptions};
use fmc_rectification::{Centre, Request, Window};

use crate::cli::{CentreName, CompressionName, RectifyArgs, WindowArgument};

pub(super) fn request(args: &RectifyArgs) -> Request {
    Request {
        window: match args.image.window {
            WindowArgument::Same => Window::Same,
            WindowArgument::Inside => Window::Inside,
            WindowArgument::Full => Window::Full,
            WindowArgument::Size(size_px) => Window::Size(size_px),
        },
        centre: match args.image.centre {
            CentreName::PrincipalPoint => Centre::PrincipalPoint,
            CentreName::Frame => Centre::Frame,
        },
        resampling: args.image.resample.kernel(),
    }
}

pub(super) fn layout(args: &RectifyArgs) -> PlanOptions {
    let compression = args.file.compression.map(|name| match name {
        CompressionName::None => Compression::None,
        CompressionName::Lzw => Compression::Lzw,
        CompressionName::Deflate => Compression::Deflate,
        CompressionName::Zstd => Compression::Zstd,
    });
    let tiles = args.file.tile.map(|side| Chunks::Tiles {
        width_px: side,
        height_px: side,
    });
    let strips = args.file.strip.map(|rows| Chunks::Strips { rows });
    PlanOptions {
        compression,
        chunks: tiles.or(strips),
        big: args.file.bigtiff,
    }
}
