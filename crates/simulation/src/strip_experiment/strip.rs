//! Strip of frames as flown: true orientations and true image points.

use fmc_adjustment::collinearity::ground_at_height;
use fmc_adjustment::correction::Corrections;
use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_adjustment::interior_orientation::InteriorOrientation;
use fmc_camera::Camera;
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera_file::InputError;
use fmc_camera_file::number::single;
use fmc_reference::exposure::{ExposurePath, ExposureRequest, FocusFormula};
use fmc_reference::fitted::FittedModel;
use fmc_reference::lens::Lens;
use fmc_reference::strict::{StrictSolver, Weight};

use super::image_truth::ImageTruth;
use super::scenario::Scenario;
use super::scenario_file::{FEWEST_CONTROL_POINTS, GroundPoint};
use super::terrain::Terrain;
use crate::noise::Noise;

/// Part of the format that check points fill.
const CHECKED_PART: f64 = 0.9;

/// A ground point and its image, without errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruePoint {
    /// Index in the scenario's list of a control point; `None` for a check point.
    pub control: Option<usize>,
    /// Position in the ground frame, m.
    pub ground_m: [f64; 3],
    /// Recorded image point, sensor frame, mm.
    pub measured_mm: [f64; 2],
}

/// A frame without errors.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueFrame {
    /// Exterior orientation at the centroid of the exposure.
    pub orientation: ExteriorOrientation,
    /// Control points on the sensor.
    pub control: Vec<TruePoint>,
    /// Check points on the sensor.
    pub check: Vec<TruePoint>,
}

/// A strip without errors.
#[derive(Debug, Clone)]
pub struct Strip {
    /// Corrections of the strip's exposures.
    pub corrections: Corrections,
    /// Frames of the strip.
    pub frames: Vec<TrueFrame>,
}

impl Strip {
    /// Creates the strip of a scenario, recorded by the exposure mean of its lens about the moving
    /// principal point, with the true focus shift.
    ///
    /// # Errors
    /// As [`Self::recorded_by`].
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, InputError> {
        let truth = StrictSolver::new(&scenario.camera, &request(scenario), Weight::Exposure);
        Self::recorded_by(&truth, scenario, seed)
    }

    /// Creates the strip of a scenario, recorded with the given distortion.
    ///
    /// # Errors
    /// [`InputError`] for an exposure that the camera refuses, for control points that no frame
    /// shows, and for frames with too few of them.
    pub fn recorded_by(
        truth: &dyn ImageTruth,
        scenario: &Scenario,
        seed: u64,
    ) -> Result<Self, InputError> {
        let corrections = corrections(scenario)?;
        let mut strip = Self {
            corrections,
            frames: orientations(scenario, seed)
                .into_iter()
                .map(|orientation| TrueFrame {
                    orientation,
                    control: Vec::new(),
                    check: Vec::new(),
                })
                .collect(),
        };
        let terrain = terrain(scenario);
        let interior = *strip.corrections.interior();
        let points = &scenario.written.control.points;
        let per_side = scenario.written.check.points_per_side;
        for frame in &mut strip.frames {
            let recorded = |control, ground_m| {
                let measured_mm = truth.recorded(&interior, &frame.orientation, ground_m)?;
                interior.contains(measured_mm).then_some(TruePoint {
                    control,
                    ground_m,
                    measured_mm,
                })
            };
            let control = points
                .iter()
                .enumerate()
                .filter_map(|(index, point)| recorded(Some(index), coordinates(point)))
                .collect();
            let check = grid(per_side)
                .filter_map(|[u, w]| {
                    let [half_x, half_y] = interior.half_format_mm;
                    let place = [CHECKED_PART * u * half_x, CHECKED_PART * w * half_y];
                    recorded(
                        None,
                        on_terrain(&terrain, &interior, &frame.orientation, place)?,
                    )
                })
                .collect();
            frame.control = control;
            frame.check = check;
        }
        strip.check_control(scenario)?;
        Ok(strip)
    }

    fn check_control(&self, scenario: &Scenario) -> Result<(), InputError> {
        let points = &scenario.written.control.points;
        let outside: Vec<&GroundPoint> = points
            .iter()
            .enumerate()
            .filter(|(index, _)| {
                self.frames.iter().all(|frame| {
                    frame
                        .control
                        .iter()
                        .all(|point| point.control != Some(*index))
                })
            })
            .map(|(_, point)| point)
            .collect();
        if !outside.is_empty() {
            let named: Vec<String> = outside
                .iter()
                .take(12)
                .map(|point| format!("{} (x_m = {}, y_m = {})", point.id, point.x_m, point.y_m))
                .collect();
            let [least, most] = self.covered(scenario);
            let more = if outside.len() > 12 { ", …" } else { "" };
            return Err(scenario.fault(
                "control.points",
                format!(
                    "outside every frame: {}{more}; the frames show about x_m = {:.0} to {:.0}, y_m = {:.0} to {:.0}",
                    named.join(", "),
                    least[0],
                    most[0],
                    least[1],
                    most[1]
                ),
            ));
        }
        let extent = extent(points.iter().map(|point| [point.x_m, point.y_m]));
        let [least, most] = self.covered(scenario);
        let covered = (most[0] - least[0]).hypot(most[1] - least[1]);
        if extent < 0.01 * covered {
            return Err(scenario.fault(
                "control.points",
                format!(
                    "x_m and y_m of all points lie within {extent:.3} m; the frames show {covered:.0} m, of which they must span at least 1 %; in kilometres?"
                ),
            ));
        }
        for (index, frame) in self.frames.iter().enumerate() {
            if frame.control.len() < FEWEST_CONTROL_POINTS {
                return Err(scenario.fault(
                    "control.points",
                    format!(
                        "frame {} of {} shows {} of them; a resection needs at least {FEWEST_CONTROL_POINTS}",
                        index + 1,
                        self.frames.len(),
                        frame.control.len()
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Returns the least and the greatest x and y on the mean terrain in the corners of the frames,
    /// m.
    fn covered(&self, scenario: &Scenario) -> [[f64; 2]; 2] {
        let interior = self.corrections.interior();
        let [half_x, half_y] = interior.half_format_mm;
        let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let mut least = [f64::INFINITY; 2];
        let mut most = [f64::NEG_INFINITY; 2];
        for frame in &self.frames {
            for [u, w] in corners {
                if let Some([x, y]) = ground_at_height(
                    &frame.orientation,
                    interior.principal_distance_mm,
                    interior.about_centroid([u * half_x, w * half_y]),
                    scenario.written.terrain.height_m,
                ) {
                    least = [least[0].min(x), least[1].min(y)];
                    most = [most[0].max(x), most[1].max(y)];
                }
            }
        }
        [least, most]
    }
}

/// Returns the exposure request of the reference.
fn request(scenario: &Scenario) -> ExposureRequest {
    ExposureRequest {
        focus_shift_mm: scenario.written.truth.focus_shift_um / 1000.0,
        focus_formula: FocusFormula::Physical,
        ..ExposureRequest::planned(scenario.vh_per_s(), scenario.written.flight.exposure_s)
    }
}

/// Computes the corrections of the strip's exposures; refuses exposures that the camera refuses.
fn corrections(scenario: &Scenario) -> Result<Corrections, InputError> {
    let camera = &scenario.camera;
    let path = ExposurePath::new(camera, &request(scenario));
    let exposure = Exposure {
        focus_shift_um: single(scenario.known_focus_shift_um()),
        model: CorrectionModel::Exact,
        ..Exposure::new(
            single(scenario.vh_per_s()),
            single(scenario.written.flight.exposure_s),
        )
    };
    let frame = Camera::new(camera.parameters())
        .map_err(|error| error.to_string())
        .and_then(|checked| checked.frame(&exposure).map_err(|error| error.to_string()))
        .map_err(|error| {
            scenario.fault(
                "flight.speed_m_s, height_m, exposure_s",
                format!(
                    "V/H = speed_m_s / (height_m - terrain.height_m) = {} 1/s and {} s: the camera refuses the exposure: {error}",
                    scenario.vh_per_s(),
                    scenario.written.flight.exposure_s
                ),
            )
        })?;
    Ok(Corrections::new(
        InteriorOrientation::new(camera, &path),
        Lens::of(camera),
        FittedModel::printed(camera, path.travel_mm),
        frame.correction,
        f64::from(frame.interior.enlargement),
    ))
}

fn terrain(scenario: &Scenario) -> Terrain {
    let table = &scenario.written.terrain;
    Terrain {
        height_m: table.height_m,
        relief_m: table.relief_m,
        wavelength_m: table.wavelength_m,
    }
}

/// Returns the true orientations: along the heading, turned so that the FMC axis points ahead, with
/// the scenario's spread of attitude.
fn orientations(scenario: &Scenario, seed: u64) -> Vec<ExteriorOrientation> {
    let flight = &scenario.written.flight;
    let heading = flight.heading_deg.to_radians();
    let (east, north) = heading.sin_cos();
    let [ex, ey] = scenario.camera.fmc.axis.unit();
    // Heading counts clockwise from north, yaw counter-clockwise from the y axis.
    let level_yaw = std::f64::consts::FRAC_PI_2 - ey.atan2(ex) - heading;
    let mut noise = Noise::new(seed, 0);
    let [start_x, start_y] = flight.start_m;
    (0..flight.frames)
        .filter_map(|index| i32::try_from(index).ok())
        .map(|index| {
            let along = f64::from(index) * flight.base_m;
            let [pitch, roll, yaw] = noise.next(flight.attitude_spread_deg.map(f64::to_radians));
            ExteriorOrientation {
                position_m: [
                    start_x + along * east,
                    start_y + along * north,
                    flight.height_m,
                ],
                attitude: [pitch, roll, level_yaw + yaw],
            }
        })
        .collect()
}

fn coordinates(point: &GroundPoint) -> [f64; 3] {
    [point.x_m, point.y_m, point.z_m]
}

/// Returns even positions from -1 to 1 in both directions.
fn grid(per_side: i64) -> impl Iterator<Item = [f64; 2]> {
    let side = i32::try_from(per_side).unwrap_or(2).max(2);
    let place = move |index: i32| 2.0 * f64::from(index) / f64::from(side - 1) - 1.0;
    (0..side).flat_map(move |row| (0..side).map(move |column| [place(column), place(row)]))
}

/// Returns the terrain point seen at a point of the sensor frame, by iteration of its height.
fn on_terrain(
    terrain: &Terrain,
    interior: &InteriorOrientation,
    orientation: &ExteriorOrientation,
    place_mm: [f64; 2],
) -> Option<[f64; 3]> {
    let image = interior.about_centroid(place_mm);
    let mut z = terrain.height_m;
    let mut place = [0.0; 2];
    for _ in 0..50 {
        place = ground_at_height(orientation, interior.principal_distance_mm, image, z)?;
        z = terrain.height_at(place);
    }
    let [x, y] = place;
    Some([x, y, z])
}

/// Returns the diagonal of the box around positions, m.
fn extent(places: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut least = [f64::INFINITY; 2];
    let mut most = [f64::NEG_INFINITY; 2];
    for [x, y] in places {
        least = [least[0].min(x), least[1].min(y)];
        most = [most[0].max(x), most[1].max(y)];
    }
    (most[0] - least[0]).hypot(most[1] - least[1])
}
