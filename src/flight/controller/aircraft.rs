//! The aircraft's instruments: their samples of V/H, time and attitude, and the findings of them.

use super::timing::ATTITUDE_WITHIN_S;
use crate::flight::event::AttitudeSample;
use crate::flight::findings::Findings;
use crate::flight::flag::{Flag, Flags};
use crate::flight::settings::FlightSettings;
use crate::flight::smear_prediction::AircraftMotion;
use crate::flight::time::Time;
use crate::flight::utc::{UtcClock, UtcFinding};
use crate::flight::vh::{VhChannel, VhFinding, VhFindingKind, VhMonitor, VhSample, VhSettings};

/// Samples and findings of the aircraft's instruments.
#[derive(Debug, Clone)]
pub(super) struct Aircraft {
    pub(super) vh: VhMonitor,
    pub(super) utc: UtcClock,
    /// The last attitude without a finding.
    attitude: Option<(Time, AttitudeSample)>,
    /// Mean square of the change of all three attitude rates from sample to sample, (°/s)².
    rate_change: f32,
    findings: Findings,
    /// The last finding, and the time of the sample of which it was made.
    last_finding: Option<(Time, Flag)>,
    /// Findings since the last record, or of the last sample of a source.
    found: Flags,
    /// Findings of the last sample of each source: of each [`VhChannel`], of pulse, time and
    /// attitude.
    last: [Flags; SOURCES],
}

const PULSE: usize = VhChannel::ALL.len();
const TIME: usize = PULSE + 1;
const ATTITUDE: usize = TIME + 1;
const SOURCES: usize = ATTITUDE + 1;

/// Number of attitudes over which the change of the rates is averaged.
const AVERAGED_ATTITUDES: f32 = 16.0;

/// A sample of an instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Said {
    Vh(VhSample),
    Attitude(AttitudeSample),
    TimePulse,
    /// µs since 1970, UTC.
    GnssTime(u64),
}

impl Aircraft {
    /// Returns the state before the first sample.
    #[inline]
    pub(super) const fn new(
        vh: VhSettings,
        time_pulse_sigma_s: f32,
        rate_sigma_deg_s: f32,
        limits_per_s: [f32; 2],
    ) -> Self {
        Self {
            vh: VhMonitor::new(vh).with_limits(limits_per_s),
            utc: UtcClock::new(time_pulse_sigma_s),
            attitude: None,
            rate_change: 3.0 * rate_sigma_deg_s * rate_sigma_deg_s,
            findings: Findings::NONE,
            last_finding: None,
            found: Flags::NONE,
            last: [Flags::NONE; SOURCES],
        }
    }

    /// Takes a sample of an instrument.
    pub(super) fn hear(&mut self, time: Time, said: Said) {
        match said {
            Said::Vh(sample) => {
                let (channel, _) = VhChannel::of(sample);
                let was_unconfirmed = self.vh.is_unconfirmed();
                let finding = self.vh.observe(time, sample);
                self.pass(channel as usize);
                if let Some(VhFinding { channel, kind, .. }) = finding {
                    let flag = Flag::of_vh(kind);
                    self.find(channel as usize, time, flag, 1);
                    if kind == VhFindingKind::Disagreement {
                        // A disagreement holds until the sources agree, whatever comes from this
                        // one.
                        self.pass(channel as usize);
                    }
                }
                if self.vh.is_unconfirmed() && !was_unconfirmed {
                    self.note(time, Flag::VhUnconfirmed, 1);
                }
            }
            Said::Attitude(sample) => {
                let finding = sample.finding();
                if let Some((_, before)) = self.attitude
                    && finding.is_none()
                {
                    let change = change_of_rates(&before, &sample);
                    self.rate_change += (change - self.rate_change) / AVERAGED_ATTITUDES;
                }
                // One that cannot be used leaves the last good one in use while that is valid.
                if finding.is_none() {
                    self.attitude = Some((time, sample));
                }
                self.find(ATTITUDE, time, finding.map(Flag::of_attitude), 1);
            }
            Said::TimePulse => {
                let finding = self.utc.pulse(time);
                let times = match finding {
                    Some(UtcFinding::MissingPulses(pulses)) => pulses,
                    _ => 1,
                };
                self.find(PULSE, time, finding.map(Flag::of_utc), times);
            }
            Said::GnssTime(unix_us) => {
                let finding = self.utc.receiver_time(time, unix_us);
                self.find(TIME, time, finding.map(Flag::of_utc), 1);
            }
        }
    }

    /// Returns the aircraft's motion at a time, as far as it is known.
    ///
    /// # Model
    /// The rates of the last attitude are as uncertain as the next attitude's differ from them.
    /// Without an attitude the settings state what the mount leaves.
    pub(super) fn motion_at(&mut self, time: Time, settings: &FlightSettings) -> AircraftMotion {
        let attitude = self.attitude_at(time);
        let [attitude_sigma_deg, rate_variance] = if attitude.is_some() {
            [0.0, self.rate_change]
        } else {
            let rate = settings.rate_sigma_deg_s;
            [settings.attitude_sigma_deg, 3.0 * rate * rate]
        };
        AircraftMotion {
            attitude,
            attitude_sigma_deg,
            rate_sigma_deg_s: fmc_camera_kernel::sqrt(rate_variance),
            vh_relative_variance: self.vh.relative_variance(),
        }
    }

    /// Returns the attitude at a time; `None`, and a finding, if the last one is too far from it.
    fn attitude_at(&mut self, time: Time) -> Option<AttitudeSample> {
        let (heard, sample) = self.attitude?;
        if libm::fabsf(time.seconds_since(heard)) <= ATTITUDE_WITHIN_S {
            return Some(sample);
        }
        self.note(time, Flag::AttitudeSilent, 1);
        None
    }

    /// Returns the findings for a record: those since the last record, or of the last sample of a
    /// source.
    pub(super) fn tell(&mut self) -> Flags {
        let told = self.found;
        if !told.is_empty() {
            self.found = self.still_found();
        }
        told
    }

    /// Trusts the instruments as they are now, for the operator.
    pub(super) const fn clear_doubt(&mut self) {
        self.utc.clear_doubt();
        self.vh.clear_doubt();
    }

    /// Forgets samples and pulses after a jump of the clock: their times cannot be compared with
    /// later ones. Findings and doubts about UTC stay.
    pub(super) const fn restart_clock(&mut self) {
        self.vh.clear();
        self.utc.forget_pulses();
        self.attitude = None;
    }

    /// Counts of the findings.
    pub(super) const fn findings(&self) -> &Findings {
        &self.findings
    }

    /// The last finding, and the time of the sample of which it was made.
    pub(super) const fn last_finding(&self) -> Option<(Time, Flag)> {
        self.last_finding
    }

    /// Notes the finding of the last sample of a source: the flag and its count, or none.
    fn find(&mut self, source: usize, time: Time, flag: Option<Flag>, times: u32) {
        self.pass(source);
        let Some(flag) = flag else {
            return;
        };
        self.note(time, flag, times);
        if let Some(last) = self.last.get_mut(source) {
            last.insert(flag);
        }
    }

    /// Notes that nothing was found of the last sample of a source.
    fn pass(&mut self, source: usize) {
        if let Some(last) = self.last.get_mut(source) {
            *last = Flags::NONE;
        }
    }

    /// Notes a finding for the next record, and counts it.
    fn note(&mut self, time: Time, flag: Flag, times: u32) {
        self.found.insert(flag);
        self.findings.count(flag, times);
        self.last_finding = Some((time, flag));
    }

    /// Returns the findings that still hold.
    fn still_found(&self) -> Flags {
        let mut found = Flags::NONE;
        for shown in self.last {
            found.insert_all(shown);
        }
        if self.vh.has_disagreed() {
            found.insert(Flag::VhDisagreement);
        }
        if self.vh.is_unconfirmed() {
            found.insert(Flag::VhUnconfirmed);
        }
        let [stepped, moved] = self.utc.has_stepped();
        if stepped {
            found.insert(Flag::UtcStepped);
        }
        if moved {
            found.insert(Flag::UtcPulsesMoved);
        }
        found
    }
}

/// Returns the squared change of all three rates between two attitudes, (°/s)².
fn change_of_rates(before: &AttitudeSample, after: &AttitudeSample) -> f32 {
    before
        .rates_deg_s
        .iter()
        .zip(after.rates_deg_s)
        .map(|(before, after)| (after - before) * (after - before))
        .sum()
}
