//! One frame, from file to file.

use std::fs;
use std::io;
use std::path::Path;

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::{CameraFile, number::single};
use fmc_output::part::Part;
use fmc_raster::{FramePlan, FrameReader, Header, PlanOptions, RectifiedCamera, TagOptions};
use fmc_rectification::{Centre, Rectification, Request, Window};
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::exposure::{Exposures, FrameExposure};
use super::frame_flow::{self, FlowResult, FrameFlow};
use super::options::Options;
use super::progress::Progress;
use super::request;
use super::sidecar::{Accuracy, CameraName, FileState, Input, Interior, Output, Sidecar};
use super::task::FrameTask;
use crate::cli::RectifyArgs;
use crate::failure::Failure;
use crate::formats::output::OutputFolder;

/// Rectifies the frames of a block, one by one.
#[derive(Debug)]
pub(super) struct FrameRectifier<'a> {
    file: &'a CameraFile,
    sensor_px: [u32; 2],
    pub(super) camera: CameraName,
    pub(super) options: Options,
    request: Request,
    layout: PlanOptions,
    memory_bytes: u64,
    threads: ThreadPool,
}

/// A frame that has been rectified.
#[derive(Debug)]
pub(super) struct Rectified {
    pub(super) sidecar: Sidecar,
    /// Facts that the user should know, in sentences.
    pub(super) notes: Vec<String>,
}

impl<'a> FrameRectifier<'a> {
    pub(super) fn new(args: &RectifyArgs, file: &'a CameraFile, crc: u32) -> Result<Self, Failure> {
        let threads = ThreadPoolBuilder::new()
            .num_threads(args.block.threads.map_or(0, usize::from))
            .build()
            .map_err(|error| Failure::device_or_io(format!("threads: {error}")))?;
        let calibration = file.parameters().calibration;
        Ok(Self {
            file,
            sensor_px: [calibration.width_px, calibration.height_px],
            camera: CameraName {
                name: file.name.clone(),
                calibration_crc32: format!("{crc:08x}"),
            },
            options: Options::of(args),
            request: request::request(args),
            layout: request::layout(args),
            memory_bytes: u64::from(args.block.memory) << 20,
            threads,
        })
    }

    /// Returns width and height of all rectified images: that of the options, the least of the
    /// frames' windows inside, or the largest of those that hold every pixel.
    ///
    /// # Errors
    /// [`Failure`] if the window of no frame can be computed.
    pub(super) fn block_size(
        &self,
        tasks: &[FrameTask],
        exposures: &Exposures<'_>,
    ) -> Result<[u32; 2], Failure> {
        let sides: fn(u32, u32) -> u32 = match self.request.window {
            Window::Inside => u32::min,
            Window::Full => u32::max,
            Window::Same => return Ok(self.sensor_px),
            Window::Size(size_px) => return Ok(size_px),
        };
        let mut common: Option<[u32; 2]> = None;
        let mut first_failure = None;
        for task in tasks {
            let size = exposures
                .of(task, self.file)
                .and_then(|exposure| self.size_px(task, &exposure));
            match (size, common) {
                (Ok([width, height]), Some([w, h])) => {
                    common = Some([sides(width, w), sides(height, h)]);
                }
                (Ok(size), None) => common = Some(size),
                (Err(failure), _) => {
                    first_failure.get_or_insert(failure);
                }
            }
        }
        // A frame whose record is missing is refused when it is its turn.
        match (common, first_failure) {
            (Some(size), _) => Ok(size),
            (None, Some(failure)) => Err(failure),
            (None, None) => Ok(self.sensor_px),
        }
    }

    fn size_px(&self, task: &FrameTask, exposure: &FrameExposure<'_>) -> Result<[u32; 2], Failure> {
        let principal_point = principal_point(exposure);
        Rectification::size_px(exposure.correction, principal_point, &self.request)
            .map_err(|error| Failure::bad_input(format!("{}: {error}", task.name)))
    }

    /// Rectifies a frame into a folder.
    ///
    /// # Errors
    /// [`Failure`] naming the file; nothing of the frame is left in the folder.
    pub(super) fn rectify(
        &self,
        task: &FrameTask,
        exposure: &FrameExposure<'_>,
        size_px: [u32; 2],
        folder: &OutputFolder,
        progress: &Progress,
    ) -> Result<Rectified, Failure> {
        let reading = |error: &io::Error| Failure::reading(&task.path, error);
        let state = FileState::of(&task.path).map_err(|error| reading(&error))?;
        if fs::metadata(&task.path).is_ok_and(|it| !it.is_file() && !it.is_dir()) {
            return Err(Failure::bad_input(format!(
                "{}: a frame must be a file",
                task.name
            )));
        }
        let reader = FrameReader::open(&task.path)
            .map_err(|error| frame_flow::read_failure(&task.path, error))?;
        let header = reader.header().clone();
        let description_crc = reader.description_crc();
        self.check_size(task, &header)?;
        let request = Request {
            window: Window::Size(size_px),
            ..self.request
        };
        let bad_input =
            |fault: &dyn std::fmt::Display| Failure::bad_input(format!("{}: {fault}", task.name));
        let rectification =
            Rectification::new(exposure.correction, principal_point(exposure), &request)
                .map_err(|error| bad_input(&error))?;
        let plan =
            FramePlan::new(&header, size_px, &self.layout).map_err(|error| bad_input(&error))?;
        let interior = self.interior(exposure, size_px);
        let name = task.image_name();
        let path = folder.path().join(&name);
        let flow = FrameFlow {
            task,
            rectification: &rectification,
            header: &header,
            layout: &self.layout,
            plan,
            tags: TagOptions {
                keep_georeference: request.centre == Centre::Frame
                    && self.request.window == Window::Same,
                camera: Some(RectifiedCamera {
                    focal_length_mm: interior.principal_distance_mm,
                    principal_point_mm: interior
                        .principal_point_from_corner_px
                        .map(|place| place * interior.pixel_um / 1000.0),
                }),
            },
            mask: self.options.mask,
            progress,
            memory_bytes: self.memory_bytes,
            out: &path,
        };
        let writing = |error: &io::Error| Failure::writing(path.display(), error);
        let mut part = Part::create(path.clone()).map_err(|error| writing(&error))?;
        let done = self.threads.install(|| match header.bits {
            8 => flow.run::<u8>(reader, part.file_mut()),
            _ => flow.run::<u16>(reader, part.file_mut()),
        })?;
        let bytes = part
            .file_mut()
            .metadata()
            .map_err(|error| writing(&error))?
            .len();
        if FileState::of(&task.path).ok() != Some(state) {
            return Err(Failure::device_or_io(format!(
                "{}: the file changed while it was read",
                task.path.display()
            )));
        }
        let sidecar = Sidecar {
            version: super::VERSION.to_owned(),
            input: Input {
                file: task.file_name(),
                bytes: state.bytes,
                description_crc32: format!("{description_crc:08x}"),
                pixels_crc32: format!("{:08x}", done.input_crc),
            },
            camera: self.camera.clone(),
            record: exposure.record.clone(),
            options: self.options.clone(),
            output: output(name, bytes, &header, size_px, &done),
            interior_orientation: interior,
            accuracy: Accuracy {
                mesh_spacing_px: rectification.mesh_spacing_px(),
                mesh_bound_px: rectification.mesh_bound_px(),
            },
        };
        let sidecar_name = task.sidecar_name();
        let sidecar_path = folder.path().join(&sidecar_name);
        // On the disk now: nothing is waited for while the image has no description.
        let on_disk = part.file_mut().sync_all();
        on_disk.map_err(|error| writing(&error))?;
        remove_older(&sidecar_path)?;
        part.complete().map_err(|error| writing(&error))?;
        folder.write_json(&sidecar_name, &sidecar)?;
        state.mark(&sidecar_path);
        Ok(Rectified {
            sidecar,
            notes: done.notes,
        })
    }

    fn check_size(&self, task: &FrameTask, header: &Header) -> Result<(), Failure> {
        let sensor = self.sensor_px;
        let found = [header.width_px, header.height_px];
        if found == sensor {
            return Ok(());
        }
        let turned = if found == [sensor[1], sensor[0]] {
            "; the frame is turned by 90°, and must be as it was recorded"
        } else {
            ""
        };
        Err(Failure::bad_input(format!(
            "{}: {} x {} px; allowed: {} x {} px, the sensor of {}{turned}",
            task.name, found[0], found[1], sensor[0], sensor[1], self.file.name
        )))
    }

    fn interior(&self, exposure: &FrameExposure<'_>, size_px: [u32; 2]) -> Interior {
        let pixel_mm = self.file.sensor.pixel_um / 1000.0;
        let [x, y] = match self.request.centre {
            Centre::PrincipalPoint => [0.0; 2],
            Centre::Frame => exposure.principal_point_mm,
        };
        let [width, height] = size_px.map(f64::from);
        let corner_px = [width / 2.0 + x / pixel_mm, height / 2.0 - y / pixel_mm];
        Interior {
            principal_distance_mm: self.file.principal_distance_mm,
            pixel_um: self.file.sensor.pixel_um,
            principal_point_mm: [x, y],
            principal_point_px: corner_px.map(|place| place - 0.5),
            principal_point_from_corner_px: corner_px,
            recorded_principal_point_mm: exposure.principal_point_mm,
        }
    }
}

/// Removes an older description, which must not stand beside the new image if this program is
/// killed now.
fn remove_older(sidecar: &Path) -> Result<(), Failure> {
    match fs::remove_file(sidecar) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(Failure::writing(sidecar.display(), &error))
        }
        _ => Ok(()),
    }
}

fn principal_point(exposure: &FrameExposure<'_>) -> SensorPoint {
    let [x, y] = exposure.principal_point_mm.map(single);
    SensorPoint::new(x, y)
}

fn output(
    name: String,
    bytes: u64,
    header: &Header,
    size_px: [u32; 2],
    done: &FlowResult,
) -> Output {
    let [width_px, height_px] = size_px;
    let pixels = u64::from(width_px) * u64::from(height_px);
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2⁵³ pixels")]
    let border_percent = 100.0 * done.border as f64 / pixels as f64;
    Output {
        file: name,
        bytes,
        width_px,
        height_px,
        bands: header.samples,
        bits: header.bits,
        pixels_crc32: format!("{:08x}", done.output_crc),
        border_pixels: done.border,
        border_percent,
    }
}
