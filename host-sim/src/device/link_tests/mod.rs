//! Tests of the link: every result is right, or an error.

#[cfg(test)]
mod answers;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod records;
#[cfg(test)]
mod sessions;

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::Grid;

use super::CorrectingDevice;
use super::error::DeviceError;
use super::faulty_port::FaultyPort;
use super::link_error::LinkError;
use super::remote::{Remote, Session};

fn camera() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion = Brown {
        k1: -1e-6,
        k2: 2e-10,
        p1: 1e-6,
        b1: 1e-5,
        ..Brown::default()
    };
    CameraParameters::new(lens)
}

fn points(count: u16) -> Vec<SensorPoint> {
    (0..count)
        .map(|index| SensorPoint::new(0.1 * f32::from(index) - 20.0, 0.05 * f32::from(index)))
        .collect()
}

fn grid() -> Grid {
    let side = |half: f32| (0..21_u8).map(move |index| half * (f32::from(index) / 10.0 - 1.0));
    Grid {
        x_mm: side(40.0).collect(),
        y_mm: side(30.0).collect(),
    }
}

const VERTICES: VertexRow = VertexRow {
    first_col_px: 480,
    row_px: 160,
    spacing_px: 16,
    count: 64,
    origin_px: [320, 64],
};

const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

/// Returns a camera that has been exposed, on a wire without faults so far.
fn exposed() -> (Remote<FaultyPort>, FaultyPort) {
    let port = FaultyPort::new([]);
    let mut remote = Remote::connect("test", port.clone(), Session::Whole).unwrap();
    remote.load(&camera()).unwrap();
    remote.expose(&EXPOSURE).unwrap();
    (remote, port)
}

fn link_error<T: std::fmt::Debug>(result: Result<T, DeviceError>) -> LinkError {
    match result.unwrap_err() {
        DeviceError::Link { error, .. } => error,
        other => panic!("{other}"),
    }
}
