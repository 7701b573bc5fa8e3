//! Refusal of a sample.

use super::finding::VhFindingKind;

/// Finding for which a sample is not used, and the value it was compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Refusal {
    pub(super) kind: VhFindingKind,
    pub(super) expected: Option<f32>,
}
