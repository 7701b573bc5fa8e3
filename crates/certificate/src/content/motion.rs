//! Motion of the principal point over V/H and exposure time, and its effect on the distortion.

use fmc_camera::flight::camera::{Camera, Frame, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, FocusTable, MechanismName, Profile};
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{StrictSolver, Weight};
use fmc_reference::verification::grid;
use fmc_simulation::smear::field::SmearRequest;
use fmc_simulation::smear::term::Disturbances;
use serde::Serialize;

use super::inputs::Inputs;
use crate::stated::Stated;

/// Values of V/H in the tables, over the camera's limits.
const VH_STEPS: u32 = 5;
/// Exposure times in the tables, over the camera's limits.
const EXPOSURE_STEPS: u32 = 4;
/// Halvings of the interval in which the longest exposure is looked for.
const HALVINGS: u32 = 40;

/// Motion of the principal point, and what it does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Motion {
    /// FMC axis, as the camera file has it.
    pub axis: &'static str,
    /// `stage` or `tdi`.
    pub mechanism: &'static str,
    /// Run-up strategy; `None` for TDI.
    pub strategy: Option<&'static str>,
    /// Total travel, half of it on either side of the calibrated position, mm.
    pub stroke_mm: Option<Stated>,
    /// Acceleration of the run-up, mm/s²; `None` for TDI.
    pub acceleration_mm_s2: Option<Stated>,
    /// Settling time, ms; `None` for TDI.
    pub settling_ms: Option<Stated>,
    /// Largest change of the acceleration, mm/s³; `None` without a limit.
    pub jerk_mm_s3: Option<Stated>,
    /// Largest speed, mm/s; `None` without a limit.
    pub max_speed_mm_s: Option<Stated>,
    /// First transfer after opening, row periods; `None` for a stage.
    pub first_transfer: Option<Stated>,
    /// Run-out of the stage, µm per power of mm, lowest power first.
    pub run_out_um: Vec<Option<Stated>>,
    /// Focus table: temperature of the lens, °C, and focus shift, µm; empty without.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub focus: Vec<[Option<Stated>; 2]>,
    /// Shape of the shutter's transmission.
    pub shutter: &'static str,
    /// Opening and closing ramps as shares of the exposure.
    pub ramps: [Option<Stated>; 2],
    /// Smallest and largest V/H, 1/s.
    pub vh_per_s: [Option<Stated>; 2],
    /// Shortest and longest exposure, s.
    pub exposure_s: [Option<Stated>; 2],
    /// Exposures over the limits.
    pub exposures: Vec<MotionRow>,
    /// Longest exposure for each V/H.
    pub reach: Vec<ReachRow>,
}

/// One exposure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionRow {
    /// V/H, 1/s.
    pub vh_per_s: Option<Stated>,
    /// Exposure time t, ms.
    pub exposure_ms: Option<Stated>,
    /// Reason for which the camera refuses the exposure.
    pub refused: Option<String>,
    /// The exposure; `None` if it is refused.
    pub frame: Option<ExposureNumbers>,
}

/// Numbers of an exposure that the camera takes, flown along the axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExposureNumbers {
    /// Speed of the stage while the shutter is open, mm/s.
    pub speed_mm_s: Option<Stated>,
    /// δ, travel while the shutter is open, µm.
    pub travel_um: Option<Stated>,
    /// Δδ, offset when the shutter opens, µm along the axis.
    pub opening_offset_um: Option<Stated>,
    /// c̄, offset of the exposure centroid, µm along the axis.
    pub centroid_offset_um: Option<Stated>,
    /// Centroid principal point, mm in the sensor frame.
    pub principal_point_mm: [Option<Stated>; 2],
    /// Centroid of the exposure after opening, ms.
    pub centroid_time_ms: Option<Stated>,
    /// Largest change of the distortion by the motion: strict exposure mean less the static
    /// distortion about the calibrated principal point, µm.
    pub change_um: Option<Stated>,
    /// Bound of what the correction leaves out, nm.
    pub left_out_nm: Option<Stated>,
    /// Smear that the distortion of the lens leaves in a perfectly compensated exposure, µm.
    pub lens_smear_um: Option<Stated>,
}

/// Longest exposure at a V/H.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReachRow {
    /// V/H, 1/s.
    pub vh_per_s: Option<Stated>,
    /// Longest exposure that limits, stroke and speed allow, ms; `None` if they allow none.
    pub longest_ms: Option<Stated>,
    /// Reason for which the next longer exposure is refused: `limits`, `stroke`, `speed` or `rows`.
    pub bound: &'static str,
}

impl Motion {
    /// Computes the motion over the camera's limits.
    pub(super) fn new(inputs: &Inputs<'_>, splines: &ResidualSplines) -> Self {
        let Inputs {
            camera, checked, ..
        } = *inputs;
        let fmc = &camera.fmc;
        let is_stage = fmc.mechanism == MechanismName::Stage;
        let of_stage = |value: f64| is_stage.then(|| Stated::exact(value)).flatten();
        let limit = |value: f64| (value > 0.0).then(|| of_stage(value)).flatten();
        let (shutter, ramps) = match camera.shutter.profile {
            Profile::Uniform => ("uniform", [0.0, 0.0]),
            Profile::Trapezoid => {
                let shutter = &camera.shutter;
                let ramps = [shutter.opening_fraction, shutter.closing_fraction];
                ("trapezoid", ramps)
            }
        };
        let vh = spread(camera.limits.vh_per_s, VH_STEPS);
        let times = spread(camera.limits.exposure_s, EXPOSURE_STEPS);
        let exposures = vh
            .iter()
            .flat_map(|vh| times.iter().map(|time| [*vh, *time]))
            .map(|exposure| row(camera, checked, splines, exposure));
        Self {
            axis: fmc.axis.name(),
            mechanism: if is_stage { "stage" } else { "tdi" },
            strategy: is_stage.then(|| fmc.strategy.unwrap_or_default().name()),
            stroke_mm: Stated::exact(fmc.stroke_mm),
            acceleration_mm_s2: of_stage(fmc.acceleration_mm_s2),
            settling_ms: of_stage(fmc.settling_ms),
            jerk_mm_s3: limit(fmc.jerk_mm_s3),
            max_speed_mm_s: limit(fmc.max_speed_mm_s),
            first_transfer: (!is_stage)
                .then(|| Stated::exact(fmc.first_transfer))
                .flatten(),
            run_out_um: fmc
                .flatness_um
                .iter()
                .map(|um| Stated::exact(*um))
                .collect(),
            focus: camera.focus.iter().flat_map(focus_rows).collect(),
            shutter,
            ramps: ramps.map(Stated::exact),
            vh_per_s: camera.limits.vh_per_s.map(|vh| Stated::digits(vh, 6)),
            exposure_s: camera.limits.exposure_s.map(|time| Stated::digits(time, 6)),
            exposures: exposures.collect(),
            reach: vh.iter().map(|vh| reach(camera, checked, *vh)).collect(),
        }
    }
}

/// Returns the rows of a focus table.
fn focus_rows(table: &FocusTable) -> impl Iterator<Item = [Option<Stated>; 2]> {
    let rows = table.temperature_c.iter().zip(&table.focus_shift_um);
    rows.map(|(celsius, shift_um)| [*celsius, *shift_um].map(Stated::exact))
}

/// Returns numbers spread over a range by equal ratios, the inner ones rounded to two digits, in
/// rising order; a range that begins at zero is spread evenly.
fn spread([from, to]: [f64; 2], count: u32) -> Vec<f64> {
    let at = |index: u32| {
        let share = f64::from(index) / f64::from(count - 1);
        if index == 0 {
            return from;
        }
        if index == count - 1 {
            return to;
        }
        let between = if from > 0.0 {
            from * (to / from).powf(share)
        } else {
            to * share
        };
        let rounded = Stated::digits(between, 2).map_or(between, |stated| stated.value());
        rounded.clamp(from, to)
    };
    let mut numbers: Vec<f64> = (0..count).map(at).collect();
    numbers.dedup_by(|a, b| a.to_bits() == b.to_bits());
    numbers
}

fn row(
    camera: &CameraFile,
    checked: &Camera,
    splines: &ResidualSplines,
    [vh_per_s, exposure_s]: [f64; 2],
) -> MotionRow {
    let exposure = Exposure::new(single(vh_per_s), single(exposure_s));
    let (refused, frame) = match checked.frame(&exposure) {
        Ok(frame) => (
            None,
            Some(ExposureNumbers::of(
                camera,
                splines,
                &frame,
                [vh_per_s, exposure_s],
            )),
        ),
        Err(error) => (Some(reason(&error).to_owned()), None),
    };
    MotionRow {
        vh_per_s: Stated::digits(vh_per_s, 6),
        exposure_ms: Stated::digits(1e3 * exposure_s, 6),
        refused,
        frame,
    }
}

/// Returns the word for what refuses an exposure.
const fn reason(error: &FrameError) -> &'static str {
    match error {
        FrameError::Stroke(_) => "stroke",
        FrameError::Speed { .. } => "speed",
        FrameError::OutOfRange(_) => "limits",
        FrameError::NotFitted | FrameError::Time { .. } => "plan",
    }
}

impl ExposureNumbers {
    fn of(
        camera: &CameraFile,
        splines: &ResidualSplines,
        frame: &Frame,
        [vh_per_s, exposure_s]: [f64; 2],
    ) -> Self {
        let interior = &frame.interior;
        let motion = &interior.motion;
        let um = |mm: f32| Stated::decimals(1e3 * f64::from(mm), 3);
        let point = interior.principal_point;
        let request = SmearRequest {
            vh_per_s,
            exposure_s,
            disturbances: Disturbances::default(),
        };
        Self {
            speed_mm_s: Stated::decimals(camera.principal_distance_mm * vh_per_s, 4),
            travel_um: um(motion.travel_mm),
            opening_offset_um: um(motion.opening_offset_mm),
            centroid_offset_um: um(motion.centroid_mm),
            principal_point_mm: [point.x_mm, point.y_mm].map(|mm| Stated::decimals(mm.into(), 6)),
            centroid_time_ms: Stated::decimals(1e3 * f64::from(motion.centroid_time_s), 4),
            change_um: Stated::decimals(
                1e3 * change_mm(camera, splines, [vh_per_s, exposure_s]),
                4,
            ),
            left_out_nm: Stated::decimals(interior.left_out_nm.into(), 3),
            lens_smear_um: Stated::decimals(request.lens_alone_um(camera), 3),
        }
    }
}

/// Returns the largest change of the distortion by the motion, mm: a length over the points of the
/// verification.
fn change_mm(
    camera: &CameraFile,
    splines: &ResidualSplines,
    [vh_per_s, exposure_s]: [f64; 2],
) -> f64 {
    let request = ExposureRequest::planned(vh_per_s, exposure_s);
    let solver =
        StrictSolver::new(camera, &request, Weight::Exposure).with_splines(splines.clone());
    let lens = Lens::of(camera);
    let [x0, y0] = camera.principal_point_mm;
    grid::points(camera.half_format_mm())
        .points()
        .map(|point| {
            let [x, y] = [point.x_mm, point.y_mm].map(f64::from);
            let [mean_x, mean_y] = solver.mean([x, y]).distortion_mm;
            let [dx, dy] = lens.displacement([x - x0, y - y0]);
            let [more_x, more_y] = splines.calibrated([x, y]);
            (mean_x - dx - more_x).hypot(mean_y - dy - more_y)
        })
        .fold(0.0, f64::max)
}

/// Returns the longest exposure at a V/H.
fn reach(camera: &CameraFile, checked: &Camera, vh_per_s: f64) -> ReachRow {
    let [shortest, longest] = camera.limits.exposure_s;
    let refusal = |time: f64| {
        let exposure = Exposure::new(single(vh_per_s), single(time));
        checked.frame(&exposure).err().map(|error| reason(&error))
    };
    let vh = Stated::digits(vh_per_s, 6);
    let line = |longest_s: Option<f64>, bound| ReachRow {
        vh_per_s: vh.clone(),
        longest_ms: longest_s.and_then(|time| Stated::digits(1e3 * time, 6)),
        bound,
    };
    match (refusal(shortest), refusal(longest)) {
        (Some(bound), _) => line(None, bound),
        (None, None) => line(Some(longest), "limits"),
        (None, Some(bound)) => {
            let (mut taken, mut refused) = (shortest, longest);
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(taken, refused);
                if refusal(middle).is_none() {
                    taken = middle;
                } else {
                    refused = middle;
                }
            }
            line(Some(taken), bound)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_reach_both_ends_of_the_limits() {
        let values = spread([0.01, 0.3], 5);
        assert_eq!(values.len(), 5);
        assert!((values[0] - 0.01).abs() < 1e-15 && (values[4] - 0.3).abs() < 1e-15);
        assert!((values[2] - 0.055).abs() < 1e-12, "{values:?}");
        assert_eq!(spread([0.1, 0.1], 5).len(), 1);
        assert!(spread([0.0, 0.4], 5)[1] > 0.0);
    }

    #[test]
    fn reach_ends_where_the_stroke_does() {
        let text = "name = \"t\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 1000\n\
                    height_px = 1000\npixel_um = 10.0\n[fmc]\nstroke_mm = 1.0\n\
                    [limits]\nvh_per_s = [0.05, 0.2]\nexposure_s = [0.001, 0.1]\n";
        let (file, camera) = CameraFile::parse("t", text).unwrap();
        let row = reach(&file, &camera, 0.2);
        assert_eq!(row.bound, "stroke");
        let longest = row.longest_ms.unwrap().value();
        assert!(longest > 1.0 && longest < 50.0, "{longest}");
        let row = reach(&file, &camera, 0.05);
        assert_eq!(row.bound, "limits");
    }
}
