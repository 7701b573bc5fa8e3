//! Node of a residual grid, as it is stored.

/// Bytes of a node: two of each component.
pub(super) const NODE_BYTES: usize = 4;

/// Returns the coefficients of x and y of a node.
#[inline]
pub(super) const fn components([x0, x1, y0, y1]: [u8; NODE_BYTES]) -> [i16; 2] {
    [i16::from_le_bytes([x0, x1]), i16::from_le_bytes([y0, y1])]
}
