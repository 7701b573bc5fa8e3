//! Numbers and names of TIFF tags.

use std::fmt;

/// A tag of a TIFF directory, shown with its name and number.
///
/// # Examples
/// ```
/// assert_eq!(fmc_raster::Tag(256).to_string(), "ImageWidth (256)");
/// assert_eq!(fmc_raster::Tag(65_000).to_string(), "tag 65000");
/// ```
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct Tag(pub u16);

/// Names of TIFF 6.0, its supplements, DNG, EXIF, GeoTIFF and GDAL.
const NAMES: [(u16, &str); 83] = [
    (254, "NewSubfileType"),
    (255, "SubfileType"),
    (256, "ImageWidth"),
    (257, "ImageLength"),
    (258, "BitsPerSample"),
    (259, "Compression"),
    (262, "PhotometricInterpretation"),
    (263, "Threshholding"),
    (264, "CellWidth"),
    (265, "CellLength"),
    (266, "FillOrder"),
    (269, "DocumentName"),
    (270, "ImageDescription"),
    (271, "Make"),
    (272, "Model"),
    (273, "StripOffsets"),
    (274, "Orientation"),
    (277, "SamplesPerPixel"),
    (278, "RowsPerStrip"),
    (279, "StripByteCounts"),
    (280, "MinSampleValue"),
    (281, "MaxSampleValue"),
    (282, "XResolution"),
    (283, "YResolution"),
    (284, "PlanarConfiguration"),
    (285, "PageName"),
    (288, "FreeOffsets"),
    (289, "FreeByteCounts"),
    (290, "GrayResponseUnit"),
    (291, "GrayResponseCurve"),
    (292, "T4Options"),
    (293, "T6Options"),
    (296, "ResolutionUnit"),
    (297, "PageNumber"),
    (301, "TransferFunction"),
    (305, "Software"),
    (306, "DateTime"),
    (315, "Artist"),
    (316, "HostComputer"),
    (317, "Predictor"),
    (318, "WhitePoint"),
    (319, "PrimaryChromaticities"),
    (320, "ColorMap"),
    (322, "TileWidth"),
    (323, "TileLength"),
    (324, "TileOffsets"),
    (325, "TileByteCounts"),
    (330, "SubIFDs"),
    (332, "InkSet"),
    (338, "ExtraSamples"),
    (339, "SampleFormat"),
    (340, "SMinSampleValue"),
    (341, "SMaxSampleValue"),
    (347, "JPEGTables"),
    (400, "GlobalParametersIFD"),
    (512, "JPEGProc"),
    (513, "JPEGInterchangeFormat"),
    (514, "JPEGInterchangeFormatLength"),
    (519, "JPEGQTables"),
    (520, "JPEGDCTables"),
    (521, "JPEGACTables"),
    (529, "YCbCrCoefficients"),
    (530, "YCbCrSubSampling"),
    (531, "YCbCrPositioning"),
    (532, "ReferenceBlackWhite"),
    (700, "XMP"),
    (33_432, "Copyright"),
    (33_550, "ModelPixelScale"),
    (33_723, "IPTC"),
    (33_922, "ModelTiepoint"),
    (34_264, "ModelTransformation"),
    (34_377, "Photoshop"),
    (34_665, "EXIF directory"),
    (34_675, "ICC profile"),
    (34_735, "GeoKeyDirectory"),
    (34_736, "GeoDoubleParams"),
    (34_737, "GeoAsciiParams"),
    (34_853, "GPS directory"),
    (37_724, "ImageSourceData"),
    (40_965, "interoperability directory"),
    (42_112, "GDAL_METADATA"),
    (42_113, "GDAL_NODATA"),
    (50_844, "RPCCoefficients"),
];

impl Tag {
    /// Returns the name where the tag has one.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        NAMES
            .iter()
            .find(|(number, _)| *number == self.0)
            .map(|(_, name)| *name)
    }
}

impl fmt::Display for Tag {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => write!(formatter, "{name} ({})", self.0),
            None => write!(formatter, "tag {}", self.0),
        }
    }
}

macro_rules! numbers {
    ($($name:ident = $number:literal),* $(,)?) => {
        impl Tag {
            $(
                #[doc = concat!("Tag ", stringify!($number), ".")]
                pub(crate) const $name: Tag = Tag($number);
            )*
        }
    };
}

numbers! {
    SUBFILE_TYPE = 254,
    OLD_SUBFILE_TYPE = 255,
    WIDTH = 256,
    LENGTH = 257,
    BITS = 258,
    COMPRESSION = 259,
    PHOTOMETRIC = 262,
    FILL_ORDER = 266,
    STRIP_OFFSETS = 273,
    ORIENTATION = 274,
    SAMPLES = 277,
    ROWS_PER_STRIP = 278,
    STRIP_BYTES = 279,
    PLANAR = 284,
    PREDICTOR = 317,
    TILE_WIDTH = 322,
    TILE_LENGTH = 323,
    TILE_OFFSETS = 324,
    TILE_BYTES = 325,
    EXTRA_SAMPLES = 338,
    SAMPLE_FORMAT = 339,
    XMP = 700,
    EXIF = 34_665,
    GPS = 34_853,
    INTEROP = 40_965,
}
