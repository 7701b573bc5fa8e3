//! What the aircraft's instruments say: V/H, time and attitude.

use super::timing::ATTITUDE_WITHIN_S;
use crate::flight::event::AttitudeSample;
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;
use crate::flight::utc::UtcClock;
use crate::flight::vh::{VhMonitor, VhSample};

/// What the aircraft's instruments say.
#[derive(Debug, Clone)]
pub(super) struct Aircraft {
    pub(super) vh: VhMonitor,
    pub(super) utc: UtcClock,
    attitude: Option<(Time, AttitudeSample)>,
}

/// What an instrument says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Said {
    Vh(VhSample),
    Attitude(AttitudeSample),
    TimePulse,
    /// µs since 1970, UTC.
    GnssTime(u64),
}

impl Aircraft {
    /// Nothing has been said yet.
    #[inline]
    pub(super) const fn new(settings: &FlightSettings) -> Self {
        Self {
            vh: VhMonitor::new(settings.vh),
            utc: UtcClock::new(settings.time_pulse_sigma_s),
            attitude: None,
        }
    }

    /// An instrument says something.
    pub(super) fn hear(&mut self, time: Time, said: Said) {
        match said {
            Said::Vh(sample) => {
                self.vh.observe(time, sample);
            }
            Said::Attitude(sample) => self.attitude = Some((time, sample)),
            Said::TimePulse => {
                self.utc.pulse(time);
            }
            Said::GnssTime(unix_us) => {
                self.utc.receiver_time(time, unix_us);
            }
        }
    }

    /// The attitude at a time; `None` where the last is too far from it.
    pub(super) fn attitude_at(&self, time: Time) -> Option<&AttitudeSample> {
        self.attitude.as_ref().and_then(|(heard, sample)| {
            let apart_s = libm::fabsf(time.seconds_since(*heard));
            (apart_s <= ATTITUDE_WITHIN_S).then_some(sample)
        })
    }
}
