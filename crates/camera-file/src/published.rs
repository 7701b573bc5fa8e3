//! The published cameras that `verify` checks when it is given none.

/// File name and text of each camera file; sources are named in the files and in
/// `host-sim/data/cameras.csv`.
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
