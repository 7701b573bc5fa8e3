//! Folders and documents that come with the source.
//!
//! | where | what is in it |
//! |---|---|
//! | `docs/conventions.md` | frames, signs, units, names and ranges |
//! | `docs/integration.md` | from wiring to the first exposure; settings, timing diagram, cause and remedy of every fault |
//! | `docs/board.md` | the firmware on a NUCLEO-H743ZI2: wiring, flashing, porting |
//! | `docs/errata.md` | where and why the library departs from a printed formula; `docs/derivations` has the scripts |
//! | `docs/performance.md` | what a point costs, and why; `docs/control_loop.md`: what the control loop leaves of a core |
//! | `docs/instructions.csv`, `docs/footprint.csv`, `docs/limits.csv` | costs, and their limits |
//! | `examples` | a file's points corrected, a mesh, coefficients fitted, records read, a mechanism of one's own |
//! | `tests` | what a user of the library would check |
//! | `crates`, `host-sim` | libraries and program of the PC; `host-sim/cameras` has camera files |
//! | `xtask`, `benches`, `fuzz` | the project's commands, what is counted and timed, hostile input |
//!
//! `docs/figures/dynamic-change.svg`, what the motion adds to the distortion of a 50 mm lens:
#![doc = include_str!("../docs/figures/dynamic-change.svg")]
