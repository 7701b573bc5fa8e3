//! A list of image coordinates, image by image.

use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};

use fmc_camera_file::{CameraFile, InputError};
use fmc_frames::FrameTable;

use super::answers::{Flag, FrameAnswers};
use super::block::FrameBlock;
use super::csv_header::IdColumn;
use super::list_program::{ListHead, ListProgram};
use crate::failure::Failure;
use crate::formats::output::Stopped;

/// Writer of a list.
///
/// Points come in any order, the list has them image by image: their lines wait in a temporary
/// file. Kept in memory are 16 bytes for each change of the image.
#[derive(Debug)]
pub struct ImageList {
    program: ListProgram,
    ids: IdColumn,
    head: ListHead,
    lines: BufWriter<File>,
    written: u64,
    /// Place of the frame, and where its lines begin.
    runs: Vec<(u32, u64)>,
    /// Names of the images by the numbers of their frames.
    names: HashMap<u32, String>,
    /// Identifiers of the images by the places of their frames.
    images: HashMap<u32, String>,
    /// Images by their identifiers.
    frames: HashMap<String, u32>,
}

impl ImageList {
    /// Creates the list of points whose names stand in a column.
    ///
    /// # Errors
    /// [`Failure`] if there is no place for the temporary file.
    pub fn new(
        program: ListProgram,
        ids: IdColumn,
        camera: &CameraFile,
        table: &FrameTable,
    ) -> Result<Self, Failure> {
        let lines = tempfile::tempfile();
        let lines = lines.map_err(|error| Failure::writing("a temporary file", &error))?;
        Ok(Self {
            program,
            ids,
            head: ListHead::new(&camera.name, camera.principal_distance_mm),
            lines: BufWriter::new(lines),
            written: 0,
            runs: Vec::new(),
            names: table
                .images()
                .map(|(image, sequence)| (sequence, image.to_owned()))
                .collect(),
            images: HashMap::new(),
            frames: HashMap::new(),
        })
    }

    /// Adds the answers to a block; points without an answer are left out. `file` is the name of
    /// the points in messages.
    ///
    /// # Errors
    /// [`InputError`] naming line and identifier, and errors of the temporary file.
    pub fn push(
        &mut self,
        file: &str,
        block: &FrameBlock,
        answers: &FrameAnswers,
        table: &FrameTable,
    ) -> Result<(), Stopped> {
        let all = answers.answers.iter().zip(&answers.flags);
        for (index, ((answer, flag), frame)) in all.zip(&block.frames).enumerate() {
            if *flag != Flag::None {
                continue;
            }
            let refused = |fault: String| {
                InputError::invalid(format!("{}: {fault}", block.place(file, index)))
            };
            let id = self.ids.cell(block, index);
            let id = str::from_utf8(id.trim_ascii());
            let id = id.map_err(|_| refused("the name of the point is not text (UTF-8)".into()))?;
            self.program.check_point(id).map_err(refused)?;
            if self.runs.last().is_none_or(|(last, _)| last != frame) {
                self.name_image(*frame, table).map_err(refused)?;
                self.runs.push((*frame, self.written));
            }
            let mut line = Vec::with_capacity(64);
            self.program.point(id, answer.point_mm, &mut line)?;
            self.lines.write_all(&line)?;
            self.written += line.len() as u64;
        }
        Ok(())
    }

    /// Finds the identifier of an image, which no other may have.
    fn name_image(&mut self, frame: u32, table: &FrameTable) -> Result<(), String> {
        if self.images.contains_key(&frame) {
            return Ok(());
        }
        let sequence = table.rows().get(frame as usize);
        let sequence = sequence.map_or(0, |row| row.sequence);
        let id = self
            .program
            .image_id(sequence, self.names.get(&sequence).map(String::as_str))?;
        if let Some(other) = self.frames.insert(id.clone(), frame) {
            let other = table.rows().get(other as usize);
            return Err(format!(
                "image = \"{id}\" of frame {sequence} is that of frame {}, too",
                other.map_or(0, |row| row.sequence)
            ));
        }
        self.images.insert(frame, id);
        Ok(())
    }

    /// Writes the list, images in the order of their frames.
    ///
    /// # Errors
    /// [`InputError`] for a point that stands twice in an image, and errors of the files.
    pub fn write(self, sink: &mut dyn Write) -> Result<(), Stopped> {
        let mut file = self
            .lines
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        file.flush()?;
        let ends = self.runs.iter().skip(1).map(|(_, start)| *start);
        let ends = ends.chain([self.written]);
        let mut runs: Vec<(u32, u64, u64)> = self
            .runs
            .iter()
            .zip(ends)
            .map(|((frame, start), end)| (*frame, *start, end))
            .collect();
        runs.sort_unstable();
        for image in runs.chunk_by(|(a, ..), (b, ..)| a == b) {
            let frame = image.first().map_or(0, |(frame, ..)| *frame);
            let id = self.images.get(&frame).map_or("", String::as_str);
            self.program.begin(id, &self.head, sink)?;
            let mut points = HashSet::new();
            for (_, start, end) in image {
                file.seek(SeekFrom::Start(*start))?;
                for line in BufReader::new((&file).take(end - start)).lines() {
                    let line = line?;
                    let point = line.split_whitespace().next().unwrap_or_default();
                    if !points.insert(point.to_owned()) {
                        let text = format!("point {point} stands twice in image {id}");
                        return Err(InputError::invalid(text).into());
                    }
                    writeln!(sink, "{line}")?;
                }
            }
            self.program.end(sink)?;
        }
        Ok(())
    }
}
