//! Damage to files: what editors, other programs and bad disks do.

/// Numbers at which readers fail.
const NUMBERS: [&str; 16] = [
    "0",
    "-0.0",
    "-1",
    "1e-320",
    "1e39",
    "1e400",
    "-1e308",
    "nan",
    "inf",
    "4294967296",
    "9223372036854775808",
    "0x10",
    "1,5",
    "1.2.3",
    "''",
    "",
];

/// Signs that have a meaning in one format or another.
const SIGNS: &[u8] = b"09-.eE{}[]<>(),&*\0\"'\n:=";

/// A random source of damaged files.
pub(crate) struct Damage {
    random: fastrand::Rng,
}

impl Damage {
    pub(crate) fn with_seed(seed: u64) -> Self {
        Self {
            random: fastrand::Rng::with_seed(seed),
        }
    }

    /// Returns one of the files, damaged in one to three places.
    pub(crate) fn one_of(&mut self, files: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = files[self.random.usize(..files.len())].clone();
        for _ in 0..self.random.usize(1..4) {
            if bytes.is_empty() {
                return bytes;
            }
            self.damage(&mut bytes);
        }
        bytes
    }

    fn damage(&mut self, bytes: &mut Vec<u8>) {
        let place = self.random.usize(..bytes.len());
        match self.random.u8(..8) {
            0 => bytes.truncate(place),
            1 => bytes[place] ^= 1 << self.random.u8(..8),
            2 => drop(bytes.remove(place)),
            3 => bytes.insert(place, SIGNS[self.random.usize(..SIGNS.len())]),
            4 => drop(bytes.drain(line(bytes, place))),
            5 => {
                let line = line(bytes, place);
                let again = bytes[line.clone()].to_vec();
                drop(bytes.splice(line.end..line.end, again));
            }
            _ => {
                if let Some(number) = number(bytes, place) {
                    let other = NUMBERS[self.random.usize(..NUMBERS.len())];
                    drop(bytes.splice(number, other.bytes()));
                }
            }
        }
    }
}

/// Returns the line around a place, its end included.
fn line(bytes: &[u8], place: usize) -> std::ops::Range<usize> {
    let is_end = |byte: &u8| *byte == b'\n';
    let start = bytes[..place]
        .iter()
        .rposition(is_end)
        .map_or(0, |end| end + 1);
    let end = bytes[place..].iter().position(is_end);
    start..end.map_or(bytes.len(), |end| place + end + 1)
}

/// Returns the first number behind a place.
fn number(bytes: &[u8], place: usize) -> Option<std::ops::Range<usize>> {
    let is_of_one = |byte: &u8| byte.is_ascii_digit() || b"+-.eE".contains(byte);
    let start = place + bytes[place..].iter().position(u8::is_ascii_digit)?;
    let length = bytes[start..].iter().position(|byte| !is_of_one(byte));
    Some(start..length.map_or(bytes.len(), |length| start + length))
}
