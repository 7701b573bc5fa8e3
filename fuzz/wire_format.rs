//! A second implementation of the wire format, slow and simple, for tests to compare with.

use fmc_camera::io::link::LONGEST_PAYLOAD;

/// Returns the payload of the bytes between two zeros, if it is whole, fits and has the right CRC.
pub(crate) fn payload_of(frame: &[u8]) -> Option<Vec<u8>> {
    let (checked, crc) = frame.split_last_chunk::<5>()?;
    let (length, encoded) = checked.split_first_chunk::<2>()?;
    if *length != wire_from_length(encoded.len()) || *crc != wire_from_crc(checked) {
        return None;
    }
    let mut payload = Vec::new();
    let mut rest = encoded;
    while let Some((length, block)) = rest.split_first() {
        let length = usize::from(*length) - 1;
        payload.extend(block.get(..length)?);
        rest = &block[length..];
        if length < 254 && !rest.is_empty() {
            payload.push(0);
        }
    }
    (!encoded.is_empty() && payload.len() <= LONGEST_PAYLOAD).then_some(payload)
}

/// Writes a length: seven bits to a byte, and a bit that keeps it from being zero.
pub(crate) fn wire_from_length(length: usize) -> [u8; 2] {
    [length % 128, length / 128].map(|bits| u8::try_from(bits + 128).unwrap_or(0))
}

/// Writes the CRC of length and encoded bytes, in the same way.
pub(crate) fn wire_from_crc(checked: &[u8]) -> [u8; 5] {
    let mut rest = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(checked);
    [(); 5].map(|()| {
        let [low, ..] = (rest % 128).to_le_bytes();
        rest /= 128;
        low + 128
    })
}

/// Returns a frame around any payload, from the definition of COBS.
pub(crate) fn frame_of(payload: &[u8]) -> Vec<u8> {
    let mut wire = Vec::new();
    for block in payload.split(|byte| *byte == 0) {
        // A full block does not end with a zero, so another block follows it.
        let mut rest = block;
        while let Some((full, more)) = rest.split_at_checked(254) {
            wire.push(255);
            wire.extend(full);
            rest = more;
        }
        wire.extend(u8::try_from(rest.len() + 1));
        wire.extend(rest);
    }
    between_zeros(&wire)
}

/// Returns a frame around any bytes, encoded by COBS or not.
pub(crate) fn between_zeros(encoded: &[u8]) -> Vec<u8> {
    let checked = [&wire_from_length(encoded.len()), encoded].concat();
    [&[0], &checked[..], &wire_from_crc(&checked), &[0]].concat()
}
