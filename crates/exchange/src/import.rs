//! Calibrations from the files of other programs.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;

use crate::calibrated::Calibrated;
use crate::found::{Formula, Found, Stated};
use crate::inverse;
use crate::least_squares::linear;
use crate::one_to_one::{self, Field};
use crate::program::{
    Program, australis, colmap, dji, inpho, kalibr, metashape, micmac, opencv, opensfm,
    opentrackio, opf, photomodeler, pix4d, ros, usgs,
};
use crate::residual::Residual;
use crate::source::Source;

/// Points along each side of the grid to which the coefficients are fitted.
pub const GRID: u32 = 61;

/// Points along each side of the sensor at which polynomial and residual grid are compared with the
/// file's formula: other points than those of a fit.
pub const COMPARED: u32 = 101;

/// Part by which a pixel pitch may differ from the file's, which is rounded.
const PITCH_TOLERANCE: f64 = 1e-4;

/// A calibration from a program's file.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Interior orientation as this project has it; its margin is zero.
    pub camera: Calibrated,
    /// The file's formula.
    pub found: Found,
    /// `true` if the coefficients were converted, `false` if they were fitted.
    pub is_exact: bool,
    /// Difference that the fit leaves over the sensor, in ideal points.
    pub residual: Residual,
}

/// A measured point and its ideal point about the principal point, mm.
type Pair = ([f64; 2], [f64; 2]);

/// Reads the camera of a program's file.
///
/// # Errors
/// [`InputError`] that names the file and the fault.
pub fn read(
    program: Program,
    source: &Source<'_>,
    stated: &Stated<'_>,
) -> Result<Found, InputError> {
    match program {
        Program::OpenCv => opencv::read(source),
        Program::Ros => ros::read(source),
        Program::Kalibr => kalibr::read(source, stated),
        Program::Colmap => colmap::read(source, stated),
        Program::Metashape => metashape::read(source, stated),
        Program::OpenSfm => opensfm::read(source, stated),
        Program::Opf => opf::read(source, stated),
        Program::Pix4d => pix4d::read(source, stated),
        Program::OpenTrackIo => opentrackio::read(source, stated),
        Program::MicMac => micmac::read(source, stated),
        Program::Australis => australis::read(source),
        Program::PhotoModeler => photomodeler::read(source),
        Program::Usgs => usgs::read(source, stated),
        Program::Inpho => inpho::read(source, stated),
        Program::Dji => dji::read(source, stated),
        Program::ArcGis | Program::Frames => Err(InputError::invalid(format!(
            "{}: files of {} are only written",
            source.file,
            program.name()
        ))),
    }
}

/// Reads a calibration, and converts or fits its coefficients.
///
/// # Model
/// A polynomial of measured points about the principal point is converted. Of any other formula the
/// ideal points of [`GRID`] x [`GRID`] measured points, edges of the sensor included, are found,
/// ideal -> measured formulas by Newton's method to 1e-13 px, and K0..K3, P1, P2, B1, B2 are fitted
/// to measured - ideal by linear least squares; f is the file's along y, the principal point the
/// file's.
///
/// # Errors
/// [`InputError`] for a file that cannot be used, for a size or a pitch that is not stated or
/// contradicts the file, and for a formula that folds within the sensor.
pub fn import(
    program: Program,
    source: &Source<'_>,
    stated: &Stated<'_>,
) -> Result<Imported, InputError> {
    let found = read(program, source, stated)?;
    let size_px = size(source, &found, stated)?;
    let pixel_mm = pitch(source, &found, stated)?;
    let mut camera = Calibrated {
        name: found.name.clone(),
        size_px,
        pixel_mm,
        principal_distance_mm: 0.0,
        principal_point_mm: [0.0; 2],
        lens: Lens {
            k: [0.0; 4],
            p: [0.0; 2],
            b: [0.0; 2],
        },
        margin_mm: [0.0; 2],
        beyond_mm: [[0.0; 2]; 2],
        residual: ResidualSplines::default(),
    };
    match &found.formula {
        Formula::Pinhole(pinhole) => {
            let [_, fy] = pinhole.focal_px;
            camera.principal_distance_mm = fy * pixel_mm;
            camera.principal_point_mm = camera.sensor_from_pixel(pinhole.centre_px);
        }
        Formula::Correction(correction) => {
            camera.principal_distance_mm = correction.principal_distance_mm;
            camera.principal_point_mm = correction.principal_point_mm;
            if correction.is_polynomial() {
                camera.lens = correction.lens;
                return Ok(Imported {
                    camera,
                    found,
                    is_exact: true,
                    residual: Residual::default(),
                });
            }
        }
    }
    let points = camera.grid_mm(GRID);
    let ideal = ideal(&camera, &found.formula, &points).map_err(|fault| fault.refused(source))?;
    let pairs: Vec<Pair> = points.into_iter().zip(ideal).collect();
    camera.lens = polynomial(camera.principal_point_mm, &pairs)
        .ok_or_else(|| source.invalid("the distortion over the sensor is not finite"))?;
    let residual = Residual::of(pairs.iter().map(|(point, [ideal_x, ideal_y])| {
        let [x, y] = camera.ideal_from_measured(*point);
        (*point, [x - ideal_x, y - ideal_y])
    }));
    Ok(Imported {
        camera,
        found,
        is_exact: false,
        residual,
    })
}

/// Returns the coefficients that fit measured - ideal best; `None` where it is not finite.
fn polynomial([x0, y0]: [f64; 2], pairs: &[Pair]) -> Option<Lens> {
    let rows: Vec<_> = pairs
        .iter()
        .flat_map(|([x, y], [ideal_x, ideal_y])| {
            let [x, y] = [x - x0, y - y0];
            let r2 = x * x + y * y;
            let (r4, r6) = (r2 * r2, r2 * r2 * r2);
            [
                (
                    [
                        x,
                        x * r2,
                        x * r4,
                        x * r6,
                        r2 + 2.0 * x * x,
                        2.0 * x * y,
                        x,
                        y,
                    ],
                    x - ideal_x,
                ),
                (
                    [
                        y,
                        y * r2,
                        y * r4,
                        y * r6,
                        2.0 * x * y,
                        r2 + 2.0 * y * y,
                        0.0,
                        0.0,
                    ],
                    y - ideal_y,
                ),
            ]
        })
        .collect();
    let [k0, k1, k2, k3, p1, p2, b1, b2] = linear(&rows)?;
    Some(Lens {
        k: [k0, k1, k2, k3],
        p: [p1, p2],
        b: [b1, b2],
    })
}

/// Fault of a formula at measured points.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FormulaFault {
    /// A measured point has no ray.
    WithoutRay,
    /// The formula is not one-to-one over the rays.
    NotOneToOne(one_to_one::Fault),
}

impl FormulaFault {
    fn refused(self, source: &Source<'_>) -> InputError {
        match self {
            Self::WithoutRay => {
                source.invalid("the model folds within the sensor: measured points without a ray")
            }
            Self::NotOneToOne(fault) => fault.refused(source.file),
        }
    }
}

/// Returns the ideal points of measured points, about the principal point, mm, and shows that they
/// are the only ones.
fn ideal(
    camera: &Calibrated,
    formula: &Formula,
    points_mm: &[[f64; 2]],
) -> Result<Vec<[f64; 2]>, FormulaFault> {
    match formula {
        Formula::Correction(correction) => {
            let points = points_mm.iter();
            Ok(points
                .map(|point| correction.ideal_from_measured(*point))
                .collect())
        }
        Formula::Pinhole(pinhole) => {
            let points = points_mm.iter();
            let rays: Option<Vec<_>> = points
                .map(|point| inverse::ray(pinhole, camera.pixel_from_sensor(*point)))
                .collect();
            let rays = rays.ok_or(FormulaFault::WithoutRay)?;
            let field = Field::around(rays.iter().copied());
            one_to_one::show(pinhole, &field).map_err(FormulaFault::NotOneToOne)?;
            let distance = camera.principal_distance_mm;
            let rays = rays.into_iter();
            Ok(rays.map(|[x, y]| [x * distance, -y * distance]).collect())
        }
    }
}

impl Imported {
    /// Returns measured - ideal at points of the sensor frame by the file's own formula, mm; `None`
    /// where it folds or is not finite.
    #[must_use]
    pub fn distortion(&self, points_mm: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
        let [x0, y0] = self.camera.principal_point_mm;
        let ideal = ideal(&self.camera, &self.found.formula, points_mm).ok()?;
        let pairs = points_mm.iter().zip(ideal);
        pairs
            .map(|([x, y], [ideal_x, ideal_y])| {
                let distortion = [x - x0 - ideal_x, y - y0 - ideal_y];
                distortion
                    .iter()
                    .all(|part| part.is_finite())
                    .then_some(distortion)
            })
            .collect()
    }

    /// Returns what polynomial and another displacement, such as that of a residual grid, leave of
    /// the file's formula over the sensor; `None` where it folds.
    #[must_use]
    pub fn residual_with(&self, displacement: impl Fn([f64; 2]) -> [f64; 2]) -> Option<Residual> {
        let [x0, y0] = self.camera.principal_point_mm;
        let points = self.camera.grid_mm(COMPARED);
        let distortion = self.distortion(&points)?;
        let rows = points.into_iter().zip(distortion);
        Some(Residual::of(rows.map(|(point, [dx, dy])| {
            let [x, y] = point;
            let [px, py] = self.camera.lens.displacement([x - x0, y - y0]);
            let [gx, gy] = displacement(point);
            (point, [dx - px - gx, dy - py - gy])
        })))
    }
}

/// Returns the size of the array: the stated one, which must be the file's where it has one.
fn size(source: &Source<'_>, found: &Found, stated: &Stated<'_>) -> Result<[u32; 2], InputError> {
    let from = stated.size_stated_by();
    match (found.size_px, stated.size_px) {
        (Some([width, height]), Some([w, h])) if [width, height] != [w, h] => Err(source.invalid(
            format!("the file is of {width} x {height} px, {from} of {w} x {h} px"),
        )),
        (Some(size), _) | (None, Some(size)) => Ok(size),
        (None, None) => Err(source
            .invalid("the file has no size of the array, and none is stated")
            .with_help("--size 14204x10652, or a camera file with --base")),
    }
}

/// Returns the pixel pitch: the stated one, which must be near the file's where it has one.
fn pitch(source: &Source<'_>, found: &Found, stated: &Stated<'_>) -> Result<f64, InputError> {
    match (found.pixel_mm, stated.pixel_mm) {
        (Some(file), Some(pitch)) if (file / pitch - 1.0).abs() > PITCH_TOLERANCE => Err(source
            .invalid(format!(
                "the file has pixels of {:.6} µm, {} of {:.6} µm",
                1e3 * file,
                stated.pixel_stated_by(),
                1e3 * pitch
            ))),
        (_, Some(pitch)) | (Some(pitch), None) => Ok(pitch),
        (None, None) => Err(source
            .invalid("the file has no pixel pitch, and none is stated")
            .with_help("--pixel-um 3.76, or a camera file with --base")),
    }
}
