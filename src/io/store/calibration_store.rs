//! The two slots: which of them is read, and which is written.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

use super::authentication::{Authentication, SignatureVerifier, StoreOrder};
use super::body::{Body, CARRIERS, Head};
use super::commit::Commit;
use super::fault::{NotStored, NothingStored, SlotFault, StoreStep};
use super::head::{self, SignedOrigin};
use super::judgement::{Reader, Record};
use super::layout::{LayoutError, MAX_SLOT_BYTES, WORD_BYTES};
use super::public_key::PublicKey;
use super::slot::{BODY, Slot, Word};
use super::statement::Statement;
use super::stored_identity::StoredIdentity;
use super::succession::{self, Newest};
use crate::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::grid_memory::GridMemory;
use crate::io::link::digest;
use crate::io::link::loading::Upload;

/// A camera's calibration in two slots of a flash `F`, signed so that `V` verifies it.
#[derive(Debug)]
pub struct CalibrationStore<F, V = PublicKey> {
    flash: F,
    /// Offset of the first slot, bytes; the second follows it.
    offset: u32,
    reader: Reader<V>,
}

/// A calibration that is stored, as it has been read.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredCalibration {
    /// Parameters of the camera, serial number and version of the calibration among them.
    pub parameters: CameraParameters,
    /// The same without its numbers, for the link.
    pub identity: StoredIdentity,
}

impl StoredCalibration {
    fn new(parameters: &CameraParameters, head: Head, (slot, store): (usize, u32)) -> Self {
        let identity = StoredIdentity {
            id: CalibrationId {
                serial: parameters.serial,
                version: parameters.version,
                crc: digest::of_camera(parameters),
                storage: Storage::Stored,
            },
            origin: head.origin,
            store,
            highest_version: head.highest,
            #[expect(clippy::cast_possible_truncation, reason = "0 or 1")]
            slot: slot as u8,
            other: None,
            is_sealed: true,
        };
        Self {
            parameters: *parameters,
            identity,
        }
    }
}

/// The newest good record.
struct Found {
    slot: usize,
    commit: Commit,
    record: Record,
    /// Commit word of the other slot, whose record is older and has not been read; or what is wrong
    /// with that slot.
    other: Result<Commit, SlotFault>,
}

/// Findings in both slots.
struct Findings {
    found: Result<Found, NothingStored>,
    /// The newest record that is signed; `None` if there is none.
    newest: Option<Newest>,
}

impl<F: NorFlash> CalibrationStore<F> {
    /// Returns the store whose first slot begins at an offset of the flash.
    ///
    /// # Errors
    /// [`LayoutError`] if two slots of whole sectors have no place there.
    pub fn new(flash: F, offset: u32) -> Result<Self, LayoutError> {
        const {
            assert!(WORD_BYTES.is_multiple_of(F::READ_SIZE));
            assert!(WORD_BYTES.is_multiple_of(F::WRITE_SIZE));
            assert!(F::ERASE_SIZE.is_multiple_of(WORD_BYTES));
        }
        let sector = F::ERASE_SIZE;
        let begin = usize::try_from(offset).unwrap_or(usize::MAX);
        if !begin.is_multiple_of(sector) {
            return Err(LayoutError::NoSector { offset, sector });
        }
        let required = begin.saturating_add(2 * slot_bytes::<F>());
        let capacity = flash.capacity();
        // An offset has 32 bits.
        if required > capacity || u32::try_from(required).is_err() {
            return Err(LayoutError::NoPlace { required, capacity });
        }
        Ok(Self {
            flash,
            offset,
            reader: Reader {
                serial: SerialNumber::EMPTY,
                key: None,
            },
        })
    }
}

impl<F: NorFlash, V: SignatureVerifier> CalibrationStore<F, V> {
    /// Returns the same store of a camera that knows its own serial number, and uses and stores no
    /// calibration of another.
    #[must_use]
    pub fn of_camera(mut self, serial: SerialNumber) -> Self {
        self.reader.serial = serial;
        self
    }

    /// Returns the same store of a camera that uses and stores what the owner of a key has signed;
    /// without a key it uses and stores nothing.
    #[must_use]
    pub fn trusting<K: SignatureVerifier>(self, key: K) -> CalibrationStore<F, K> {
        CalibrationStore {
            flash: self.flash,
            offset: self.offset,
            reader: Reader {
                serial: self.reader.serial,
                key: Some(key),
            },
        }
    }

    /// The flash.
    pub const fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Returns the flash.
    #[must_use]
    pub fn into_flash(self) -> F {
        self.flash
    }

    /// Reads the newest calibration that this camera can use. The files of its grids, checked, are
    /// in the buffers of `memory` that are not in use. Nothing is written.
    ///
    /// # Errors
    /// [`NothingStored`] with what is wrong with either slot.
    pub fn load(
        &mut self,
        memory: Option<&mut GridMemory>,
    ) -> Result<StoredCalibration, NothingStored> {
        let found = self.find(memory).found?;
        let is_sealed = self.slot(found.slot).last_seal().is_some();
        Ok(found.stored(is_sealed))
    }

    /// Stores a calibration that is signed; if it has residual grids, those in use, which have to
    /// be its own. Its version has to be higher than all that were stored, or its signature to hold
    /// a permission that names the calibration that is stored now. Only the slot is written that is
    /// not the newest good one. A calibration that is stored already is not written again.
    ///
    /// The buffers of `memory` that are not in use serve to read what is stored: grids that are
    /// being uploaded are lost.
    ///
    /// # Errors
    /// [`NotStored`]: the flash is as it was, except after [`NotStored::Flash`], which says what a
    /// start finds.
    pub fn store(
        &mut self,
        parameters: &CameraParameters,
        order: &StoreOrder,
        mut memory: Option<&mut GridMemory>,
    ) -> Result<StoredCalibration, NotStored> {
        let camera = Camera::new(*parameters).map_err(NotStored::Calibration)?;
        let origin = &order.origin;
        origin.check().map_err(NotStored::Origin)?;
        check_serial(self.reader.serial, parameters)?;
        let upload = Upload::of(parameters).ok_or(NotStored::TooLong)?;
        let authentication = self.authenticated(parameters, &upload, order, memory.as_deref())?;
        let Findings { found, newest } = self.find(memory.as_deref_mut());
        if let Some(newest) = &newest {
            check_serial(newest.serial, parameters)?;
        }
        let highest = succession::check(newest.as_ref(), parameters.version, &authentication)?;
        let (target, sequence, last_seal) = match &found {
            Ok(found) => self.target(found, memory.as_deref_mut()),
            Err(nothing) => self.first_target(nothing),
        };
        let memory = memory.as_deref();
        let files = head::files_in_use(parameters, memory)?;
        let signed = SignedOrigin {
            origin,
            authentication,
            highest,
        };
        let head = head::of(&camera, &upload, &signed, memory, files)?;
        let body = Body::new(&head, files).ok_or(NotStored::TooLong)?;
        let commit = body.commit(sequence).ok_or(NotStored::TooLong)?;
        // Once more: a processor that leaves out an instruction stores nothing that is not signed.
        self.authenticated(parameters, &upload, order, memory)?;
        // From here on nothing is refused, and the flash is written.
        if let (Ok(found), Some(last)) = (found, last_seal) {
            // The seal that was seen may have been cut itself, and be blank when it is read again.
            // Therefore a further one is written before anything is erased: if it could not be, the
            // flash is worn, and the record is sound all the same.
            self.slot(found.slot).seal_behind(last);
            if found.record.head == head {
                return Ok(found.stored(true));
            }
        }
        let stored = StoredCalibration::new(parameters, head, (target, sequence));
        let slot = stored.identity.slot;
        self.write(target, &body, commit)
            .map_err(|step| NotStored::Flash { slot, step })?;
        Ok(stored)
    }

    /// Returns the signature of a calibration, which has been verified.
    #[inline(never)]
    fn authenticated(
        &self,
        parameters: &CameraParameters,
        upload: &Upload,
        order: &StoreOrder,
        memory: Option<&GridMemory>,
    ) -> Result<Authentication, NotStored> {
        let authentication = order.authentication.ok_or(NotStored::Unsigned)?;
        let key = self.reader.key.as_ref().ok_or(NotStored::NoKey)?;
        if parameters.serial.is_empty() {
            return Err(NotStored::NoSerial);
        }
        let files = head::files_in_use(parameters, memory)?;
        let permission = authentication.permission;
        let statement = Statement::of_bytes(upload.bytes(), &order.origin, permission, files)
            .ok_or(NotStored::TooLong)?;
        if key.verifies(&statement.pieces(), &authentication.signature) {
            Ok(authentication)
        } else {
            Err(NotStored::WrongSignature)
        }
    }

    /// Finds the newest record that this camera can use, and the newest that is signed. Each commit
    /// word is read once. Buffers of `memory` that are not in use hold nothing else afterwards.
    fn find(&mut self, mut memory: Option<&mut GridMemory>) -> Findings {
        if let Some(memory) = memory.as_deref_mut() {
            for carrier in CARRIERS {
                memory.spare_mut(carrier).clear();
            }
        }
        let commits = self.commits();
        let newest = match &commits {
            [Ok(first), Ok(second)] => usize::from(second.is_newer_than(first)),
            [first, _] => usize::from(first.is_err()),
        };
        let other = 1 - newest;
        let [first, second] = commits;
        let [newer, older] = if newest == 0 {
            [first, second]
        } else {
            [second, first]
        };
        let mut signed = None;
        let newer_fault = match self.judge(newest, newer, memory.as_deref_mut(), &mut signed) {
            Ok((commit, record)) => {
                let found = Ok(Found {
                    slot: newest,
                    commit,
                    record,
                    other: older,
                });
                return Findings {
                    found,
                    newest: signed,
                };
            }
            Err(fault) => fault,
        };
        let found = match self.judge(other, older, memory, &mut signed) {
            Ok((commit, record)) => Ok(Found {
                slot: other,
                commit,
                record,
                other: Err(newer_fault),
            }),
            Err(older_fault) => Err(NothingStored {
                slots: if newest == 0 {
                    [newer_fault, older_fault]
                } else {
                    [older_fault, newer_fault]
                },
            }),
        };
        Findings {
            found,
            newest: signed,
        }
    }

    /// Reads the record behind a commit word; notes in `newest` the first that is signed.
    fn judge(
        &mut self,
        index: usize,
        commit: Result<Commit, SlotFault>,
        mut memory: Option<&mut GridMemory>,
        newest: &mut Option<Newest>,
    ) -> Result<(Commit, Record), SlotFault> {
        let commit = commit?;
        let mut slot = slot_of(&mut self.flash, self.offset, index);
        let read = self.reader.read(&mut slot, &commit, memory.as_deref_mut());
        let record = read?;
        newest.get_or_insert_with(|| Newest::of(&commit, &record));
        record.check(memory)?;
        Ok((commit, record))
    }

    /// Returns the slot to be written beside a record, the number of the next, and the record's
    /// last seal, which shows that its store was carried to its end. Nothing is written.
    fn target(
        &mut self,
        found: &Found,
        memory: Option<&mut GridMemory>,
    ) -> (usize, u32, Option<u16>) {
        let next = found.commit.sequence.wrapping_add(1);
        let other = 1 - found.slot;
        if let Some(last) = self.slot(found.slot).last_seal() {
            return (other, next, Some(last));
        }
        match self.judge(other, found.other, memory, &mut None) {
            Ok(_) => (found.slot, next, None),
            Err(_) => (other, next, None),
        }
    }

    /// Returns the same where there is no record: a slot that is not blank is written again, so
    /// that none is left behind that may be read as whole later.
    fn first_target(&mut self, nothing: &NothingStored) -> (usize, u32, Option<u16>) {
        let numbers = self.commits().into_iter().flatten();
        let last = numbers.map(|commit| commit.sequence).max().unwrap_or(0);
        let [first, second] = nothing.slots;
        let is_second = first == SlotFault::Blank && second != SlotFault::Blank;
        (usize::from(is_second), last.wrapping_add(1), None)
    }

    /// Writes a record into a slot.
    fn write(&mut self, index: usize, body: &Body<'_>, commit: Commit) -> Result<(), StoreStep> {
        let mut slot = self.slot(index);
        slot.erase(slot_bytes::<F>()).ok_or(StoreStep::Erase)?;
        for (index, word) in (BODY..).zip(body.words()) {
            put(&mut slot, index, &word)?;
        }
        // Once more, now that all has been written.
        for (index, word) in (BODY..).zip(body.words()) {
            compare(&mut slot, index, &word)?;
        }
        put(&mut slot, 0, &commit.to_word())?;
        if slot.seal_behind(0) {
            Ok(())
        } else {
            Err(StoreStep::Write { word: 1 })
        }
    }

    /// Reads both commit words.
    fn commits(&mut self) -> [Result<Commit, SlotFault>; 2] {
        [0, 1].map(|index| match self.slot(index).read(0) {
            Some(word) => Commit::parse(&word),
            None => Err(SlotFault::Unreadable { word: 0 }),
        })
    }

    fn slot(&mut self, index: usize) -> Slot<'_, F> {
        slot_of(&mut self.flash, self.offset, index)
    }
}

/// Returns a slot of the store that begins at an offset.
fn slot_of<F: NorFlash>(flash: &mut F, offset: u32, index: usize) -> Slot<'_, F> {
    let second = if index == 0 { 0 } else { slot_bytes::<F>() };
    #[expect(
        clippy::cast_possible_truncation,
        reason = "both slots end within 32 bits"
    )]
    let offset = offset + second as u32;
    Slot { flash, offset }
}

impl Found {
    fn stored(self, is_sealed: bool) -> StoredCalibration {
        let Record { head, parameters } = self.record;
        let place = (self.slot, self.commit.sequence);
        let mut stored = StoredCalibration::new(&parameters, head, place);
        stored.identity.other = self.other.err();
        stored.identity.is_sealed = is_sealed;
        stored
    }
}

/// Writes a word and compares it.
fn put<F: NorFlash>(slot: &mut Slot<'_, F>, index: u16, word: &Word) -> Result<(), StoreStep> {
    slot.write(index, word)
        .ok_or(StoreStep::Write { word: index })?;
    compare(slot, index, word)
}

/// Checks that a word reads as it was written.
fn compare<F: ReadNorFlash>(
    slot: &mut Slot<'_, F>,
    index: u16,
    word: &Word,
) -> Result<(), StoreStep> {
    if slot.read(index).as_ref() == Some(word) {
        Ok(())
    } else {
        Err(StoreStep::Compare { word: index })
    }
}

/// Checks that parameters are those of a camera, if its serial number is known.
fn check_serial(camera: SerialNumber, parameters: &CameraParameters) -> Result<(), NotStored> {
    if camera.is_empty() || camera == parameters.serial {
        Ok(())
    } else {
        Err(NotStored::OtherCamera { camera })
    }
}

/// Bytes of a slot: whole sectors.
const fn slot_bytes<F: NorFlash>() -> usize {
    MAX_SLOT_BYTES.next_multiple_of(F::ERASE_SIZE)
}
