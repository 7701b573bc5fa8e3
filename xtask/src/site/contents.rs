//! Contents of the site: the pages, in their order.

/// Heading of a part, or title and file of a page.
pub(super) enum Entry {
    Part(&'static str),
    Page(&'static str, &'static str),
}

use Entry::{Page, Part};

/// The site's pages, which are the project's documents. The first one is the site's entry.
pub(super) const CONTENTS: &[Entry] = &[
    Page("fmc-camera", "README.md"),
    Page("Start in five minutes", "docs/start.md"),
    Part("In the camera"),
    Page("Integration", "docs/integration.md"),
    Page("A board", "docs/board.md"),
    Page("The link", "docs/link.md"),
    Page("A calibration in flash", "docs/store.md"),
    Page("Load of the control loop", "docs/control_loop.md"),
    Page("The camera in C", "docs/c.md"),
    Part("Calibration"),
    Page("Camera file", "docs/camera-file.md"),
    Page("Calibration", "docs/calibration.md"),
    Page("Calibration by images", "docs/calibration-by-images.md"),
    Page("Certificate", "docs/certificate.md"),
    Page("A camera of six detectors", "docs/composition.md"),
    Part("Points, frames, images"),
    Page("Formats", "docs/formats.md"),
    Page("Blocks", "docs/blocks.md"),
    Page("TIFF", "docs/tiff.md"),
    Page("The camera in Python", "docs/python.md"),
    Page("A session in Python", "docs/python-session.md"),
    Page("The camera in a browser", "docs/demo/README.md"),
    Part("Reference"),
    Page("Conventions", "docs/conventions.md"),
    Page("Errata", "docs/errata.md"),
    Page("Hazards", "docs/safety.md"),
    Page("A campaign of faults", "docs/campaign.md"),
    Page("Model checks", "docs/models.md"),
    Page("Derivations", "docs/derivations/README.md"),
    Page("Performance", "docs/performance.md"),
    Page("Rounding", "docs/rounding.md"),
    Page("What is linked", "docs/supply-chain.md"),
    Page("Changes", "CHANGELOG.md"),
];
