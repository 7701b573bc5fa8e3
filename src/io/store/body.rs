//! Body of a record: what is stored of a calibration.

use embedded_storage::nor_flash::ReadNorFlash;
use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::authentication::Authentication;
use super::commit::Commit;
use super::fault::SlotFault;
use super::layout::{HEAD_CAPACITY, MAX_BODY_WORDS, WORD_BYTES};
use super::origin::Origin;
use super::probe_point::ProbePoint;
use super::slot::{BODY, Slot, Word};
use crate::flight::grid_memory::GridMemory;
use crate::geometry::grid::{GridCarrier, MAX_FILE_BYTES};
use crate::io::link::CALIBRATION_CAPACITY;
use crate::io::link::packet::CRC;

/// Parts of the camera in the order of their grids.
pub(super) const CARRIERS: [GridCarrier; 2] = [GridCarrier::Lens, GridCarrier::Sensor];

/// Bytes of the length in front of a head.
const LENGTH_BYTES: usize = 2;

/// Everything of a record but the files of its grids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) origin: Origin,
    /// Signature of the statement.
    pub(super) authentication: Authentication,
    /// Highest version that this camera has ever stored.
    pub(super) highest: u32,
    pub(super) probe: ProbePoint,
    /// Bytes of the files of the grids of lens and sensor; 0 without.
    pub(super) grid_bytes: [u16; 2],
    /// Parameters of the camera, as the link carries them.
    pub(super) camera: Vec<u8, CALIBRATION_CAPACITY>,
}

/// Body of a record to be written.
///
/// # Model
/// Length of the head (u16, little endian) and the head as `postcard` writes it; the file of the
/// lens's grid; that of the sensor's. Each of the three is filled up with zeros to whole words.
pub(super) struct Body<'a> {
    head: [u8; HEAD_CAPACITY],
    head_bytes: usize,
    files: [&'a [u8]; 2],
}

impl<'a> Body<'a> {
    /// Returns the body; `None` only if it were longer than a body may be.
    pub(super) fn new(head: &Head, files: [&'a [u8]; 2]) -> Option<Self> {
        let mut bytes = [0; HEAD_CAPACITY];
        let (length, place) = bytes.split_first_chunk_mut::<LENGTH_BYTES>()?;
        let written = postcard::to_slice(head, place).ok()?.len();
        *length = u16::try_from(written).ok()?.to_le_bytes();
        Some(Self {
            head: bytes,
            head_bytes: LENGTH_BYTES + written,
            files,
        })
    }

    /// The words, in order.
    pub(super) fn words(&self) -> impl Iterator<Item = Word> + '_ {
        let head = self.head.get(..self.head_bytes).unwrap_or_default();
        let [lens, sensor] = self.files;
        let pieces = [head, lens, sensor].into_iter();
        pieces
            .flat_map(|piece| piece.chunks(WORD_BYTES))
            .map(|piece| {
                let mut word = [0; WORD_BYTES];
                for (place, byte) in word.iter_mut().zip(piece) {
                    *place = *byte;
                }
                word
            })
    }

    /// Returns the commit word of the body; `None` if it is longer than a body may be.
    pub(super) fn commit(&self, sequence: u32) -> Option<Commit> {
        let mut digest = CRC.digest();
        let mut words = 0_u16;
        for word in self.words() {
            digest.update(&word);
            words = words.checked_add(1)?;
        }
        (words <= MAX_BODY_WORDS).then(|| Commit {
            sequence,
            words,
            crc: digest.finalize(),
        })
    }
}

/// Reads a body: every word once, the files of its grids into the buffers of `memory` that are not
/// in use.
///
/// # Errors
/// [`SlotFault`] for a word that cannot be read, a wrong CRC-32, and contents of another layout.
pub(super) fn read<F: ReadNorFlash>(
    slot: &mut Slot<'_, F>,
    commit: &Commit,
    memory: Option<&mut GridMemory>,
) -> Result<Head, SlotFault> {
    let mut contents = Contents::new(memory);
    let mut digest = CRC.digest();
    for index in BODY..BODY.saturating_add(commit.words) {
        let word = slot
            .read(index)
            .ok_or(SlotFault::Unreadable { word: index })?;
        digest.update(&word);
        contents.add(&word);
    }
    let computed = digest.finalize();
    if computed != commit.crc {
        let stored = commit.crc;
        return Err(SlotFault::Crc { stored, computed });
    }
    contents.finish()
}

/// Contents of a body of which words have come.
struct Contents<'a> {
    memory: Option<&'a mut GridMemory>,
    /// Words of the head.
    bytes: Vec<u8, HEAD_CAPACITY>,
    /// The head, once it has come.
    head: Option<Head>,
    /// Bytes of the files that have not come.
    left: [usize; 2],
    is_wrong: bool,
}

impl<'a> Contents<'a> {
    fn new(mut memory: Option<&'a mut GridMemory>) -> Self {
        if let Some(memory) = &mut memory {
            for carrier in CARRIERS {
                memory.spare_mut(carrier).clear();
            }
        }
        Self {
            memory,
            bytes: Vec::new(),
            head: None,
            left: [0; 2],
            is_wrong: false,
        }
    }

    /// Takes the next word.
    fn add(&mut self, word: &Word) {
        if self.is_wrong {
            return;
        }
        if self.head.is_none() {
            self.add_to_head(word);
            return;
        }
        for (carrier, left) in CARRIERS.into_iter().zip(&mut self.left) {
            if *left > 0 {
                let bytes = (*left).min(WORD_BYTES);
                *left -= bytes;
                if let (Some(memory), Some(bytes)) = (&mut self.memory, word.get(..bytes)) {
                    let added = memory.spare_mut(carrier).add(bytes);
                    self.is_wrong = added.is_err();
                }
                return;
            }
        }
        // Nothing is left to come.
        self.is_wrong = true;
    }

    fn add_to_head(&mut self, word: &Word) {
        self.is_wrong = self.bytes.extend_from_slice(word).is_err();
        let Some((length, rest)) = self.bytes.split_first_chunk::<LENGTH_BYTES>() else {
            return;
        };
        let length = usize::from(u16::from_le_bytes(*length));
        let Some(bytes) = rest.get(..length) else {
            return;
        };
        match postcard::take_from_bytes::<Head>(bytes) {
            Ok((head, [])) => {
                self.left = head.grid_bytes.map(usize::from);
                self.is_wrong |= self.left.iter().any(|left| *left > MAX_FILE_BYTES);
                self.head = Some(head);
            }
            _ => self.is_wrong = true,
        }
    }

    /// Returns the head if all has come and nothing else.
    fn finish(self) -> Result<Head, SlotFault> {
        let head = self.head.ok_or(SlotFault::Contents)?;
        if self.is_wrong || self.left != [0; 2] || head.origin.check().is_err() {
            return Err(SlotFault::Contents);
        }
        if head.grid_bytes != [0; 2] && self.memory.is_none() {
            return Err(SlotFault::NoGridMemory);
        }
        Ok(head)
    }
}

#[cfg(test)]
mod tests {
    use super::super::authentication::{Permission, Signature};
    use super::super::layout::HEAD_BYTES;
    use super::super::origin::{LABORATORY_BYTES, LENS_BYTES};
    use super::*;

    /// Returns a probe point all of whose numbers take as many bytes as can be.
    fn longest_probe() -> ProbePoint {
        let mut bytes = std::vec![0; 5 * 4];
        for _ in 0..4 {
            bytes.extend([0xff, 0xff, 0xff, 0xff, 0x0f]);
        }
        let probe: ProbePoint = postcard::from_bytes(&bytes).unwrap();
        assert_eq!(probe.bits(), [u32::MAX; 4]);
        probe
    }

    #[test]
    fn longest_record_fits_a_slot() {
        let [lens, laboratory] = [LENS_BYTES, LABORATORY_BYTES].map(|bytes| "x".repeat(bytes));
        let file = std::vec![0xff; MAX_FILE_BYTES];
        let grid_bytes = u16::try_from(file.len()).unwrap();
        let head = Head {
            origin: Origin::new(&lens, &laboratory, "2026-05-17").unwrap(),
            authentication: Authentication {
                signature: Signature::new(&[0xff; Signature::BYTES]),
                permission: Some(Permission {
                    store: u32::MAX,
                    crc: u32::MAX,
                }),
            },
            highest: u32::MAX,
            probe: longest_probe(),
            grid_bytes: [grid_bytes; 2],
            camera: Vec::from_slice(&[0xff; CALIBRATION_CAPACITY]).unwrap(),
        };
        let body = Body::new(&head, [&file, &file]).unwrap();
        assert_eq!(body.head_bytes, HEAD_BYTES, "no byte is reserved in vain");
        assert_eq!(body.commit(1).unwrap().words, MAX_BODY_WORDS);
        assert_eq!(body.words().count(), usize::from(MAX_BODY_WORDS));
    }
}
