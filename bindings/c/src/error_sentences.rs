//! Sentences of errors against those of the library.

use std::format;
use std::string::String;

use fmc::flight::camera::FrameError;
use fmc::flight::stage::StrokeTooShort;
use fmc::geometry::calibration::{CalibrationError, Polynomial};
use fmc::geometry::inverse::{DistortError, DistortSliceError};
use fmc::geometry::range::{OutOfRange, Quantity};
use fmc::geometry::sensor::SensorPoint;

use crate::refusal::{Refusal, of_point};
use crate::text::Text;
use crate::{fmc_error, fmc_error_text, fmc_quantity_name};

/// Numbers of every size and kind.
const NUMBERS: [f32; 22] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    0.1,
    0.3,
    123.456,
    1e-7,
    -2.5e-5,
    1e-38,
    1e-45,
    0.05,
    2.5,
    3.5,
    1e6,
    1e7,
    16_777_216.0,
    1.5e9,
    -7.25e12,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
];

fn sentence(error: &fmc_error) -> String {
    let mut buffer = [0_u8; 400];
    // SAFETY: the buffer has its size.
    let length = unsafe { fmc_error_text(error, buffer.as_mut_ptr().cast(), buffer.len()) };
    assert_eq!(buffer[length], 0);
    String::from_utf8(buffer[..length].to_vec()).unwrap()
}

/// Returns the sentence of a refusal.
fn refused(refusal: impl Into<Refusal>) -> String {
    sentence(&refusal.into().into())
}

fn written(write: impl FnOnce(&mut Text<'_>)) -> String {
    let mut buffer = [0_u8; 80];
    let mut text = Text::new(&mut buffer);
    write(&mut text);
    let length = text.end();
    String::from_utf8(buffer[..length].to_vec()).unwrap()
}

#[test]
fn numbers_are_written_as_the_core_library_does() {
    let bits = (0_u32..200_000).map(|step| f32::from_bits(step.wrapping_mul(21_467)));
    let inside = |value: &f32| value.abs() < 1e12;
    for value in NUMBERS.into_iter().chain(bits.clone().filter(inside)) {
        let shortest = written(|text| drop_ref(text.number(value)));
        assert_eq!(shortest, format!("{value}"));
        for decimals in [2, 3, 4] {
            let fixed = written(|text| drop_ref(text.fixed(value, decimals)));
            assert_eq!(
                fixed,
                format!("{value:.*}", usize::from(decimals)),
                "{value:e}"
            );
        }
    }
    assert_eq!(
        written(|text| drop_ref(text.hexadecimal(0x00c0_ffee))),
        "00c0ffee"
    );
    for number in [0, 7, 10, u64::MAX] {
        assert_eq!(
            written(|text| drop_ref(text.whole(number))),
            format!("{number}")
        );
    }
}

/// Ends a chain.
fn drop_ref<T>(_: &mut T) {}

#[test]
fn sentences_are_those_of_the_library() {
    for value in NUMBERS {
        let at = SensorPoint::new(value, -value);
        for (min, max) in [(f32::MIN, f32::MAX), (0.25, 1e4)] {
            let quantity = Quantity::K1;
            let error = OutOfRange {
                quantity,
                value,
                min,
                max,
            };
            assert_eq!(refused(error), format!("{error}"));
        }
        for polynomial in [Polynomial::Static, Polynomial::Fitted] {
            let error = CalibrationError::Folds {
                polynomial,
                scale: value,
                at,
            };
            assert_eq!(refused(error), format!("{error}"));
        }
        for error in [
            FrameError::Stroke(StrokeTooShort {
                from_mm: value,
                to_mm: 2.0 * value,
                half_stroke_mm: 2.0,
            }),
            FrameError::NotFitted,
            FrameError::Speed {
                wanted_mm_s: value,
                max_mm_s: 3.5,
            },
            FrameError::Time {
                needed_s: value,
                available_s: 0.25,
            },
        ] {
            assert_eq!(refused(error), format!("{error}"));
        }
        for error in [
            DistortError::OffSensor(at),
            DistortError::NotConverged { residual_nm: value },
        ] {
            let index = 17;
            let library = DistortSliceError { index, error };
            assert_eq!(refused(of_point(error, index)), format!("{library}"));
        }
    }
}

#[test]
fn quantities_have_the_names_of_the_camera_file() {
    for (number, quantity) in Quantity::ALL.iter().enumerate() {
        let mut buffer = [0_u8; 64];
        let number = i32::try_from(number).unwrap();
        assert_eq!(*quantity as i32, number);
        // SAFETY: the buffer has its size.
        let length = unsafe { fmc_quantity_name(number, buffer.as_mut_ptr().cast(), 64) };
        assert_eq!(&buffer[..length], quantity.name().as_bytes());
    }
}
