//! `camera-file`: the check of a camera file.

use std::path::Path;

use fmc_camera::flight::camera::{Camera, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader, ResidualGrid};
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, GridFiles, MechanismName, Profile};
use fmc_reference::lens::Lens;
use fmc_report::terminal;
use fmc_report::wording;

use crate::cli::{CameraFileAction, CameraFileArgs};
use crate::failure::Failure;
use crate::formats::output;

/// Columns of the names in the answer.
const NAMES: u16 = 25;

/// Halvings that find the largest V/H of an exposure.
const HALVINGS: u32 = 30;

pub(super) fn run(args: &CameraFileArgs) -> Result<(), Failure> {
    match &args.action {
        CameraFileAction::Check { file } => check(file),
    }
}

fn check(path: &Path) -> Result<(), Failure> {
    let (file, camera, grids) = CameraFile::read_with_grids(path)?;
    super::warn_of_distortion(path, &file);
    super::note_unused_strategy(path, &file);
    let name = path.display();
    let [vh_from, vh_to] = file.limits.vh_per_s;
    let [shortest, longest] = file.limits.exposure_s;
    let [first, last] = [shortest, longest]
        .map(|exposure_s| Flyable::of(&camera, file.limits.vh_per_s, exposure_s));
    let pairs = [
        ("camera file", format!("{name}: valid")),
        ("camera", file.name.clone()),
        ("serial, version", serial(&file)),
        ("sensor", sensor(&file)),
        (
            "principal distance",
            format!("{} mm", file.principal_distance_mm),
        ),
        ("distortion at the corner", corner(&file)),
        ("fitted coefficients", fitted(&file)),
        ("residual grids", residual_grids(&grids)),
        ("mechanism", mechanism(&file)),
        ("shutter", shutter(&file)),
        (
            "limits of V/H",
            format!(
                "{vh_from} to {vh_to} 1/s ({})",
                file.limits.origin(Quantity::VhPerS, &name)
            ),
        ),
        (
            "limits of exposure",
            format!(
                "{} to {} ({})",
                wording::exposure(shortest),
                wording::exposure(longest),
                file.limits.origin(Quantity::ExposureS, &name)
            ),
        ),
        ("shortest exposure", first.text(shortest)),
        ("longest exposure", last.text(longest)),
    ];
    output::write(None, |sink| {
        writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
    })
}

fn serial(file: &CameraFile) -> String {
    let serial = match file.serial.as_str() {
        "" => "not given",
        serial => serial,
    };
    match file.version {
        0 => format!("{serial}, not given"),
        version => format!("{serial}, {version}"),
    }
}

fn sensor(file: &CameraFile) -> String {
    let [width, height] = file.half_format_mm().map(|half| 2.0 * half);
    format!(
        "{} x {} px of {} µm, {width:.3} x {height:.3} mm",
        file.sensor.width_px, file.sensor.height_px, file.sensor.pixel_um
    )
}

/// Describes the distortion, measured - ideal, at the corner where it is largest.
fn corner(file: &CameraFile) -> String {
    let lens = Lens::of(file);
    let [half_width, half_height] = file.half_format_mm();
    let [x0, y0] = file.principal_point_mm;
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let of_corner = |(left, up): (f64, f64)| {
        let [x, y] = [left * half_width, up * half_height];
        let about = [x - x0, y - y0];
        let [dx, dy] = lens.displacement(about);
        ([x, y], about, dx.hypot(dy))
    };
    let largest = corners
        .into_iter()
        .map(of_corner)
        .max_by(|(_, _, a), (_, _, b)| a.total_cmp(b));
    let Some(([x, y], [about_x, about_y], length_mm)) = largest else {
        return String::new();
    };
    let radius_mm = about_x.hypot(about_y);
    format!(
        "{:.2} µm, {:.2} px, {:.3} % of the radius of {radius_mm:.2} mm, at ({x:.3}, {y:.3}) mm",
        1000.0 * length_mm,
        1000.0 * length_mm / file.sensor.pixel_um,
        100.0 * length_mm / radius_mm,
    )
}

fn fitted(file: &CameraFile) -> String {
    file.fitted.as_ref().map_or_else(
        || "none: --model fitted is refused".to_owned(),
        |fitted| format!("there, per {}", fitted.per.name()),
    )
}

fn residual_grids(files: &GridFiles) -> String {
    let described = [GridCarrier::Lens, GridCarrier::Sensor]
        .into_iter()
        .filter_map(|carrier| {
            let grid = ResidualGrid::parse(files.bytes(carrier)?).ok()?;
            let GridHeader {
                columns,
                rows,
                pitch_mm,
                ..
            } = *grid.header();
            Some(format!(
                "{carrier}: {columns} x {rows} nodes every {pitch_mm} mm, CRC-32 {:08x}",
                grid.crc32()
            ))
        });
    let described: Vec<String> = described.collect();
    if described.is_empty() {
        "none".to_owned()
    } else {
        described.join("; ")
    }
}

fn mechanism(file: &CameraFile) -> String {
    let axis = file.fmc.axis.name();
    match file.fmc.mechanism {
        MechanismName::Stage => format!(
            "stage along {axis}, {}, stroke {} mm",
            file.fmc.strategy.unwrap_or_default().name(),
            file.fmc.stroke_mm
        ),
        MechanismName::Tdi => format!("TDI along {axis}"),
    }
}

fn shutter(file: &CameraFile) -> String {
    match file.shutter.profile {
        Profile::Uniform => "uniform".to_owned(),
        Profile::Trapezoid => format!(
            "trapezoid, opening {} and closing {} of the exposure",
            file.shutter.opening_fraction, file.shutter.closing_fraction
        ),
    }
}

/// V/H up to which an exposure can be flown within the limits.
enum Flyable {
    /// The largest of the limits.
    All(f32),
    /// Less than that; the error is that of the largest.
    UpTo(f32, FrameError),
    /// No V/H of the limits.
    Nothing(FrameError),
}

impl Flyable {
    /// Finds the largest V/H: travel, speed and rows grow with it.
    fn of(camera: &Camera, vh_per_s: [f64; 2], exposure_s: f64) -> Self {
        let refusal = |vh_per_s| {
            let exposure = Exposure::new(vh_per_s, single(exposure_s));
            camera.frame(&exposure).err()
        };
        let [mut least, mut most] = vh_per_s.map(single);
        let Some(error) = refusal(most) else {
            return Self::All(most);
        };
        if let Some(error) = refusal(least) {
            return Self::Nothing(error);
        }
        for _ in 0..HALVINGS {
            let middle = f32::midpoint(least, most);
            if refusal(middle).is_none() {
                least = middle;
            } else {
                most = middle;
            }
        }
        Self::UpTo(least, error)
    }

    fn text(&self, exposure_s: f64) -> String {
        let exposure = wording::exposure(exposure_s);
        match self {
            Self::All(most) => format!("{exposure}: V/H up to {most} 1/s"),
            Self::UpTo(most, error) => {
                format!("{exposure}: V/H up to {most:.4} 1/s; at the largest: {error}")
            }
            Self::Nothing(error) => format!("{exposure}: refused at every V/H: {error}"),
        }
    }
}
