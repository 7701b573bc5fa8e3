//! The firmware's wires below the client: the bytes on them, and the end of QEMU.

use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::thread;
use std::time::Duration;
use std::{env, fs};

use fmc_camera::io::link::message::{Ending, ResetCause};
use host_sim::device::block_port::BlockPort;
use host_sim::device::client::Client;
use host_sim::device::machine::{self, Started};
use host_sim::device::port::TcpPort;
use host_sim::device::{Machine, log};
use rustix::process::{Pid, Signal, kill_process};

const MACHINES: [Machine; 2] = [Machine::An386, Machine::An500];

fn image() -> PathBuf {
    env::var_os("FMC_FIRMWARE").unwrap().into()
}

fn start(machine: Machine) -> Started {
    machine::start(&machine::find().unwrap(), machine, &image(), None).unwrap()
}

/// Returns random bytes, the same in every run.
fn garbage(count: usize) -> Vec<u8> {
    let mut random = fastrand::Rng::with_seed(1);
    std::iter::repeat_with(|| random.u8(..))
        .take(count)
        .collect()
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn camera_answers_after_100_kb_of_garbage_and_has_counted_it() {
    for machine in MACHINES {
        let Started {
            process: _process,
            mut link,
            log: _log,
            wires: _wires,
            memory: _memory,
        } = start(machine);
        link.write_all(&garbage(100_000)).unwrap();
        let mut client = Client::new(TcpPort::new(link).unwrap());
        // QEMU reads some 40 kB/s, less on a busy PC, so the first tries wait behind the garbage.
        let sessions = (1..=6).find(|_| client.connect().is_ok()).unwrap();
        let counters = client.counters().unwrap();
        let lost = counters.truncated + counters.oversized + counters.wrong_crc;
        assert!(lost > 200, "{counters:?}");
        // The camera has obeyed only the requests to connect, and took no garbage for a request.
        assert!((1..=sessions).contains(&counters.done), "{counters:?}");
        assert_eq!(counters.unknown + counters.other_protocol, 0);
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn surplus_bytes_on_the_wire_repeat_no_request_of_a_block() {
    for machine in MACHINES {
        let Started {
            process: _process,
            link,
            log: _log,
            wires,
            memory,
        } = start(machine);
        let mut beside = link.try_clone().unwrap();
        let wires = wires.map(|wire| TcpPort::new(wire).unwrap());
        let memory = memory.expect("blocks are tried where a machine shares its memory");
        let [link, ..] = BlockPort::all(TcpPort::new(link).unwrap(), wires, Some(memory));
        let mut client = Client::new(link);
        client.connect().unwrap();
        for done in 1..20_u8 {
            let counters = client.counters().unwrap();
            assert_eq!([counters.done, counters.repeated], [done.into(), 0]);
            beside.write_all(&garbage(usize::from(done % 4))).unwrap();
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn power_off_ends_qemu_with_success_after_the_answer() {
    for machine in MACHINES {
        let Started {
            mut process,
            link,
            log: _log,
            wires: _wires,
            memory: _memory,
        } = start(machine);
        let mut client = Client::new(TcpPort::new(link).unwrap());
        client.connect().unwrap();
        client.power_off(Ending::Orderly).unwrap();
        let end = process.end().unwrap();
        assert!(end.contains("exit status: 0"), "{end}");
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn image_as_it_flies_has_no_accidents_on_request() {
    for accident in [b'h', b'f'] {
        let Started {
            process: _process,
            link,
            mut log,
            wires: _wires,
            memory: _memory,
        } = start(MACHINES[0]);
        let mut client = Client::new(TcpPort::new(link).unwrap());
        client.connect().unwrap();
        log.write_all(&[accident]).unwrap();
        // The pause is longer than the watchdog waits.
        thread::sleep(Duration::from_millis(1500));
        assert_eq!(client.counters().unwrap().done, 1);
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn firmware_goes_on_after_the_pc_has_slept() {
    let Started {
        process,
        link,
        log: _log,
        wires: _wires,
        memory: _memory,
    } = start(MACHINES[0]);
    let mut client = Client::new(TcpPort::new(link).unwrap());
    client.connect().unwrap();
    let qemu = i32::try_from(process.id()).ok().and_then(Pid::from_raw);
    for signal in [Signal::STOP, Signal::CONT] {
        kill_process(qemu.unwrap(), signal).unwrap();
        thread::sleep(Duration::from_millis(2500));
    }
    assert_eq!(client.counters().unwrap().done, 1);
    assert_eq!(client.connect().unwrap().reset_cause, ResetCause::PowerOn);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn every_line_of_the_log_is_shown_with_its_arguments() {
    let elf = fs::read(image()).unwrap();
    assert_eq!(log::formats_not_shown(&elf).unwrap(), [""; 0]);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn log_names_board_build_and_cause_of_the_start() {
    for machine in MACHINES {
        let Started {
            process: _process,
            link,
            mut log,
            wires: _wires,
            memory: _memory,
        } = start(machine);
        let mut client = Client::new(TcpPort::new(link).unwrap());
        let identity = client.connect().unwrap();
        client.power_off(Ending::Orderly).unwrap();
        let mut bytes = Vec::new();
        log.read_to_end(&mut bytes).unwrap();
        let elf = fs::read(image()).unwrap();
        let (lines, thread) = log::follow(std::io::Cursor::new(bytes), &elf, false);
        thread.join().unwrap();
        let line = lines.all().first().unwrap().clone();
        let named = format!("mps2 {} starts after power on", identity.build);
        assert!(line.contains(&named), "{line}");
    }
}
