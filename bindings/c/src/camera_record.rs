//! Record of a camera: everything that describes it, as C fills it.

use core::ffi::c_char;

use fmc::flight::calibration_id::{SerialError, SerialNumber};
use fmc::flight::camera::{CameraParameters, Mechanism};
use fmc::flight::exposure::Limits;
use fmc::flight::stage::RunUp;
use fmc::geometry::brown::Brown;
use fmc::geometry::calibration::CalibrationParameters;
use fmc::geometry::five_coefficient::FiveCoefficients;
use fmc::geometry::focus_table::FocusTable;
use fmc::geometry::grid::GridChecksums;
use fmc::geometry::principal_distance::{FLATNESS_TERMS, Flatness};
use fmc::geometry::sensor::SensorPoint;
use fmc::geometry::shutter::ShutterProfile;

use crate::code::{self, fmc_code, unknown};

use crate::refusal::{Failure, Refusal};
use crate::version::Input;
use crate::{
    FMC_AXIS_PLUS_Y, FMC_CAMERA_VERSION, FMC_ERROR_SERIAL, FMC_MECHANISM_STAGE_CENTRED,
    FMC_MECHANISM_TDI, FMC_NO, FMC_REGRESSOR_TRAVEL, FMC_VOLATILE,
};

/// Opening and closing at once.
pub const FMC_SHUTTER_UNIFORM: fmc_code = 0;
/// Linear ramps, as leaf shutters have.
pub const FMC_SHUTTER_TRAPEZOID: fmc_code = 1;

/// Terms of the polynomial of the stage's run-out.
pub const FMC_FLATNESS_TERMS: usize = 5;
/// Characters of a serial number.
pub const FMC_SERIAL_LENGTH: usize = 16;

const _: () = assert!(FMC_FLATNESS_TERMS == FLATNESS_TERMS);
const _: () = assert!(FMC_SERIAL_LENGTH == SerialNumber::CAPACITY);

/// A camera, as `fmc_camera_record_defaults` begins it. Coefficients are measured - ideal; the keys
/// of a camera file have the same names.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_camera_record {
    /// Size of this structure, bytes.
    pub size: u32,
    /// `FMC_CAMERA_VERSION` of the header.
    pub version: u32,
    /// Principal distance, mm.
    pub principal_distance_mm: f32,
    /// Distance from exit pupil to image, mm; 0: the principal distance.
    pub exit_pupil_mm: f32,
    /// Calibrated principal point, sensor frame, mm.
    pub principal_point_x_mm: f32,
    /// Calibrated principal point, sensor frame, mm.
    pub principal_point_y_mm: f32,
    /// Columns.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
    /// Side of a pixel, µm.
    pub pixel_um: f32,
    /// K0.
    pub k0: f32,
    /// K1, mm^-2.
    pub k1: f32,
    /// K2, mm^-4.
    pub k2: f32,
    /// K3, mm^-6.
    pub k3: f32,
    /// P1, mm^-1, which goes with x².
    pub p1: f32,
    /// P2, mm^-1.
    pub p2: f32,
    /// B1.
    pub b1: f32,
    /// B2.
    pub b2: f32,
    /// `FMC_YES` with a five-coefficient model.
    pub has_fitted: fmc_code,
    /// `K_m0`.
    pub km0: f32,
    /// `K_m1`, mm^-2.
    pub km1: f32,
    /// `K_m2`, mm^-4.
    pub km2: f32,
    /// `K_d1`, mm^-2.
    pub kd1: f32,
    /// `P_m1`, mm^-2.
    pub pm1: f32,
    /// `FMC_REGRESSOR_...`
    pub regressor: fmc_code,
    /// `FMC_AXIS_...`
    pub axis: fmc_code,
    /// Travel of the stage, plus and minus half of it, mm.
    pub stroke_mm: f32,
    /// Run-out of the stage, µm per power of mm, lowest first.
    pub flatness_um: [f32; FMC_FLATNESS_TERMS],
    /// `FMC_MECHANISM_...`
    pub mechanism: fmc_code,
    /// Acceleration of the stage, mm/s².
    pub acceleration_mm_s2: f32,
    /// Settling time between run-up and exposure, ms.
    pub settling_ms: f32,
    /// Largest jerk, mm/s³; 0: without limit.
    pub jerk_mm_s3: f32,
    /// Largest speed, mm/s; 0: without limit.
    pub max_speed_mm_s: f32,
    /// First transfer of a TDI sensor after opening, row periods.
    pub first_transfer: f32,
    /// `FMC_SHUTTER_...`
    pub shutter: fmc_code,
    /// Opening ramp of a trapezoid, as a fraction of the base.
    pub opening_fraction: f32,
    /// Closing ramp of a trapezoid, as a fraction of the base.
    pub closing_fraction: f32,
    /// Smallest and largest V/H, 1/s.
    pub limits_vh_per_s: [f32; 2],
    /// Shortest and longest exposure, s.
    pub limits_exposure_s: [f32; 2],
    /// Serial number, printable ASCII, filled with zeros.
    pub serial: [c_char; FMC_SERIAL_LENGTH],
    /// Version of the calibration; 0: none is given.
    pub calibration_version: u32,
    /// `FMC_VOLATILE` or `FMC_STORED`.
    pub storage: fmc_code,
}

impl Input for fmc_camera_record {}

impl fmc_camera_record {
    pub(crate) const DEFAULT: Self = {
        let limits = Limits::DEFAULT;
        #[expect(clippy::cast_possible_truncation, reason = "hundreds of bytes")]
        Self {
            size: size_of::<Self>() as u32,
            version: FMC_CAMERA_VERSION,
            principal_distance_mm: 0.0,
            exit_pupil_mm: 0.0,
            principal_point_x_mm: 0.0,
            principal_point_y_mm: 0.0,
            width_px: 0,
            height_px: 0,
            pixel_um: 0.0,
            k0: 0.0,
            k1: 0.0,
            k2: 0.0,
            k3: 0.0,
            p1: 0.0,
            p2: 0.0,
            b1: 0.0,
            b2: 0.0,
            has_fitted: FMC_NO,
            km0: 0.0,
            km1: 0.0,
            km2: 0.0,
            kd1: 0.0,
            pm1: 0.0,
            regressor: FMC_REGRESSOR_TRAVEL,
            axis: FMC_AXIS_PLUS_Y,
            stroke_mm: 4.0,
            flatness_um: [0.0; FMC_FLATNESS_TERMS],
            mechanism: FMC_MECHANISM_STAGE_CENTRED,
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            jerk_mm_s3: 0.0,
            max_speed_mm_s: 0.0,
            first_transfer: 0.5,
            shutter: FMC_SHUTTER_UNIFORM,
            opening_fraction: 0.0,
            closing_fraction: 0.0,
            limits_vh_per_s: limits.vh_per_s,
            limits_exposure_s: limits.exposure_s,
            serial: [0; FMC_SERIAL_LENGTH],
            calibration_version: 0,
            storage: FMC_VOLATILE,
        }
    };

    /// Returns the parameters of the record, not yet validated.
    ///
    /// # Errors
    /// The refusal of a code or of the serial number.
    pub fn parameters(&self) -> Result<CameraParameters, Refusal> {
        let fitted = if code::bool_of(self.has_fitted)? {
            Some(FiveCoefficients {
                regressor: code::regressor(self.regressor)?,
                km0: self.km0,
                km1: self.km1,
                km2: self.km2,
                kd1: self.kd1,
                pm1: self.pm1,
            })
        } else {
            None
        };
        let run_up = match self.mechanism {
            FMC_MECHANISM_TDI => None,
            code => Some(code::run_up(code)?),
        };
        let exit_pupil_mm = given(self.exit_pupil_mm).unwrap_or(self.principal_distance_mm);
        Ok(CameraParameters {
            calibration: CalibrationParameters {
                principal_distance_mm: self.principal_distance_mm,
                exit_pupil_mm,
                principal_point: SensorPoint::new(
                    self.principal_point_x_mm,
                    self.principal_point_y_mm,
                ),
                width_px: self.width_px,
                height_px: self.height_px,
                pixel_um: self.pixel_um,
                distortion: self.distortion(),
                fitted,
                axis: code::axis(self.axis)?,
                stroke_mm: self.stroke_mm,
                flatness: Flatness {
                    coefficients_um: self.flatness_um,
                },
            },
            mechanism: self.mechanism(run_up),
            shutter: match self.shutter {
                FMC_SHUTTER_UNIFORM => ShutterProfile::Uniform,
                FMC_SHUTTER_TRAPEZOID => ShutterProfile::Trapezoid {
                    opening_fraction: self.opening_fraction,
                    closing_fraction: self.closing_fraction,
                },
                code => return Err(unknown(code)),
            },
            limits: Limits {
                vh_per_s: self.limits_vh_per_s,
                exposure_s: self.limits_exposure_s,
            },
            serial: serial(&self.serial)?,
            version: self.calibration_version,
            grids: GridChecksums::NONE,
            // It comes with the bytes of a calibration alone.
            focus: FocusTable::NONE,
        })
    }

    fn distortion(&self) -> Brown {
        Brown {
            k0: self.k0,
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
            p1: self.p1,
            p2: self.p2,
            b1: self.b1,
            b2: self.b2,
        }
    }

    /// Returns the mechanism; `None` for `run_up` is a TDI sensor.
    fn mechanism(&self, run_up: Option<RunUp>) -> Mechanism {
        match run_up {
            None => Mechanism::Tdi {
                first_transfer: self.first_transfer,
            },
            Some(run_up) => Mechanism::Stage {
                acceleration_mm_s2: self.acceleration_mm_s2,
                settling_ms: self.settling_ms,
                run_up,
                jerk_mm_s3: given(self.jerk_mm_s3),
                max_speed_mm_s: given(self.max_speed_mm_s),
            },
        }
    }
}

/// Returns a number that is given; 0 stands for one that is not.
pub(crate) fn given(value: f32) -> Option<f32> {
    // A NaN is given, and refused later.
    (value.to_bits() << 1 != 0).then_some(value)
}

/// Returns the serial number of characters that end at a zero or fill the field.
pub(crate) fn serial(characters: &[c_char; FMC_SERIAL_LENGTH]) -> Result<SerialNumber, Refusal> {
    // On some cores a character is signed, on others it is not.
    let bytes = characters.map(|character| character.to_ne_bytes()[0]);
    let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    SerialNumber::from_bytes(text).map_err(|error| {
        let (SerialError::NotPrintable { index } | SerialError::TooLong { length: index }) = error;
        let index = u32::try_from(index).unwrap_or(u32::MAX);
        Failure::new(FMC_ERROR_SERIAL).at(index).into()
    })
}
