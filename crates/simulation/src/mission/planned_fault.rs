//! Faults of a mission: names, onsets, sizes and expected outcomes.

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;
use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;

use super::expectation::{Expectation, REASON_NAMES, STATE_NAMES, VH_WAYS, way_name};
use super::fault::{InjectedFault, Injection};
use super::file::{
    AutopilotFormat, ExpectTable, FaultTable, MissionFile, ReceiverFormat, VhQuantity, VhSourceName,
};
use crate::range::{Range, range, whole};

const WITHIN: Range = range(0.0, 1e6, "ms");
const WITHIN_S: Range = range(0.0, 1000.0, "s");
const SMEAR: Range = range(0.0, 1000.0, "px");
const DURATION: Range = range(1e-6, 1e6, "s");

/// A fault of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedFault {
    /// Fault with onset and size.
    pub injection: Injection,
    /// Outcome that it should have.
    pub expectation: Expectation,
}

/// Reads the faults of a mission with this interval between triggers.
pub(super) fn planned(
    written: &MissionFile,
    interval_s: f64,
    text: &TomlText,
) -> Result<Vec<PlannedFault>, InputError> {
    let numbered = written.fault.iter().enumerate();
    numbered
        .map(|(index, table)| {
            Entry {
                table,
                index: index.to_string(),
                text,
            }
            .planned(written, interval_s)
        })
        .collect()
}

/// A `[[fault]]` and its index in the file.
struct Entry<'a> {
    table: &'a FaultTable,
    index: String,
    text: &'a TomlText<'a>,
}

impl Entry<'_> {
    fn planned(&self, written: &MissionFile, interval_s: f64) -> Result<PlannedFault, InputError> {
        let name = &self.table.name;
        let Some(fault) = InjectedFault::named(name) else {
            let known = InjectedFault::ALL.map(InjectedFault::name).join(", ");
            return Err(self.invalid("name", &format!("is not a fault; there are {known}")));
        };
        let size = self.table.size.unwrap_or(fault.default_size());
        let [least, most] = fault.range();
        let sizes = Range {
            least,
            most,
            unit: fault.unit(),
        };
        sizes.check(size, self.text, &self.path("size"))?;
        self.check_wire(fault, written)?;
        if fault.is_counted() && size.fract() != 0.0 {
            return Err(self.invalid("size", "is not a whole number"));
        }
        let injection = Injection {
            fault,
            onset_s: self.onset_s(written, interval_s)?,
            size,
            duration_s: self.duration_s(fault)?,
            source: self.source(fault, written)?,
            quantity: self.quantity(fault, written)?,
        };
        let expectation = self.expectation(&self.table.expect)?;
        if expectation.armed_within_s.is_some() && injection.end_s().is_infinite() {
            return Err(self.invalid_expectation(
                "armed_within_s",
                "counts from the end of the fault, which has none: give its duration_s",
            ));
        }
        Ok(PlannedFault {
            injection,
            expectation,
        })
    }

    /// Checks that the wire is there on which the fault is.
    fn check_wire(&self, fault: InjectedFault, written: &MissionFile) -> Result<(), InputError> {
        if fault.is_of_receiver() && written.line.receiver != ReceiverFormat::Nmea {
            return Err(self.invalid("name", "needs [line] receiver = \"nmea\""));
        }
        if fault.is_of_autopilot() && written.line.autopilot != AutopilotFormat::Mavlink {
            return Err(self.invalid("name", "needs [line] autopilot = \"mavlink\""));
        }
        Ok(())
    }

    /// Returns the source of V/H that the fault affects, which has to be one of the scenario's.
    fn source(
        &self,
        fault: InjectedFault,
        written: &MissionFile,
    ) -> Result<Option<VhSourceName>, InputError> {
        let Some(source) = self.table.source else {
            return Ok(None);
        };
        if !fault.is_of_vh() {
            return Err(self.invalid(
                "source",
                &format!("is not for {fault}, only for faults of V/H"),
            ));
        }
        if written.vh.iter().all(|table| table.source != source) {
            return Err(self.invalid("source", "is a source that no [[vh]] has"));
        }
        Ok(Some(source))
    }

    fn quantity(
        &self,
        fault: InjectedFault,
        written: &MissionFile,
    ) -> Result<Option<VhQuantity>, InputError> {
        let Some(quantity) = self.table.of else {
            return Ok(None);
        };
        if !fault.is_of_vh() {
            return Err(self.invalid("of", &format!("is not for {fault}, only for faults of V/H")));
        }
        let source = self
            .table
            .source
            .or_else(|| written.vh.first().map(|table| table.source));
        if quantity == VhQuantity::Height && source == Some(VhSourceName::Direct) {
            return Err(self.invalid("of", "is not for the source direct, which gives V/H alone"));
        }
        Ok(Some(quantity))
    }

    /// Returns the onset, which is counted from a frame's trigger or from the start.
    fn onset_s(&self, written: &MissionFile, interval_s: f64) -> Result<f64, InputError> {
        let flight = &written.flight;
        let last_s = flight.first_trigger_s + (whole(flight.exposures) - 1.0) * interval_s;
        match (self.table.at_frame, self.table.onset_s) {
            (None, None) => Err(self.invalid("name", "needs at_frame or onset_s")),
            (None, Some(onset_s)) => {
                range(0.0, last_s, "s, the time of the last trigger").check(
                    onset_s,
                    self.text,
                    &self.path("onset_s"),
                )?;
                Ok(onset_s)
            }
            (Some(frame), after_s) => {
                range(1.0, whole(flight.exposures), "frames").check(
                    whole(frame),
                    self.text,
                    &self.path("at_frame"),
                )?;
                let after_s = after_s.unwrap_or(0.0);
                range(-interval_s, interval_s, "s from the frame's trigger").check(
                    after_s,
                    self.text,
                    &self.path("onset_s"),
                )?;
                let trigger_s = flight.first_trigger_s + (whole(frame) - 1.0) * interval_s;
                Ok((trigger_s + after_s).max(0.0))
            }
        }
    }

    fn duration_s(&self, fault: InjectedFault) -> Result<f64, InputError> {
        match self.table.duration_s {
            None => Ok(f64::INFINITY),
            Some(_) if fault.is_sized_by_its_duration() => Err(self.invalid(
                "duration_s",
                &format!("is not for {fault}, which lasts for its size, in s"),
            )),
            Some(_) if fault.is_momentary() => Err(self.invalid(
                "duration_s",
                &format!("is not for {fault}, which happens once"),
            )),
            Some(duration_s) => {
                DURATION.check(duration_s, self.text, &self.path("duration_s"))?;
                Ok(duration_s)
            }
        }
    }

    fn expectation(&self, table: &ExpectTable) -> Result<Expectation, InputError> {
        let fault = self.one_of(
            "fault",
            table.fault.as_deref(),
            |name| Fault::ALL.into_iter().find(|fault| fault.name() == name),
            || Fault::ALL.map(Fault::name).join(", "),
        )?;
        let flag = self.one_of(
            "flag",
            table.flag.as_deref(),
            |name| Flag::ALL.into_iter().find(|flag| flag.name() == name),
            || Flag::ALL.map(Flag::name).join(", "),
        )?;
        let state = self.one_of(
            "state",
            table.state.as_deref(),
            |name| STATE_NAMES.contains(&name).then(|| name.to_owned()),
            || STATE_NAMES.join(", "),
        )?;
        let refused = self.one_of(
            "refused",
            table.refused.as_deref(),
            |name| {
                let is_fault = Fault::ALL.iter().any(|fault| fault.name() == name);
                (is_fault || REASON_NAMES.contains(&name)).then(|| name.to_owned())
            },
            || format!("{}, or a fault", REASON_NAMES.join(", ")),
        )?;
        if let Some(within_ms) = table.within_ms {
            WITHIN.check(within_ms, self.text, &self.expect_path("within_ms"))?;
            if fault.is_none() {
                return Err(self.invalid_expectation(
                    "within_ms",
                    "is how soon expect.fault is named, which is missing",
                ));
            }
        }
        let refused_at_most = match table.refused_at_most {
            None => None,
            Some(most) => Some(usize::try_from(most).map_err(|_| {
                self.invalid_expectation("refused_at_most", "is out of range: allowed 0 and more")
            })?),
        };
        let vh_from = self.one_of(
            "vh_from",
            table.vh_from.as_deref(),
            |name| VH_WAYS.into_iter().find(|way| way_name(*way) == name),
            || VH_WAYS.map(way_name).join(", "),
        )?;
        for (range, value, key) in [
            (SMEAR, table.smear_px, "smear_px"),
            (WITHIN_S, table.armed_within_s, "armed_within_s"),
        ] {
            if let Some(value) = value {
                range.check(value, self.text, &self.expect_path(key))?;
            }
        }
        Ok(Expectation {
            fault,
            within_ms: table.within_ms,
            state,
            refused,
            flag,
            refused_at_most,
            vh_from,
            smear_px: table.smear_px,
            armed_within_s: table.armed_within_s,
        })
    }

    fn one_of<T>(
        &self,
        key: &str,
        name: Option<&str>,
        find: impl Fn(&str) -> Option<T>,
        known: impl Fn() -> String,
    ) -> Result<Option<T>, InputError> {
        let Some(name) = name else {
            return Ok(None);
        };
        match find(name) {
            Some(found) => Ok(Some(found)),
            None => {
                Err(self.invalid_expectation(key, &format!("is unknown; there are {}", known())))
            }
        }
    }

    fn path<'b>(&'b self, key: &'b str) -> [&'b str; 3] {
        ["fault", &self.index, key]
    }

    fn expect_path<'b>(&'b self, key: &'b str) -> [&'b str; 4] {
        ["fault", &self.index, "expect", key]
    }

    fn invalid(&self, key: &str, fault: &str) -> InputError {
        self.text.invalid(&self.path(key), fault)
    }

    fn invalid_expectation(&self, key: &str, fault: &str) -> InputError {
        self.text.invalid(&self.expect_path(key), fault)
    }
}
