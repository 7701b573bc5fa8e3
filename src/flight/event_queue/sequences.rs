//! All short sequences of arrivals and rounds, against a slow queue.

use std::vec::Vec;

use super::{EventQueue, Full};
use crate::flight::control_loop::MAX_EVENTS;
use crate::flight::event::{Command, Event, ShutterEdge};
use crate::flight::time::Time;

const NOW: Time = Time::from_us(1000);

/// Number of arrivals and rounds in a sequence.
const LENGTH: usize = 6;

/// Arrivals: time, µs, event, and the places that its kind has. Kinds differ in their events.
const ARRIVALS: [(u64, Event, usize); 6] = [
    (2, Event::Trigger, 4),
    (0, Event::Trigger, 4),
    (1, Event::Shutter(ShutterEdge::Opened), 4),
    (1, Event::Command(Command::Referenced), 4),
    (2, Event::Command(Command::Disarm), 4),
    (1, Event::TimePulse, 2),
];

/// A queue that sorts at every round.
#[derive(Debug, Clone, Default)]
struct Slow {
    /// In the order of their arrival.
    waiting: Vec<(Time, Event)>,
    lost: u32,
}

impl Slow {
    fn offer(&mut self, time: Time, event: Event, places: usize) -> Result<(), Full> {
        let kind = |event: &Event| std::mem::discriminant(event);
        let alike = |(_, other): &&(Time, Event)| kind(other) == kind(&event);
        if self.waiting.iter().filter(alike).count() == places {
            return Err(Full);
        }
        self.waiting.push((time, event));
        Ok(())
    }

    fn take(&mut self) -> Vec<(Time, Event)> {
        self.waiting.sort_by_key(|(time, _)| *time);
        let room = MAX_EVENTS - usize::from(self.lost > 0);
        let is_reference = |event: &Event| *event == Event::Command(Command::Referenced);
        let mut events = self.waiting.iter().take(room).enumerate();
        let end = events.find(|(index, (_, event))| *index > 0 && is_reference(event));
        let end = end.map_or(room.min(self.waiting.len()), |(index, _)| index);
        let mut batch: Vec<_> = self.waiting.drain(..end).collect();
        if self.lost > 0 {
            batch.push((NOW, Event::Lost(self.lost)));
            self.lost = 0;
        }
        batch
    }
}

/// Tries every sequence of so many arrivals and rounds from here; returns how many there are.
fn try_all(queue: &EventQueue, slow: &Slow, left: usize) -> u32 {
    if left == 0 {
        let (mut queue, mut slow) = (queue.clone(), slow.clone());
        while !slow.waiting.is_empty() {
            assert_eq!(queue.take(NOW).as_slice(), slow.take());
        }
        // Losses are told with the next events.
        assert!(queue.take(NOW).is_empty() && slow.lost == 0);
        return 1;
    }
    let mut sequences = 0;
    for (index, (us, event, places)) in ARRIVALS.into_iter().enumerate() {
        let (mut queue, mut slow) = (queue.clone(), slow.clone());
        let time = Time::from_us(us);
        let is_taken = slow.offer(time, event, places);
        if index % 2 == 0 {
            queue.push(time, event);
            slow.lost += u32::from(is_taken.is_err());
        } else {
            assert_eq!(queue.offer(time, event), is_taken);
        }
        sequences += try_all(&queue, &slow, left - 1);
    }
    let (mut queue, mut slow) = (queue.clone(), slow.clone());
    assert_eq!(queue.take(NOW).as_slice(), slow.take());
    sequences + try_all(&queue, &slow, left - 1)
}

#[test]
fn every_short_sequence_of_arrivals_and_rounds_is_handed_over_as_by_a_slow_queue() {
    // From an empty queue, and from one in which most places are taken.
    let mut full = (EventQueue::new(), Slow::default());
    for (us, event, places) in [0, 0, 0, 2, 2, 2, 4, 5].map(|index| ARRIVALS[index]) {
        full.0.push(Time::from_us(us), event);
        full.1.offer(Time::from_us(us), event, places).unwrap();
    }
    let sequences: u32 = [(EventQueue::new(), Slow::default()), full]
        .iter()
        .map(|(queue, slow)| try_all(queue, slow, LENGTH))
        .sum();
    // docs/models.md has this number.
    assert_eq!(sequences, 235_298);
}
