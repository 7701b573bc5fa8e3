//! Published cameras, which `verify` checks if it is given none.

/// File name and text of each camera file; the files and `host-sim/data/cameras.csv` name the
/// sources.
pub const CAMERA_FILES: [(&str, &str); 5] = [
    (
        "phase-one-ixm-rs150f-50.toml",
        include_str!("../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml"),
    ),
    (
        "phase-one-ixu-rs1000-50.toml",
        include_str!("../../../host-sim/cameras/phase-one-ixu-rs1000-50.toml"),
    ),
    (
        "rc30-5368.toml",
        include_str!("../../../host-sim/cameras/rc30-5368.toml"),
    ),
    (
        "rc30-5324.toml",
        include_str!("../../../host-sim/cameras/rc30-5324.toml"),
    ),
    (
        "rc30-5282.toml",
        include_str!("../../../host-sim/cameras/rc30-5282.toml"),
    ),
];
