//! The ring of records: wrap-around, cuts of the supply at every word, and flash that is worn.

use fmc_camera::io::store::LayoutError;
use fmc_camera::io::store::record_flash::RecordFlash;
use fmc_camera::io::store::record_ring::{CONTENTS_BYTES, Erasing, RecordRing, RingState};

use crate::store::flash_model::{BLANK, Cell, Cut, FlashOf, Operation, SECTOR, WORD};
use crate::store::wrong_rings::{ChecksAssumed, LastWordFirst, RingFlash, Small};

/// Sectors of a ring.
const SECTORS: u32 = 6;

/// The flash of a board.
type Large = FlashOf<6, SECTOR>;

/// Contents of an entry; their first bytes are its number in the test.
fn contents(number: u32) -> Vec<u8> {
    let length = 4 + usize::try_from(number * 37).unwrap() % (CONTENTS_BYTES - 3);
    let noise = (4..length).map(|at| number.wrapping_mul(0x9e37_79b9).rotate_left(5) as usize + at);
    let mut bytes = number.to_le_bytes().to_vec();
    bytes.extend(noise.map(|byte| byte.to_le_bytes()[0]));
    bytes
}

/// Writes an entry. Returns `true` if it was written.
fn write<F: RecordFlash>(ring: &mut RecordRing<F>, number: u32, erasing: Erasing) -> bool {
    if !ring.push(&contents(number)) {
        return false;
    }
    for _ in 0..1000 {
        let state = ring.step(erasing);
        if state == RingState::Worn || !ring.holds_entry() {
            return state != RingState::Worn;
        }
    }
    false
}

/// Numbers of the entries, the newest first; each has its contents.
fn entries<F: RecordFlash>(ring: &mut RecordRing<F>) -> Vec<u32> {
    let mut found = Vec::new();
    ring.newest_first(u32::MAX, |_, bytes| {
        let number = u32::from_le_bytes(bytes[..4].try_into().unwrap());
        assert_eq!(
            bytes,
            contents(number),
            "entry {number} has other contents than were written"
        );
        found.push(number);
        true
    });
    found
}

fn open<F: RecordFlash>(flash: F) -> RecordRing<F> {
    RecordRing::open(flash, 0, SECTORS).unwrap()
}

/// Returns the flash of a ring after its supply has come back.
fn started<F: RingFlash>(ring: RecordRing<F>) -> F {
    F::before(ring.into_flash().into_model().started())
}

/// Cuts an operation of the next steps of a ring.
fn cut<F: RingFlash>(ring: &mut RecordRing<F>, index: usize, cut: Cut, seed: u64) {
    let model = ring.flash_mut().model_mut();
    model.operations.clear();
    *model = model.clone().seeded(seed).cut_at(index, cut);
}

/// Starts twice with a flash whose supply has failed, and checks that the entries up to `last` are
/// there without a gap, at least `least` of them; behind them there may be the one that was being
/// written.
fn start_twice<F: RingFlash>(flash: &F, last: u32, least: usize, unsure: &[u32]) -> RecordRing<F> {
    let mut ring = open(flash.clone());
    for _ in 0..2 {
        ring = open(ring.into_flash());
        let mut found = entries(&mut ring);
        found.retain(|number| !unsure.contains(number));
        assert!(found.len() >= least, "{} of {least}", found.len());
        let expected = (0..=last).rev().filter(|number| !unsure.contains(number));
        let expected: Vec<u32> = expected.take(found.len()).collect();
        assert_eq!(found, expected);
    }
    let operations = &ring.flash_mut().model_mut().operations;
    assert!(operations.is_empty(), "a start only reads");
    ring
}

/// Entries that a ring keeps at least, once there are as many.
fn least_kept(count: u32) -> usize {
    let entries = RecordRing::<Small>::ENTRIES;
    usize::try_from(count.min((SECTORS - 2) * entries)).unwrap()
}

/// Cuts the supply in every word of every `nth` of 300 entries, with all that can be left of it.
/// Returns the numbers of cuts, of second cuts, and of erasures that were cut.
fn cut_everywhere<F: RingFlash>(nth: u32) -> [usize; 3] {
    let (mut cuts, mut second_cuts, mut erasures) = (0, 0, 0);
    let mut ring = open(F::before(Small::blank()));
    for number in 0..300 {
        // Most of the time somebody waits for the erasure.
        let erasing = if number % 3 == 0 {
            Erasing::AtNeed
        } else {
            Erasing::Ahead
        };
        let before = RecordRing::clone(&ring);
        ring.flash_mut().model_mut().operations.clear();
        assert!(write(&mut ring, number, erasing));
        while ring.state() == RingState::Erasing {
            ring.step(erasing);
        }
        let operations = ring.flash_mut().model_mut().operations.clone();
        assert!(operations.len() >= 6);
        let erases = operations
            .iter()
            .any(|it| matches!(it, Operation::Erase(_)));
        if number % nth != 0 && !(erases && number > 100 && number < 130) {
            continue;
        }
        for (index, operation) in operations.into_iter().enumerate() {
            erasures += usize::from(matches!(operation, Operation::Erase(_)));
            for (which, way) in operation.cuts().into_iter().enumerate() {
                let mut cut_ring = RecordRing::clone(&before);
                cut(&mut cut_ring, index, way, which as u64);
                let is_written = write(&mut cut_ring, number, erasing);
                for _ in 0..20 {
                    cut_ring.step(erasing);
                }
                cuts += 1;
                // The last word may be whole though its write was cut.
                let last = if is_written { number + 1 } else { number };
                let unsure: &[u32] = if is_written { &[] } else { &[number] };
                let flash = started(cut_ring);
                let Some(last) = last.checked_sub(1) else {
                    continue;
                };
                let mut again = start_twice(&flash, last, least_kept(last), unsure);
                let unsure = [unsure, &[1000]].concat();
                if cuts % 11 == 0 {
                    second_cuts += cut_again(&again, last, &unsure);
                }
                // With a good supply it goes on.
                for next in 2000..2003 {
                    assert!(write(&mut again, next, Erasing::AtNeed));
                }
                check_written_once(&mut again);
                let found = entries(&mut open(started(again)));
                assert_eq!(found[..3], [2002, 2001, 2000]);
                let rest = found[3..].iter().filter(|old| !unsure.contains(old));
                let rest: Vec<u32> = rest.copied().collect();
                let expected: Vec<u32> = (0..=last).rev().take(rest.len()).collect();
                assert_eq!(rest, expected);
            }
        }
    }
    [cuts, second_cuts, erasures]
}

#[test]
fn supply_that_fails_twice_loses_no_entry_but_the_one_that_is_written() {
    let [cuts, second_cuts, erasures] = cut_everywhere::<Small>(41);
    assert!(
        cuts > 2000 && second_cuts > 5000 && erasures > 0,
        "{cuts} {second_cuts} {erasures}"
    );
}

#[test]
#[ignore = "minutes; docs/store.md has the command"]
fn supply_that_fails_twice_at_any_word_loses_no_entry_but_the_one_that_is_written() {
    let [cuts, second_cuts, erasures] = cut_everywhere::<Small>(1);
    println!("{cuts} cuts, {second_cuts} second cuts, {erasures} erasures that were cut");
    assert!(cuts > 50_000 && second_cuts > 200_000 && erasures > 10);
}

/// Cuts the next entry at every word, starts twice, and writes another with a good supply.
fn cut_again<F: RingFlash>(ring: &RecordRing<F>, last: u32, unsure: &[u32]) -> usize {
    let mut whole = RecordRing::clone(ring);
    assert!(write(&mut whole, 1000, Erasing::AtNeed));
    let operations = whole.flash_mut().model_mut().operations.clone();
    let mut cuts = 0;
    for (index, operation) in operations.into_iter().enumerate() {
        for way in operation.cuts().into_iter().step_by(5) {
            let mut cut_ring = RecordRing::clone(ring);
            cut(&mut cut_ring, index, way, 0);
            assert!(!write(&mut cut_ring, 1000, Erasing::AtNeed));
            cuts += 1;
            let flash = started(cut_ring);
            let mut again = start_twice(&flash, last, least_kept(last), unsure);
            assert!(write(&mut again, 1001, Erasing::AtNeed));
            check_written_once(&mut again);
            let found = entries(&mut open(started(again)));
            assert_eq!(found[0], 1001);
        }
    }
    cuts
}

/// Checks that no word was written again that did not read as blank.
fn check_written_once<F: RingFlash>(ring: &mut RecordRing<F>) {
    let written_again = ring.flash_mut().model_mut().written_again;
    assert_eq!(written_again, 0, "words that were written a second time");
}

#[test]
#[should_panic(expected = "words that were written a second time")]
fn ring_that_writes_the_last_word_of_an_entry_first_is_caught() {
    cut_everywhere::<LastWordFirst>(41);
}

#[test]
#[should_panic(expected = "other contents than were written")]
fn ring_that_takes_an_entry_without_its_checksum_is_caught() {
    cut_everywhere::<ChecksAssumed>(41);
}

#[test]
fn board_keeps_at_least_3000_entries_while_the_ring_goes_round() {
    let mut ring = open(Large::blank());
    let (mut seen, mut least, mut erasures) = (0, usize::MAX, 0);
    for number in 0..9000 {
        assert!(write(&mut ring, number, Erasing::Ahead));
        while ring.state() == RingState::Erasing {
            ring.step(Erasing::Ahead);
        }
        // It is least after an erasure.
        if ring.erasures() != erasures || number % 1000 == 0 {
            erasures = ring.erasures();
            let found = entries(&mut ring);
            let expected = (0..=number).rev().take(found.len());
            assert!(expected.eq(found.iter().copied()));
            if number > 4000 {
                least = least.min(found.len());
                seen += 1;
            }
        }
    }
    assert!(seen > 10 && erasures > 10, "{seen} {erasures}");
    assert!(least >= 3000, "{least}");
    assert_eq!(ring.capacity(), 3405);
    // The start finds them, too.
    let mut again = open(ring.into_flash().started());
    assert_eq!(entries(&mut again)[..2], [8999, 8998]);
}

#[test]
fn entries_wait_for_an_erasure_that_goes_on_and_nothing_touches_the_flash_meanwhile() {
    let mut flash = Small::blank();
    flash.erasure_looks = 500;
    let mut ring = open(flash);
    let mut longest = 0;
    for number in 0..200 {
        assert!(ring.push(&contents(number)));
        assert!(!ring.push(&contents(number)), "a second one is not taken");
        let mut steps = 0;
        while ring.holds_entry() {
            ring.step(Erasing::AtNeed);
            steps += 1;
            assert!(steps < 600);
        }
        longest = longest.max(steps);
    }
    assert!(longest > 400, "{longest}");
    let found = entries(&mut ring);
    assert_eq!(found[..4], [199, 198, 197, 196]);
}

#[test]
fn loop_of_starts_wears_nothing() {
    let mut ring = open(Small::blank());
    for number in 0..50 {
        assert!(write(&mut ring, number, Erasing::Ahead));
    }
    let mut flash = ring.into_flash().started();
    for _ in 0..1000 {
        flash = open(flash).into_flash();
    }
    assert!(flash.operations.is_empty());
    assert_eq!(entries(&mut open(flash))[0], 49);
}

#[test]
fn any_contents_of_the_flash_are_taken_and_written_over() {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        seed >> 33
    };
    for round in 0..200 {
        let mut flash = Small::blank();
        for sector in &mut flash.sectors {
            *sector = (0..4096 / WORD)
                .map(|_| match (round + random()) % 5 {
                    0 => Cell::Blank,
                    1 => Cell::Failing,
                    2 => Cell::Holding(BLANK),
                    3 => Cell::Unstable(BLANK, core::array::from_fn(|_| random().to_le_bytes()[0])),
                    _ => Cell::Holding(core::array::from_fn(|_| random().to_le_bytes()[0])),
                })
                .collect();
        }
        let mut ring = open(flash);
        assert!(entries(&mut ring).is_empty());
        for number in 0..150 {
            assert!(write(&mut ring, number, Erasing::AtNeed), "{number}");
        }
        let found = entries(&mut open(ring.into_flash().started()));
        assert!(found.len() >= 80);
        assert!(
            found
                .iter()
                .copied()
                .eq((70..150).rev().chain(0..70).take(found.len()))
                || found[..80].iter().copied().eq((70..150).rev())
        );
    }
}

#[test]
fn words_that_take_nothing_cost_their_places_and_a_worn_flash_is_said_to_be_worn() {
    let mut ring = open(Small::blank());
    for number in 0..30 {
        assert!(write(&mut ring, number, Erasing::Ahead));
    }
    // Some words of the sector in use.
    let next = usize::try_from(ring.next() % (RecordRing::<Small>::ENTRIES + 1)).unwrap();
    let cells = &mut ring.flash_mut().sectors[1];
    cells.resize(4096 / WORD, Cell::Blank);
    cells[6 * next + 2] = Cell::Failing;
    cells[6 * (next + 1)] = Cell::Failing;
    for number in 30..33 {
        assert!(write(&mut ring, number, Erasing::Ahead));
    }
    assert_eq!(entries(&mut ring)[..4], [32, 31, 30, 29]);
    for sector in &mut ring.flash_mut().sectors {
        sector.resize(4096 / WORD, Cell::Blank);
        for cell in sector.iter_mut().filter(|cell| **cell == Cell::Blank) {
            *cell = Cell::Failing;
        }
    }
    assert!(!write(&mut ring, 33, Erasing::Never));
    let mut worn = open(ring.into_flash().started());
    assert_eq!(entries(&mut worn)[..4], [32, 31, 30, 29]);
}

#[test]
fn ring_has_whole_sectors_and_at_least_three() {
    let layout = |offset, sectors| {
        let opened = RecordRing::open(Small::blank(), offset, sectors);
        opened.map(|_| ()).err()
    };
    let no_sector = LayoutError::NoSector {
        offset: 100,
        sector: 4096,
    };
    assert_eq!(layout(100, 3), Some(no_sector));
    let no_place = |required| LayoutError::NoPlace {
        required,
        capacity: 6 * 4096,
    };
    assert_eq!(layout(4096, 6), Some(no_place(7 * 4096)));
    assert_eq!(layout(0, 2), Some(no_place(3 * 4096)));
    assert_eq!(layout(4096, 5), None);
}

#[test]
fn sector_that_was_erased_ahead_of_one_that_is_lost_begins_the_ring_anew() {
    let mut ring = open(Small::blank());
    let mut number = 0;
    while ring.erasures() < 2 || ring.state() == RingState::Erasing {
        assert!(write(&mut ring, number, Erasing::Ahead));
        number += 1;
        ring.step(Erasing::Ahead);
    }
    let next = ring.next();
    let sector = RecordRing::<Small>::sector_of(next);
    assert_eq!(sector, 0, "the next sector is blank");
    let flash = ring.into_flash().started();
    let mut whole = open(flash.clone());
    assert_eq!(entries(&mut whole).first(), Some(&(number - 1)));
    let mut lost = flash;
    lost.sectors[0].clear();
    let mut ring = open(lost);
    assert_eq!(RecordRing::<Small>::sector_of(ring.next()), 1);
    assert!(entries(&mut ring).is_empty());
    assert!(write(&mut ring, 7, Erasing::Ahead));
    assert_eq!(entries(&mut ring), [7]);
    let mut again = open(ring.into_flash().started());
    assert_eq!(entries(&mut again), [7]);
}
