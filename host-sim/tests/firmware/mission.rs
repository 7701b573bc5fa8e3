//! A mission with the firmware in QEMU in the loop.

use fmc_camera::io::instruments::counters::InstrumentCounters;
use fmc_report::records::crc32;
use fmc_simulation::mechanics::Mechanics;
use fmc_simulation::mission::expectation::Expectation;
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::planned_fault::PlannedFault;
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice, DeviceError, FlyingDevice, InProcess, Machine};

/// Number of records, their CRC, and the counts of the wires.
type Outcome = (usize, u32, Option<InstrumentCounters>);

fn records_crc(
    scenario: &MissionScenario,
    device: &mut dyn FlyingDevice<Error = DeviceError>,
) -> Outcome {
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
    (records.len(), crc32(&records), flown.instruments)
}

/// Returns the nominal mission of three frames with a fault from the second frame on.
fn with_fault(fault: InjectedFault) -> MissionScenario {
    let mut scenario = MissionScenario::nominal(Some(3)).unwrap();
    let trigger_s = scenario.triggers_s().nth(1).unwrap();
    scenario.faults = vec![PlannedFault {
        injection: Injection::new(fault, trigger_s).lasting(0.2),
        expectation: Expectation::default(),
    }];
    scenario
}

/// On each wire there is a flood once, and the other one and the link are as they were.
#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn flood_of_a_wire_leaves_the_records_and_counts_of_the_camera_in_this_process() {
    for (machine, fault) in [
        (Machine::An386, InjectedFault::ReceiverFlood),
        (Machine::An500, InjectedFault::AutopilotFlood),
    ] {
        let scenario = with_fault(fault);
        let here = records_crc(&scenario, &mut InProcess::default());
        let counters = here.2.unwrap();
        let flooded = match fault {
            InjectedFault::ReceiverFlood => counters.receiver.flooded_bytes,
            _ => counters.autopilot.flooded_bytes,
        };
        assert!(flooded > 10_000, "{counters:?}");
        let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
        assert_eq!(records_crc(&scenario, &mut qemu), here, "{machine:?}");
        let link = CorrectingDevice::counters(&mut qemu).unwrap().unwrap();
        assert_eq!(
            (link.wrong_crc, link.truncated, link.overrun_bytes),
            (0, 0, 0)
        );
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn mission_leaves_the_records_of_the_camera_in_this_process_bit_for_bit() {
    let scenario = MissionScenario::nominal(Some(4)).unwrap();
    let here = records_crc(&scenario, &mut InProcess::default());
    assert_eq!(here.0, 4);
    assert!(here.2.unwrap().receiver.read > 20);
    for machine in [Machine::An386, Machine::An500] {
        let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
        assert_eq!(records_crc(&scenario, &mut qemu), here, "{machine:?}");
    }
}
