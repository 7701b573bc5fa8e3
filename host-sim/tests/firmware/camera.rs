//! The camera in QEMU, used as a device.

use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::message::{Grid, ResetCause};
use fmc_camera::{CalibrationParameters, CameraParameters, Exposure, SensorPoint};
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice as _, Device, DeviceError, InProcess, Machine};

const MACHINES: [Machine; 2] = [Machine::An386, Machine::An500];
const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

fn camera() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion.k1 = -1e-6;
    lens.distortion.p1 = 1e-6;
    lens.distortion.b2 = 1e-5;
    CameraParameters::new(lens)
}

fn exposed(machine: Machine) -> Qemu {
    let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
    qemu.load(&camera()).unwrap();
    qemu.expose(&EXPOSURE).unwrap();
    qemu
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn points_rows_grid_and_record_have_the_bits_computed_on_this_pc() {
    let mut twin = InProcess::default();
    twin.load(&camera()).unwrap();
    let record = twin.expose(&EXPOSURE).unwrap();
    let points: Vec<SensorPoint> = (0..200_u8)
        .map(|index| SensorPoint::new(0.2 * f32::from(index) - 20.0, -0.1 * f32::from(index)))
        .collect();
    let side = |half: f32| (0..21_u8).map(move |index| half * (f32::from(index) / 10.0 - 1.0));
    let grid = Grid {
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
    for machine in MACHINES {
        let mut qemu = exposed(machine);
        assert_eq!(qemu.correct(&points), twin.correct(&points));
        assert_eq!(qemu.distort(&points), twin.distort(&points));
        assert_eq!(qemu.correct_grid(&grid), twin.correct_grid(&grid));
        assert_eq!(qemu.remote().interior_orientation(), Ok(record));
        assert_eq!(qemu.corrections(&row), twin.corrections(&row));
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn mesh_of_a_warp_engine_has_the_bytes_computed_on_this_pc() {
    let mut twin = InProcess::default();
    twin.load(&camera()).unwrap();
    twin.expose(&EXPOSURE).unwrap();
    for machine in MACHINES {
        let mut qemu = exposed(machine);
        for format in MeshFormat::ALL {
            for first_col_px in [200, 900] {
                let row = VertexRow {
                    first_col_px,
                    row_px: 500,
                    spacing_px: 16,
                    count: 64,
                    origin_px: [100, 300],
                };
                let bytes = qemu.mesh(&row, format).unwrap();
                assert_eq!(bytes.len(), 64 * format.bytes());
                assert_eq!(Ok(bytes), twin.mesh(&row, format));
            }
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn mesh_of_a_graphics_processor_has_the_bits_computed_on_this_pc() {
    let mut with_k3 = camera();
    with_k3.calibration.distortion.k3 = 1e-15;
    for machine in MACHINES {
        let mut qemu = exposed(machine);
        for record in [camera(), with_k3] {
            let mut twin = InProcess::default();
            let devices: [&mut dyn Device; 2] = [&mut qemu, &mut twin];
            for device in devices {
                device.load(&record).unwrap();
                device.expose(&EXPOSURE).unwrap();
            }
            // The rows reach one spacing beyond the last column and row, over the centre, and to
            // the right of it.
            for (first_col_px, row_px, spacing_px) in
                [(0, 6126, 127), (3500, 0, 16), (7496, 2999, 8)]
            {
                let row = VertexRow {
                    first_col_px,
                    row_px,
                    spacing_px,
                    count: 64,
                    origin_px: [0, 0],
                };
                let bits = |of: &PixelCorrection| [of.cols_px, of.rows_px].map(f32::to_bits);
                let corrections = qemu.corrections(&row).unwrap();
                let expected = twin.corrections(&row).unwrap();
                assert_eq!(corrections.len(), 64);
                assert!(corrections.iter().map(bits).eq(expected.iter().map(bits)));
            }
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn camera_says_who_it_is_and_starts_again_when_asked() {
    for machine in MACHINES {
        let mut qemu = exposed(machine);
        let identity = qemu.remote().identity().clone();
        assert_eq!(identity.board, "mps2");
        assert_eq!(identity.reset_cause, ResetCause::PowerOn);
        assert!(identity.power_switch);
        qemu.remote().reset().unwrap();
        assert_eq!(qemu.remote().identity().reset_cause, ResetCause::Requested);
        assert_eq!(qemu.remote().identity().calibration, None);
        assert_eq!(qemu.expose(&EXPOSURE), Err(DeviceError::NoFrame));
        qemu.load(&camera()).unwrap();
        qemu.expose(&EXPOSURE).unwrap();
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn refusals_have_their_reasons_and_nothing_is_lost_on_the_way() {
    for machine in MACHINES {
        let mut qemu = exposed(machine);
        let mut bad = camera();
        bad.calibration.principal_distance_mm = -1.0;
        assert!(matches!(qemu.load(&bad), Err(DeviceError::Calibration(_))));
        let fast = Exposure::new(1.0, 0.005);
        assert!(matches!(qemu.expose(&fast), Err(DeviceError::Frame(_))));
        qemu.expose(&EXPOSURE).unwrap();
        let far = SensorPoint::new(60.0, 0.0);
        assert_eq!(
            qemu.correct(&[far]),
            Err(DeviceError::OffSensor { index: 0 })
        );
        assert!(matches!(
            qemu.distort(&[far]),
            Err(DeviceError::Distort { index: 0, .. })
        ));
        let counters = qemu.remote().counters().unwrap().unwrap();
        assert_eq!(counters.refused, 4);
        assert_eq!(
            counters.truncated + counters.wrong_crc + counters.oversized,
            0
        );
        assert_eq!(counters.overrun_bytes, 0);
        assert!((1..1 << 22).contains(&counters.stack_used_bytes));
    }
}
