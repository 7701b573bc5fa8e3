//! A mission with the firmware in QEMU in the loop.

use fmc_report::records::crc32;
use fmc_simulation::mechanics::Mechanics;
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{DeviceError, FlyingDevice, InProcess, Machine};

fn records_crc(
    scenario: &MissionScenario,
    device: &mut dyn FlyingDevice<Error = DeviceError>,
) -> (usize, u32) {
    device
        .prepare(&scenario.camera.parameters(), &scenario.flight_settings())
        .unwrap();
    let mechanics = Mechanics::new(scenario.written.mechanics).unwrap();
    let options = FlightOptions {
        seed: 2,
        frame: None,
    };
    let flown = fly(scenario, options, mechanics, device, |_| {}).unwrap();
    let records: Vec<_> = flown.frames.iter().map(|frame| frame.record).collect();
    (records.len(), crc32(&records))
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn mission_leaves_the_records_of_the_camera_in_this_process_bit_for_bit() {
    let scenario = MissionScenario::nominal(Some(4)).unwrap();
    let here = records_crc(&scenario, &mut InProcess::default());
    assert_eq!(here.0, 4);
    for machine in [Machine::An386, Machine::An500] {
        let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
        assert_eq!(records_crc(&scenario, &mut qemu), here, "{machine:?}");
    }
}
