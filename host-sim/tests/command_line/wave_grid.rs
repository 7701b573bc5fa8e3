//! Residual grids of waves for the tests of commands.

use fmc_camera::SensorPoint;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
use fmc_reference::residual_spline::ResidualSpline;
use fmc_reference::residual_splines::ResidualSplines;

/// Size of a grid: nodes along a side, about the middle of the sensor, and their distance, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    pub(crate) nodes: u16,
    pub(crate) pitch_mm: f32,
}

/// Returns the file of a grid with waves of an amplitude, µm, about ten nodes long, and its CRC-32.
pub(crate) fn wave_grid(
    carrier: GridCarrier,
    phase: f64,
    amplitude_um: f64,
    lattice: Lattice,
) -> (Vec<u8>, u32) {
    let Lattice { nodes, pitch_mm } = lattice;
    let first_mm = -0.5 * pitch_mm * f32::from(nodes - 1);
    let header = GridHeader {
        carrier,
        columns: nodes,
        rows: nodes,
        first_node: SensorPoint::new(first_mm, first_mm),
        pitch_mm,
        scale_mm: 1e-6,
    };
    let mut file = header.to_bytes().to_vec();
    for node in 0..nodes * nodes {
        let [column, row] = [node % nodes, node / nodes].map(f64::from);
        for along in [0.7 * column + 0.3 * row, 0.5 * row - 0.6 * column] {
            let value = 1000.0 * amplitude_um * (along + phase).sin();
            #[expect(clippy::cast_possible_truncation, reason = "at most 20000")]
            let value = value.round() as i16;
            file.extend(value.to_le_bytes());
        }
    }
    let crc = GridHeader::checksum(&file);
    file.extend(crc.to_le_bytes());
    (file, crc)
}

/// Files of grids of lens and sensor, `l.fmcg` and `s.fmcg`, and the table of the camera file that
/// names them.
#[derive(Debug, Clone)]
pub(crate) struct WaveGrids {
    pub(crate) lens: Vec<u8>,
    pub(crate) sensor: Vec<u8>,
    pub(crate) table: String,
}

impl WaveGrids {
    /// Returns grids with waves of an amplitude, µm.
    pub(crate) fn new(amplitude_um: f64, lattice: Lattice) -> Self {
        let (lens, lens_crc) = wave_grid(GridCarrier::Lens, 0.3, amplitude_um, lattice);
        let (sensor, sensor_crc) = wave_grid(GridCarrier::Sensor, 1.9, amplitude_um, lattice);
        let table = format!(
            "[grid]\nlens = \"l.fmcg\"\nlens_crc32 = \"{lens_crc:08x}\"\n\
             sensor = \"s.fmcg\"\nsensor_crc32 = \"{sensor_crc:08x}\"\n"
        );
        Self {
            lens,
            sensor,
            table,
        }
    }

    /// The files with their names.
    pub(crate) fn files(&self) -> [(&'static str, &[u8]); 2] {
        [("l.fmcg", &self.lens), ("s.fmcg", &self.sensor)]
    }

    /// The grids in double precision.
    pub(crate) fn splines(&self) -> ResidualSplines {
        let spline = |file: &[u8]| ResidualSpline::of(&ResidualGrid::parse(file).unwrap());
        ResidualSplines::new(Some(spline(&self.lens)), Some(spline(&self.sensor)))
    }
}
