//! Synthetic camera of several detectors, and what it records, with truth.

mod detector;
mod exposure;
mod judgement;
mod marks;
mod points;
mod request;
mod terrain;
mod texture;
mod true_rig;

pub use detector::{Detector, FULL_SCALE_DN};
pub use exposure::{Exposure, Scene};
pub use judgement::Judgement;
pub use marks::Mark;
pub use request::SceneRequest;
pub use terrain::Terrain;
pub use true_rig::{TrueRig, lens_of};
