//! Identity of a calibration, computed from its numbers.

use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};

use crate::flight::camera::{CameraParameters, Mechanism};
use crate::flight::exposure::Limits;
use crate::geometry::calibration::CalibrationParameters;
use crate::geometry::five_coefficient::FiveCoefficients;
use crate::geometry::focus_table::{FocusRow, FocusTable};
use crate::geometry::grid::GridChecksums;
use crate::geometry::principal_distance::Flatness;
use crate::geometry::sensor::SensorPoint;
use crate::geometry::shutter::ShutterProfile;

/// The CRC-32 of packets, bit by bit: it is computed once for a calibration, and a camera without a
/// link has no other use for a table of a kilobyte.
const CRC: Crc<u32, Table<0>> = Crc::<u32, Table<0>>::new(&CRC_32_ISO_HDLC);

/// Sum over the bytes of a camera's parameters as `postcard` writes them, without the bytes.
///
/// `serde` would do the same in three times the code, which is much of a small program
/// (`docs/c.md`). A field that is added to the parameters does not compile until it has its place
/// here, and a test compares both.
pub(super) struct Identity(Digest<'static, u32, Table<0>>);

impl Identity {
    /// Returns the CRC-32 of a camera's parameters.
    #[expect(
        clippy::inline_always,
        reason = "a program whose cameras have neither grids nor focus table is without their code"
    )]
    #[inline(always)]
    pub(super) fn of(record: &CameraParameters) -> u32 {
        let mut sum = Self::of_fields(record);
        let CameraParameters { grids, focus, .. } = record;
        if !grids.is_empty() || !focus.is_empty() {
            sum.checksums(*grids);
        }
        if !focus.is_empty() {
            sum.focus_table(focus);
        }
        sum.0.finalize()
    }

    /// Returns the sum over all that a camera without grids and focus table has.
    fn of_fields(record: &CameraParameters) -> Self {
        static SUM: Crc<u32, Table<0>> = CRC;
        let mut sum = Self(SUM.digest());
        let CameraParameters {
            calibration,
            mechanism,
            shutter,
            limits,
            serial,
            version,
            grids: _,
            focus: _,
        } = record;
        sum.calibration(calibration);
        sum.mechanism(mechanism);
        match *shutter {
            ShutterProfile::Uniform => sum.byte(0),
            ShutterProfile::Trapezoid {
                opening_fraction,
                closing_fraction,
            } => {
                sum.byte(1);
                sum.numbers(&[opening_fraction, closing_fraction]);
            }
        }
        let Limits {
            vh_per_s,
            exposure_s,
        } = limits;
        sum.numbers(vh_per_s);
        sum.numbers(exposure_s);
        sum.0.update(serial.padded());
        sum.whole(*version);
        sum
    }

    fn checksums(&mut self, grids: GridChecksums) {
        let GridChecksums { lens, sensor } = grids;
        for crc in [lens, sensor] {
            self.byte(u8::from(crc.is_some()));
            if let Some(crc) = crc {
                self.whole(crc);
            }
        }
    }

    fn focus_table(&mut self, table: &FocusTable) {
        let rows = table.rows();
        // There are 16 at most.
        self.byte(u8::try_from(rows.len()).unwrap_or(0));
        for row in rows {
            let FocusRow {
                temperature_c,
                focus_shift_um,
            } = *row;
            self.numbers(&[temperature_c, focus_shift_um]);
        }
    }

    fn calibration(&mut self, calibration: &CalibrationParameters) {
        let CalibrationParameters {
            principal_distance_mm,
            exit_pupil_mm,
            principal_point: SensorPoint { x_mm, y_mm },
            width_px,
            height_px,
            pixel_um,
            distortion,
            fitted,
            axis,
            stroke_mm,
            flatness: Flatness { coefficients_um },
        } = *calibration;
        self.numbers(&[principal_distance_mm, exit_pupil_mm, x_mm, y_mm]);
        self.whole(width_px);
        self.whole(height_px);
        self.number(pixel_um);
        self.numbers(distortion.coefficients());
        self.byte(u8::from(fitted.is_some()));
        if let Some(fitted) = fitted {
            let FiveCoefficients {
                km0,
                km1,
                km2,
                kd1,
                pm1,
                regressor,
            } = fitted;
            self.numbers(&[km0, km1, km2, kd1, pm1]);
            self.byte(regressor as u8);
        }
        self.byte(axis as u8);
        self.number(stroke_mm);
        self.numbers(&coefficients_um);
    }

    fn mechanism(&mut self, mechanism: &Mechanism) {
        match *mechanism {
            Mechanism::Stage {
                acceleration_mm_s2,
                settling_ms,
                run_up,
                jerk_mm_s3,
                max_speed_mm_s,
            } => {
                self.byte(0);
                self.numbers(&[acceleration_mm_s2, settling_ms]);
                self.byte(run_up as u8);
                for limit in [jerk_mm_s3, max_speed_mm_s] {
                    self.byte(u8::from(limit.is_some()));
                    if let Some(limit) = limit {
                        self.number(limit);
                    }
                }
            }
            Mechanism::Tdi { first_transfer } => {
                self.byte(1);
                self.number(first_transfer);
            }
        }
    }

    #[inline(never)]
    fn numbers(&mut self, numbers: &[f32]) {
        for number in numbers {
            self.number(*number);
        }
    }

    #[inline(never)]
    fn number(&mut self, number: f32) {
        self.0.update(&number.to_le_bytes());
    }

    /// Adds a whole number: seven bits in each byte, the lowest first, with the eighth set in all
    /// but the last.
    fn whole(&mut self, number: u32) {
        let mut rest = number;
        while rest >= 0x80 {
            let [low, ..] = rest.to_le_bytes();
            self.byte(low | 0x80);
            rest >>= 7;
        }
        let [low, ..] = rest.to_le_bytes();
        self.byte(low);
    }

    #[inline(never)]
    fn byte(&mut self, byte: u8) {
        self.0.update(&[byte]);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Identity;
    use crate::flight::calibration_id::SerialNumber;
    use crate::flight::camera::{CameraParameters, Mechanism};
    use crate::flight::exposure::Limits;
    use crate::flight::stage::RunUp;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::CalibrationParameters;
    use crate::geometry::five_coefficient::{FiveCoefficients, Regressor};
    use crate::geometry::focus_table::{FOCUS_ROWS, FocusRow, FocusTable};
    use crate::geometry::grid::GridChecksums;
    use crate::geometry::principal_distance::Flatness;
    use crate::geometry::sensor::{FmcAxis, SensorPoint};
    use crate::geometry::shutter::ShutterProfile;
    use crate::io::link::loading::{Upload, parameters};

    prop_compose! {
        fn calibrations()(
            optics: [f32; 6],
            size_px in prop_oneof![any::<[u32; 2]>(), [1_u32..20_000, 1_u32..20_000]],
            k: [f32; 4],
            p: [f32; 2],
            b: [f32; 2],
            fitted: Option<([f32; 5], bool)>,
            axis in prop::sample::select(&FmcAxis::ALL[..]),
            coefficients_um: [f32; 5],
        ) -> CalibrationParameters {
            let [principal_distance_mm, exit_pupil_mm, x_mm, y_mm, pixel_um, stroke_mm] = optics;
            let ([k0, k1, k2, k3], [p1, p2], [b1, b2]) = (k, p, b);
            CalibrationParameters {
                principal_distance_mm,
                exit_pupil_mm,
                principal_point: SensorPoint { x_mm, y_mm },
                width_px: size_px[0],
                height_px: size_px[1],
                pixel_um,
                distortion: Brown { k0, k1, k2, k3, p1, p2, b1, b2 },
                fitted: fitted.map(|([km0, km1, km2, kd1, pm1], is_centroid)| FiveCoefficients {
                    km0,
                    km1,
                    km2,
                    kd1,
                    pm1,
                    regressor: if is_centroid { Regressor::Centroid } else { Regressor::Travel },
                }),
                axis,
                stroke_mm,
                flatness: Flatness { coefficients_um },
            }
        }
    }

    prop_compose! {
        fn mechanisms()(
            is_tdi: bool,
            numbers: [f32; 3],
            from_rest: bool,
            jerk_mm_s3: Option<f32>,
            max_speed_mm_s: Option<f32>,
        ) -> Mechanism {
            let [acceleration_mm_s2, settling_ms, first_transfer] = numbers;
            if is_tdi {
                return Mechanism::Tdi { first_transfer };
            }
            Mechanism::Stage {
                acceleration_mm_s2,
                settling_ms,
                run_up: if from_rest { RunUp::FromRest } else { RunUp::Centred },
                jerk_mm_s3,
                max_speed_mm_s,
            }
        }
    }

    proptest! {
        #[test]
        fn identity_is_the_checksum_of_the_upload(
            calibration in calibrations(),
            mechanism in mechanisms(),
            ramps: Option<[f32; 2]>,
            vh_per_s: [f32; 2],
            exposure_s: [f32; 2],
            serial in "[ -~]{0,16}",
            version: u32,
            lens: Option<u32>,
            sensor: Option<u32>,
            focus in proptest::option::of(prop::collection::vec(any::<[f32; 2]>(), 2..=FOCUS_ROWS)),
        ) {
            let rows: std::vec::Vec<FocusRow> = focus
                .iter()
                .flatten()
                .map(|&[temperature_c, focus_shift_um]| FocusRow {
                    temperature_c,
                    focus_shift_um,
                })
                .collect();
            let record = CameraParameters {
                calibration,
                mechanism,
                shutter: ramps.map_or(ShutterProfile::Uniform, |[opening, closing]| {
                    ShutterProfile::Trapezoid {
                        opening_fraction: opening,
                        closing_fraction: closing,
                    }
                }),
                limits: Limits { vh_per_s, exposure_s },
                serial: SerialNumber::new(&serial).unwrap(),
                version,
                grids: GridChecksums { lens, sensor },
                focus: FocusTable::new(&rows).unwrap_or(FocusTable::NONE),
            };
            let upload = Upload::of(&record).unwrap();
            prop_assert_eq!(Identity::of(&record), upload.crc());
            prop_assert_eq!(parameters(upload.bytes()), Some(record));
        }
    }
}
