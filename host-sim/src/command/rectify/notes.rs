//! Sentences that are said once of a block.

use std::collections::BTreeSet;

use super::frame::Rectified;
use super::task::FrameTask;
use crate::failure::note;

/// Sentences that have been printed.
#[derive(Debug, Default)]
pub(super) struct Notes(BTreeSet<String>);

impl Notes {
    /// Prints those sentences of a frame that no frame before it had.
    pub(super) fn tell(&mut self, task: &FrameTask, rectified: &Rectified) {
        for sentence in &rectified.notes {
            if self.0.insert(sentence.clone()) {
                note(format_args!("note: {}: {sentence}", task.name));
            }
        }
    }
}
