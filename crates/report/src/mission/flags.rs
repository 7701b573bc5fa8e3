//! Flags of the frames of a mission: in how many each is, and what it means.

use fmc_camera::flight::frame_record::Flag;

use super::MissionReport;

/// Returns the flags that some frame has, each with the number of its frames.
pub(super) fn counts(report: &MissionReport<'_>) -> Vec<(Flag, usize)> {
    let frames = || report.flown.frames.iter();
    let counts = Flag::ALL.into_iter().map(|flag| {
        let with = frames().filter(|frame| frame.record.flags.contains(flag));
        (flag, with.count())
    });
    counts.filter(|(_, frames)| *frames > 0).collect()
}

/// Returns what a flag tells of, for a column of a table.
pub(super) const fn told_of(flag: Flag) -> &'static str {
    if flag.is_of_instrument() {
        "instrument"
    } else {
        "camera"
    }
}

/// Returns the meaning of a flag, as docs/integration.md, section 7, has it.
pub(super) const fn meaning(flag: Flag) -> &'static str {
    match flag {
        Flag::NoCompensation => "the stage stood still",
        Flag::LastGoodVh => "a source was silent for longer than its period",
        Flag::OffCentre => {
            "the exposure was planned off its place, as the stage came from elsewhere"
        }
        Flag::SmearOverBudget => "predicted smear exceeds smear_budget_px",
        Flag::PlannedMotion => {
            "the motion is the plan's: no encoder to be believed, or the clock has jumped"
        }
        Flag::StaticCorrection => "coordinates are corrected by the static calibration alone",
        Flag::EncoderGlitch => "a single wrong reading was left out",
        Flag::Unreferenced => {
            "the encoder was not compared with the index mark since the last record, or there is no mark; with fault 14 in a record of an exposure: the next crossing has found it wrong; or the next crossing, which would show it, has not come; or both ways across the mark differ from those of arming"
        }
        Flag::ExtrapolatedMotion => {
            "readings are missing, at one end, or between for longer than READING_GAP_S; the path was continued from the others"
        }
        Flag::WithAttitude => "attitude and its rates are in the predicted smear",
        Flag::LastLightAssumed => {
            "last light was not seen, as the shutter was given up or the clock has jumped; closed is as planned"
        }
        Flag::VhNotANumber => "a source of V/H gave a NaN or an infinity",
        Flag::VhOutOfRange => "a source of V/H was outside its range",
        Flag::VhWrongSign => "a source of V/H had the wrong sign",
        Flag::VhFeet => "a height came in feet",
        Flag::VhKnots => "a speed came in knots",
        Flag::VhJump => "a source of V/H went farther than slew_per_s allows",
        Flag::VhFrozen => "a source of V/H gave the same number for longer than frozen_s",
        Flag::VhFromThePast => "a sample of V/H was older than the last of its source",
        Flag::VhDisagreement => {
            "two ways to V/H differ by more than vh.disagreement_percent and by more than their σ explain"
        }
        Flag::UtcMissingPulses => "time pulses did not come",
        Flag::UtcExtraPulse => "a time pulse belonged to no second",
        Flag::UtcPulsesMoved => {
            "CONSISTENT_PULSES came at another place in the second: they are the pulses"
        }
        Flag::UtcWrongSecond => {
            "the receiver's time differs from the count of pulses, which goes on by the clock while they are missing or have moved"
        }
        Flag::UtcStepped => {
            "the receiver's time has differed for CONSISTENT_TIMES, and is believed"
        }
        Flag::UtcFromThePast => "a pulse or a time of the receiver was older than the last pulse",
        Flag::UtcNoPulse => "a time of the receiver came without a pulse in the second before",
        Flag::AttitudeNotANumber => "an attitude had a NaN or an infinity",
        Flag::AttitudeOutOfRange => "an angle or a rate was outside its range",
        Flag::AttitudeSilent => {
            "attitudes have come, but none within ATTITUDE_WITHIN_S of the exposure"
        }
        Flag::NotMeasured => {
            "nothing measures the stage: the motion is that of the steps that were made, by a stepper"
        }
        Flag::TemperatureOutside => {
            "the temperature is outside the focus table: the focus shift is that of the nearest row"
        }
        Flag::TemperatureUnknown => {
            "no temperature was told for TEMPERATURE_VALID_S, or none since a reset: the focus shift is that of the last one, 0 before the first"
        }
        Flag::VhUnconfirmed => {
            "V/H comes from a source that has jumped and that no other has confirmed"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = include_str!("../../../../docs/integration.md");

    #[test]
    fn meanings_are_those_of_the_document() {
        for flag in Flag::ALL {
            let row = format!("| {} | {} |", flag.name(), meaning(flag));
            assert!(DOCUMENT.replace('`', "").contains(&row), "{row}");
        }
    }
}
