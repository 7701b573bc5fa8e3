//! Residual grid: points, and the reading of a file.

use core::hint::black_box;

use fmc_camera::Camera;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, PlacedGrid, ResidualGrid};
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};

use crate::counter::Counter;
use crate::specimen::{EXPOSURE, POINTS, points, short};

/// 53 mm by 40 mm and a stroke of 4 mm, at 2 mm.
const HEADER: GridHeader = GridHeader {
    carrier: GridCarrier::Lens,
    columns: 31,
    rows: 25,
    first_node: SensorPoint::new(-30.0, -24.0),
    pitch_mm: 2.0,
    scale_mm: 1e-7,
};
const BYTES: usize = 28 + 4 * 31 * 25 + 4;
#[expect(clippy::cast_possible_truncation, reason = "1024 points")]
const PER_POINT: (u32, &str) = (POINTS as u32, "point");

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let file = file()?;
    counter.count("grid_load", (1, "grid"), || {
        black_box(ResidualGrid::parse(black_box(&file)).ok()?);
        Some(())
    })?;
    let grid = ResidualGrid::parse(&file).ok()?;
    let placed = PlacedGrid::new(&grid, FmcAxis::PlusY, 0.15, 1e-4);
    let points = points();
    counter.count("grid", PER_POINT, || {
        for point in black_box(&points) {
            black_box(black_box(&placed).displacement(*point));
        }
        Some(())
    })?;
    corrections(counter, grid)
}

/// Counts the points of an exposure with a grid of the lens, one after the other, and as a slice;
/// the polynomial alone is `correct`, `distort`.
fn corrections(counter: &mut Counter, lens: ResidualGrid<'_>) -> Option<()> {
    let mut parameters = short();
    // The cells leave 2 mm less a rounding beyond the sensor.
    parameters.calibration.stroke_mm = 3.9;
    let camera = Camera::new(parameters).ok()?;
    let frame = camera.frame(&EXPOSURE).ok()?;
    let (motion, kappa) = (frame.interior.motion, frame.interior.enlargement);
    counter.count("grid_place", (1, "frame"), || {
        let grids = CameraGrids::new(black_box(camera.calibration()), Some(lens), None).ok()?;
        let correction = GriddedCorrection::exposed(frame.correction, &grids, &motion, kappa);
        black_box(correction);
        Some(())
    })?;
    let grids = CameraGrids::new(camera.calibration(), Some(lens), None).ok()?;
    let correction = GriddedCorrection::exposed(frame.correction, &grids, &motion, kappa);
    let points = points();
    counter.count("correct_grid", PER_POINT, || {
        for point in black_box(&points) {
            black_box(black_box(&correction).correct(*point));
        }
        Some(())
    })?;
    let mut slice = points;
    counter.count("correct_slice_grid", PER_POINT, || {
        black_box(&correction).correct_slice(black_box(&mut slice));
        Some(())
    })?;
    counter.count("distort_grid", PER_POINT, || {
        for point in black_box(&points) {
            black_box(black_box(&correction).distort(*point).ok()?);
        }
        Some(())
    })
}

/// Returns a file whose coefficients have no order.
fn file() -> Option<[u8; BYTES]> {
    let mut file = [0; BYTES];
    let (head, rest) = file.split_first_chunk_mut()?;
    *head = HEADER.to_bytes();
    let (nodes, _) = rest.split_last_chunk_mut::<4>()?;
    let mut word = 1_u32;
    for node in nodes.as_chunks_mut().0 {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *node = word.to_be_bytes();
    }
    let (checked, crc) = file.split_last_chunk_mut()?;
    *crc = GridHeader::checksum(checked).to_le_bytes();
    Some(file)
}
