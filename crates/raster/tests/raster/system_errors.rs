//! Errors of the operating system while a frame is read.

use std::io;
use std::sync::Arc;

use fmc_raster::{Compression, FrameReader, ReadError, Source};

use crate::tiff_bytes::TestFrame;

/// A file whose bytes from an offset on the operating system does not deliver.
struct Failing {
    bytes: Vec<u8>,
    from: u64,
}

impl Source for Failing {
    fn length(&self) -> io::Result<u64> {
        self.bytes.length()
    }

    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<usize> {
        if (self.from..self.from + 100).contains(&offset) {
            return Err(io::Error::from_raw_os_error(5));
        }
        self.bytes.read_at(offset, bytes)
    }
}

#[test]
fn error_of_the_operating_system_is_no_fault_of_the_file() {
    for compression in [
        Compression::None,
        Compression::PackBits,
        Compression::Lzw,
        Compression::Deflate,
        Compression::Zstd,
    ] {
        let frame = TestFrame {
            compression,
            ..TestFrame::default()
        };
        let source = Failing {
            bytes: frame.bytes(),
            from: 8,
        };
        let mut reader = FrameReader::new(Arc::new(source)).unwrap();
        let error = reader.read_rows(&mut [0_u16; 111]).unwrap_err();
        assert!(matches!(error, ReadError::Io { .. }), "{error}");
    }
}
