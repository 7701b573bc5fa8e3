//! Records of a flight: principal point, enlargement and time of every exposure, applied to the
//! tables of a network.

use std::collections::{HashMap, HashSet};

use fmc_camera_file::InputError;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::Vector2;

use super::interior::Interior;
use super::stage::StageSetting;
use super::tables::{ImagePointRow, ImageRow, NetworkTables, Table};

/// Largest number of steps of an inversion of the distortion.
const MOST_STEPS: usize = 50;

/// Step at which the inversion ends, mm.
const SMALLEST_STEP_MM: f64 = 1e-12;

/// Record of an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordRow {
    /// Line in the file.
    pub line: u64,
    /// Number of the frame, which is the name of its image.
    pub sequence: u32,
    /// `false` for a trigger without an exposure that can be used.
    pub is_exposed: bool,
    /// c̄: the principal point from the calibrated one along the FMC axis, mm.
    pub offset_mm: f64,
    /// σ of it, mm.
    pub sigma_mm: f64,
    /// κ = Δz/L: enlargement of the image by the focus shift.
    pub enlargement: f64,
    /// Centroid of the exposure after the trigger, s, where the record has both times.
    pub centroid_after_trigger_s: Option<f64>,
}

/// Records of a flight, and the camera's share in them.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightRecords {
    /// Rows.
    pub table: Table<RecordRow>,
    /// e: direction in which the principal point moves, sensor frame, of length 1.
    pub direction: [f64; 2],
    /// Calibrated principal point of the camera file, mm.
    pub principal_point_mm: [f64; 2],
    /// L: distance of the exit pupil, by which a focus shift enlarges the image, mm.
    pub lever_mm: f64,
    /// Residual grids of the camera; empty for one without.
    pub grids: ResidualSplines,
}

impl FlightRecords {
    /// Records of exposures.
    pub fn exposed(&self) -> impl Iterator<Item = &RecordRow> {
        self.table.rows.iter().filter(|row| row.is_exposed)
    }

    /// Least and largest c̄ of the exposures, mm; `None` without any.
    #[must_use]
    pub fn offsets_mm(&self) -> Option<[f64; 2]> {
        self.exposed()
            .map(|row| [row.offset_mm; 2])
            .reduce(|[least, most], [offset, _]| [least.min(offset), most.max(offset)])
    }

    /// Returns the tables with every image point reduced to the calibrated principal point and
    /// principal distance.
    ///
    /// # Model
    /// `v = x̄ - (1+κ)·(D(x̄/(1+κ)) + G) + f(1+κ)·u`, `x̄ = measured - (x0, y0) - c̄·e`:
    /// convention (B) of `docs/conventions.md` section 6, with G what the residual grids of the
    /// camera add to (A): that of the lens at `(measured - c̄·e)/(1+κ)`, that of the sensor at the
    /// measured point. Divided by `1+κ` it is the static equation of the point
    /// `(x0, y0) + x̄/(1+κ)` with `σ/(1+κ)`. c̄ and κ are those of the records; the setting of the
    /// stage goes with every image, so that [`Stage`](super::stage::Stage) can differ from them.
    ///
    /// # Accuracy
    /// The calibrated principal point stands for the adjusted one as the centre of the enlargement:
    /// their distance times κ, 0.02 nm for 20 µm and Δz = 0.1 µm in 100 mm. The grid of the lens
    /// stays at the place of the record where [`Stage`](super::stage::Stage) differs from it: for a
    /// scale 6 % off at c̄ = 64 µm and a slope of 1e-3, 4 nm.
    ///
    /// # Errors
    /// [`InputError`]: an image without record or with a refused one, a record twice or without
    /// image, a name of an image that is no number.
    pub fn reduced(&self, tables: &NetworkTables) -> Result<NetworkTables, InputError> {
        let [x0, y0] = self.principal_point_mm;
        let [e_x, e_y] = self.direction;
        self.with_points(tables, |record, row| {
            let scale = 1.0 + record.enlargement;
            let motion = [record.offset_mm * e_x, record.offset_mm * e_y];
            row.by_grids_mm = self
                .grids
                .moved(row.measured_mm, motion, record.enlargement);
            let ([x, y], [motion_x, motion_y]) = (row.measured_mm, motion);
            row.measured_mm = [
                x0 + (x - x0 - motion_x) / scale,
                y0 + (y - y0 - motion_y) / scale,
            ];
        })
    }

    /// Returns the tables as [`Self::reduced`], but with the distortion of every image about the
    /// calibrated principal point, as a program corrects that knows nothing of c̄, instead of about
    /// its own: what the recentring of the distortion is worth can be seen by the difference.
    ///
    /// # Model
    /// `p - D(p) = (x̄ - D(x̄) - c̄·e)/(1+κ)`, `x̄ = measured - (x0, y0)`, for the point p from
    /// (x0, y0), by at most 50 steps of `p → D(p) + …`; a lens of 10 % contracts by
    /// 0.3.
    ///
    /// # Errors
    /// As [`Self::reduced`].
    pub fn not_recentred(
        &self,
        tables: &NetworkTables,
        interior: &Interior,
    ) -> Result<NetworkTables, InputError> {
        let [x0, y0] = self.principal_point_mm;
        let direction = Vector2::from(self.direction);
        self.with_points(tables, |record, row| {
            row.by_grids_mm = self.grids.calibrated(row.measured_mm);
            let [x, y] = row.measured_mm;
            let measured = Vector2::new(x - x0, y - y0);
            let ideal = measured - interior.distortion(measured.into());
            let moved = (ideal - record.offset_mm * direction) / (1.0 + record.enlargement);
            let mut point = moved;
            for _ in 0..MOST_STEPS {
                let next = moved + interior.distortion(point.into());
                let step = (next - point).norm();
                point = next;
                if step < SMALLEST_STEP_MM {
                    break;
                }
            }
            row.measured_mm = [x0 + point.x, y0 + point.y];
        })
    }

    /// Returns the tables with every image point replaced, and σ divided by 1+κ.
    fn with_points(
        &self,
        tables: &NetworkTables,
        replace: impl Fn(&RecordRow, &mut ImagePointRow),
    ) -> Result<NetworkTables, InputError> {
        let by_sequence = self.by_sequence(tables)?;
        let mut reduced = tables.clone();
        let file = &tables.image_points.file;
        for row in &mut reduced.image_points.rows {
            let record = self.of_image(&by_sequence, file, row.line, &row.image)?;
            replace(record, row);
            row.sigma_mm = row.sigma_mm.map(|sigma| sigma / (1.0 + record.enlargement));
            if !reduced.stages.contains_key(&row.image) {
                let setting = StageSetting {
                    principal_point_mm: self.principal_point_mm,
                    direction: self.direction,
                    offset_mm: record.offset_mm,
                    enlargement: record.enlargement,
                    lever_mm: self.lever_mm,
                };
                reduced.stages.insert(row.image.clone(), setting);
            }
        }
        Ok(reduced)
    }

    /// Returns the tables with observed positions moved from the triggers to the centroids of the
    /// exposures: `S + V·(centroid - trigger)`.
    ///
    /// # Errors
    /// [`InputError`] as [`Self::reduced`], and an image without velocity or a record without both
    /// times.
    pub fn at_centroids(&self, tables: &NetworkTables) -> Result<NetworkTables, InputError> {
        let by_sequence = self.by_sequence(tables)?;
        let mut moved = tables.clone();
        let Some(images) = &mut moved.images else {
            return Ok(moved);
        };
        let shown = shown(tables);
        let rows = images.rows.iter_mut();
        for row in rows.filter(|row| shown.contains(&*row.image)) {
            let record = self.of_image(&by_sequence, &images.file, row.line, &row.image)?;
            let ImageRow { line, image, .. } = row;
            let seconds = record.centroid_after_trigger_s.ok_or_else(|| {
                InputError::invalid(format!(
                    "{}, line {}: trigger_us or centroid_us of frame {image} is missing; positions at the triggers need both",
                    self.table.file, record.line
                ))
            })?;
            let velocity = row.velocity_m_s.ok_or_else(|| {
                InputError::invalid(format!(
                    "{}, line {line}: image {image} has no velocity (vx_m_s,vy_m_s,vz_m_s); a position at the trigger needs one",
                    images.file
                ))
            })?;
            for (coordinate, speed) in row.position_m.iter_mut().zip(velocity) {
                *coordinate += speed * seconds;
            }
        }
        Ok(moved)
    }

    /// Returns the records by number, after a look at whether they belong to the images.
    fn by_sequence(&self, tables: &NetworkTables) -> Result<HashMap<u32, &RecordRow>, InputError> {
        let file = &self.table.file;
        let mut by_sequence: HashMap<u32, &RecordRow> = HashMap::new();
        for row in &self.table.rows {
            if let Some(first) = by_sequence.insert(row.sequence, row) {
                return Err(InputError::invalid(format!(
                    "{file}, lines {} and {}: sequence = {} appears twice; a frame has one record",
                    first.line, row.line, row.sequence
                )));
            }
        }
        let shown = shown(tables);
        let listed = tables.images.iter().flat_map(|table| &table.rows);
        let names: HashSet<u32> = shown
            .iter()
            .copied()
            .chain(listed.map(|row| &*row.image))
            .filter_map(|name| name.parse().ok())
            .collect();
        if let Some(row) = self.exposed().find(|row| !names.contains(&row.sequence)) {
            return Err(InputError::invalid(format!(
                "{file}, line {}: sequence = {} is no image of {}; allowed: the names of its images (records of another flight?)",
                row.line, row.sequence, tables.image_points.file
            )));
        }
        Ok(by_sequence)
    }

    fn of_image<'a>(
        &self,
        by_sequence: &HashMap<u32, &'a RecordRow>,
        file: &str,
        line: u64,
        image: &str,
    ) -> Result<&'a RecordRow, InputError> {
        let sequence: u32 = image.parse().map_err(|_| {
            InputError::invalid(format!(
                "{file}, line {line}: image {image} is no number; with records the name of an image is the sequence of its \
                 frame, 0 to {}",
                u32::MAX
            ))
        })?;
        let records = &self.table.file;
        match by_sequence.get(&sequence) {
            None => Err(InputError::invalid(format!(
                "{file}, line {line}: image {image} has no record in {records}; every image needs one with sequence = {sequence}"
            ))),
            Some(record) if !record.is_exposed => Err(InputError::invalid(format!(
                "{records}, line {}: outcome of sequence = {sequence} is refused, but {file} has its image {image}; allowed: exposed",
                record.line
            ))),
            Some(record) => Ok(record),
        }
    }
}

/// Names of the images with image points.
fn shown(tables: &NetworkTables) -> HashSet<&str> {
    let rows = tables.image_points.rows.iter();
    rows.map(|row| &*row.image).collect()
}

#[cfg(test)]
mod tests {
    use fmc_reference::residual_spline::ResidualSpline;

    use super::*;

    /// Spline of `size`·(xy, x² - y²) over ±30 mm, which have their own values as coefficients: the
    /// second differences of a bilinear and of a harmonic square cancel.
    fn bowl(size: f64) -> ResidualSpline {
        let nodes = (0..49_u8).map(|node| {
            let [x, y] = [node % 7, node / 7].map(|place| 10.0 * f64::from(place) - 30.0);
            [size * x * y, size * (x * x - y * y)]
        });
        ResidualSpline::new([-30.0; 2], 10.0, 7, nodes.collect())
    }

    #[test]
    fn reduced_points_satisfy_convention_b() {
        let interior = Interior {
            principal_distance_mm: 50.0,
            principal_point_mm: [0.05, -0.08],
            k: [0.0, -1.2e-5, 6e-9, -1e-12],
            p: [3e-6, -2e-6],
            b: [2e-4, -1e-4],
        };
        let (kappa, offset_mm, direction) = (1.3e-4, 0.4, [-1.0, 0.0]);
        let measured_mm = [17.0, -9.0];
        let tables = NetworkTables {
            image_points: Table {
                file: "points".to_owned(),
                rows: vec![ImagePointRow {
                    line: 2,
                    image: "7".into(),
                    point: "p".into(),
                    measured_mm,
                    by_grids_mm: [0.0; 2],
                    sigma_mm: Some(0.001),
                }],
            },
            object_points: Table {
                file: "objects".to_owned(),
                rows: Vec::new(),
            },
            images: None,
            scale_bars: None,
            stages: HashMap::new(),
        };
        let records = FlightRecords {
            table: Table {
                file: "records".to_owned(),
                rows: vec![RecordRow {
                    line: 2,
                    sequence: 7,
                    is_exposed: true,
                    offset_mm,
                    sigma_mm: 0.0,
                    enlargement: kappa,
                    centroid_after_trigger_s: None,
                }],
            },
            direction,
            principal_point_mm: interior.principal_point_mm,
            lever_mm: 50.0,
            grids: ResidualSplines::new(Some(bowl(2e-6)), Some(bowl(-3e-6))),
        };
        let reduced = records.reduced(&tables).unwrap();
        let row = reduced.image_points.rows.first().unwrap();
        let ideal = interior.corrected(row.measured_mm);
        // The grid of the lens goes with c̄ and the focus, that of the sensor stays.
        let [x, y] = [17.4, -9.0].map(|place| place / (1.0 + kappa));
        let grids = [
            2e-6 * x * y - 3e-6 * 17.0 * -9.0,
            2e-6 * (x * x - y * y) - 3e-6 * (17.0 * 17.0 - 9.0 * 9.0),
        ];
        for (found, expected) in row.by_grids_mm.into_iter().zip(grids) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
        let at_rest = tables.with_grids(&records.grids).image_points.rows;
        let [at_x, at_y] = at_rest.first().unwrap().by_grids_mm;
        let [expected_x, expected_y] = [-1e-6 * 17.0 * -9.0, -1e-6 * (17.0 * 17.0 - 9.0 * 9.0)];
        assert!((at_x - expected_x).abs() < 1e-15 && (at_y - expected_y).abs() < 1e-15);
        // f(1+κ), (1+κ)·D(r/(1+κ)) about (x0, y0) + c̄·e.
        let scale = 1.0 + kappa;
        let about = [measured_mm[0] - 0.05 + offset_mm, measured_mm[1] + 0.08];
        let distortion = scale * interior.distortion(about.map(|one| one / scale));
        for (axis, one) in about.into_iter().enumerate() {
            let tangent = (one - distortion[axis]) / (50.0 * scale);
            assert!((tangent - ideal[axis] / 50.0).abs() < 1e-15);
        }
        assert!((row.sigma_mm.unwrap() * scale - 0.001).abs() < 1e-18);
    }
}
