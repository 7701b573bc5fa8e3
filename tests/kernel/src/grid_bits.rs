//! Residual grids at random points: all bits of the displacements, and of the corrections and
//! inverses of an exposure with two grids, each in one number, which is the same on the PC and on
//! the target.

use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, PlacedGrid, ResidualGrid};
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::principal_distance::{FocusShift, FocusSign};
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};

/// The number of [`bits`].
pub(crate) const BITS: u32 = 0x7343_00d8;

/// The number of [`correction_bits`].
pub(crate) const CORRECTION_BITS: u32 = 0x6c0e_b535;

/// Number of points.
pub(crate) const POINTS: u16 = 50_000;

const HEADER: GridHeader = GridHeader {
    carrier: GridCarrier::Lens,
    columns: 31,
    rows: 25,
    first_node: SensorPoint::new(-30.0, -24.0),
    pitch_mm: 2.0,
    scale_mm: 1e-7,
};
const BYTES: usize = 28 + 4 * 31 * 25 + 4;

/// Returns the bits of the displacements at points within the cells and beyond, folded; `None` if
/// the file is refused.
pub(crate) fn bits() -> Option<u32> {
    let mut random = Random(1);
    let file = file(GridCarrier::Lens, &mut random)?;
    let grid = ResidualGrid::parse(&file).ok()?;
    let placed = PlacedGrid::new(&grid, FmcAxis::MinusX, 0.15, 1.3e-4);
    let mut folded = OFFSET_BASIS;
    for _ in 0..POINTS {
        let d = placed.displacement(random.point());
        for component in [d.dx_mm, d.dy_mm] {
            folded = with(folded, component);
        }
    }
    Some(folded)
}

/// Returns the bits of the ideal points, the distortions and, where there are any, the measured
/// points of random ones, folded; `None` if the grids are refused.
pub(crate) fn correction_bits() -> Option<u32> {
    let mut random = Random(1);
    let lens_file = file(GridCarrier::Lens, &mut random)?;
    let sensor_file = file(GridCarrier::Sensor, &mut random)?;
    let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    parameters.axis = FmcAxis::MinusX;
    parameters.stroke_mm = 2.0;
    parameters.distortion.k1 = -1.6056e-5;
    parameters.distortion.k2 = 6.18966e-9;
    parameters.distortion.p1 = 2e-6;
    let calibration = Calibration::new(parameters).ok()?;
    let lens = ResidualGrid::parse(&lens_file).ok()?;
    let sensor = ResidualGrid::parse(&sensor_file).ok()?;
    let grids = CameraGrids::new(&calibration, Some(lens), Some(sensor)).ok()?;
    let travel = UniformTravel {
        opening_offset_mm: 0.15,
        speed_mm_s: -8.0,
        exposure_s: 0.01,
    };
    let shutter = Shutter::new(ShutterProfile::Uniform).ok()?;
    let motion = PrincipalPointMotion::from_plan(travel, &shutter);
    let focus = FocusShift {
        shift_mm: 0.01,
        principal_distance_mm: parameters.principal_distance_mm,
        exit_pupil_mm: parameters.exit_pupil_mm,
        sign: FocusSign::Physical,
    };
    let polynomial = FrameCorrection::exact(&calibration, &motion, &focus);
    let correction = GriddedCorrection::exposed(polynomial, &grids, &motion, focus.enlargement());
    let mut folded = with(OFFSET_BASIS, correction.left_out_nm());
    for _ in 0..POINTS {
        let point = random.point();
        let answer = correction.correct(point);
        for number in [
            answer.point.x_mm,
            answer.point.y_mm,
            answer.distortion.dx_mm,
            answer.distortion.dy_mm,
        ] {
            folded = with(folded, number);
        }
        // As many of the ideal points lie off the sensor as of the measured ones.
        if let Ok(measured) = correction.distort(point) {
            folded = with(with(folded, measured.point.x_mm), measured.point.y_mm);
        }
    }
    Some(folded)
}

/// Linear congruence.
struct Random(u32);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }

    /// Returns a coordinate within 32 mm, in steps of a 2⁻¹⁰th.
    fn coordinate(&mut self) -> f32 {
        let [high, low, ..] = self.next().to_be_bytes();
        f32::from(i16::from_be_bytes([high, low])) / 1024.0
    }

    fn point(&mut self) -> SensorPoint {
        let x_mm = self.coordinate();
        SensorPoint::new(x_mm, self.coordinate() * 0.8)
    }
}

/// Returns a file with coefficients of all sizes.
fn file(carrier: GridCarrier, random: &mut Random) -> Option<[u8; BYTES]> {
    let mut file = [0; BYTES];
    let (head, rest) = file.split_first_chunk_mut()?;
    *head = GridHeader { carrier, ..HEADER }.to_bytes();
    let (nodes, _) = rest.split_last_chunk_mut::<4>()?;
    for node in nodes.as_chunks_mut().0 {
        *node = random.next().to_be_bytes();
    }
    let (checked, crc) = file.split_last_chunk_mut()?;
    *crc = GridHeader::checksum(checked).to_le_bytes();
    Some(file)
}

/// Start of the folding by multiplication (FNV-1a).
const OFFSET_BASIS: u32 = 0x811c_9dc5;

/// Returns the folded bits with those of a number.
fn with(folded: u32, number: f32) -> u32 {
    (folded ^ number.to_bits()).wrapping_mul(0x0100_0193)
}
