//! Codes of choices, which are the same in structures, events and records.

use fmc::flight::calibration_id::Storage;
use fmc::flight::exposure::{CorrectionModel, FlightDirection};
use fmc::flight::fault::Fault;
use fmc::flight::stage::RunUp;
use fmc::geometry::five_coefficient::Regressor;
use fmc::geometry::principal_distance::FocusSign;
use fmc::geometry::sensor::FmcAxis;

use crate::FMC_ERROR_CODE;
use crate::refusal::{Failure, Refusal};

/// A choice between named values; what each means stands at its code.
pub type fmc_code = i32;

/// No, or without.
pub const FMC_NO: fmc_code = 0;
/// Yes, or with.
pub const FMC_YES: fmc_code = 1;

/// FMC axis along +x of the sensor.
pub const FMC_AXIS_PLUS_X: fmc_code = 0;
/// FMC axis along -x of the sensor.
pub const FMC_AXIS_MINUS_X: fmc_code = 1;
/// FMC axis along +y of the sensor.
pub const FMC_AXIS_PLUS_Y: fmc_code = 2;
/// FMC axis along -y of the sensor.
pub const FMC_AXIS_MINUS_Y: fmc_code = 3;

/// A stage moves the detector; the centroid of the exposure is at the calibrated position.
pub const FMC_MECHANISM_STAGE_CENTRED: fmc_code = 0;
/// A stage moves the detector, from the calibrated position on.
pub const FMC_MECHANISM_STAGE_FROM_REST: fmc_code = 1;
/// The charge moves in rows.
pub const FMC_MECHANISM_TDI: fmc_code = 2;

/// Exposure mean of the calibration about the moving principal point.
pub const FMC_MODEL_EXACT: fmc_code = 0;
/// Five fitted coefficients.
pub const FMC_MODEL_FITTED: fmc_code = 1;
/// Static calibration, motion and focus shift ignored.
pub const FMC_MODEL_STATIC: fmc_code = 2;

/// Flight along the FMC axis.
pub const FMC_FORWARD: fmc_code = 0;
/// Flight against the FMC axis.
pub const FMC_REVERSE: fmc_code = 1;

/// A detector moved away from the lens enlarges the image.
pub const FMC_FOCUS_PHYSICAL: fmc_code = 0;
/// Sign of the focus shift as printed in Yuan et al. 2012, eqs. 14-17.
pub const FMC_FOCUS_PRINTED: fmc_code = 1;

/// kd1 and pm1 go with the travel.
pub const FMC_REGRESSOR_TRAVEL: fmc_code = 0;
/// kd1 and pm1 go with the centroid.
pub const FMC_REGRESSOR_CENTROID: fmc_code = 1;

/// The calibration is in memory alone.
pub const FMC_VOLATILE: fmc_code = 0;
/// The calibration is in the board's own store.
pub const FMC_STORED: fmc_code = 1;

/// A code that its type does not have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unknown(pub(crate) fmc_code);

impl From<Unknown> for Refusal {
    #[cold]
    #[inline(never)]
    fn from(Unknown(code): Unknown) -> Self {
        Failure::new(FMC_ERROR_CODE)
            .numbers(code.cast_unsigned(), 0)
            .into()
    }
}

/// Returns the refusal of a code.
pub(crate) fn unknown(code: fmc_code) -> Refusal {
    Unknown(code).into()
}

/// Defines the conversion of a type from its codes, and the one to them.
macro_rules! codes {
    ($from:ident, $to:ident, $type:ty: $($code:ident = $value:path),+ $(,)?) => {
        pub(crate) fn $from(code: $crate::fmc_code) -> Result<$type, $crate::code::Unknown> {
            match code {
                $($crate::$code => Ok($value),)+
                _ => Err($crate::code::Unknown(code)),
            }
        }

        pub(crate) const fn $to(value: $type) -> $crate::fmc_code {
            match value {
                $($value => $crate::$code,)+
            }
        }
    };
    ($from:ident, $type:ty: $($code:ident = $value:path),+ $(,)?) => {
        pub(crate) fn $from(code: $crate::fmc_code) -> Result<$type, $crate::code::Unknown> {
            match code {
                $($crate::$code => Ok($value),)+
                _ => Err($crate::code::Unknown(code)),
            }
        }
    };
}
pub(crate) use codes;

codes!(bool_of, code_of_bool, bool: FMC_NO = self::NO, FMC_YES = self::YES);
codes!(axis, FmcAxis:
    FMC_AXIS_PLUS_X = FmcAxis::PlusX,
    FMC_AXIS_MINUS_X = FmcAxis::MinusX,
    FMC_AXIS_PLUS_Y = FmcAxis::PlusY,
    FMC_AXIS_MINUS_Y = FmcAxis::MinusY,
);
codes!(run_up, RunUp:
    FMC_MECHANISM_STAGE_CENTRED = RunUp::Centred,
    FMC_MECHANISM_STAGE_FROM_REST = RunUp::FromRest,
);
codes!(model, code_of_model, CorrectionModel:
    FMC_MODEL_EXACT = CorrectionModel::Exact,
    FMC_MODEL_FITTED = CorrectionModel::Fitted,
    FMC_MODEL_STATIC = CorrectionModel::Static,
);
codes!(direction, code_of_direction, FlightDirection:
    FMC_FORWARD = FlightDirection::Forward,
    FMC_REVERSE = FlightDirection::Reverse,
);
codes!(focus_sign, FocusSign:
    FMC_FOCUS_PHYSICAL = FocusSign::Physical,
    FMC_FOCUS_PRINTED = FocusSign::Printed,
);
codes!(regressor, Regressor:
    FMC_REGRESSOR_TRAVEL = Regressor::Travel,
    FMC_REGRESSOR_CENTROID = Regressor::Centroid,
);
codes!(storage, code_of_storage, Storage:
    FMC_VOLATILE = Storage::Volatile,
    FMC_STORED = Storage::Stored,
);

const NO: bool = false;
const YES: bool = true;

/// Returns the fault with a code (`docs/integration.md`).
pub(crate) fn fault(code: fmc_code) -> Result<Fault, Refusal> {
    let mut faults = Fault::ALL.into_iter();
    let found = faults.find(|fault| i32::from(fault.code()) == code);
    found.ok_or_else(|| unknown(code))
}
