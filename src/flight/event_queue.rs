//! Queue of the events that wait for the control loop.

use heapless::Vec;

use super::control_loop::{Events, MAX_EVENTS};
use super::event::{Command, Event, ShutterEdge};
use super::time::Time;

/// Places for all kinds of events together.
const CAPACITY: usize = {
    let mut places = 0;
    let mut kinds = Kind::ALL.as_slice();
    while let Some((kind, rest)) = kinds.split_first() {
        places += kind.places();
        kinds = rest;
    }
    places
};

/// Events that share places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Opened,
    Closed,
    Trigger,
    TimePulse,
    LimitSwitch,
    Drive,
    Supply,
    Command,
    Vh,
    Attitude,
    GnssTime,
}

impl Kind {
    const ALL: [Self; 11] = [
        Self::Opened,
        Self::Closed,
        Self::Trigger,
        Self::TimePulse,
        Self::LimitSwitch,
        Self::Drive,
        Self::Supply,
        Self::Command,
        Self::Vh,
        Self::Attitude,
        Self::GnssTime,
    ];

    const fn places(self) -> usize {
        match self {
            Self::Opened | Self::Closed | Self::Trigger | Self::Command | Self::Vh => 4,
            _ => 2,
        }
    }

    /// Returns the kind of an event; `None` for those that the control loop makes itself.
    const fn of(event: &Event) -> Option<Self> {
        Some(match event {
            Event::Shutter(ShutterEdge::Opened) => Self::Opened,
            Event::Shutter(ShutterEdge::Closed) => Self::Closed,
            Event::Trigger => Self::Trigger,
            Event::TimePulse => Self::TimePulse,
            Event::LimitSwitch => Self::LimitSwitch,
            Event::Drive(_) => Self::Drive,
            Event::Supply(_) => Self::Supply,
            Event::Command(_) => Self::Command,
            Event::Vh(_) => Self::Vh,
            Event::Attitude(_) => Self::Attitude,
            Event::GnssTime(_) => Self::GnssTime,
            Event::Stage(_)
            | Event::IndexMark(_)
            | Event::Latched(_)
            | Event::Tick
            | Event::Lost(_) => return None,
        })
    }
}

/// The error that an event finds no place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Full;

/// Events that wait for the control loop, in order of their times, whatever the order in which they
/// came.
///
/// Every kind of event has separate places, so that a trigger line that bounces, or a PC that sends
/// too much, keeps out events of its own kind alone, and never an edge of the shutter. Of one kind
/// the first are kept, since a contact that bounces makes its true edge first. The others are
/// counted, and the control loop gets the number as [`Event::Lost`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EventQueue {
    waiting: Vec<(Time, Event), CAPACITY>,
    lost: u32,
}

impl EventQueue {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            waiting: Vec::new(),
            lost: 0,
        }
    }

    /// Adds an event whose sender can be told that there is no place.
    ///
    /// # Errors
    /// [`Full`] if there is no place; the event is not counted as lost. [`Event::Stage`],
    /// [`Event::IndexMark`], [`Event::Latched`], [`Event::Tick`] and [`Event::Lost`], which the
    /// control loop makes itself, have no place.
    pub(crate) fn offer(&mut self, time: Time, event: Event) -> Result<(), Full> {
        let kind = Kind::of(&event).ok_or(Full)?;
        let alike = self
            .waiting
            .iter()
            .filter(|(_, waiting)| Kind::of(waiting) == Some(kind));
        if alike.count() >= kind.places() {
            return Err(Full);
        }
        let mut carried = (time, event);
        let mut is_in_place = false;
        for place in &mut self.waiting {
            // Events of one time stay in the order in which they came.
            is_in_place |= place.0 > time;
            if is_in_place {
                core::mem::swap(place, &mut carried);
            }
        }
        self.waiting.push(carried).map_err(|_| Full)
    }

    /// Adds an event whose sender cannot wait; without a place it is counted as lost.
    pub fn push(&mut self, time: Time, event: Event) {
        if self.offer(time, event).is_err() {
            self.count_lost(1);
        }
    }

    /// Counts events that were lost before they came here.
    pub const fn count_lost(&mut self, events: u32) {
        self.lost = self.lost.saturating_add(events);
    }

    /// Takes the oldest events for a round of the control loop at `now`; the rest stays for the
    /// next. The number of lost events comes last.
    ///
    /// [`Command::Referenced`] is the first of a batch or not in it: the drive's zero has to be set
    /// before the command is obeyed, in the state that the previous round has left.
    pub fn take(&mut self, now: Time) -> Events {
        let mut batch = Events::new();
        let lost = core::mem::take(&mut self.lost);
        let most = MAX_EVENTS.saturating_sub(usize::from(lost > 0));
        if !self.waiting.is_empty() {
            let mut later = Vec::new();
            for waiting in &self.waiting {
                let begins = waiting.1 == Event::Command(Command::Referenced);
                let goes = later.is_empty() && batch.len() < most && (batch.is_empty() || !begins);
                // There is room in both.
                if goes {
                    let _ = batch.push(*waiting);
                } else {
                    let _ = later.push(*waiting);
                }
            }
            self.waiting = later;
        }
        if lost > 0 {
            let _ = batch.push((now, Event::Lost(lost)));
        }
        batch
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::new();
    }
}

#[cfg(test)]
mod sequences;
#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::control_loop::MAX_ROUND_ACTIONS;
    use crate::flight::controller::timing::{LATE_EVENT_S, TICK_S};
    use crate::flight::event::{AttitudeSample, Supply};
    use crate::flight::fault::Fault;
    use crate::flight::vh::VhSample;

    fn at(us: u64) -> Time {
        Time::from_us(us)
    }

    const OPENED: Event = Event::Shutter(ShutterEdge::Opened);
    const CLOSED: Event = Event::Shutter(ShutterEdge::Closed);
    const NOW: Time = Time::from_us(1000);

    #[test]
    fn events_come_out_in_order_of_time_and_those_of_one_time_as_they_came() {
        let mut queue = EventQueue::new();
        queue.push(at(300), Event::Trigger);
        queue.push(at(100), OPENED);
        queue.push(at(300), Event::TimePulse);
        queue.push(at(200), CLOSED);
        queue.push(at(300), Event::LimitSwitch);
        let expected = [
            (at(100), OPENED),
            (at(200), CLOSED),
            (at(300), Event::Trigger),
            (at(300), Event::TimePulse),
            (at(300), Event::LimitSwitch),
        ];
        assert_eq!(queue.take(NOW).as_slice(), expected);
        assert!(queue.take(NOW).is_empty());
    }

    #[test]
    fn bounces_of_the_trigger_and_a_flood_of_messages_keep_out_no_edge_of_the_shutter() {
        let mut queue = EventQueue::new();
        for bounce in 0..50 {
            queue.push(at(bounce), Event::Trigger);
            queue.push(at(bounce), Event::TimePulse);
            let told = queue.offer(at(bounce), Event::Vh(VhSample::Direct(0.1)));
            assert_eq!(told.is_err(), bounce >= 4);
        }
        queue.push(at(60), OPENED);
        queue.push(at(70), CLOSED);
        queue.push(at(80), Event::Supply(Supply::Low));
        let mut handed = std::vec::Vec::new();
        for _ in 0..4 {
            handed.extend(queue.take(NOW));
        }
        let lost: u32 = handed
            .iter()
            .map(|(_, event)| match event {
                Event::Lost(events) => *events,
                _ => 0,
            })
            .sum();
        // 50 triggers in 4 places, 50 pulses in 2; no message is lost, as all were refused.
        assert_eq!(lost, 46 + 48);
        for kept in [OPENED, CLOSED, Event::Supply(Supply::Low)] {
            assert!(handed.iter().any(|(_, event)| *event == kept), "{kept:?}");
        }
        // The first edge of a line that bounces is its true one.
        assert_eq!(handed.first(), Some(&(at(0), Event::Trigger)));
        assert!(queue.take(NOW).is_empty());
    }

    #[test]
    fn bouncing_opening_keeps_out_no_closing() {
        let mut queue = EventQueue::new();
        for bounce in 0..20 {
            queue.push(at(bounce), OPENED);
        }
        queue.push(at(500), CLOSED);
        let handed = queue.take(NOW);
        assert_eq!(handed.len(), MAX_EVENTS);
        assert_eq!(handed.first(), Some(&(at(0), OPENED)));
        assert!(handed.contains(&(at(500), CLOSED)));
        assert_eq!(handed.last(), Some(&(NOW, Event::Lost(16))));
    }

    #[test]
    fn round_takes_as_many_as_it_may_and_the_next_the_rest() {
        let mut queue = EventQueue::new();
        for event in [OPENED, CLOSED, Event::Trigger, Event::TimePulse] {
            queue.push(at(1), event);
            queue.push(at(2), event);
        }
        assert_eq!(queue.take(NOW).len(), MAX_EVENTS);
        assert_eq!(queue.take(NOW).len(), 8 - MAX_EVENTS);
        const { assert!(MAX_ROUND_ACTIONS >= MAX_EVENTS) };
    }

    #[test]
    fn reference_begins_a_round() {
        let referenced = Event::Command(Command::Referenced);
        let mut queue = EventQueue::new();
        for event in [
            Event::Command(Command::Disarm),
            referenced,
            Event::Trigger,
            referenced,
        ] {
            queue.push(at(1), event);
        }
        let rounds: [std::vec::Vec<Event>; 4] =
            [(); 4].map(|()| queue.take(NOW).iter().map(|(_, event)| *event).collect());
        assert_eq!(rounds[0], [Event::Command(Command::Disarm)]);
        assert_eq!(rounds[1], [referenced, Event::Trigger]);
        assert_eq!(rounds[2], [referenced]);
        assert!(rounds[3].is_empty());
    }

    #[test]
    fn what_the_control_loop_makes_itself_is_not_queued() {
        let mut queue = EventQueue::new();
        for event in [Event::Tick, Event::Lost(3)] {
            assert_eq!(queue.offer(NOW, event), Err(Full));
        }
        queue.count_lost(2);
        queue.push(NOW, Event::Trigger);
        queue.clear();
        assert!(queue.take(NOW).is_empty());
    }

    /// An event of each kind.
    fn of_every_kind() -> [Event; 11] {
        let attitude = AttitudeSample {
            pitch_deg: 0.0,
            roll_deg: 0.0,
            drift_deg: 0.0,
            rates_deg_s: [0.0; 3],
        };
        [
            OPENED,
            CLOSED,
            Event::Trigger,
            Event::TimePulse,
            Event::LimitSwitch,
            Event::Drive(Fault::Drive),
            Event::Supply(Supply::Low),
            Event::Command(Command::Referenced),
            Event::Vh(VhSample::Direct(0.1)),
            Event::Attitude(attitude),
            Event::GnssTime(0),
        ]
    }

    #[test]
    fn full_queue_is_handed_over_before_its_events_are_too_old() {
        let mut queue = EventQueue::new();
        // Each kind more often than it has places, and every command one that begins a round.
        for time in 0..5 {
            for event in of_every_kind() {
                queue.push(at(time), event);
            }
        }
        assert_eq!(queue.waiting.len(), CAPACITY);
        let mut rounds = 0_u8;
        while !queue.waiting.is_empty() {
            // One more is lost in every round.
            queue.count_lost(1);
            queue.take(NOW);
            rounds += 1;
        }
        let waited_s = f32::from(rounds) * TICK_S;
        assert!(waited_s <= LATE_EVENT_S, "{rounds} rounds");
    }

    #[test]
    fn whatever_comes_is_handed_over_in_order_refused_or_counted() {
        let arrivals = proptest::collection::vec((0..11_usize, 0..1000_u64, 0..8_u8), 0..200);
        proptest::proptest!(|(arrivals in arrivals)| {
            let mut queue = EventQueue::new();
            let (mut pushed, mut handed, mut lost) = (0, 0, 0);
            let mut take = |queue: &mut EventQueue| {
                let batch = queue.take(NOW);
                assert!(batch.is_sorted_by_key(|(time, _)| *time));
                for (_, event) in &batch {
                    match event {
                        Event::Lost(events) => lost += events,
                        _ => handed += 1,
                    }
                }
            };
            for (kind, time, round) in arrivals {
                queue.push(at(time), of_every_kind()[kind]);
                pushed += 1;
                if round == 0 {
                    take(&mut queue);
                }
            }
            while !queue.waiting.is_empty() || queue.lost > 0 {
                take(&mut queue);
            }
            assert_eq!(pushed, handed + lost);
        });
    }
}
