//! Files of a mesh, written while it is computed.

use std::io::Write;

use crate::failure::Failure;
use crate::formats::output::{self, OutputFolder, Stopped};

/// Sinks of a mesh's bytes: one file, or two with the first and the second number of every vertex.
pub(super) struct Sinks<'a> {
    first: &'a mut dyn Write,
    second: Option<&'a mut dyn Write>,
    /// Numbers of one file.
    numbers: Vec<u8>,
}

impl Sinks<'_> {
    /// Writes the bytes of more vertices.
    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<(), Stopped> {
        let Some(second) = &mut self.second else {
            return Ok(self.first.write_all(bytes)?);
        };
        let (pairs, _) = bytes.as_chunks::<8>();
        part(pairs, &mut self.numbers, |[x0, x1, x2, x3, ..]| {
            [*x0, *x1, *x2, *x3]
        });
        self.first.write_all(&self.numbers)?;
        part(pairs, &mut self.numbers, |[.., y0, y1, y2, y3]| {
            [*y0, *y1, *y2, *y3]
        });
        Ok(second.write_all(&self.numbers)?)
    }
}

/// Takes one number of every pair.
fn part(pairs: &[[u8; 8]], numbers: &mut Vec<u8>, of: impl Fn(&[u8; 8]) -> [u8; 4]) {
    numbers.resize(4 * pairs.len(), 0);
    let (places, _) = numbers.as_chunks_mut::<4>();
    for (place, pair) in places.iter_mut().zip(pairs) {
        *place = of(pair);
    }
}

/// Writes a mesh's files, one or two, which appear when `body` has written all of them.
pub(super) fn write<T>(
    folder: &OutputFolder,
    names: &[&str],
    body: impl FnOnce(&mut Sinks<'_>) -> Result<T, Stopped>,
) -> Result<T, Failure> {
    let mut result = None;
    let paths: Vec<_> = names.iter().map(|name| folder.path().join(name)).collect();
    let [first, second @ ..] = paths.as_slice() else {
        return Err(Failure::bad_input("a mesh has no files".to_owned()));
    };
    output::stream(Some(first), |first| {
        let numbers = Vec::new();
        match second.first() {
            None => {
                result = Some(body(&mut Sinks {
                    first,
                    second: None,
                    numbers,
                })?);
            }
            Some(second) => output::stream(Some(second), |second| {
                result = Some(body(&mut Sinks {
                    first,
                    second: Some(second),
                    numbers,
                })?);
                Ok(())
            })?,
        }
        Ok(())
    })?;
    result.ok_or_else(|| Failure::bad_input("a mesh has no rows".to_owned()))
}
