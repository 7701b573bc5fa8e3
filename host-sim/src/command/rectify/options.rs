//! Options on which the bytes of a rectified frame depend.

use serde::{Deserialize, Serialize};

use crate::cli::{CompressionName, RectifyArgs, WindowArgument};

/// The options as the description of a rectified frame has them, by their names on the command
/// line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Options {
    pub(super) centre: String,
    pub(super) window: String,
    pub(super) resample: String,
    pub(super) mask: bool,
    pub(super) compression: Option<String>,
    pub(super) tile: Option<u32>,
    pub(super) strip: Option<u32>,
    pub(super) bigtiff: bool,
}

impl Options {
    pub(super) fn of(args: &RectifyArgs) -> Self {
        let (image, file) = (&args.image, &args.file);
        Self {
            centre: image.centre.name().to_owned(),
            window: match image.window {
                WindowArgument::Same => "same".to_owned(),
                WindowArgument::Inside => "inside".to_owned(),
                WindowArgument::Full => "full".to_owned(),
                WindowArgument::Size([width, height]) => format!("{width}x{height}"),
            },
            resample: image.resample.name().to_owned(),
            mask: image.mask,
            compression: file
                .compression
                .map(CompressionName::name)
                .map(str::to_owned),
            tile: file.tile,
            strip: file.strip,
            bigtiff: file.bigtiff,
        }
    }

    /// Returns the first option that differs from that of an earlier run: its name, its value now,
    /// and its value then.
    pub(super) fn difference(&self, earlier: &Self) -> Option<(&'static str, String, String)> {
        let given = |value: &Option<u32>| value.map_or("not given".to_owned(), |it| it.to_string());
        let flag = |value: bool| if value { "given" } else { "not given" }.to_owned();
        let compression = |options: &Self| {
            let compression = options.compression.clone();
            compression.unwrap_or_else(|| "not given".to_owned())
        };
        let both = |of: &dyn Fn(&Self) -> String| [of(self), of(earlier)];
        let pairs = [
            ("--centre", both(&|options| options.centre.clone())),
            ("--window", both(&|options| options.window.clone())),
            ("--resample", both(&|options| options.resample.clone())),
            ("--mask", both(&|options| flag(options.mask))),
            ("--compression", both(&compression)),
            ("--tile", both(&|options| given(&options.tile))),
            ("--strip", both(&|options| given(&options.strip))),
            ("--bigtiff", both(&|options| flag(options.bigtiff))),
        ];
        pairs
            .into_iter()
            .find(|(_, [now, then])| now != then)
            .map(|(name, [now, then])| (name, now, then))
    }
}
