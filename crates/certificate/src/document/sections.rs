//! The sections of a certificate.

mod camera;
mod evidence;
mod movement;
mod residual;

use super::block::Section;
use crate::content::Certificate;

/// Returns all sections, in order.
pub(super) fn all(certificate: &Certificate) -> Vec<Section> {
    let mut sections = vec![
        camera::identity(certificate),
        camera::parameters(certificate),
        camera::distortion(certificate),
    ];
    sections.extend(residual::grids(certificate));
    sections.extend([
        movement::motion(certificate),
        evidence::proof(certificate),
        evidence::exchange(certificate),
        evidence::signatures(certificate),
    ]);
    sections
}
