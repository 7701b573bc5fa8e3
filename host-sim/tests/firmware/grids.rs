//! A camera with residual grids in QEMU: they come over the link, and it corrects with them.

use fmc_camera::geometry::grid::{GridCarrier, GridChecksums, GridHeader, ResidualGrid};
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::message::Grid;
use fmc_camera::{CalibrationParameters, CameraParameters, Exposure, SensorPoint};
use fmc_camera_file::GridFiles;
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice as _, Device as _, DeviceError, InProcess, Machine};

/// From rest, so that the grid of the lens has moved.
const EXPOSURE: Exposure = Exposure {
    opening_offset_mm: Some(0.2),
    ..Exposure::new(0.1, 0.005)
};

/// Returns the file of a grid of 65 x 51 nodes with structure of 3 µm that differs for every seed.
fn grid(carrier: GridCarrier, seed: i32) -> Vec<u8> {
    let header = GridHeader {
        carrier,
        columns: 65,
        rows: 51,
        first_node: SensorPoint::new(-44.8, -35.0),
        pitch_mm: 1.4,
        scale_mm: 1e-7,
    };
    let mut file = header.to_bytes().to_vec();
    for node in 0..65 * 51 {
        let value = |factor: i32| i16::try_from((node * factor + seed) % 60_001 - 30_000).unwrap();
        for component in [value(7919), value(104_729)] {
            file.extend(component.to_le_bytes());
        }
    }
    file.extend(GridHeader::checksum(&file).to_le_bytes());
    file
}

/// Returns a camera of 80 mm by 60 mm that states the grids, and their files.
pub(crate) fn camera(seed: i32) -> (CameraParameters, GridFiles) {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion.k1 = -1e-6;
    let files = [GridCarrier::Lens, GridCarrier::Sensor].map(|carrier| grid(carrier, seed));
    let [lens_crc, sensor_crc] = [0, 1].map(|index: usize| {
        let grid = ResidualGrid::parse(&files[index]).unwrap();
        Some(grid.crc32())
    });
    let camera = CameraParameters {
        grids: GridChecksums {
            lens: lens_crc,
            sensor: sensor_crc,
        },
        ..CameraParameters::new(lens)
    };
    let [lens, sensor] = files;
    (camera, GridFiles::new(Some(lens), Some(sensor)))
}

/// Requests that the camera has answered.
fn answered(qemu: &mut Qemu) -> u32 {
    qemu.counters().unwrap().unwrap().done
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn camera_with_both_grids_has_the_bits_computed_on_this_pc() {
    let (parameters, files) = camera(1);
    let mut twin = InProcess::default();
    twin.load_grids(&files).unwrap();
    twin.load(&parameters).unwrap();
    let interior = twin.expose(&EXPOSURE).unwrap();
    let points: Vec<SensorPoint> = (0..200_u8)
        .map(|index| {
            SensorPoint::new(
                0.38 * f32::from(index) - 38.0,
                28.0 - 0.28 * f32::from(index),
            )
        })
        .collect();
    let side = |half: f32| (0..21_u8).map(move |index| half * (f32::from(index) / 10.0 - 1.0));
    let lines = Grid {
        x_mm: side(40.0).collect(),
        y_mm: side(30.0).collect(),
    };
    let row = VertexRow {
        first_col_px: 480,
        row_px: 160,
        spacing_px: 16,
        count: 64,
        origin_px: [0, 0],
    };
    // Without grids the same camera corrects otherwise: they are in use.
    let mut plain = InProcess::default();
    plain
        .load(&CameraParameters {
            grids: GridChecksums::NONE,
            ..parameters
        })
        .unwrap();
    plain.expose(&EXPOSURE).unwrap();
    assert_ne!(twin.correct(&points), plain.correct(&points));
    for machine in [Machine::An386, Machine::An500] {
        let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
        qemu.load_grids(&files).unwrap();
        qemu.load(&parameters).unwrap();
        assert_eq!(qemu.expose(&EXPOSURE), Ok(interior));
        assert_eq!(qemu.correct(&points), twin.correct(&points));
        assert_eq!(qemu.distort(&points), twin.distort(&points));
        assert_eq!(qemu.correct_grid(&lines), twin.correct_grid(&lines));
        assert_eq!(qemu.evidence().by_digest, 441);
        assert_eq!(
            qemu.mesh(&row, MeshFormat::Single),
            twin.mesh(&row, MeshFormat::Single)
        );
        assert_eq!(qemu.corrections(&row), Err(DeviceError::PolynomialMesh));
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn grids_that_the_camera_has_do_not_come_again_and_a_restart_loses_them() {
    let ((one, grids_of_one), (other, grids_of_other)) = (camera(1), camera(2));
    let mut qemu = Qemu::start(Machine::An386, &QemuOptions::default()).unwrap();
    let missing = |camera: &CameraParameters| DeviceError::MissingGrid {
        carrier: GridCarrier::Lens,
        crc32: camera.grids.lens.unwrap(),
    };
    assert_eq!(qemu.load(&one), Err(missing(&one)));
    let requests_of = |qemu: &mut Qemu, camera: &CameraParameters, grids: &GridFiles| {
        let before = answered(qemu);
        qemu.load_grids(grids).unwrap();
        qemu.load(camera).unwrap();
        qemu.expose(&EXPOSURE).unwrap();
        answered(qemu) - before
    };
    assert!(requests_of(&mut qemu, &one, &grids_of_one) > 50);
    assert!(requests_of(&mut qemu, &one, &grids_of_one) < 10);
    assert!(requests_of(&mut qemu, &other, &grids_of_other) > 50);
    // Those of the camera before are still there.
    assert!(requests_of(&mut qemu, &one, &grids_of_one) < 10);
    qemu.remote().reset().unwrap();
    assert!(requests_of(&mut qemu, &one, &grids_of_one) > 50);
}
