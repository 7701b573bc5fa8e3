//! Files of every program, damaged at random.

use fmc_exchange::found::Stated;
use fmc_exchange::import::import;
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;

use crate::support::{ixm, written};

#[test]
fn damaged_files_are_refused_or_read_and_nothing_else() {
    let stated = Stated {
        size_px: Some([14204, 10652]),
        is_correction: Some(true),
        pixel_mm: Some(0.003_76),
        ..Stated::default()
    };
    let mut state = 1_u64;
    let mut random = |below: usize| {
        // Knuth's multiplier; the upper bits are the better ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        usize::try_from(state >> 33).unwrap() % below
    };
    let (mut read, mut refused) = (0, 0);
    for program in Program::WRITTEN {
        let whole = written(&ixm(), program, "").files[0].1.clone();
        for _ in 0..40 {
            let mut bytes = whole.clone();
            for _ in 0..=random(3) {
                let place = random(bytes.len());
                match random(4) {
                    0 => bytes.truncate(place.max(1)),
                    1 => bytes[place] = b"0-.e{}[]<>&*\0\"\n:"[random(16)],
                    2 => drop(bytes.remove(place)),
                    _ => bytes.insert(place, b'9'),
                }
            }
            let source = Source {
                file: "a.file",
                bytes: &bytes,
            };
            match import(program, &source, &stated) {
                Ok(imported) => {
                    assert!(imported.residual.rms_um.is_finite());
                    read += 1;
                }
                Err(error) => {
                    assert!(error.to_string().starts_with("a.file: "), "{error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(read > 50 && refused > 50, "{read} {refused}");
}
