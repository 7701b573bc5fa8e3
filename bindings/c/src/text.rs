//! Text in a buffer of the caller, written without a panic: the digits of numbers come from
//! `ryu`, because the core library's formatting may panic.

/// Decimal digits of an `u64`.
const DIGITS: usize = 20;

/// Text that is cut where the buffer ends.
#[derive(Debug)]
pub(crate) struct Text<'a> {
    rest: &'a mut [u8],
    /// Length of the whole text, cut or not.
    length: usize,
}

impl<'a> Text<'a> {
    /// Begins a text in a buffer.
    pub(crate) const fn new(buffer: &'a mut [u8]) -> Self {
        Self {
            rest: buffer,
            length: 0,
        }
    }

    /// Ends the text with a zero; returns the length of the whole text without it.
    pub(crate) fn end(self) -> usize {
        if let Some(place) = self.rest.first_mut() {
            *place = 0;
        }
        self.length
    }

    /// Adds characters; the last byte of the buffer is left for the zero.
    pub(crate) fn add(&mut self, text: &str) -> &mut Self {
        self.length += text.len();
        for byte in text.bytes() {
            if self.rest.len() < 2 {
                break;
            }
            if let Some((place, behind)) = core::mem::take(&mut self.rest).split_first_mut() {
                *place = byte;
                self.rest = behind;
            }
        }
        self
    }

    /// Adds a whole number.
    pub(crate) fn whole(&mut self, number: u64) -> &mut Self {
        self.padded(number, 1)
    }

    /// Adds a whole number with at least so many digits.
    fn padded(&mut self, number: u64, least: usize) -> &mut Self {
        let mut digits = [b'0'; DIGITS];
        let mut left = number;
        let mut count = 0;
        for place in digits.iter_mut().rev() {
            if left == 0 && count >= least {
                break;
            }
            *place = b'0' + u8::try_from(left % 10).unwrap_or_default();
            left /= 10;
            count += 1;
        }
        let (_, shown) = digits
            .split_at_checked(DIGITS.saturating_sub(count))
            .unwrap_or_default();
        self.add(core::str::from_utf8(shown).unwrap_or_default())
    }

    /// Adds a number with eight hexadecimal digits.
    pub(crate) fn hexadecimal(&mut self, number: u32) -> &mut Self {
        for byte in number.to_be_bytes() {
            for nibble in [byte >> 4, byte & 15] {
                let digit = [if nibble < 10 {
                    b'0' + nibble
                } else {
                    b'a' - 10 + nibble
                }];
                self.add(core::str::from_utf8(&digit).unwrap_or_default());
            }
        }
        self
    }

    /// Adds the shortest number that is read as the same one, without an exponent.
    pub(crate) fn number(&mut self, value: f32) -> &mut Self {
        if !value.is_finite() {
            return self.not_finite(value);
        }
        let mut buffer = ryu::Buffer::new();
        let text = buffer.format_finite(value);
        let (sign, text) = text
            .strip_prefix('-')
            .map_or(("", text), |text| ("-", text));
        self.add(sign);
        let (mantissa, exponent) = split_at(text, b'e').unwrap_or((text, "0"));
        let exponent = integer(exponent);
        let (whole, part) = split_at(mantissa, b'.').unwrap_or((mantissa, ""));
        let part = if part == "0" { "" } else { part };
        let lower = whole_number_of(whole, part);
        let last = exponent - i32::try_from(part.len()).unwrap_or(i32::MAX);
        if is_midway(value, lower, last) {
            // The core library takes the upper one of two numbers that are equally near.
            let mut upper = [0_u8; DIGITS];
            let digits = part.bytes().rev();
            for (place, digit) in upper.iter_mut().zip(digits) {
                *place = digit;
            }
            if let Some(place) = upper.first_mut().filter(|digit| **digit != 0) {
                *place += 1;
                let (digits, _) = upper.split_at_mut_checked(part.len()).unwrap_or_default();
                digits.reverse();
                let part = core::str::from_utf8(digits).unwrap_or_default();
                return self.shifted(whole, part, exponent);
            }
        }
        self.shifted(whole, part, exponent)
    }

    /// Adds the digits of a number times a power of ten.
    fn shifted(&mut self, whole: &str, part: &str, exponent: i32) -> &mut Self {
        let zeros = |text: &mut Self, count: usize| {
            for _ in 0..count {
                text.add("0");
            }
        };
        if exponent < 0 {
            // There is one digit before the point.
            self.add("0.");
            let count = exponent.unsigned_abs() as usize;
            zeros(self, count.saturating_sub(whole.len()));
            return self.add(whole).add(part);
        }
        let count = exponent.unsigned_abs() as usize;
        self.add(whole);
        if count >= part.len() {
            self.add(part);
            zeros(self, count - part.len());
            return self;
        }
        let (before, behind) = part.split_at_checked(count).unwrap_or_default();
        self.add(before).add(".").add(behind)
    }

    /// Adds a number with so many decimals, rounded to the nearest, or to the even one between two.
    pub(crate) fn fixed(&mut self, value: f32, decimals: u8) -> &mut Self {
        if !value.is_finite() {
            return self.not_finite(value);
        }
        let sign = if value.is_sign_negative() { "-" } else { "" };
        let scale = (0..decimals).fold(1_u64, |scale, _| scale * 10);
        #[expect(clippy::cast_precision_loss, reason = "a power of ten below 2^53")]
        let scaled = f64::from(value.abs()) * scale as f64;
        // The product is exact. A number that large is whole, and none of the camera's is larger
        // than 2⁶⁴, where its shortest digits are written.
        if scaled >= 9e15 {
            if value.abs() < 1.8e19 {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "positive and below 2^64"
                )]
                self.add(sign).whole(value.abs() as u64);
            } else {
                self.number(value);
            }
            self.add(".");
            return self.padded(0, usize::from(decimals));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive and below 2^53"
        )]
        let units = libm::rint(scaled) as u64;
        // The scale is not 0, and the compiler does not see it.
        let whole = units.checked_div(scale).unwrap_or_default();
        self.add(sign).whole(whole).add(".");
        self.padded(units - whole * scale, usize::from(decimals))
    }

    fn not_finite(&mut self, value: f32) -> &mut Self {
        self.add(if value.is_nan() {
            "NaN"
        } else if value > 0.0 {
            "inf"
        } else {
            "-inf"
        })
    }
}

/// Returns what is before and behind the first such byte of ASCII. Unlike `str::split_once` it has
/// no panic that a compiler for size would have to remove.
fn split_at(text: &str, at: u8) -> Option<(&str, &str)> {
    let place = text.bytes().position(|byte| byte == at)?;
    text.get(..place).zip(text.get(place + 1..))
}

/// Returns the number of digits with a sign.
fn integer(text: &str) -> i32 {
    let (digits, sign) = text.strip_prefix('-').map_or((text, 1), |text| (text, -1));
    let number = digits
        .bytes()
        .fold(0_i32, |number, digit| 10 * number + i32::from(digit - b'0'));
    sign * number
}

/// Returns the whole number of the digits before and behind a point.
fn whole_number_of(whole: &str, part: &str) -> u32 {
    let digits = whole.bytes().chain(part.bytes());
    digits.fold(0, |number: u32, digit| {
        number
            .wrapping_mul(10)
            .wrapping_add(u32::from(digit.wrapping_sub(b'0')))
    })
}

/// Returns true if a number lies midway between `lower` and the next whole number, times a power of
/// ten. Only with exponents as here is that possible in single precision, and the products are exact.
fn is_midway(value: f32, lower: u32, exponent: i32) -> bool {
    let power = |exponent: i32| (0..exponent).fold(1.0_f64, |power, _| power * 10.0);
    let midway = f64::from(lower) + 0.5;
    let value = f64::from(value.abs());
    if exponent < 0 {
        exponent >= -13 && (value * power(-exponent)).to_bits() == midway.to_bits()
    } else {
        exponent <= 13 && value.to_bits() == (midway * power(exponent)).to_bits()
    }
}
