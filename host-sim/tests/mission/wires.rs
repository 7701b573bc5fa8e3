//! Flights with receiver and autopilot on wires, whole and with the faults of a wire.

use fmc_camera::flight::frame_record::Outcome;
use fmc_camera::io::instruments::counters::{
    AutopilotCounters, InstrumentCounters, ReceiverCounters,
};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::{fault_scenario, flown, passed};

fn counters(flown: &Flown) -> InstrumentCounters {
    flown.instruments.unwrap()
}

/// Returns the flight of a fault's scenario, which has all its records, and its counters.
fn flown_to_the_end(name: &str) -> (Flown, InstrumentCounters) {
    let (flight, _) = passed(&fault_scenario(name), 1);
    let sequences = flight.frames.iter().map(|frame| frame.record.sequence);
    assert!(sequences.eq(1..=40), "{name}");
    let counters = counters(&flight);
    (flight, counters)
}

/// Returns the receiver's counters if nothing but bytes and sentences was counted.
fn undisturbed_receiver(counters: &ReceiverCounters) -> ReceiverCounters {
    ReceiverCounters {
        bytes: counters.bytes,
        read: counters.read,
        ..ReceiverCounters::NONE
    }
}

/// Returns the autopilot's counters if nothing but bytes and messages was counted.
fn undisturbed_autopilot(counters: &AutopilotCounters) -> AutopilotCounters {
    AutopilotCounters {
        bytes: counters.bytes,
        read: counters.read,
        system: Some(1),
        ..AutopilotCounters::NONE
    }
}

#[test]
fn every_sentence_and_message_of_the_nominal_mission_is_read() {
    let scenario = MissionScenario::nominal(Some(20)).unwrap();
    let (flight, _) = passed(&scenario, 1);
    let counters = counters(&flight);
    assert_eq!(counters.receiver, undisturbed_receiver(&counters.receiver));
    assert_eq!(
        counters.autopilot,
        undisturbed_autopilot(&counters.autopilot)
    );
    assert_eq!(counters.crowded_out, 0);
    // Ten speeds and one time a second; the last may be on its way.
    let sent = flight.sentences.sent;
    assert!(sent - counters.receiver.read <= 2, "{counters:?}");
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some seconds"
    )]
    let seconds = flight.duration_s as u32;
    assert!(counters.receiver.read + 2 >= 11 * seconds);
    // Ten heights, fifty tracks and fifty attitudes a second.
    assert!(counters.autopilot.read + 5 >= 110 * seconds);
    let has_utc = |outcome: &Outcome| match outcome {
        Outcome::Exposed(exposed) => exposed.centroid_utc.is_some(),
        Outcome::Refused(_) => false,
    };
    let frames = flight.frames.iter();
    // The third time that names a pulse comes 2.4 s after the start.
    assert_eq!(
        frames
            .filter(|frame| !has_utc(&frame.record.outcome))
            .count(),
        1
    );
}

#[test]
fn fault_of_the_receivers_wire_leaves_the_autopilots_and_the_records_as_they_are() {
    let whole = flown(&without_fault("receiver-cut"), 1);
    let whole = counters(&whole).autopilot;
    for name in ["receiver-cut", "receiver-flood", "receiver-baud"] {
        let (flight, found) = flown_to_the_end(name);
        let undisturbed = undisturbed_autopilot(&found.autopilot);
        assert_eq!(found.autopilot, undisturbed, "{name}");
        assert_eq!(found.autopilot, whole, "{name}");
        let receiver = found.receiver;
        match name {
            "receiver-cut" => {
                assert!(flight.sentences.lost_bytes > 5000, "{:?}", flight.sentences);
                assert!(receiver.truncated <= 1);
            }
            "receiver-flood" => {
                assert_eq!(receiver.bytes - receiver.flooded_bytes, taken(&receiver));
                assert!(receiver.flooded_bytes > 600_000, "{receiver:?}");
            }
            _ => assert!(receiver.unexplained_bytes > 4000, "{receiver:?}"),
        }
    }
}

/// Bytes that were taken from the wire of a flood: at most those that its rounds may take.
fn taken(counters: &ReceiverCounters) -> u32 {
    let taken = counters.bytes - counters.flooded_bytes;
    // 8 s of 16 bytes per ms, and 14 s of 500 bytes per s.
    assert!(
        taken > 120_000 && taken < 8000 * 16 + 64 + 14_000,
        "{counters:?}"
    );
    taken
}

#[test]
fn fault_of_the_autopilots_wire_leaves_the_receivers_and_the_records_as_they_are() {
    let whole = flown(&without_fault("autopilot-cut"), 1);
    let InstrumentCounters {
        receiver: whole,
        autopilot: whole_autopilot,
        ..
    } = counters(&whole);
    for name in ["autopilot-cut", "autopilot-flood", "autopilot-baud"] {
        let (_, found) = flown_to_the_end(name);
        let undisturbed = undisturbed_receiver(&found.receiver);
        assert_eq!(found.receiver, undisturbed, "{name}");
        assert_eq!(found.receiver, whole, "{name}");
        let autopilot = found.autopilot;
        match name {
            // 110 messages a second for nine seconds.
            "autopilot-cut" => assert!(
                whole_autopilot.read.abs_diff(autopilot.read + 990) < 5,
                "{autopilot:?}"
            ),
            "autopilot-flood" => assert!(autopilot.flooded_bytes > 700_000, "{autopilot:?}"),
            _ => assert!(autopilot.unexplained_bytes > 10_000, "{autopilot:?}"),
        }
    }
}

fn without_fault(name: &str) -> MissionScenario {
    let mut scenario = fault_scenario(name);
    scenario.faults.clear();
    scenario
}
