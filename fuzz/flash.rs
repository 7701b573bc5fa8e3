//! Fuzz targets of what a camera finds in its flash when it starts, and their properties. The tests
//! of the crate run the same functions.

use crc::{CRC_32_ISO_HDLC, Crc};
use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::io::store::record_ring::{
    CONTENTS_BYTES, ENTRY_WORDS, Erasing, RecordRing, RingState,
};
use fmc_camera::io::store::{
    Authentication, CalibrationStore, NotStored, Origin, PublicKey, SEAL_WORDS, Signature,
    SignatureVerifier, StoreOrder,
};

use super::flash_model::{BLANK, Cell, Cut, FlashModel, FlashOf, WORD};

/// Sectors of a ring, and their bytes: few entries, so that it soon goes round.
const SECTORS: usize = 6;
const SECTOR: usize = 4096;

type RingFlash = FlashOf<SECTORS, SECTOR>;
type Ring = RecordRing<RingFlash>;

const ENTRY_BYTES: usize = ENTRY_WORDS * WORD;

const KEY: Option<PublicKey> =
    PublicKey::from_pem(include_str!("../src/bin/firmware/test-public-key.pem"));

/// A verifier to which every signature is right, so that what lies behind it is reached.
struct Credulous;

impl SignatureVerifier for Credulous {
    fn verifies(&self, _: &[&[u8]], _: &Signature) -> bool {
        true
    }
}

fn crc_of(bytes: &[u8]) -> u32 {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(bytes)
}

/// Writes the CRC-32 of what lies before it into the last four bytes.
fn seal(bytes: &mut [u8]) {
    if let Some((checked, crc)) = bytes.split_last_chunk_mut() {
        *crc = crc_of(checked).to_le_bytes();
    }
}

/// Returns the words of some bytes, the last filled up with ones; those of ones alone are blank.
fn words(bytes: &[u8]) -> Vec<Cell> {
    let words = bytes.chunks(WORD).map(|piece| {
        let mut word = BLANK;
        word[..piece.len()].copy_from_slice(piece);
        if word == BLANK {
            Cell::Blank
        } else {
            Cell::Holding(word)
        }
    });
    words.collect()
}

/// Starts a camera with any contents of its flash: a calibration that is used makes a camera, every
/// entry of the ring is one that a slow and simple reader finds in the same place, and nothing is
/// written. Then a calibration and records are stored and found.
///
/// The first four bytes of the input say which CRCs are made right, how many words the first slot
/// has, and which words cannot be read or read otherwise every time. Returns whether a calibration
/// was used.
pub(crate) fn flash_image(bytes: &[u8]) -> bool {
    let Some(([settings, first_words, failing, unstable], image)) = bytes.split_first_chunk()
    else {
        return false;
    };
    let (first, second) = image.split_at(image.len().min(usize::from(*first_words) * WORD));
    let mut flash = FlashModel::blank();
    for (slot, (bytes, bit)) in [(first, 1), (second, 2)].into_iter().enumerate() {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(WORD), 0xff);
        let body = (1 + usize::from(SEAL_WORDS)) * WORD;
        if settings & bit != 0 && bytes.len() > body {
            let crc = crc_of(&bytes[body..]);
            bytes[12..16].copy_from_slice(&crc.to_le_bytes());
            seal(&mut bytes[..WORD]);
        }
        flash.sectors[slot] = words(&bytes);
    }
    damage(&mut flash.sectors[0], *failing, *unstable);
    let is_used = calibrations(flash);
    ring_of_any_contents(image, settings & 4 != 0, *failing, *unstable);
    is_used
}

/// Makes a word of a sector unreadable, and another one unstable, unless it has not that many.
fn damage(sector: &mut [Cell], failing: u8, unstable: u8) {
    if let Some(cell) = sector.get_mut(usize::from(failing)) {
        *cell = Cell::Failing;
    }
    if let Some(cell) = sector.get_mut(usize::from(unstable))
        && let Cell::Holding(held) = *cell
    {
        *cell = Cell::Unstable(BLANK, held);
    }
}

/// Reads and writes the two slots of calibrations.
fn calibrations(flash: FlashModel) -> bool {
    let store = CalibrationStore::new(flash.clone(), 0).unwrap();
    // No image is signed by the private half of this key.
    let mut strict = store.trusting(KEY.unwrap());
    assert!(strict.load(None).is_err());

    let mut store = CalibrationStore::new(flash, 0).unwrap().trusting(Credulous);
    let loaded = store.load(None);
    match &loaded {
        Ok(stored) => {
            assert!(Camera::new(stored.parameters).is_ok());
            let texts = &stored.identity.origin;
            let origin = Origin::new(texts.lens(), texts.laboratory(), texts.date());
            assert_eq!(origin.as_ref(), Ok(texts));
        }
        Err(nothing) => assert!(nothing.to_string().contains("slot")),
    }
    assert!(
        store.flash_mut().operations.is_empty(),
        "a start only reads"
    );

    let calibration = CalibrationParameters::new(100.0, [8000, 4000], 10.0);
    let mut parameters = CameraParameters::new(calibration);
    parameters.serial = SerialNumber::new("RC30-5282").unwrap();
    parameters.version = u32::MAX;
    let order = StoreOrder {
        origin: Origin::new("a lens", "a laboratory", "2026-05-01").unwrap(),
        authentication: Some(Authentication {
            signature: Signature::new(&[0x5a; Signature::BYTES]),
            permission: None,
        }),
    };
    match store.store(&parameters, &order, None) {
        Ok(stored) => {
            assert_eq!(stored.parameters, parameters);
            assert_eq!(store.flash_mut().written_again, 0);
            let flash = store.into_flash().started();
            let mut again = CalibrationStore::new(flash, 0).unwrap().trusting(Credulous);
            assert_eq!(again.load(None).unwrap().parameters, parameters);
        }
        // Of another camera, or as new: the flash is as it was.
        Err(NotStored::OtherCamera { .. } | NotStored::VersionNotRisen { highest: u32::MAX }) => {
            assert!(store.flash_mut().operations.is_empty());
        }
        Err(error) => panic!("{error}"),
    }
    loaded.is_ok()
}

/// Starts a ring with any contents of its flash, and writes on.
fn ring_of_any_contents(image: &[u8], is_crc_right: bool, failing: u8, unstable: u8) {
    let mut sectors: Vec<Vec<u8>> = image
        .chunks(SECTOR)
        .take(SECTORS)
        .map(<[u8]>::to_vec)
        .collect();
    if is_crc_right {
        for sector in &mut sectors {
            for (place, bytes) in sector.chunks_mut(ENTRY_BYTES).enumerate() {
                // A sector begins with a word of its own.
                let length = if place == 0 { WORD } else { ENTRY_BYTES };
                seal(bytes.get_mut(..length).unwrap_or_default());
            }
        }
    }
    let mut flash = RingFlash::blank();
    for (place, sector) in flash.sectors.iter_mut().zip(&sectors) {
        *place = words(sector);
    }
    damage(&mut flash.sectors[0], failing, unstable);
    let contents = flash.sectors.clone();
    let mut ring = open(flash);
    let mut found = Vec::new();
    ring.newest_first(u32::MAX, |number, contents| {
        found.push((number, contents.to_vec()));
        true
    });
    assert!(ring.flash_mut().operations.is_empty(), "a start only reads");
    let next = ring.next();
    let expected: Vec<_> = (next.saturating_sub(ring.capacity())..next)
        .rev()
        .filter_map(|number| Some((number, slow_entry(&contents, number)?)))
        .collect();
    if contents
        .iter()
        .flatten()
        .any(|cell| matches!(cell, Cell::Unstable(..)))
    {
        // It is read as whole or not.
        assert!(found.iter().all(|entry| expected.contains(entry)));
    } else {
        assert_eq!(found, expected);
    }
    // Behind the last number there is none.
    if next < u32::MAX - 1000 {
        written_and_found(ring);
    }
}

fn open(flash: RingFlash) -> Ring {
    RecordRing::open(flash, 0, u32::try_from(SECTORS).unwrap()).unwrap()
}

/// Returns the contents of an entry of a number, straight from the words of the flash; `None` if
/// they hold none that is whole, or cannot be read.
fn slow_entry(sectors: &[Vec<Cell>; SECTORS], number: u32) -> Option<Vec<u8>> {
    let places = SECTOR / ENTRY_BYTES;
    let number = usize::try_from(number).unwrap();
    let (sector, place) = (number / places % SECTORS, number % places);
    let cells = sectors[sector].get(place * ENTRY_WORDS..(place + 1) * ENTRY_WORDS)?;
    let mut bytes = Vec::new();
    for cell in cells {
        match cell {
            Cell::Holding(word) | Cell::Unstable(_, word) => bytes.extend(word),
            Cell::Blank => bytes.extend(BLANK),
            Cell::Failing => return None,
        }
    }
    let (checked, crc) = bytes.split_last_chunk()?;
    let length = usize::from(bytes[1]);
    let is_whole = *crc == crc_of(checked).to_le_bytes()
        && bytes[0] == 1
        && length <= CONTENTS_BYTES
        && bytes[2..6] == u32::try_from(number).unwrap().to_le_bytes();
    is_whole.then(|| bytes[6..6 + length].to_vec())
}

/// Writes entries with a good supply, and finds them after the next start, unless the flash takes
/// no more.
fn written_and_found(mut ring: Ring) {
    for number in 0..3_u8 {
        if !ring.push(&[number; 9]) || !finish(&mut ring) {
            assert_eq!(ring.state(), RingState::Worn);
            return;
        }
    }
    let mut found = Vec::new();
    // A place is left out at a start, and where a word takes nothing.
    open(ring.into_flash().started()).newest_first(u32::MAX, |_, contents| {
        found.push(contents.to_vec());
        found.len() < 3
    });
    assert_eq!(found, [[2; 9], [1; 9], [0; 9]]);
}

/// Lets the ring write what it holds; returns `false` if the flash takes no more.
fn finish(ring: &mut Ring) -> bool {
    for _ in 0..200 {
        match ring.step(Erasing::AtNeed) {
            RingState::Worn => return false,
            RingState::Idle => return true,
            RingState::Writing | RingState::Erasing => {}
        }
    }
    panic!("the entry is not written: {:?}", ring.state());
}

/// Runs a ring of records by a program of pushes, steps, starts and cuts of its supply, which the
/// input is read as: every entry that was written to its end is there after each start as long as
/// it has to be, in order and without a gap.
pub(crate) fn record_ring(bytes: &[u8]) {
    let mut run = Run {
        ring: open(RingFlash::blank()),
        written: Vec::new(),
        held: None,
        unsure: Vec::new(),
        next: 0,
        starts: 0,
    };
    for order in bytes {
        let number = usize::from(order >> 3);
        match order & 7 {
            0 | 1 => run.push(number),
            2 => run.step(Erasing::Ahead, number),
            3 | 4 => run.step(Erasing::AtNeed, number),
            5 => run.step(Erasing::Never, number),
            6 => run.start(),
            _ => run.cut(number),
        }
    }
    run.start();
    assert!(run.ring.push(&[]) && finish(&mut run.ring));
    assert_eq!(run.ring.flash_mut().written_again, 0);
    written_and_found(run.ring);
}

/// A run of a ring, and what it has to have.
struct Run {
    ring: Ring,
    /// Contents of the entries that were written to their ends, the oldest first.
    written: Vec<Vec<u8>>,
    /// Contents of the entry that is being written.
    held: Option<Vec<u8>>,
    /// Contents of entries whose writing was cut: they may be there or not.
    unsure: Vec<Vec<u8>>,
    next: u32,
    starts: usize,
}

impl Run {
    fn push(&mut self, number: usize) {
        let mut contents = self.next.to_le_bytes().to_vec();
        contents.resize(4 + number * 5, 0xa5);
        assert!(contents.len() <= CONTENTS_BYTES);
        let is_taken = self.ring.push(&contents);
        assert_eq!(is_taken, self.held.is_none());
        if is_taken {
            self.held = Some(contents);
            self.next += 1;
        }
    }

    fn step(&mut self, erasing: Erasing, number: usize) {
        for _ in 0..=number {
            let state = self.ring.step(erasing);
            // A word that was cut cannot be the fault of the ring.
            assert_ne!(state, RingState::Worn);
            if !self.ring.holds_entry() {
                self.written.extend(self.held.take());
            }
        }
    }

    /// Starts anew, and compares what the ring has.
    fn start(&mut self) {
        let ring = std::mem::replace(&mut self.ring, open(RingFlash::blank()));
        self.unsure.extend(self.held.take());
        self.starts += 1;
        self.ring = open(ring.into_flash().started());
        let mut found = Vec::new();
        self.ring.newest_first(u32::MAX, |_, contents| {
            found.push(contents.to_vec());
            true
        });
        assert!(
            self.ring.flash_mut().operations.is_empty(),
            "a start only reads"
        );
        found.retain(|contents| !self.unsure.contains(contents));
        let kept = self.written.iter().rev().take(found.len());
        assert!(kept.eq(&found), "in order and without a gap");
        // Places that were cut, and one behind each start, hold nothing.
        let entries =
            usize::try_from((u32::try_from(SECTORS).unwrap() - 2) * Ring::ENTRIES).unwrap();
        let lost = 2 * self.unsure.len() + 2 * self.starts;
        assert!(found.len() >= self.written.len().min(entries.saturating_sub(lost)));
    }

    /// Cuts the supply in the next operation, and starts anew.
    fn cut(&mut self, number: usize) {
        let flash = self.ring.flash_mut();
        let operation = flash.operations.len();
        let cut = match number {
            29 => Cut::Mixed,
            30 => Cut::Unstable,
            31 => Cut::Failing,
            written => Cut::First(written),
        };
        *flash = flash.clone().cut_at(operation, cut);
        for _ in 0..20 {
            self.ring.step(Erasing::AtNeed);
        }
        self.start();
    }
}
