//! A stream of points from a file through a model into a file, in memory that does not grow with
//! their number.

use std::io::{self, IsTerminal as _};
use std::path::Path;
use std::sync::Arc;

use fmc_camera_file::CameraFile;
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::PointFiles;
use crate::failure::Failure;
use crate::formats::output::{self, Stopped};
use crate::formats::points::{Answers, Block, BlockAnswers, Blocks, Checked, PointFormat, Source};

/// Points that are being read.
pub(super) struct PointStream<'a> {
    files: &'a PointFiles,
    camera: &'a CameraFile,
    source: Arc<Source>,
    blocks: Blocks,
    first: Option<Block>,
    format: PointFormat,
}

impl<'a> PointStream<'a> {
    /// Opens the points and reads the first of them, so that an error there is reported before a
    /// device is asked.
    pub(super) fn open(
        files: &'a PointFiles,
        camera: &'a CameraFile,
        checked: Checked,
    ) -> Result<Self, Failure> {
        let format = |path: Option<&Path>, otherwise| {
            path.and_then(PointFormat::of)
                .or(files.format)
                .unwrap_or(otherwise)
        };
        let points_format = format(Some(&files.points), PointFormat::Csv);
        let answer_format = format(files.out.as_deref(), points_format);
        let (source, mut blocks) = Source::open(&files.points, points_format, camera, checked)?;
        Answers::new(&source, camera, answer_format)?;
        let first = blocks.next_block()?;
        Ok(Self {
            files,
            camera,
            source,
            blocks,
            first,
            format: answer_format,
        })
    }

    /// Writes the answers that `answer` appends for every block. Rows of an array in single
    /// precision are as they were read, if the answers are an array, too.
    pub(super) fn answer(
        mut self,
        mut answer: impl FnMut(&Source, &mut Block, &mut BlockAnswers) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let source = self.source;
        let mut writer = Answers::new(&source, self.camera, self.format)?;
        let bar = progress(source.bytes, self.files.out.is_some());
        let written = output::stream(self.files.out.as_deref(), |sink| {
            let Some(mut block) = self.first else {
                return Ok(writer.begin(sink)?);
            };
            let mut answers = BlockAnswers::default();
            let mut begun = false;
            loop {
                answers.numbers.clear();
                answers.rows.clear();
                if self.format != PointFormat::Npy {
                    block.widen();
                }
                answer(&source, &mut block, &mut answers)?;
                // If the first block is refused, nothing is written.
                if !begun {
                    writer.begin(sink)?;
                    begun = true;
                }
                writer.write(&block, &answers, sink)?;
                bar.set_position(block.read_bytes);
                self.blocks.reuse(block);
                match self.blocks.next_block()? {
                    Some(next) => block = next,
                    None => return Ok::<(), Stopped>(()),
                }
            }
        });
        bar.finish_and_clear();
        written
    }
}

/// Returns a bar of the bytes read; hidden where a terminal shows the answers.
pub(super) fn progress(bytes: Option<u64>, into_file: bool) -> ProgressBar {
    if !into_file && io::stdout().is_terminal() {
        return ProgressBar::hidden();
    }
    let (bar, template) = match bytes {
        Some(bytes) => (
            ProgressBar::new(bytes),
            "{wide_bar} {bytes}/{total_bytes}, {bytes_per_sec}, {eta}",
        ),
        None => (
            ProgressBar::new_spinner(),
            "{spinner} {bytes}, {bytes_per_sec}",
        ),
    };
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
