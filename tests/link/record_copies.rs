//! Two copies of a record in memory, as a reset between their writings leaves them.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::frame_record::{Outcome, Reason};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::message::{Answer, ResetCause};

use crate::link::in_flight::Flight;
use crate::link::resets::{all_records, armed, expose, of_words};

#[test]
fn reset_between_two_copies_of_a_record_leaves_the_newer_one_wherever_it_lies() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    for _ in 0..2 {
        expose(&mut flight);
    }
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    // Places in front of that of the record under way become free.
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(1));
    let mut before = memory.words();
    while all_records(&mut flight).is_empty() {
        before = memory.words();
        flight.round(None);
    }
    let finished = all_records(&mut flight);
    let after = memory.words();
    let changed = (0..after.len()).filter(|at| before[*at] != after[*at]);
    let changed: Vec<usize> = changed.collect();
    let mut whole = 0;
    for parts in 0..=changed.len() {
        let mut words = before;
        for at in &changed[..parts] {
            words[*at] = after[*at];
        }
        let mut flight = Flight::after_reset(ResetCause::Watchdog, of_words(&words));
        let found = all_records(&mut flight);
        assert_eq!((found.len(), found[0].sequence), (1, 3), "{parts}");
        whole += usize::from(found == finished);
        let is_unfinished = found[0].outcome == Outcome::Refused(Reason::Unusable);
        assert!(found == finished || is_unfinished, "{parts}: {found:?}");
        // Once the newer copy is whole it is the one that counts.
        assert!(whole == 0 || found == finished, "{parts}");
    }
    assert!(whole > 1, "{whole} of {}", changed.len());
}
