//! The sentence of an error: that of the library's own error.

use core::ffi::c_char;

use fmc::geometry::range::Quantity;

use crate::error::{fmc_error, fmc_status};
use crate::memory;
use crate::text::Text;
use crate::{
    FMC_ERROR_BUFFER, FMC_ERROR_BYTES, FMC_ERROR_CAMERA_CHANGED, FMC_ERROR_CODE, FMC_ERROR_CRC,
    FMC_ERROR_FITTED_FOLDS, FMC_ERROR_FOLDS, FMC_ERROR_GRIDS, FMC_ERROR_MISALIGNED, FMC_ERROR_NONE,
    FMC_ERROR_NOT_CONVERGED, FMC_ERROR_NOT_FITTED, FMC_ERROR_NULL, FMC_ERROR_OFF_SENSOR,
    FMC_ERROR_OUT_OF_RANGE, FMC_ERROR_OVERLAP, FMC_ERROR_SERIAL, FMC_ERROR_SPEED, FMC_ERROR_STROKE,
    FMC_ERROR_STRUCT_SIZE, FMC_ERROR_TIME, FMC_ERROR_TOO_MANY, FMC_ERROR_UNINITIALISED,
    FMC_ERROR_VERSION, FMC_OK,
};

/// Writes the sentence of an error, with a zero at its end, cut if the buffer is smaller. Returns
/// the length of the whole sentence without the zero; 0 for a NULL or misaligned error. With `size`
/// 0 nothing is written.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `buffer` to `size`
/// characters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_error_text(
    error: *const fmc_error,
    buffer: *mut c_char,
    size: usize,
) -> usize {
    // SAFETY: the caller's promise; all fields are valid with all bits.
    let error = unsafe { memory::structure(error, 1) };
    // SAFETY: the caller's promise.
    let buffer = unsafe { memory::elements_mut(buffer.cast::<u8>(), size, 2) };
    let (Ok(error), Ok(buffer)) = (error, buffer) else {
        return 0;
    };
    let mut text = Text::new(buffer);
    write(&error, &mut text);
    text.end()
}

/// Writes the name of a quantity, as `fmc_error_text` writes a sentence; returns 0 for a number
/// that is none.
///
/// # Safety
/// Unless it is NULL, `buffer` is to `size` characters of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_quantity_name(
    quantity: i32,
    buffer: *mut c_char,
    size: usize,
) -> usize {
    // SAFETY: the caller's promise.
    let buffer = unsafe { memory::elements_mut(buffer.cast::<u8>(), size, 2) };
    let (Some(quantity), Ok(buffer)) = (of_number(quantity), buffer) else {
        return 0;
    };
    let mut text = Text::new(buffer);
    text.add(quantity.name());
    text.end()
}

fn of_number(quantity: i32) -> Option<Quantity> {
    Quantity::ALL.get(usize::try_from(quantity).ok()?).copied()
}

fn write(error: &fmc_error, text: &mut Text<'_>) {
    let status: fmc_status = error.status;
    match status {
        FMC_ERROR_OUT_OF_RANGE => out_of_range(error, text),
        FMC_ERROR_FOLDS | FMC_ERROR_FITTED_FOLDS => folds(error, text),
        FMC_ERROR_STROKE => {
            text.add("the exposure moves the principal point from ")
                .fixed(error.value, 4)
                .add(" mm to ")
                .fixed(error.other, 4)
                .add(" mm, the stroke allows -")
                .fixed(error.most, 4)
                .add(" mm to ")
                .fixed(error.most, 4)
                .add(" mm");
        }
        FMC_ERROR_SPEED => {
            text.add("the exposure needs a speed of ")
                .number(error.value)
                .add(" mm/s, the stage allows -")
                .number(error.most)
                .add(" mm/s to ")
                .number(error.most)
                .add(" mm/s");
        }
        FMC_ERROR_TIME => {
            text.add("the travel takes ")
                .fixed(error.value, 4)
                .add(" s, there are ")
                .fixed(error.most, 4)
                .add(" s");
        }
        FMC_ERROR_OFF_SENSOR => {
            text.add("point ")
                .whole(error.index.into())
                .add(": its measured point (")
                .fixed(error.x_mm, 4)
                .add(", ")
                .fixed(error.y_mm, 4)
                .add(") mm is off the sensor");
        }
        FMC_ERROR_NOT_CONVERGED => {
            text.add("point ")
                .whole(error.index.into())
                .add(": no measured point found: ")
                .number(error.value)
                .add(" nm are left after ")
                .whole(error.number.into())
                .add(" Newton steps");
        }
        _ => call(error, text),
    }
}

fn out_of_range(error: &fmc_error, text: &mut Text<'_>) {
    let name = of_number(error.quantity).map_or("quantity", Quantity::name);
    text.add(name).add(" = ").number(error.value);
    if error.least <= f32::MIN && error.most >= f32::MAX {
        text.add(" is not a finite number");
    } else {
        text.add(" is outside ")
            .number(error.least)
            .add(" to ")
            .number(error.most);
    }
}

fn folds(error: &fmc_error, text: &mut Text<'_>) {
    let which = if error.status == FMC_ERROR_FOLDS {
        "the distortion polynomial"
    } else {
        "the five-coefficient model"
    };
    text.add(which)
        .add(
            " folds the image or comes too near to it: the scale d(ideal)/d(measured) may fall to ",
        )
        .fixed(error.value, 3)
        .add(" near (")
        .fixed(error.x_mm, 2)
        .add(", ")
        .fixed(error.y_mm, 2)
        .add(") mm; at least ")
        .number(error.least)
        .add(" is required over the sensor enlarged by half the stroke");
}

/// Writes the sentence of a call that was wrong in itself.
fn call(error: &fmc_error, text: &mut Text<'_>) {
    if error.argument != 0 {
        text.add("argument ").whole(error.argument.into()).add(" ");
    }
    let found = u64::from(error.number);
    let expected = u64::from(error.expected);
    match error.status {
        FMC_OK => text.add("no error"),
        FMC_ERROR_NULL => text.add("is NULL"),
        FMC_ERROR_MISALIGNED => text.add("is misaligned"),
        FMC_ERROR_OVERLAP => text.add("shares memory with argument ").whole(expected),
        FMC_ERROR_TOO_MANY => text.add("is of more elements than memory can hold"),
        FMC_ERROR_STRUCT_SIZE => text
            .add("is a structure of ")
            .whole(found)
            .add(" bytes, the library's has ")
            .whole(expected),
        FMC_ERROR_VERSION => text
            .add("is of header ")
            .hexadecimal(error.number)
            .add(", the library is ")
            .hexadecimal(error.expected),
        FMC_ERROR_UNINITIALISED => text.add("does not hold such an object"),
        FMC_ERROR_CAMERA_CHANGED => text
            .add("is of the calibration with CRC-32 ")
            .hexadecimal(error.number)
            .add(", the camera has ")
            .hexadecimal(error.expected),
        FMC_ERROR_CODE => text.add("no choice has the code ").whole(found),
        FMC_ERROR_BUFFER => text
            .add("has room for ")
            .whole(found)
            .add(" elements, needed are ")
            .whole(expected),
        FMC_ERROR_NOT_FITTED => text.add("the camera has no fitted five-coefficient model"),
        FMC_ERROR_BYTES => text.add("is not what it should be"),
        FMC_ERROR_CRC => text
            .add("has CRC-32 ")
            .hexadecimal(error.number)
            .add(", stated is ")
            .hexadecimal(error.expected),
        FMC_ERROR_GRIDS => text.add("is of a camera with residual grids"),
        FMC_ERROR_SERIAL => text
            .add("the serial number holds other than printable ASCII at byte ")
            .whole(u64::from(error.index)),
        FMC_ERROR_NONE => text.add("names a record or frame that is not there"),
        other => text.add("status ").whole(u64::from(other.cast_unsigned())),
    };
}
