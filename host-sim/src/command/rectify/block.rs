//! The frames of a block, one after the other.

use std::fs;
use std::time::{Duration, Instant};

use fmc_camera_file::CameraFile;
use fmc_frames::FrameCamera;

use super::exposure::Exposures;
use super::frame::{FrameRectifier, Rectified};
use super::manifest::{self, Manifest, Row};
use super::notes::Notes;
use super::progress::Progress;
use super::recorded_frame;
use super::rectified_camera;
use super::sidecar::Sidecar;
use super::task::FrameTask;
use crate::cli::{CentreName, RectifyArgs};
use crate::failure::{Failure, note};
use crate::formats::output::OutputFolder;

/// Rectifies the frames that are asked for.
///
/// # Errors
/// [`Failure`] of the options, of the camera, of the records, and of a frame: the first one, or
/// with `--keep-going` the worst.
pub(in crate::command) fn run(args: &RectifyArgs) -> Result<(), Failure> {
    let (file, grids) = args.exposure.read_camera_with_grids()?;
    let name = args.exposure.camera.display().to_string();
    let camera = FrameCamera::with_grids(&name, &file, grids)?;
    let tasks = FrameTask::all(args)?;
    let rectifier = FrameRectifier::new(args, &file, camera.crc())?;
    let exposures = Exposures::read(args, &file, &camera)?;
    // Of all frames of a table, whether they are chosen or not: all have one camera.
    let size_px = rectifier.block_size(&tasks, &exposures)?;
    let tasks = FrameTask::chosen(tasks, args)?;
    let is_new = !args.out.exists();
    let block = Block {
        args,
        file: &file,
        folder: OutputFolder::create(&args.out)?,
        rectifier,
        exposures,
        size_px,
    };
    let tasks = FrameTask::of_shard(tasks, args.block.shard);
    let done = block.rectify(tasks);
    if is_new && done.is_err() {
        // It goes if nothing is in it.
        let _ = fs::remove_dir(&args.out);
    }
    done
}

/// Frames, and what they have in common.
struct Block<'a> {
    args: &'a RectifyArgs,
    file: &'a CameraFile,
    folder: OutputFolder,
    rectifier: FrameRectifier<'a>,
    exposures: Exposures<'a>,
    /// Width and height of every rectified image.
    size_px: [u32; 2],
}

impl Block<'_> {
    fn rectify(&self, tasks: Vec<FrameTask>) -> Result<(), Failure> {
        let options = &self.args.block;
        let all = tasks.len();
        if options.resume {
            self.check_camera()?;
        }
        let is_new = !self
            .folder
            .path()
            .join(manifest::name(options.shard))
            .exists();
        let manifest = Manifest::open(self.folder.path(), options.shard)?;
        let tasks = if options.resume {
            self.left(tasks, &manifest)?
        } else {
            tasks
        };
        let finished = all - tasks.len();
        if finished > 0 {
            self.write_camera()?;
        }
        let done = self.rectify_all(&tasks, &manifest);
        let compacted = if done.is_err() && is_new && !self.is_part_of_a_block() {
            manifest.remove_without_frames()
        } else {
            manifest.keep_last_rows()
        };
        let failures = done?;
        compacted?;
        self.folder.sync()?;
        let failed = failures.count;
        note(format_args!(
            "{}: frames: {} rectified, {finished} finished before, {failed} failed",
            self.folder.path().display(),
            tasks.len() - failed,
        ));
        match failures.worst {
            None => Ok(()),
            Some(worst) => Err(worst.with_help(format!(
                "{failed} of {all} frames failed; the manifest has the reason of each"
            ))),
        }
    }

    /// Returns true if another run goes on with the folder, and needs the exit codes.
    fn is_part_of_a_block(&self) -> bool {
        let options = &self.args.block;
        options.keep_going || options.resume || options.shard.is_some()
    }

    fn rectify_all(&self, tasks: &[FrameTask], manifest: &Manifest) -> Result<Failures, Failure> {
        let mut progress = Progress::new(tasks.iter().map(|task| task.path.as_path()));
        let mut notes = Notes::default();
        let mut failures = Failures::default();
        for task in tasks {
            progress.begin();
            let start = Instant::now();
            let done = self.rectify_frame(task, &progress);
            progress.end();
            let appended = manifest.append(&row(task, &done, start.elapsed()));
            match done {
                Ok(rectified) => progress.aside(|| notes.tell(task, &rectified)),
                Err(failure) if self.args.block.keep_going => {
                    progress.aside(|| note(format_args!("{}", failure.text())));
                    failures.add(failure);
                }
                Err(failure) => return Err(failure),
            }
            appended?;
        }
        Ok(failures)
    }

    fn rectify_frame(&self, task: &FrameTask, progress: &Progress) -> Result<Rectified, Failure> {
        let exposure = self.exposures.of(task, self.file)?;
        let rectified =
            self.rectifier
                .rectify(task, &exposure, self.size_px, &self.folder, progress)?;
        self.write_camera()?;
        Ok(rectified)
    }

    /// Writes the camera of all frames, if they have one; it stands there as soon as a frame does.
    fn write_camera(&self) -> Result<(), Failure> {
        if self.args.image.centre == CentreName::Frame {
            return Ok(());
        }
        let text = rectified_camera::text(self.file, self.size_px)?;
        self.folder.write(rectified_camera::NAME, |sink| {
            std::io::Write::write_all(sink, text.as_bytes())
        })
    }

    /// Refuses to go on in a folder whose frames have another camera.
    fn check_camera(&self) -> Result<(), Failure> {
        let path = self.folder.path().join(rectified_camera::NAME);
        let Ok(found) = fs::read_to_string(&path) else {
            return Ok(());
        };
        let [width_px, height_px] = self.size_px;
        if self.args.image.centre == CentreName::PrincipalPoint
            && found == rectified_camera::text(self.file, self.size_px)?
        {
            return Ok(());
        }
        Err(Failure::bad_input(format!(
            "--resume: {} is another camera than that of {width_px} x {height_px} px which these options make",
            path.display()
        ))
        .with_help("the options and the camera file of the earlier run; or another folder"))
    }

    /// Returns the frames that no earlier run has finished. A finished one without a row, whose
    /// program was killed before it wrote one, gets it.
    fn left(&self, tasks: Vec<FrameTask>, manifest: &Manifest) -> Result<Vec<FrameTask>, Failure> {
        let present = manifest.done()?;
        let mut left = Vec::new();
        for task in tasks {
            let path = self.folder.path().join(task.sidecar_name());
            match Sidecar::read(&path) {
                Some(sidecar) if self.is_finished(&task, &sidecar)? => {
                    if !present.contains(&task.stem) {
                        manifest.append(&done_row(&task, &sidecar, None))?;
                    }
                }
                _ => left.push(task),
            }
        }
        Ok(left)
    }

    fn is_finished(&self, task: &FrameTask, sidecar: &Sidecar) -> Result<bool, Failure> {
        let path = self.folder.path().join(task.sidecar_name());
        let options = &self.rectifier.options;
        if let Some((option, now, then)) = options.difference(&sidecar.options) {
            return Err(Failure::bad_input(format!(
                "--resume: {option} is {now}, but {} was written with {option} {then}",
                path.display()
            ))
            .with_help("the options of the earlier run; or, without --resume, all frames anew"));
        }
        let output = &sidecar.output;
        let image = fs::metadata(self.folder.path().join(&output.file));
        Ok(image.is_ok_and(|image| image.len() == output.bytes)
            && sidecar.version == super::VERSION
            && sidecar.camera == self.rectifier.camera
            && [output.width_px, output.height_px] == self.size_px
            && self
                .exposures
                .of(task, self.file)
                .is_ok_and(|exposure| exposure.record == sidecar.record)
            && recorded_frame::is_that_of(&sidecar.input, &path, task))
    }
}

/// Frames that failed.
#[derive(Default)]
struct Failures {
    count: usize,
    /// The first of those with the largest exit code.
    worst: Option<Failure>,
}

impl Failures {
    fn add(&mut self, failure: Failure) {
        self.count += 1;
        if self
            .worst
            .as_ref()
            .is_none_or(|worst| worst.code() < failure.code())
        {
            self.worst = Some(failure);
        }
    }
}

fn row(task: &FrameTask, done: &Result<Rectified, Failure>, elapsed: Duration) -> Row {
    match done {
        Ok(rectified) => done_row(task, &rectified.sidecar, Some(elapsed)),
        Err(failure) => Row {
            file: task.name.clone(),
            sequence: task.sequence,
            status: failure.code(),
            output: None,
            width_px: None,
            height_px: None,
            pixels_crc32: None,
            border_percent: None,
            seconds: Some(seconds(elapsed)),
            error: failure.text(),
        },
    }
}

fn done_row(task: &FrameTask, sidecar: &Sidecar, elapsed: Option<Duration>) -> Row {
    let output = &sidecar.output;
    Row {
        file: task.name.clone(),
        sequence: task.sequence,
        status: 0,
        output: Some(output.file.clone()),
        width_px: Some(output.width_px),
        height_px: Some(output.height_px),
        pixels_crc32: Some(output.pixels_crc32.clone()),
        border_percent: Some(format!("{:.4}", output.border_percent)),
        seconds: elapsed.map(seconds),
        error: String::new(),
    }
}

fn seconds(elapsed: Duration) -> String {
    format!("{:.2}", elapsed.as_secs_f64())
}
