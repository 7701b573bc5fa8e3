//! Folders and documents that come with the source.
//!
//! | where | contents |
//! |---|---|
//! | `docs/conventions.md` | frames, signs, units, names and ranges |
//! | `docs/integration.md` | wiring, first exposure, settings, timing, remedy of every fault |
//! | `docs/board.md` | the firmware on a NUCLEO-H743ZI2: wiring, flashing, porting |
//! | `docs/link.md` | messages of the link for other languages: schema, test vectors |
//! | `docs/store.md` | a calibration in flash: layout, order of writes, what is lost when |
//! | `docs/errata.md` | departures from printed formulas; `docs/derivations` has the scripts |
//! | `docs/performance.md` | cost of a point; `docs/control_loop.md`: load of the control loop |
//! | `docs/instructions.csv`, `docs/footprint.csv`, `docs/limits.csv` | costs, and their limits |
//! | `examples` | points of a file, a mesh, a fit, records, a user's own mechanism |
//! | `tests` | tests of the library as its users see it |
//! | `crates`, `host-sim` | libraries and program of the PC; `host-sim/cameras` has camera files |
//! | `xtask`, `benches`, `fuzz` | the project's commands, counts and times, hostile input |
//!
//! The motion adds to the distortion of a 50 mm lens as shown (`docs/figures/dynamic-change.svg`):
#![doc = include_str!("../docs/figures/dynamic-change.svg")]
