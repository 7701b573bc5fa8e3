//! Numbers and names as the reports write them.

use fmc_camera::io::link::message::Counters;
pub use fmc_frames::row::FOCUS_CONVENTION;
use fmc_reference::verification::device::Evidence;
pub(crate) use fmc_simulation::wording::{count, counted, grouped};

/// Describes how points are known to be the camera's.
pub(crate) fn evidence(evidence: &Evidence) -> String {
    let by_value = count(evidence.by_value);
    if evidence.by_digest == 0 {
        format!("{by_value} answered one by one")
    } else {
        format!(
            "{} shown by digest to have the bits computed on this PC, {by_value} of them also compared one by one",
            count(evidence.by_digest)
        )
    }
}

/// Writes an exposure time, as a fraction of a second where it is one.
#[must_use]
pub fn exposure(exposure_s: f64) -> String {
    let denominator = exposure_s.recip().round();
    if denominator > 1.0 && (exposure_s * denominator - 1.0).abs() < 1e-6 {
        format!("1/{denominator} s")
    } else {
        format!("{} s", decimals(exposure_s, 6))
    }
}

/// Writes V/H with its unit.
pub(crate) fn vh(vh_per_s: f64) -> String {
    format!("{} s⁻¹", decimals(vh_per_s, 4))
}

/// Writes a number with at most so many decimals, without trailing zeros.
pub(crate) fn decimals(number: f64, most: usize) -> String {
    // Adding zero turns -0 into 0.
    let text = format!("{:.most$}", number + 0.0);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Describes the counters of a camera's end of the link.
pub(crate) fn link(counters: &Counters) -> String {
    let lost = counters.truncated + counters.oversized + counters.wrong_crc;
    format!(
        "{} requests done, {} refused, {} repeated, {} frames and {} bytes lost; {} bytes of stack used",
        count(counters.done.into()),
        count(counters.refused.into()),
        count(counters.repeated.into()),
        count(lost.into()),
        count(counters.overrun_bytes.into()),
        count(counters.stack_used_bytes.into())
    )
}

/// Describes a run-up strategy, for a sentence.
pub(crate) fn strategy(name: &str) -> &str {
    match name {
        "centred" => "centred run-up",
        "from-rest" => "run-up from rest",
        "tdi" => "TDI, no run-up",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_a_fraction_where_it_is_one() {
        assert_eq!(exposure(1.0 / 175.0), "1/175 s");
        assert_eq!(exposure(0.01), "1/100 s");
        assert_eq!(exposure(0.0123), "0.0123 s");
    }

    #[test]
    fn no_number_ends_in_a_trailing_zero() {
        assert_eq!(vh(0.17), "0.17 s⁻¹");
        assert_eq!(vh(0.05 + 0.12 / 9.0), "0.0633 s⁻¹");
        assert_eq!(decimals(100.0, 0), "100");
    }
}
