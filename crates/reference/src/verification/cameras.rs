//! Verification of several cameras, each on whichever device is free.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use fmc_camera::io::link::message::Counters;
use fmc_camera_file::{CameraFile, GridFiles};

use super::device::{CorrectingDevice, CorrectionFailure, Evidence};
use super::grid;
use super::result::{CameraResult, Verification};
use super::run;

/// Error of a device that refused a camera or failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{camera}: {error}")]
pub struct VerificationError<E> {
    /// Name of the camera that was checked.
    pub camera: String,
    /// Error of the device.
    pub error: E,
}

/// Checks cameras with their residual grids on devices of one kind, side by side; the results are
/// in the order of the cameras. `before_camera` is called with a camera's name, `after_frame` once
/// per exposure.
///
/// If a device computes otherwise than its own code on this PC, the verification reports the
/// difference and ends there; it leaves out the cameras after that one.
///
/// # Errors
/// [`VerificationError`] of the first camera that a device refuses or fails with. Without a device
/// no camera is checked.
pub fn cameras<D: CorrectingDevice + ?Sized>(
    devices: &mut [Box<D>],
    cameras: &[(CameraFile, GridFiles)],
    before_camera: impl Fn(&str) + Sync,
    after_frame: impl Fn() + Sync,
) -> Result<Verification, VerificationError<D::Error>> {
    let next = AtomicUsize::new(0);
    let checked = Mutex::new(Vec::new());
    thread::scope(|scope| {
        for device in &mut *devices {
            scope.spawn(|| {
                while let Some((index, (camera, grids))) = taken(&next, cameras) {
                    before_camera(&camera.name);
                    let before = device.evidence();
                    let exposures = grid::exposures(camera);
                    let camera_with_grids = (camera, grids);
                    let result = run::exposures(
                        device.as_mut(),
                        camera_with_grids,
                        &exposures,
                        &after_frame,
                    );
                    let evidence = since(before, device.evidence());
                    if result.is_err() {
                        // No device starts another camera.
                        next.store(cameras.len(), Ordering::Relaxed);
                    }
                    let mut checked = checked.lock().unwrap_or_else(PoisonError::into_inner);
                    checked.push((index, camera, evidence, result));
                }
            });
        }
    });
    let mut checked = checked.into_inner().unwrap_or_else(PoisonError::into_inner);
    checked.sort_by_key(|(index, ..)| *index);

    let mut results: Vec<CameraResult> = Vec::new();
    let mut difference = None;
    let mut evidence = Evidence::default();
    for (_, camera, of_camera, result) in checked {
        evidence.by_digest += of_camera.by_digest;
        evidence.by_value += of_camera.by_value;
        match result {
            Ok(result) => results.push(result),
            // The device's other answers say nothing about the code that was to be checked.
            Err(found) if found.is_difference() => {
                difference = Some(format!("{}: {found}", camera.name));
                break;
            }
            Err(error) => {
                let camera = camera.name.clone();
                return Err(VerificationError { camera, error });
            }
        }
    }
    let device = devices.first().map(|device| device.description());
    Ok(Verification {
        device: device.unwrap_or_default(),
        not_in_qemu: None,
        evidence,
        link: link(devices)?,
        difference,
        cameras: results,
    })
}

/// Takes the next camera that no device has taken.
fn taken<'a, C>(next: &AtomicUsize, cameras: &'a [C]) -> Option<(usize, &'a C)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    Some((index, cameras.get(index)?))
}

/// Returns the evidence that a device has added between two moments.
fn since(before: Evidence, now: Evidence) -> Evidence {
    Evidence {
        by_digest: now.by_digest - before.by_digest,
        by_value: now.by_value - before.by_value,
    }
}

/// Returns the counters of all devices' links together; `None` if there is no link.
fn link<D: CorrectingDevice + ?Sized>(
    devices: &mut [Box<D>],
) -> Result<Option<Counters>, VerificationError<D::Error>> {
    let mut sum: Option<Counters> = None;
    for device in devices {
        let counters = device.counters().map_err(|error| VerificationError {
            camera: device.description(),
            error,
        })?;
        sum = match (sum, counters) {
            (Some(sum), Some(counters)) => Some(together(&sum, &counters)),
            (sum, counters) => sum.or(counters),
        };
    }
    Ok(sum)
}

/// Adds the counters of two links; of the stack, which each device has for itself, takes the
/// largest.
fn together(a: &Counters, b: &Counters) -> Counters {
    Counters {
        done: a.done + b.done,
        refused: a.refused + b.refused,
        repeated: a.repeated + b.repeated,
        truncated: a.truncated + b.truncated,
        oversized: a.oversized + b.oversized,
        wrong_crc: a.wrong_crc + b.wrong_crc,
        other_protocol: a.other_protocol + b.other_protocol,
        unknown: a.unknown + b.unknown,
        other_session: a.other_session + b.other_session,
        out_of_order: a.out_of_order + b.out_of_order,
        overrun_bytes: a.overrun_bytes + b.overrun_bytes,
        stack_used_bytes: a.stack_used_bytes.max(b.stack_used_bytes),
    }
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::camera::{Camera, CameraParameters};
    use fmc_camera::flight::exposure::Exposure;
    use fmc_camera::flight::interior_orientation::InteriorOrientation;
    use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
    use fmc_camera::geometry::sensor::SensorPoint;
    use fmc_camera_file::published::CAMERA_FILES;

    use super::*;

    /// Runs the camera's code in this process, one point at a time.
    #[derive(Default)]
    struct InProcess {
        camera: Option<Camera>,
        correction: Option<FrameCorrection>,
        answered: u64,
    }

    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    enum Failure {
        #[error("refused: {0}")]
        Refused(String),
        #[error("{answered} of {asked} points answered")]
        Count { asked: usize, answered: usize },
        #[error("not exposed")]
        NotExposed,
    }

    impl CorrectionFailure for Failure {
        fn of_count(asked: usize, answered: usize) -> Self {
            Self::Count { asked, answered }
        }

        fn of_grids() -> Self {
            Self::Refused("no grids here".to_owned())
        }

        fn is_difference(&self) -> bool {
            false
        }
    }

    impl CorrectingDevice for InProcess {
        type Error = Failure;

        fn description(&self) -> String {
            "this process".to_owned()
        }

        fn load(&mut self, camera: &CameraParameters) -> Result<(), Failure> {
            let camera = Camera::new(*camera).map_err(|error| Failure::Refused(error.to_string()));
            self.camera = Some(camera?);
            Ok(())
        }

        fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, Failure> {
            let camera = self.camera.as_ref().ok_or(Failure::NotExposed)?;
            let frame = camera.frame(exposure);
            let frame = frame.map_err(|error| Failure::Refused(error.to_string()))?;
            self.correction = Some(frame.correction);
            Ok(frame.interior)
        }

        fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, Failure> {
            let correction = self.correction.as_ref().ok_or(Failure::NotExposed)?;
            self.answered += measured.len() as u64;
            Ok(measured
                .iter()
                .map(|point| correction.correct(*point))
                .collect())
        }

        fn evidence(&self) -> Evidence {
            Evidence {
                by_digest: 0,
                by_value: self.answered,
            }
        }
    }

    fn published() -> Vec<(CameraFile, GridFiles)> {
        let cameras = CAMERA_FILES.iter();
        cameras
            .map(|(file, text)| {
                (
                    CameraFile::parse(file, text).unwrap().0,
                    GridFiles::default(),
                )
            })
            .collect()
    }

    fn checked(
        count: usize,
        files: &[(CameraFile, GridFiles)],
    ) -> Result<Verification, VerificationError<Failure>> {
        let mut devices: Vec<Box<InProcess>> = (0..count).map(|_| Box::default()).collect();
        cameras(&mut devices, files, |_| (), || ())
    }

    #[test]
    fn three_devices_find_what_one_finds_in_the_same_order() {
        let files = published();
        let one = checked(1, &files).unwrap();
        assert_eq!(checked(3, &files).unwrap(), one);
        let names: Vec<_> = one.cameras.iter().map(|camera| &camera.name).collect();
        let expected: Vec<_> = files.iter().map(|(camera, _)| &camera.name).collect();
        assert_eq!(names, expected);
    }

    #[test]
    fn camera_that_is_refused_is_named_and_no_device_is_no_pass() {
        let mut files = published();
        files[2].0.distortion.k1 = f64::NAN;
        let refused = checked(2, &files).unwrap_err();
        assert_eq!(refused.camera, files[2].0.name);
        assert!(!checked(0, &files).unwrap().passed());
    }

    #[test]
    fn device_without_grids_refuses_a_camera_that_has_some() {
        let mut files = published();
        files[1].1 = GridFiles::new(Some(vec![0; 40]), None);
        let refused = checked(1, &files).unwrap_err();
        assert_eq!(refused.camera, files[1].0.name);
        assert_eq!(refused.error, Failure::of_grids());
    }

    #[test]
    fn counts_of_links_are_added_and_stacks_are_not() {
        let counters = |done, stack_used_bytes| Counters {
            done,
            overrun_bytes: 1,
            stack_used_bytes,
            ..Counters::default()
        };
        let sum = together(&counters(3, 700), &counters(4, 500));
        assert_eq!(
            (sum.done, sum.overrun_bytes, sum.stack_used_bytes),
            (7, 2, 700)
        );
    }
}
