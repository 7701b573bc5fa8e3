//! Check of a record against its camera.

use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::frame_correction::Terms;
use fmc_camera::geometry::moments::CentralMoments;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::range::{MAX_FOCUS_FRACTION, Quantity};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::InputError;

use crate::columns::shown;
use crate::frame::focus_shift;
use crate::row::{self, Names, Row};
use crate::{Exposed, FlightFrame, FrameCamera, Outcome};

/// Largest difference of a principal point or distance of a record from what the camera file gives,
/// mm. Records hold all digits; a file whose numbers were rounded to a nanometre passes.
const TOLERANCE_MM: f32 = 1e-6;
/// The same of an enlargement.
const ENLARGEMENT_TOLERANCE: f32 = 1e-9;

/// Returns the frame of a record.
///
/// # Errors
/// [`InputError`] naming the place, the column, its value and the allowed range.
pub(crate) fn frame<L: Names>(
    row: Row<L>,
    place: &str,
    camera: &FrameCamera,
) -> Result<FlightFrame, InputError> {
    let fields = Fields { place };
    let crc = fields.crc(&row.calibration_crc32, camera)?;
    let outcome = match &*row.outcome {
        row::EXPOSED => Outcome::Exposed(fields.exposed(&row, camera)?),
        row::REFUSED => match &row.reason {
            Some(reason) if !reason.is_empty() => Outcome::Refused(reason.clone().into_owned()),
            _ => return Err(fields.missing("reason", "a refused trigger")),
        },
        other => return Err(fields.wrong("outcome", other, "exposed or refused")),
    };
    Ok(FlightFrame {
        sequence: row.sequence,
        image: None,
        trigger: Some(Time::from_us(row.trigger_us)),
        outcome,
        faults: row.faults.into_cell(),
        flags: row.flags.into_cell(),
        calibration_crc: crc,
    })
}

/// The fields of a record, as messages name them.
struct Fields<'a> {
    place: &'a str,
}

impl Fields<'_> {
    fn crc(&self, text: &str, camera: &FrameCamera) -> Result<Option<u32>, InputError> {
        const COLUMN: &str = "calibration_crc32";
        let crc = match text.len() {
            8 => u32::from_str_radix(text, 16).ok(),
            _ => None,
        };
        match crc {
            None => Err(self.wrong(COLUMN, text, "eight hexadecimal digits")),
            // The camera had no identity.
            Some(0) => Ok(None),
            Some(crc) if camera.has_crc(crc) => Ok(Some(crc)),
            Some(crc) => Err(InputError::invalid(format!(
                "{}: {COLUMN} = {crc:08x}: a record of another calibration than {}, which has {:08x}",
                self.place,
                camera.name(),
                camera.crc()
            ))
            .with_help(
                "--camera with the file that the camera was given for this flight; if it states no [limits] and the \
                 camera flew with settings of its own, with the largest V/H of those settings",
            )),
        }
    }

    fn exposed<L>(&self, row: &Row<L>, camera: &FrameCamera) -> Result<Exposed, InputError> {
        let motion = self.motion(row, camera)?;
        let calibration = camera.calibration();
        let parameters = calibration.parameters();
        let model = self.model(row.model.as_deref())?;
        if model == CorrectionModel::Fitted && parameters.fitted.is_none() {
            let text = format!("a model that {} has, which has no [fitted]", camera.name());
            return Err(self.wrong("model", "fitted", &text));
        }
        let terms = match row.kernel.as_deref() {
            Some(name) if name == row::kernel(Terms::Short) => Terms::Short,
            Some(name) if name == row::kernel(Terms::Full) => Terms::Full,
            other => return Err(self.wrong("kernel", other.unwrap_or_default(), "short or full")),
        };
        let centre = parameters
            .axis
            .sensor_from_offset(parameters.principal_point, motion.centroid_mm);
        let principal_point = SensorPoint::new(
            self.of_camera(
                "principal_point_x_mm",
                row.principal_point_x_mm,
                centre.x_mm,
                camera,
            )?,
            self.of_camera(
                "principal_point_y_mm",
                row.principal_point_y_mm,
                centre.y_mm,
                camera,
            )?,
        );
        let principal_distance_mm = self.of_camera(
            "principal_distance_mm",
            row.principal_distance_mm,
            parameters.principal_distance_mm,
            camera,
        )?;
        let most = MAX_FOCUS_FRACTION
            * parameters
                .exit_pupil_mm
                .min(parameters.principal_distance_mm);
        let focus_shift_mm = self.within("focus_shift_mm", row.focus_shift_mm, [-most, most])?;
        let (enlargement, focus_sign) = self.enlargement(row, model, focus_shift_mm, camera)?;
        let non_negative = [0.0, f32::MAX];
        Ok(Exposed {
            interior: InteriorOrientation {
                vh_per_s: self.within(
                    "compensated_vh_per_s",
                    row.compensated_vh_per_s,
                    [f32::MIN, f32::MAX],
                )?,
                exposure_s: self.within("exposure_s", row.exposure_s, non_negative)?,
                motion,
                principal_point,
                principal_distance_mm,
                focus_shift_mm,
                enlargement,
                model,
                terms,
                left_out_nm: self.within("left_out_nm", row.left_out_nm, non_negative)?,
            },
            focus_sign,
            opened: row.opened_us.map(Time::from_us),
            closed: row.closed_us.map(Time::from_us),
            centroid: Some(Time::from_us(
                row.centroid_us
                    .ok_or_else(|| self.missing("centroid_us", "an exposure"))?,
            )),
            centroid_utc: match row.centroid_unix_us {
                None => None,
                Some(unix_us) => Some(UtcTime {
                    unix_us,
                    sigma_s: self.within("utc_sigma_s", row.utc_sigma_s, non_negative)?,
                }),
            },
            sigma: self.sigma(row)?,
        })
    }

    fn motion<L>(
        &self,
        row: &Row<L>,
        camera: &FrameCamera,
    ) -> Result<PrincipalPointMotion, InputError> {
        let any = [f32::MIN, f32::MAX];
        let non_negative = [0.0, f32::MAX];
        let motion = PrincipalPointMotion {
            opening_offset_mm: self.within("opening_offset_mm", row.opening_offset_mm, any)?,
            travel_mm: self.within("travel_mm", row.travel_mm, any)?,
            centroid_time_s: self.within(
                "centroid_after_opening_s",
                row.centroid_after_opening_s,
                non_negative,
            )?,
            centroid_mm: self.within("centroid_offset_mm", row.centroid_offset_mm, any)?,
            moments: CentralMoments {
                second: self.within("variance_mm2", row.variance_mm2, non_negative)?,
                third: self.within("third_moment_mm3", row.third_moment_mm3, any)?,
                fourth: self.within("fourth_moment_mm4", row.fourth_moment_mm4, non_negative)?,
            },
        };
        let still = Exposure {
            model: CorrectionModel::Static,
            ..Exposure::new(0.0, 0.0)
        };
        match camera.camera().frame_of(&still, &motion) {
            Ok(_) => Ok(motion),
            Err(FrameError::OutOfRange(range)) => {
                let column = match range.quantity {
                    Quantity::OpeningOffsetMm => "opening_offset_mm",
                    Quantity::CentroidOffsetMm => "centroid_offset_mm",
                    Quantity::FocusShiftUm => "centroid_offset_mm (its run-out)",
                    _ => "travel_mm",
                };
                Err(InputError::invalid(format!(
                    "{}: {column} = {} is outside {} to {}, the stroke of {}",
                    self.place,
                    range.value,
                    range.min,
                    range.max,
                    camera.name()
                )))
            }
            Err(error) => Err(InputError::invalid(format!("{}: {error}", self.place))),
        }
    }

    /// Returns the enlargement of the record, and the formula that gives it.
    fn enlargement<L>(
        &self,
        row: &Row<L>,
        model: CorrectionModel,
        focus_shift_mm: f32,
        camera: &FrameCamera,
    ) -> Result<(f32, FocusSign), InputError> {
        const COLUMN: &str = "enlargement";
        match row.focus_convention.as_deref() {
            Some(row::FOCUS_CONVENTION) => {}
            other => {
                return Err(self.wrong(
                    "focus_convention",
                    other.unwrap_or_default(),
                    row::FOCUS_CONVENTION,
                ));
            }
        }
        let enlargement = self.within(COLUMN, row.enlargement, [-1.0, 1.0])?;
        let of = |sign| match model {
            CorrectionModel::Exact => {
                focus_shift(camera.calibration(), focus_shift_mm, sign).enlargement()
            }
            CorrectionModel::Fitted | CorrectionModel::Static => 0.0,
        };
        [FocusSign::Physical, FocusSign::Printed]
            .into_iter()
            .find(|sign| (of(*sign) - enlargement).abs() <= ENLARGEMENT_TOLERANCE)
            .map(|sign| (enlargement, sign))
            .ok_or_else(|| {
                let expected = format!(
                    "{}, that of focus_shift_mm = {focus_shift_mm} and {}",
                    of(FocusSign::Physical),
                    camera.name()
                );
                self.wrong(COLUMN, &enlargement.to_string(), &expected)
            })
    }

    fn sigma<L>(&self, row: &Row<L>) -> Result<Option<PrincipalPointSigma>, InputError> {
        let non_negative = [0.0, f32::MAX];
        // Records from before the two parts were told apart have the sum.
        let (frame, common) = match (
            row.principal_point_frame_sigma_mm,
            row.principal_point_common_sigma_mm,
        ) {
            (None, None) => (row.principal_point_sigma_mm, Some(0.0)),
            parts => parts,
        };
        Ok(Some(PrincipalPointSigma {
            frame_mm: self.within("principal_point_frame_sigma_mm", frame, non_negative)?,
            common_mm: self.within("principal_point_common_sigma_mm", common, non_negative)?,
        }))
    }

    fn model(&self, name: Option<&str>) -> Result<CorrectionModel, InputError> {
        [
            CorrectionModel::Exact,
            CorrectionModel::Fitted,
            CorrectionModel::Static,
        ]
        .into_iter()
        .find(|model| Some(row::model(*model)) == name)
        .ok_or_else(|| self.wrong("model", name.unwrap_or_default(), "exact, fitted or static"))
    }

    /// Returns a number that the camera file gives, too.
    fn of_camera(
        &self,
        column: &str,
        value: Option<f32>,
        expected: f32,
        camera: &FrameCamera,
    ) -> Result<f32, InputError> {
        let value = self.within(column, value, [f32::MIN, f32::MAX])?;
        if (value - expected).abs() <= TOLERANCE_MM {
            return Ok(value);
        }
        let text = format!("{expected}, by centroid_offset_mm and {}", camera.name());
        Err(self.wrong(column, &value.to_string(), &text))
    }

    fn within(
        &self,
        column: &str,
        value: Option<f32>,
        [least, most]: [f32; 2],
    ) -> Result<f32, InputError> {
        let value = value.ok_or_else(|| self.missing(column, "an exposure"))?;
        if !value.is_finite() {
            return Err(self.wrong(column, &value.to_string(), "a finite number"));
        }
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.wrong(column, &value.to_string(), &range(least, most)))
    }

    fn missing(&self, column: &str, of: &str) -> InputError {
        InputError::invalid(format!("{}: {column} of {of} is missing", self.place))
    }

    fn wrong(&self, column: &str, value: &str, allowed: &str) -> InputError {
        InputError::invalid(format!(
            "{}: {column} = {}: must be {allowed}",
            self.place,
            shown(value)
        ))
    }
}

/// Returns a range in words.
fn range(least: f32, most: f32) -> String {
    if most < f32::MAX {
        format!("{least} to {most}")
    } else {
        format!("at least {least}")
    }
}
