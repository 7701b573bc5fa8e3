//! Statement of the frames of a flight that were exported.

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::frames::{Flight, ImagePose, ONE_CAMERA_PX, Refused};
use fmc_frames::time::LEAP_SECONDS;
use serde::Serialize;

use crate::length;

/// Most refused triggers that a terminal lists; `export.json` has them all.
const LISTED: usize = 20;

/// Statement of the frames of a flight. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExportedFlight {
    /// File of the records.
    pub records: String,
    /// Number of frames written.
    pub exposures: usize,
    /// Triggers without an exposure, which have no frame.
    pub refused: Vec<RefusedTrigger>,
    /// Source of the names of the images: a pattern, or the file of a table.
    pub images: String,
    /// Frames whose time in UTC is not known: their fields of UTC and GPS time are empty.
    pub without_utc: usize,
    /// Source of the leap seconds in GPS time.
    pub leap_seconds: &'static str,
    /// Largest distance of a principal point from the calibrated one, µm.
    pub largest_offset_um: f64,
    /// The same, px.
    pub largest_offset_px: f64,
    /// Sequence number of that frame.
    pub largest_offset_sequence: u32,
    /// Largest enlargement κ of the image by the focus shift.
    pub largest_enlargement: f64,
    /// Largest displacement of a point by that enlargement, µm.
    pub largest_enlargement_um: f64,
    /// Cost of one camera for all frames: both displacements together, px.
    pub one_camera_px: f64,
    /// `true` if one camera for all frames costs less than 0.05 px.
    pub one_camera_is_enough: bool,
    /// Way that is advised, in words.
    pub way: String,
    /// Largest effect of the motion during an exposure that no camera has a place for, nm.
    pub left_out_nm: f64,
    /// Poses that were written; `null` without a trajectory, or for a program without a place for
    /// them.
    pub poses: Option<ExportedPoses>,
}

/// Statement of the poses of the frames.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ExportedPoses {
    /// Number of frames with a pose.
    pub frames: usize,
    /// Coordinates of the places.
    pub coordinates: &'static str,
    /// Angles, and the axes of the camera.
    pub convention: &'static str,
    /// `true` if the trajectory states σ. Metashape's table and `OpenSfM`'s priors hold it.
    pub has_sigma: bool,
}

impl ExportedPoses {
    fn of(flight: &Flight) -> Option<Self> {
        let poses = flight.poses.as_ref()?;
        let first = poses.first().map(|(_, pose)| pose);
        Some(Self {
            frames: poses.len(),
            coordinates: match first.and_then(ImagePose::geographic) {
                Some(_) => "latitude, longitude and height above the ellipsoid of WGS 84",
                None => "x, y and z of the trajectory, or east, north and up of its origin",
            },
            convention: "ground_from_camera = Rx(omega)·Ry(phi)·Rz(kappa); camera: x right and y \
                         up in the image, z away from the ground, the FMC axis forward; no lever \
                         arm, no boresight",
            has_sigma: first.is_some_and(|pose| pose.sigma.is_some()),
        })
    }
}

/// A trigger without an exposure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RefusedTrigger {
    /// Sequence number.
    pub sequence: u32,
    /// Reason.
    pub reason: String,
}

impl ExportedFlight {
    /// Returns the statement of a flight's frames.
    #[must_use]
    pub fn of(
        records: String,
        images: String,
        flight: &Flight,
        camera: &Calibrated,
        left_out_nm: f64,
    ) -> Self {
        let cost = flight.one_camera(camera);
        Self {
            records,
            exposures: flight.frames.len(),
            refused: flight.refused.iter().map(refused).collect(),
            images,
            without_utc: flight.without_utc(),
            leap_seconds: LEAP_SECONDS,
            largest_offset_um: cost.offset_mm * 1e3,
            largest_offset_px: cost.offset_mm / camera.pixel_mm,
            largest_offset_sequence: cost.sequence,
            largest_enlargement: cost.enlargement,
            largest_enlargement_um: cost.enlarged_mm * 1e3,
            one_camera_px: cost.cost_px,
            one_camera_is_enough: cost.is_advised(),
            way: if cost.is_advised() {
                format!(
                    "one camera for all frames: it costs less than {ONE_CAMERA_PX} px (export \
                     without --records)"
                )
            } else {
                "a camera per image, held fixed; for a block that calibrates itself one camera, \
                 with points of host-sim correct --records --answer ideal-shifted or \
                 measured-shifted"
                    .to_owned()
            },
            left_out_nm,
            poses: ExportedPoses::of(flight),
        }
    }

    /// Returns names and values for a terminal.
    pub(super) fn pairs(&self) -> Vec<(&'static str, String)> {
        let mut pairs = vec![
            ("records", self.records.clone()),
            ("exposures", self.exposures.to_string()),
            ("refused", self.refused_text()),
            ("images", self.images.clone()),
        ];
        if self.without_utc > 0 {
            let text = format!("{} of {}: left empty", self.without_utc, self.exposures);
            pairs.push(("without UTC", text));
        }
        pairs.push((
            "largest c̄",
            format!(
                "{} ({:.4} px), sequence {}",
                length::text(self.largest_offset_um / 1e3),
                self.largest_offset_px,
                self.largest_offset_sequence
            ),
        ));
        let edge = length::text(self.largest_enlargement_um / 1e3);
        pairs.push((
            "largest κ",
            format!("{:.7}: {edge} at the edge", self.largest_enlargement),
        ));
        pairs.push((
            "one camera",
            format!("would cost {:.4} px", self.one_camera_px),
        ));
        pairs.push(("way", self.way.clone()));
        let left_out = format!("{:.2} nm: curvature over the motion", self.left_out_nm);
        pairs.push(("left out", left_out));
        if let Some(poses) = &self.poses {
            let count = format!(
                "{} of {}; {}",
                poses.frames, self.exposures, poses.coordinates
            );
            pairs.push(("poses", count));
            pairs.push(("angles", poses.convention.to_owned()));
        }
        pairs
    }

    fn refused_text(&self) -> String {
        if self.refused.is_empty() {
            return "none".to_owned();
        }
        let listed: Vec<String> = self
            .refused
            .iter()
            .take(LISTED)
            .map(|one| format!("{} ({})", one.sequence, one.reason))
            .collect();
        let more = match self.refused.len().saturating_sub(LISTED) {
            0 => String::new(),
            more => format!(" and {more} more in export.json"),
        };
        format!("{}: {}{more}", self.refused.len(), listed.join(", "))
    }
}

fn refused(refused: &Refused) -> RefusedTrigger {
    RefusedTrigger {
        sequence: refused.sequence,
        reason: refused.reason.to_string(),
    }
}
