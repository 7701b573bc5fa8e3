//! Numbers of a few digits, as coordinates are written: `-12.3456`.
//!
//! Their digits are read eight at a time without a branch on how many there are, which is almost
//! random: a mispredicted branch takes longer than a number.

/// Characters that are read at once: the digits before the point and one behind them, or those
/// behind it.
const CHARACTERS: usize = 8;

/// Powers of ten by which the digits are divided.
const SCALES: [u32; CHARACTERS] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000];

/// Reads a number of at most seven digits before a point and seven behind it, or without a point;
/// returns it, correctly rounded, and its length. `None` for any other text, which may be a number
/// as well, and for the last bytes of a text.
#[inline]
pub(super) fn parse_partial(text: &[u8]) -> Option<(f64, usize)> {
    let is_negative = *text.first()? == b'-';
    let sign = usize::from(is_negative);
    let whole = Digits::at(text, sign)?;
    let point = sign + whole.count;
    let decimals = if *text.get(point)? == b'.' {
        Some(Digits::at(text, point + 1)?)
    } else {
        None
    };
    let end = point + decimals.as_ref().map_or(0, |decimals| 1 + decimals.count);
    let decimals = decimals.unwrap_or_default();
    // Another sign, an exponent, a space or a word makes it another number, or none.
    if whole.count + decimals.count == 0 || !matches!(text.get(end)?, b',' | b'\n') {
        return None;
    }
    let scale = *SCALES.get(decimals.count)?;
    let digits = whole.value() * u64::from(scale) + decimals.value();
    // Both are exact, so that the quotient is rounded once.
    #[expect(clippy::cast_precision_loss, reason = "14 digits are less than 2^53")]
    let magnitude = digits as f64 / f64::from(scale);
    Some((if is_negative { -magnitude } else { magnitude }, end))
}

/// Digits, each in a byte by its value, the first in the lowest; zeros in the bytes below them.
#[derive(Default)]
struct Digits {
    bytes: u64,
    count: usize,
}

impl Digits {
    /// Takes the digits from a place on; `None` if none of the next eight characters ends them.
    #[inline]
    fn at(text: &[u8], from: usize) -> Option<Self> {
        let characters = text.get(from..)?.first_chunk::<CHARACTERS>()?;
        let values = u64::from_le_bytes(*characters) ^ 0x3030_3030_3030_3030;
        // The top bit of a byte is set for every value above 9; a carry reaches only bytes behind
        // the first of them.
        let ends = (values.wrapping_add(0x7676_7676_7676_7676) | values) & 0x8080_8080_8080_8080;
        if ends == 0 {
            return None;
        }
        let count = ends.trailing_zeros() / 8;
        // Eight bytes are shifted out in two steps.
        let bytes = values << 8 << (56 - 8 * count);
        Some(Self {
            bytes: if count == 0 { 0 } else { bytes },
            count: count as usize,
        })
    }

    /// Joins the digits to pairs, to fours and to eight.
    #[inline]
    const fn value(&self) -> u64 {
        let pairs = (self.bytes * 10 + (self.bytes >> 8)) & 0x00ff_00ff_00ff_00ff;
        let fours = (pairs * 100 + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
        (fours * 10_000 + (fours >> 32)) & 0xffff_ffff
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares it with the general reader where it answers; returns `true` if it does.
    fn is_short(text: &str) -> bool {
        let found = parse_partial(text.as_bytes());
        let general = fast_float2::parse_partial::<f64, _>(text.as_bytes()).ok();
        let bits = |(number, length): (f64, usize)| (number.to_bits(), length);
        if found.is_some() {
            assert_eq!(found.map(bits), general.map(bits), "{text:?}");
        }
        found.is_some()
    }

    #[test]
    fn coordinates_are_short_and_have_the_bits_of_the_general_reader() {
        let mut random = fastrand::Rng::with_seed(19);
        for _ in 0..300_000 {
            let value = 10_f64.powi(random.i32(-3..7)) * (random.f64() - 0.5);
            let decimals = random.usize(0..8);
            assert!(is_short(&format!("{value:.decimals$},p7,-4.5,")), "{value}");
        }
    }

    #[test]
    fn any_characters_are_left_to_the_general_reader_or_read_as_by_it() {
        const CHARACTERS: &[u8] = b"0123456789999000..--+eE,\n \"xnif";
        let mut random = fastrand::Rng::with_seed(20);
        let mut short = 0;
        for _ in 0..500_000 {
            let text: String = (0..random.usize(0..24))
                .map(|_| char::from(CHARACTERS[random.usize(..CHARACTERS.len())]))
                .collect();
            short += usize::from(is_short(&text));
        }
        assert!(short > 10_000, "{short}");
    }

    #[test]
    fn numbers_at_the_ends_of_its_range_are_read_or_left() {
        let behind = ",,,,,,,,";
        for number in [
            "0",
            "-0",
            "-0.0",
            "1.",
            ".5",
            "-.5",
            "9999999",
            "-9999999.9999999",
            "0.0000001",
            "0000000.0000000",
        ] {
            assert!(is_short(&format!("{number}{behind}")), "{number}");
            assert!(is_short(&format!("{number}\n12345678")), "{number}");
        }
        for other in [
            "",
            "-",
            ".",
            "-.",
            "+1",
            "--1",
            "1e5",
            "1.5e5",
            "1 ",
            "12345678",
            "0.12345678",
            "nan",
            "1.2.3",
        ] {
            assert!(!is_short(&format!("{other}{behind}")), "{other}");
        }
        // Too near the end of what has been read.
        assert!(!is_short("1.5,"));
    }
}
