//! Test of the image on a real board: flashes it over the ST-LINK, restarts it and checks that it
//! runs and answers.
//!
//! ```text
//! FMC_FIRMWARE=target/firmware/nucleo-h743zi FMC_HIL_PORT=/dev/ttyACM0 \
//! cargo test -p hil -- --ignored
//! ```

use std::{env, path::PathBuf, thread, time::Duration};

use anyhow::{Context as _, Result, ensure};
use fmc_camera::{
    Brown, CalibrationParameters, CameraParameters, Exposure, io::link::message::Grid,
};
use host_sim::device::{
    CorrectingDevice as _, Device as _, remote, serial, serial_line::SerialLine,
};
use probe_rs::{
    CoreStatus, MemoryInterface as _, Session, SessionConfig,
    flashing::{ElfLoader, ElfOptions, download_file},
};

const CHIP: &str = "STM32H743ZITx";

/// Time from the restart to the check.
const WATCHED: Duration = Duration::from_secs(2);

/// Address of the firmware's count of microseconds, which begins at every start: TIM2, counter.
const MICROSECONDS: u64 = 0x4000_0024;
/// Count that shows that the firmware does not restart: longer than the watchdog's interval, with
/// the tolerance of its oscillator.
const WITHOUT_RESTART_US: u32 = 1_000_000;

/// Returns the path of the image from `FMC_FIRMWARE`; a relative path starts at the root of the
/// workspace.
fn firmware() -> Result<PathBuf> {
    let path = env::var_os("FMC_FIRMWARE").context("FMC_FIRMWARE names no image")?;
    Ok(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join(path))
}

#[test]
#[ignore = "needs a board; see the head of this file"]
fn image_runs_without_restart_and_computes_as_this_pc() -> Result<()> {
    let port = env::var("FMC_HIL_PORT").context("FMC_HIL_PORT names no serial port")?;
    let mut session = Session::auto_attach(CHIP, SessionConfig::default())?;
    download_file(&mut session, firmware()?, ElfLoader(ElfOptions::default()))?;
    let mut core = session.core(0)?;
    core.reset()?;
    thread::sleep(WATCHED);

    let status = core.status()?;
    ensure!(
        matches!(status, CoreStatus::Running | CoreStatus::Sleeping),
        "the processor is {status:?}"
    );
    let running_us = core.read_word_32(MICROSECONDS)?;
    ensure!(
        running_us > WITHOUT_RESTART_US,
        "{WATCHED:?} after its reset the firmware counts {running_us} µs: it keeps restarting"
    );
    computes_as_this_pc(&SerialLine::parse(&port).map_err(anyhow::Error::msg)?)
}

/// Checks a frame and a grid over the sensor: the camera's own answers must have the bits of its
/// code on this PC.
fn computes_as_this_pc(port: &SerialLine) -> Result<()> {
    let mut camera = serial::connect(port, remote::Session::Whole)?;
    let lens = CalibrationParameters {
        distortion: Brown {
            k1: -1.6056e-5,
            k2: 6.189_66e-9,
            ..Brown::default()
        },
        ..CalibrationParameters::new(51.3712, [14204, 10652], 3.76)
    };
    camera.load(&CameraParameters::new(lens))?;
    camera.expose(&Exposure::new(0.17, 1.0 / 200.0))?;
    let grid = Grid {
        x_mm: heapless::Vec::from_array([-26.5, -13.0, 0.0, 13.0, 26.5]),
        y_mm: heapless::Vec::from_array([-20.0, -10.0, 0.0, 10.0, 20.0]),
    };
    camera.correct_grid(&grid)?;
    camera.distort(&grid.points().collect::<Vec<_>>())?;
    Ok(())
}
