//! Residual grids: evaluation against the spline in double precision, bounds, and files that are
//! refused.

use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{
    GridCarrier, GridError, GridHeader, MAX_NODES, PlacedGrid, ResidualGrid,
};
use fmc_camera::geometry::sensor::FmcAxis;

use super::spline::{file, header, noise, rounded, strict, wave};

#[path = "../kernel/src/grid_bits.rs"]
mod grid_bits;

/// Rounding of the evaluation for 3 µm of structure in waves of ten nodes, nm.
const ROUNDING_NM: f64 = 0.1;
/// The same without any order, so that neighbours differ by 6 µm.
const ROUNDING_OF_NOISE_NM: f64 = 0.3;

fn value(grid: &PlacedGrid<'_>, point: SensorPoint) -> [f64; 2] {
    let found = grid.displacement(point);
    [found.dx_mm, found.dy_mm].map(f64::from)
}

/// Returns points between the corners of the cells, corners included.
fn points(grid: &ResidualGrid<'_>) -> impl Iterator<Item = SensorPoint> {
    let [from, to] = grid.cells();
    let along = |from: f32, to: f32, i: u8| from + (to - from) * f32::from(i) / 96.0;
    (0..=96_u8).flat_map(move |i| {
        (0..=96_u8).map(move |j| {
            SensorPoint::new(along(from.x_mm, to.x_mm, j), along(from.y_mm, to.y_mm, i))
        })
    })
}

#[test]
fn evaluation_is_within_a_tenth_of_a_nanometre_of_the_spline() {
    for (coefficient, allowed_nm) in [
        (wave as fn(u16, u16) -> [i16; 2], ROUNDING_NM),
        (noise, ROUNDING_OF_NOISE_NM),
    ] {
        let bytes = file(&header(), coefficient);
        let grid = ResidualGrid::parse(&bytes).unwrap();
        let placed = PlacedGrid::calibrated(&grid);
        let mut largest_nm = 0.0_f64;
        for point in points(&grid) {
            let expected = strict(&grid, [point.x_mm, point.y_mm].map(f64::from));
            for (found, expected) in value(&placed, point).into_iter().zip(expected) {
                largest_nm = largest_nm.max(1e6 * (found - expected).abs());
            }
        }
        assert!(largest_nm <= allowed_nm, "{largest_nm} nm");
    }
}

#[test]
fn bits_are_those_of_the_target() {
    assert_eq!(grid_bits::bits(), Some(grid_bits::BITS));
    let corrected = grid_bits::correction_bits();
    assert_eq!(corrected, Some(grid_bits::CORRECTION_BITS));
}

#[test]
fn grid_of_the_lens_moves_with_the_principal_point_and_that_of_the_sensor_stays() {
    let kappa = 1.3e-4_f32;
    for axis in FmcAxis::ALL {
        for carrier in [GridCarrier::Lens, GridCarrier::Sensor] {
            let header = GridHeader {
                carrier,
                ..header()
            };
            let bytes = file(&header, wave);
            let grid = ResidualGrid::parse(&bytes).unwrap();
            let placed = PlacedGrid::new(&grid, axis, 0.15, kappa);
            for point in [(11.3, -7.9), (-24.0, 18.5)] {
                let [mut x, mut y] = [point.0, point.1].map(f64::from);
                if carrier == GridCarrier::Lens {
                    let centre = axis.sensor_from_offset(SensorPoint::default(), 0.15);
                    x = (x - f64::from(centre.x_mm)) / (1.0 + f64::from(kappa));
                    y = (y - f64::from(centre.y_mm)) / (1.0 + f64::from(kappa));
                }
                let expected = strict(&grid, [x, y]);
                let found = value(&placed, SensorPoint::new(point.0, point.1));
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!(1e6 * (found - expected).abs() <= ROUNDING_NM);
                }
            }
        }
    }
}

#[test]
fn beyond_the_cells_the_value_is_that_of_the_border_and_a_nan_stays_one() {
    let bytes = file(&header(), noise);
    let grid = ResidualGrid::parse(&bytes).unwrap();
    let placed = PlacedGrid::calibrated(&grid);
    let [from, to] = grid.cells();
    let at = |x, y| placed.displacement(SensorPoint::new(x, y));
    assert_eq!(at(-1e9, 3.3), at(from.x_mm, 3.3));
    assert_eq!(at(f32::INFINITY, f32::NEG_INFINITY), at(to.x_mm, from.y_mm));
    assert_ne!(at(to.x_mm, 3.3), at(to.x_mm - 0.5, 3.3));
    for point in [(f32::NAN, 0.0), (0.0, f32::NAN)] {
        let found = at(point.0, point.1);
        assert!(found.dx_mm.is_nan() && found.dy_mm.is_nan());
    }
}

/// The bound holds for all pairs of points; a ramp reaches it.
#[test]
fn slope_is_bounded_by_differences_of_coefficients() {
    for (coefficient, least_share) in [
        (wave as fn(u16, u16) -> [i16; 2], 0.5),
        (noise, 0.2),
        (
            |column, row| {
                [0, 0].map(|zero: i16| {
                    zero + rounded(f64::from(column) * 30.0 - f64::from(row) * 7.0)
                })
            },
            0.999,
        ),
    ] {
        let bytes = file(&header(), coefficient);
        let grid = ResidualGrid::parse(&bytes).unwrap();
        let bound = f64::from(grid.bounds().slope());
        let step = 1e-4;
        let mut steepest = 0.0_f64;
        for point in points(&grid).step_by(17) {
            let [x, y] = [point.x_mm, point.y_mm].map(f64::from);
            let centre = strict(&grid, [x, y]);
            for direction in 0..24_u8 {
                let angle = f64::from(direction) * std::f64::consts::PI / 12.0;
                let to = [x + step * angle.cos(), y + step * angle.sin()];
                let inside = grid
                    .cells()
                    .map(|cell| [cell.x_mm, cell.y_mm].map(f64::from));
                if (0..2).any(|i| to[i] < inside[0][i] || to[i] > inside[1][i]) {
                    continue;
                }
                let moved = strict(&grid, to);
                let slope = (moved[0] - centre[0]).hypot(moved[1] - centre[1]) / step;
                steepest = steepest.max(slope);
            }
        }
        assert!(steepest <= bound * (1.0 + 1e-6), "{steepest} > {bound}");
        assert!(steepest >= least_share * bound, "{steepest} of {bound}");
    }
}

/// A parabola along one axis has the same second difference everywhere, so that the mean over the
/// exposure differs from the value at the centroid by exactly the bound.
#[test]
fn second_moment_is_bounded_by_second_differences() {
    let parabola = |node: u16| {
        let place = f64::from(node) - 12.0;
        rounded(40.0 * place * place)
    };
    for along_x in [true, false] {
        let bytes = file(&header(), |column, row| {
            [0, parabola(if along_x { column } else { row })]
        });
        let grid = ResidualGrid::parse(&bytes).unwrap();
        let half_travel = 0.3;
        // Two instants of equal weight: the variance is the square of half their distance.
        let variance = half_travel * half_travel;
        let along = |offset: f64| {
            if along_x {
                [3.1 + offset, 2.2]
            } else {
                [3.1, 2.2 + offset]
            }
        };
        let mean = [-half_travel, half_travel]
            .map(|offset| strict(&grid, along(offset))[1])
            .iter()
            .sum::<f64>()
            / 2.0;
        let left_out = (mean - strict(&grid, along(0.0))[1]).abs();
        #[expect(clippy::cast_possible_truncation, reason = "0.09")]
        let variance = variance as f32;
        let bound = f64::from(grid.bounds().second_moment_mm(variance, along_x));
        assert!((left_out / bound - 1.0).abs() < 1e-4, "{left_out} {bound}");
        let across = grid.bounds().second_moment_mm(variance, !along_x);
        assert!(across.abs() < 1e-12, "{across}");
    }
}

#[test]
fn header_and_coefficients_are_those_of_the_file() {
    let bytes = file(&header(), noise);
    assert_eq!(&bytes[..4], b"FMCG");
    assert_eq!(bytes.len(), header().file_bytes());
    assert_eq!(bytes.len(), 28 + 4 * 31 * 25 + 4);
    let check = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&bytes[..bytes.len() - 4]);
    assert_eq!(bytes[bytes.len() - 4..], check.to_le_bytes());
    let grid = ResidualGrid::parse(&bytes).unwrap();
    assert_eq!(*grid.header(), header());
    assert_eq!(grid.coefficient(30, 24), Some(noise(30, 24)));
    assert_eq!(grid.coefficient(1, 2), Some(noise(1, 2)));
    assert_eq!(grid.coefficient(31, 0), None);
    assert_eq!(grid.coefficient(0, 25), None);
}

#[test]
fn damaged_files_are_refused() {
    let bytes = file(&header(), wave);
    for index in 0..bytes.len() {
        for bit in [0_u8, 7] {
            let mut damaged = bytes.clone();
            damaged[index] ^= 1 << bit;
            assert!(ResidualGrid::parse(&damaged).is_err(), "byte {index}");
        }
    }
    let mut last = bytes.clone();
    *last.last_mut().unwrap() ^= 0x10;
    assert!(matches!(
        ResidualGrid::parse(&last),
        Err(GridError::Crc { stored, computed }) if stored ^ computed == 0x1000_0000
    ));
    for length in 0..bytes.len() {
        assert!(matches!(
            ResidualGrid::parse(&bytes[..length]),
            Err(GridError::Length { bytes, expected }) if bytes == length && expected > length
        ));
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    let expected = bytes.len();
    assert_eq!(
        ResidualGrid::parse(&longer),
        Err(GridError::Length {
            bytes: expected + 1,
            expected
        })
    );
}

/// Returns the error of a file of a header, with the right CRC.
fn refused(header: &GridHeader) -> GridError {
    ResidualGrid::parse(&file(header, |_, _| [0, 0])).unwrap_err()
}

#[test]
fn numbers_that_are_not_allowed_are_refused_by_name() {
    for pitch_mm in [0.0, -2.0, 1000.0, f32::INFINITY] {
        let header = GridHeader {
            pitch_mm,
            ..header()
        };
        assert_eq!(refused(&header), GridError::Pitch { pitch_mm });
    }
    for scale_mm in [0.0, -1e-7, 1.0, f32::INFINITY] {
        let header = GridHeader {
            scale_mm,
            ..header()
        };
        assert_eq!(refused(&header), GridError::Scale { scale_mm });
    }
    let no_number = |header: GridHeader| refused(&header).to_string().contains("NaN");
    assert!(no_number(GridHeader {
        pitch_mm: f32::NAN,
        ..header()
    }));
    assert!(no_number(GridHeader {
        scale_mm: f32::NAN,
        ..header()
    }));
    for first_node in [
        SensorPoint::new(f32::NAN, 0.0),
        SensorPoint::new(0.0, f32::NAN),
    ] {
        assert!(no_number(GridHeader {
            first_node,
            ..header()
        }));
    }
    let sides = |columns, rows| GridHeader {
        columns,
        rows,
        ..header()
    };
    for (columns, rows) in [
        (3, 30),
        (30, 3),
        (0, 0),
        (65, 64),
        (4, 1025),
        (65535, 65535),
    ] {
        // Its coefficients would be too many to be written.
        let mut bytes = sides(columns, rows).to_bytes().to_vec();
        bytes.extend(GridHeader::checksum(&bytes).to_le_bytes());
        let error = ResidualGrid::parse(&bytes).unwrap_err();
        assert_eq!(error, GridError::Nodes { columns, rows });
    }
    let largest = file(&sides(64, 64), noise);
    assert!(ResidualGrid::parse(&largest).is_ok());
    assert_eq!(64 * 64, MAX_NODES);
    let with = |index: usize, byte: u8| {
        let mut bytes = file(&header(), wave);
        bytes[index] = byte;
        ResidualGrid::parse(&bytes).unwrap_err()
    };
    assert_eq!(
        with(0, b'G'),
        GridError::NoGrid {
            begins_with: *b"GMCG"
        }
    );
    assert_eq!(with(4, 2), GridError::Version(2));
    assert_eq!(with(6, 2), GridError::Carrier(2));
}

#[test]
fn grid_that_ends_inside_the_region_is_refused() {
    let bytes = file(&header(), wave);
    let grid = ResidualGrid::parse(&bytes).unwrap();
    let [from, to] = grid.cells();
    assert_eq!((from.x_mm, from.y_mm), (-28.0, -22.0));
    assert_eq!((to.x_mm, to.y_mm), (28.0, 22.0));
    assert_eq!(grid.covering(from, to), Ok(grid));
    for (from, to) in [
        ((-28.001, -22.0), (28.0, 22.0)),
        ((-28.0, -22.001), (28.0, 22.0)),
        ((-28.0, -22.0), (28.001, 22.0)),
        ((-28.0, -22.0), (28.0, 22.001)),
        ((-28.0, f32::NAN), (28.0, 22.0)),
    ] {
        let covered = grid.covering(
            SensorPoint::new(from.0, from.1),
            SensorPoint::new(to.0, to.1),
        );
        assert!(matches!(covered, Err(GridError::Uncovered { .. })));
    }
}
