//! The frames that are asked for.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use fmc_frames::ImageMap;

use super::{manifest, rectified_camera};
use crate::cli::{RectifyArgs, Shard};
use crate::failure::Failure;

/// A frame to be rectified.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FrameTask {
    /// The recorded image.
    pub(super) path: PathBuf,
    /// Its name in messages, as it was given.
    pub(super) name: String,
    /// Name of the outputs, without an extension.
    pub(super) stem: String,
    /// Sequence number of its record; `None` for an exposure that the options describe.
    pub(super) sequence: Option<u32>,
}

impl FrameTask {
    /// Returns all frames, in the order of the arguments, or of the sequence numbers of a table.
    ///
    /// # Errors
    /// [`Failure`] of the table; for a name without a number; for two frames of one record or with
    /// one output; for an output in the place of an input.
    pub(super) fn all(args: &RectifyArgs) -> Result<Vec<Self>, Failure> {
        let tasks = match &args.frames {
            Some(table) => Self::of_table(table)?,
            None => args
                .inputs
                .iter()
                .map(|path| Self::of_path(path, args.records.is_some()))
                .collect::<Result<_, _>>()?,
        };
        if args.records.is_none() && tasks.len() > 1 {
            return Err(Failure::bad_input(format!(
                "{} frames: --vh and --exposure describe one frame; for several, give --records",
                tasks.len()
            )));
        }
        if tasks.is_empty() {
            let table = args.frames.as_deref().unwrap_or(Path::new(""));
            return Err(Failure::bad_input(format!(
                "{}: there is no frame in it",
                table.display()
            )));
        }
        check_names(&tasks)?;
        check_outputs(&tasks, args)?;
        Ok(tasks)
    }

    /// Returns the frames of a table.
    fn of_table(table: &Path) -> Result<Vec<Self>, Failure> {
        let map = ImageMap::read_files(table)?;
        let folder = table.parent().unwrap_or(Path::new(""));
        map.images()
            .map(|(sequence, file)| {
                let beside = folder.join(file);
                let path = if beside.exists() {
                    beside
                } else {
                    PathBuf::from(file)
                };
                Ok(Self {
                    stem: stem(&path)?.to_owned(),
                    name: file.to_owned(),
                    path,
                    sequence: Some(sequence),
                })
            })
            .collect()
    }

    /// Returns those of a table's frames that are chosen; all, if none is.
    ///
    /// # Errors
    /// [`Failure`] naming a frame that is not in the table.
    pub(super) fn chosen(tasks: Vec<Self>, args: &RectifyArgs) -> Result<Vec<Self>, Failure> {
        let (Some(table), [_, ..]) = (&args.frames, args.inputs.as_slice()) else {
            return Ok(tasks);
        };
        let is_it = |task: &Self, path: &Path| {
            task.path == path
                || (task.path.file_name() == path.file_name()
                    && same_file::is_same_file(&task.path, path).unwrap_or(false))
        };
        args.inputs
            .iter()
            .map(|path| {
                let task = tasks.iter().find(|task| is_it(task, path));
                task.cloned().ok_or_else(|| {
                    Failure::bad_input(format!(
                        "{}: this frame is not in {}",
                        path.display(),
                        table.display()
                    ))
                })
            })
            .collect()
    }

    fn of_path(path: &Path, has_records: bool) -> Result<Self, Failure> {
        let stem = stem(path)?;
        let sequence = has_records.then(|| sequence(path, stem)).transpose()?;
        Ok(Self {
            path: path.to_path_buf(),
            name: path.display().to_string(),
            stem: stem.to_owned(),
            sequence,
        })
    }

    /// Returns the frames of a part.
    pub(super) fn of_shard(tasks: Vec<Self>, shard: Option<Shard>) -> Vec<Self> {
        let Some(Shard { number, of }) = shard else {
            return tasks;
        };
        let parts = (1..=of).cycle();
        let numbered = tasks.into_iter().zip(parts);
        numbered
            .filter_map(|(task, part)| (part == number).then_some(task))
            .collect()
    }

    /// Name of the recorded image in its folder.
    pub(super) fn file_name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Name of the rectified image.
    pub(super) fn image_name(&self) -> String {
        format!("{}.tif", self.stem)
    }

    /// Name of the description beside it.
    pub(super) fn sidecar_name(&self) -> String {
        format!("{}.json", self.stem)
    }
}

fn stem(path: &Path) -> Result<&str, Failure> {
    path.file_stem()
        .and_then(|stem| stem.to_str())
        .filter(|stem| !stem.is_empty())
        .ok_or_else(|| {
            Failure::bad_input(format!(
                "{}: the name of a frame must be text in UTF-8",
                path.display()
            ))
        })
}

/// Returns the number that ends a name.
fn sequence(path: &Path, stem: &str) -> Result<u32, Failure> {
    let digits = stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let number = stem.get(digits..).unwrap_or_default();
    number.parse().map_err(|_| {
        let fault = if number.is_empty() {
            "no number ends the name".to_owned()
        } else {
            format!("{number} is not a sequence number from 0 to {}", u32::MAX)
        };
        Failure::bad_input(format!("{}: {fault}", path.display()))
            .with_help("--frames with a table of the columns file and sequence says which record belongs to which frame")
    })
}

/// Refuses two frames of one record, and two with one output.
fn check_names(tasks: &[FrameTask]) -> Result<(), Failure> {
    let (mut stems, mut sequences) = (HashMap::new(), HashMap::new());
    for task in tasks {
        let twice = |other: &str, what: String| {
            Err(Failure::bad_input(format!(
                "{} and {other}: {what}",
                task.name
            )))
        };
        // Some file systems do not tell capitals from small letters.
        if let Some(other) = stems.insert(task.stem.to_lowercase(), task.name.as_str()) {
            let image = task.image_name();
            return twice(other, format!("both would be rectified into {image}"));
        }
        if let Some(sequence) = task.sequence
            && let Some(other) = sequences.insert(sequence, task.name.as_str())
        {
            return twice(other, format!("both are of the record {sequence}"));
        }
    }
    Ok(())
}

/// Refuses outputs in the place of a frame, of the camera file, of the records or of the table.
fn check_outputs(tasks: &[FrameTask], args: &RectifyArgs) -> Result<(), Failure> {
    let Ok(out) = fs::canonicalize(&args.out) else {
        // Nothing is in a folder that does not exist.
        return Ok(());
    };
    let files = [
        Some(&args.exposure.camera),
        args.records.as_ref(),
        args.frames.as_ref(),
    ];
    let inputs = files
        .into_iter()
        .flatten()
        .chain(tasks.iter().map(|task| &task.path));
    let read: HashMap<PathBuf, &PathBuf> = inputs
        .filter_map(|input| Some((fs::canonicalize(input).ok()?, input)))
        .filter(|(place, _)| place.parent() == Some(&out))
        .collect();
    if read.is_empty() {
        return Ok(());
    }
    let names = tasks
        .iter()
        .flat_map(|task| [task.image_name(), task.sidecar_name()])
        .chain([
            rectified_camera::NAME.to_owned(),
            manifest::name(args.block.shard),
        ]);
    for name in names {
        if let Some(input) = fs::canonicalize(out.join(&name))
            .ok()
            .and_then(|place| read.get(&place))
        {
            return Err(Failure::bad_input(format!(
                "--out would replace {}, which is read, by {name}; name another folder",
                input.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(name: &str) -> FrameTask {
        FrameTask::of_path(Path::new(name), true).unwrap_or_else(|_| panic!("{name} has a number"))
    }

    #[test]
    fn number_that_ends_the_name_is_the_sequence() {
        for (name, expected) in [
            ("a/IMG_0012.tif", Some(12)),
            ("7.tiff", Some(7)),
            ("strip2-frame00003", Some(3)),
            ("frame.tif", None),
            ("12a.tif", None),
            ("4294967296.tif", None),
        ] {
            let found = FrameTask::of_path(Path::new(name), true);
            assert_eq!(
                found.ok().and_then(|task| task.sequence),
                expected,
                "{name}"
            );
        }
    }

    #[test]
    fn parts_hold_every_frame_once() {
        let all: Vec<_> = (0..10)
            .map(|number| task(&format!("{number}.tif")))
            .collect();
        let mut found = Vec::new();
        for number in 1..=3 {
            let part = FrameTask::of_shard(all.clone(), Some(Shard { number, of: 3 }));
            assert!((3..=4).contains(&part.len()));
            found.extend(part);
        }
        found.sort_by_key(|task| task.sequence);
        assert_eq!(found, all);
    }

    #[test]
    fn frames_with_one_output_or_one_record_are_refused() {
        let refused = |names: [&str; 2]| check_names(&names.map(task)).is_err();
        assert!(refused(["a/f1.tif", "b/f1.tif"]));
        assert!(refused(["a/F1.tif", "b/f1.tif"]));
        assert!(refused(["a/f1.tif", "a/g1.tif"]));
        assert!(!refused(["a/f1.tif", "a/f2.tif"]));
    }
}
