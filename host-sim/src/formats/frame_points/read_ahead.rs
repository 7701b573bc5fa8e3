//! Blocks of points that a thread reads ahead.

use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use fmc_camera_file::CameraFile;

use super::block::FrameBlock;
use super::source::RowReader;
use crate::failure::Failure;

/// Number of blocks between the thread that reads and the one that answers.
const AHEAD: usize = 4;

/// The points of a file, block by block, in order.
#[derive(Debug)]
pub struct FrameBlocks {
    full: Receiver<Result<FrameBlock, Failure>>,
    empty: Sender<FrameBlock>,
}

impl FrameBlocks {
    /// Begins to read.
    pub(super) fn of(reader: Box<dyn RowReader>, camera: &CameraFile) -> Self {
        let (full_sender, full) = sync_channel(AHEAD);
        let (empty, empty_receiver) = channel();
        let camera = camera.clone();
        // The thread is not joined: after an error elsewhere the process ends while the thread may
        // still wait for its input.
        thread::spawn(move || read(reader, &camera, &full_sender, &empty_receiver));
        Self { full, empty }
    }

    /// Returns the next points; `None` behind the last.
    ///
    /// # Errors
    /// [`Failure`] of the first point that cannot be read; those before it have been returned.
    pub fn next_block(&mut self) -> Result<Option<FrameBlock>, Failure> {
        match self.full.recv() {
            Ok(block) => block.map(|block| (!block.points_mm.is_empty()).then_some(block)),
            Err(_) => Err(Failure::device_or_io("the reader of points has ended")),
        }
    }

    /// Returns a block to the reader, to be filled again.
    pub fn reuse(&self, block: FrameBlock) {
        // Sending fails if the reader has ended, and then needs no block.
        let _ = self.empty.send(block);
    }
}

fn read(
    mut reader: Box<dyn RowReader>,
    camera: &CameraFile,
    full: &SyncSender<Result<FrameBlock, Failure>>,
    empty: &Receiver<FrameBlock>,
) {
    loop {
        let mut block = empty.try_recv().unwrap_or_default();
        let filled = reader.fill(&mut block, camera);
        let last = block.points_mm.is_empty();
        // The points before one that cannot be read are answered, or refused, first.
        let ends = last || filled.is_err();
        if !last && full.send(Ok(block)).is_err() {
            return;
        }
        match filled {
            Err(failure) => {
                let _ = full.send(Err(failure));
            }
            Ok(()) if last => {
                let _ = full.send(Ok(FrameBlock::default()));
            }
            Ok(()) => {}
        }
        if ends {
            return;
        }
    }
}
