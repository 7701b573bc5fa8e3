//! Status of a call, and the error that a refusal fills.

/// Status of a call: `FMC_OK`, or the reason for its refusal.
pub type fmc_status = i32;

/// The call has done its work.
pub const FMC_OK: fmc_status = 0;
/// A pointer is NULL.
pub const FMC_ERROR_NULL: fmc_status = 1;
/// A pointer is not aligned for what it points to.
pub const FMC_ERROR_MISALIGNED: fmc_status = 2;
/// Two arguments share memory of which one is written.
pub const FMC_ERROR_OVERLAP: fmc_status = 3;
/// There are more elements than memory can hold.
pub const FMC_ERROR_TOO_MANY: fmc_status = 4;
/// A structure does not have the size that the library's has; `number` and `expected` hold both.
pub const FMC_ERROR_STRUCT_SIZE: fmc_status = 5;
/// The header is of another version than the library; `number` and `expected` hold both.
pub const FMC_ERROR_VERSION: fmc_status = 6;
/// The storage does not hold such an object: it was never initialised, or is of another type.
pub const FMC_ERROR_UNINITIALISED: fmc_status = 7;
/// The frame or the mesh is of another calibration than the camera has now.
pub const FMC_ERROR_CAMERA_CHANGED: fmc_status = 8;
/// A code is none of those that its type has; `number` holds it.
pub const FMC_ERROR_CODE: fmc_status = 9;
/// The buffer is too small; `number` holds its size, `expected` the least one.
pub const FMC_ERROR_BUFFER: fmc_status = 10;
/// A quantity is not a number or outside its range.
pub const FMC_ERROR_OUT_OF_RANGE: fmc_status = 11;
/// The distortion polynomial folds the image; `value` holds its scale, at (`x_mm`, `y_mm`).
pub const FMC_ERROR_FOLDS: fmc_status = 12;
/// The five-coefficient model folds the image; `value` holds its scale, at (`x_mm`, `y_mm`).
pub const FMC_ERROR_FITTED_FOLDS: fmc_status = 13;
/// The travel from `value` to `other` leaves the stroke of `most` either side, mm.
pub const FMC_ERROR_STROKE: fmc_status = 14;
/// The speed `value` exceeds the stage's, mm/s.
pub const FMC_ERROR_SPEED: fmc_status = 15;
/// The travel takes `value`, and there are `most`, s.
pub const FMC_ERROR_TIME: fmc_status = 16;
/// The camera has no five-coefficient model.
pub const FMC_ERROR_NOT_FITTED: fmc_status = 17;
/// The measured point of the ideal one, at (`x_mm`, `y_mm`), is off the sensor.
pub const FMC_ERROR_OFF_SENSOR: fmc_status = 18;
/// No measured point was found; `value` holds what is left, nm.
pub const FMC_ERROR_NOT_CONVERGED: fmc_status = 19;
/// The bytes are not what they should be.
pub const FMC_ERROR_BYTES: fmc_status = 20;
/// The bytes have another CRC-32 than stated; `number` and `expected` hold both.
pub const FMC_ERROR_CRC: fmc_status = 21;
/// The calibration has residual grids, which this library does not evaluate.
pub const FMC_ERROR_GRIDS: fmc_status = 22;
/// The serial number has a character that is not printable ASCII, at `index`.
pub const FMC_ERROR_SERIAL: fmc_status = 23;
/// There is no such record or frame.
pub const FMC_ERROR_NONE: fmc_status = 24;

/// No quantity.
pub const FMC_NO_QUANTITY: i32 = -1;

/// The reason for a refusal. Fields that a status does not use are 0, and `quantity` is
/// `FMC_NO_QUANTITY`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fmc_error {
    /// Status of the call.
    pub status: fmc_status,
    /// Quantity that was refused: its name is that of the camera file (`fmc_quantity_name`).
    pub quantity: i32,
    /// Its value, in the unit of its name.
    pub value: f32,
    /// Smallest allowed value.
    pub least: f32,
    /// Largest allowed value.
    pub most: f32,
    /// Second value, where there are two.
    pub other: f32,
    /// Place on the sensor, mm.
    pub x_mm: f32,
    /// Place on the sensor, mm.
    pub y_mm: f32,
    /// Index of the point or the byte, from 0.
    pub index: u32,
    /// Argument of the call, from 1; 0 if the refusal is about none.
    pub argument: u32,
    /// Number that was found.
    pub number: u32,
    /// Number that was expected.
    pub expected: u32,
}

impl fmc_error {
    /// Returns the error of a status without details.
    #[must_use]
    pub const fn of_status(status: fmc_status) -> Self {
        Self {
            status,
            quantity: FMC_NO_QUANTITY,
            value: 0.0,
            least: 0.0,
            most: 0.0,
            other: 0.0,
            x_mm: 0.0,
            y_mm: 0.0,
            index: 0,
            argument: 0,
            number: 0,
            expected: 0,
        }
    }
}
