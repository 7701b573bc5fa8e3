//! Second look at the speed of the stage, before the shutter is told to open.

use super::StageMachine;
use crate::flight::controller::setup::Setup;
use crate::flight::controller::timing::LATE_TICK_S;
use crate::flight::slope::VALUES;
use crate::flight::stage::Setpoint;
use crate::flight::stage_track::StagePlace;
use crate::flight::time::Time;

/// Change of the following error by which the second look is wider than the first: it takes two
/// readings where the first takes four, and must not refuse what that has allowed.
const WIDER: f32 = 2.0;

/// Distance by which the stage may stray between two readings however long the exposure is, mm: one
/// that shakes by 0.5 µm at 430 Hz strays by 0.98 µm.
const STRAYS_MM: f32 = 0.002;

/// Longest time since the first of its readings, s: their times may be wrong, too.
#[expect(clippy::cast_precision_loss, reason = "a few readings")]
const LONGEST_S: f32 = VALUES as f32 * LATE_TICK_S;

impl StageMachine {
    /// Returns `true` if the stage has moved as its set point since the reading [`VALUES`] - 1
    /// before the last, and since the one before the last, as far as an exposure, s, allows. A
    /// stage that has been slow and is fast has moved far enough, too, and is not at speed; nor is
    /// one whose last reading is in doubt.
    ///
    /// It says what [`Self::is_steady`] says, from places that are kept elsewhere and by another
    /// way: a processor that leaves out an instruction of either does not open the shutter over a
    /// stage that is not at speed.
    #[inline(never)]
    pub(in super::super) fn moves_as_set(&self, setup: &Setup, now: Time, exposure_s: f32) -> bool {
        if !setup.camera.has_stage() || self.is_place_lost {
            return true;
        }
        if self.suspicious.is_some() {
            return false;
        }
        let mut readings = self.track.readings();
        let (Some(last), Some(middle), Some(before)) = (
            readings.next_back(),
            readings.next_back(),
            readings.nth_back(VALUES - 3),
        ) else {
            return false;
        };
        // A stage without force is to stand.
        let (set, set_middle, set_before) = (
            self.setpoint(last.time).unwrap_or_default(),
            self.setpoint(middle.time).unwrap_or_default(),
            self.setpoint(before.time).unwrap_or_default(),
        );
        let travel_mm = set.speed_mm_s * exposure_s;
        let allowed_mm = WIDER * setup.allowed_change_mm(travel_mm, exposure_s);
        let strays_mm = STRAYS_MM + 1e-3 * setup.settings.drive.coarseness_um();
        let is_as_set = |then: &StagePlace, then_set: Setpoint, strays_mm: f32| {
            let moved_mm = last.offset_mm - then.offset_mm;
            let off_mm = libm::fabsf(moved_mm - (set.offset_mm - then_set.offset_mm));
            let elapsed_s = last.time.seconds_since(then.time);
            0.0 < elapsed_s
                && (off_mm * exposure_s <= allowed_mm * elapsed_s || off_mm <= strays_mm)
        };
        let [old_s, elapsed_s] = [now, last.time].map(|time| time.seconds_since(before.time));
        elapsed_s <= old_s
            && old_s <= LONGEST_S
            && is_as_set(before, set_before, 0.0)
            && is_as_set(middle, set_middle, strays_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::controller::Start;
    use crate::flight::controller::stage::Seen;
    use crate::flight::drive::StageReading;
    use crate::flight::prepared_camera::PreparedCamera;
    use crate::flight::settings::FlightSettings;
    use crate::flight::stage_track::PlaceReading;
    use crate::flight::stage_watch::ReadingVerdict;
    use crate::{CalibrationParameters, Camera, CameraParameters};

    const EXPOSURE_S: f32 = 0.004;

    /// Returns what the second look says, 20 ms after the stage has begun a way of 1 mm. `time_s`
    /// makes the times of the readings of the true ones, s, and `moved` their moves of those of
    /// the set point, mm.
    fn look(time_s: impl Fn(f32) -> f32, moved: impl Fn(f32) -> f32) -> bool {
        look_before(0.0, time_s, moved)
    }

    /// Returns what it says about a command that is to leave after a time, s.
    fn look_before(leaves_s: f32, time_s: impl Fn(f32) -> f32, moved: impl Fn(f32) -> f32) -> bool {
        look_at(leaves_s, time_s, moved, None)
    }

    /// Returns what it says about a stage that moves as set, with a last reading in doubt or none.
    fn look_in_doubt(suspicious: Option<(StageReading, Seen)>) -> bool {
        look_at(0.0, |s| s, |mm| mm, suspicious)
    }

    fn look_at(
        leaves_s: f32,
        time_s: impl Fn(f32) -> f32,
        moved: impl Fn(f32) -> f32,
        suspicious: Option<(StageReading, Seen)>,
    ) -> bool {
        let parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
        let camera = Camera::new(CameraParameters::new(parameters)).unwrap();
        let settings = FlightSettings::default();
        let mut prepared = PreparedCamera::new(camera, &settings, Start::Orderly).unwrap();
        let (setup, controller) = prepared.flown();
        let (stage, began) = (&mut controller.stage, Time::from_us(1_000_000));
        assert!(stage.go_to(&setup, began, 1.0));
        let first = began.plus_s(0.02);
        let first_mm = stage.setpoint(first).unwrap().offset_mm;
        for round in 0..VALUES {
            let true_s = 1e-3 * f32::from(u8::try_from(round).unwrap());
            let set_mm = stage.setpoint(first.plus_s(true_s)).unwrap().offset_mm;
            stage.track.push(StagePlace {
                time: first.plus_s(time_s(true_s)),
                offset_mm: first_mm + moved(set_mm - first_mm),
                reading: PlaceReading::of_round(0.0),
            });
        }
        let now = first.plus_s(1e-3 * f32::from(u8::try_from(VALUES - 1).unwrap()));
        controller.stage.suspicious = suspicious;
        controller.may_open(&setup, now, (now.plus_s(leaves_s), EXPOSURE_S))
    }

    #[test]
    fn stage_that_moves_as_set_passes_and_one_that_is_slow_or_fast_or_stands_does_not() {
        assert!(look(|s| s, |mm| mm));
        for part in [0.0, 0.6, 1.4, -1.0, f32::NAN] {
            assert!(!look(|s| s, |mm| part * mm), "{part}");
        }
    }

    #[test]
    fn stage_that_is_fast_after_it_was_slow_does_not_pass_and_one_that_shakes_does() {
        // The set point has moved 0.04 mm at the last reading but one, and 0.06 mm at the last.
        let behind = |behind_mm: f32| {
            let is_behind = |mm: f32| (0.03..0.05).contains(&mm);
            look(|s| s, |mm| if is_behind(mm) { mm - behind_mm } else { mm })
        };
        assert!(behind(0.001));
        assert!(behind(-0.001));
        assert!(!behind(0.006));
        assert!(!behind(-0.006));
    }

    #[test]
    fn stage_whose_last_reading_is_in_doubt_does_not_pass() {
        let doubt = StageReading {
            time: Time::START,
            offset_mm: 0.0,
        };
        let seen = Seen {
            verdict: ReadingVerdict::Suspicious,
            error_mm: 0.0,
        };
        assert!(look_in_doubt(None));
        assert!(!look_in_doubt(Some((doubt, seen))));
    }

    #[test]
    fn command_is_given_in_the_last_round_before_it_leaves_and_no_earlier() {
        assert!(look_before(0.001, |s| s, |mm| mm));
        assert!(!look_before(0.0011, |s| s, |mm| mm));
        assert!(!look_before(0.002, |s| s, |mm| mm));
    }

    #[test]
    fn readings_whose_times_are_wrong_do_not_pass() {
        for factor in [1e3, 3.0, 1.5, 0.3] {
            assert!(!look(|s| factor * s, |mm| mm), "{factor}");
        }
        // Readings of 20 ms ago.
        assert!(!look(|s| s - 0.02, |mm| mm));
        assert!(!look(|_| 0.0, |mm| mm));
    }
}
