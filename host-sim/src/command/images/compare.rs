//! `compare`: what is different in two images, in grey values and in places.

use std::io::Write;

use fmc_rectification::comparison::BlockShift;
use fmc_report::figure::FigureError;
use fmc_report::images::shift_field::{self, Shift};
use fmc_report::terminal;
use serde::Serialize;

use super::image_difference::{self, ImageDifference};
use crate::cli::CompareArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Columns of the names in the answer.
const NAMES: u16 = 25;

/// One pixel in so many may have content in one of the images alone where limits are given: the rim
/// of the border.
const ONE_SIDED_PART: u64 = 100;

pub(in crate::command) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let found = image_difference::of(&args.first, &args.second, args.edge.into())?;
    let summary = Summary::of(args, &found);
    if let Some(out) = &args.out {
        write_report(&OutputFolder::create(out)?, args, &found, &summary)?;
    }
    output::write(None, |sink| summary.print(sink))?;
    summary.judge(args)
}

/// Keys of summary.json.
#[derive(Debug, Serialize)]
struct Summary {
    first: String,
    second: String,
    width_px: u32,
    height_px: u32,
    grey_values: u64,
    grey_mean: Option<f64>,
    grey_rms: Option<f64>,
    grey_largest: Option<f64>,
    one_sided_pixels: u64,
    blocks: u64,
    blocks_without_texture: u64,
    shift_rms_px: Option<f64>,
    shift_largest_px: Option<f64>,
}

impl Summary {
    fn of(args: &CompareArgs, found: &ImageDifference) -> Self {
        let [width_px, height_px] = found.size_px;
        let (grey, shifts) = (&found.grey, &found.shifts);
        Self {
            first: args.first.display().to_string(),
            second: args.second.display().to_string(),
            width_px,
            height_px,
            grey_values: grey.count,
            grey_mean: grey.mean(),
            grey_rms: grey.rms(),
            grey_largest: (grey.count > 0).then_some(grey.largest),
            one_sided_pixels: found.one_sided,
            blocks: shifts.found,
            blocks_without_texture: shifts.not_found,
            shift_rms_px: shifts.rms_px(),
            shift_largest_px: (shifts.found > 0).then_some(shifts.largest_px),
        }
    }

    fn print(&self, sink: &mut dyn Write) -> std::io::Result<()> {
        let number = |value: Option<f64>, digits: usize, unit: &str| {
            value.map_or("nothing to compare".to_owned(), |value| {
                format!("{value:.digits$} {unit}")
            })
        };
        let pairs = [
            ("size", format!("{} x {} px", self.width_px, self.height_px)),
            ("grey values", self.grey_values.to_string()),
            ("grey, mean", number(self.grey_mean, 4, "counts")),
            ("grey, RMS", number(self.grey_rms, 3, "counts")),
            ("grey, largest", number(self.grey_largest, 0, "counts")),
            (
                "content in one alone",
                format!("{} px", self.one_sided_pixels),
            ),
            (
                "blocks of 64 px",
                format!(
                    "{}, and {} without texture or content",
                    self.blocks, self.blocks_without_texture
                ),
            ),
            ("shift, RMS", number(self.shift_rms_px, 5, "px")),
            ("shift, longest", number(self.shift_largest_px, 5, "px")),
        ];
        writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
    }

    /// Checks what was found against the limits that were given.
    fn judge(&self, args: &CompareArgs) -> Result<(), Failure> {
        let pixels = u64::from(self.width_px) * u64::from(self.height_px);
        if (args.max_px.is_some() || args.max_grey.is_some())
            && self.one_sided_pixels > pixels / ONE_SIDED_PART
        {
            return Err(Failure::check(format!(
                "{}: {} of {pixels} pixels have content in it or in {} alone; allowed with --max-px and --max-grey: {}",
                self.second,
                self.one_sided_pixels,
                self.first,
                pixels / ONE_SIDED_PART
            )));
        }
        for (what, option, limit, found, unit) in [
            (
                "longest shift",
                "--max-px",
                args.max_px,
                self.shift_largest_px,
                "px",
            ),
            (
                "largest difference",
                "--max-grey",
                args.max_grey,
                self.grey_largest,
                "counts",
            ),
        ] {
            match (limit, found) {
                (Some(limit), Some(found)) if found > limit => {
                    return Err(Failure::check(format!(
                        "{}: its {what} against {} is {found:.5} {unit}; allowed: {limit} {unit} ({option})",
                        self.second, self.first
                    )));
                }
                (Some(_), None) => {
                    return Err(Failure::check(format!(
                        "{option}: there was nothing to compare"
                    )));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

fn write_report(
    folder: &OutputFolder,
    args: &CompareArgs,
    found: &ImageDifference,
    summary: &Summary,
) -> Result<(), Failure> {
    folder.write("shifts.csv", |sink| write_shifts(&found.blocks, sink))?;
    let titles = [
        "Shift of the content, by blocks of 64 px".to_owned(),
        format!("{} less {}", args.second.display(), args.first.display()),
    ];
    let shifts: Vec<Shift> = found.blocks.iter().map(drawn).collect();
    match shift_field::svg(&titles, found.size_px, &shifts) {
        Ok(svg) => folder.write("shifts.svg", |sink| sink.write_all(svg.as_bytes()))?,
        Err(FigureError::NothingToDraw) => note("note: no block has texture; no figure"),
        Err(error) => return Err(Failure::device_or_io(format!("shifts.svg: {error}"))),
    }
    folder.write_json("summary.json", summary)
}

fn drawn(block: &BlockShift) -> Shift {
    Shift {
        first_px: block
            .first_px
            .map(|place| u32::try_from(place).unwrap_or(u32::MAX)),
        length_px: block.shift_px.map(|[dcol, drow]| dcol.hypot(drow)),
    }
}

fn write_shifts(blocks: &[BlockShift], sink: &mut dyn Write) -> std::io::Result<()> {
    let mut table = csv::Writer::from_writer(sink);
    table.write_record(["col_px", "row_px", "dcol_px", "drow_px"])?;
    for block in blocks {
        let [col, row] = block.first_px.map(|place| place.to_string());
        let shift = |axis: usize| {
            let shift = block.shift_px.and_then(|shift| shift.get(axis).copied());
            shift.map_or(String::new(), |shift| format!("{shift:.6}"))
        };
        table.write_record([col, row, shift(0), shift(1)])?;
    }
    table.flush()
}
