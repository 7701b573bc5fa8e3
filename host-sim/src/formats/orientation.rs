//! Table of exterior orientations.

use std::io::{self, Write};

use fmc_frames::trajectory::{ImageOrientation, OrientationSigma, Place};
use serde::Serialize;

/// Columns of place and angles.
#[derive(Debug, Serialize)]
struct PlaceColumns<'a> {
    image: &'a str,
    x_m: String,
    y_m: String,
    z_m: String,
    pitch_deg: String,
    roll_deg: String,
    yaw_deg: String,
}

/// Columns of σ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SigmaColumns {
    sigma_x_m: String,
    sigma_y_m: String,
    sigma_z_m: String,
    sigma_pitch_deg: String,
    sigma_roll_deg: String,
    sigma_yaw_deg: String,
}

/// Columns of the velocity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VelocityColumns {
    vx_m_s: String,
    vy_m_s: String,
    vz_m_s: String,
}

impl SigmaColumns {
    /// Returns the cells of σ.
    #[must_use]
    pub fn of(sigma: &OrientationSigma) -> Self {
        let [x, y, z] = sigma.position_m.map(metres);
        let [pitch, roll, yaw] = sigma.angles_rad.map(degrees);
        Self {
            sigma_x_m: x,
            sigma_y_m: y,
            sigma_z_m: z,
            sigma_pitch_deg: pitch,
            sigma_roll_deg: roll,
            sigma_yaw_deg: yaw,
        }
    }
}

impl VelocityColumns {
    /// Returns the cells of a velocity.
    #[must_use]
    pub fn of(velocity_m_s: [f64; 3]) -> Self {
        let [vx_m_s, vy_m_s, vz_m_s] = velocity_m_s.map(|speed| format!("{:.4}", speed + 0.0));
        Self {
            vx_m_s,
            vy_m_s,
            vz_m_s,
        }
    }
}

/// Returns a length with micrometres.
#[must_use]
pub fn metres(length_m: f64) -> String {
    format!("{:.6}", length_m + 0.0)
}

/// Returns an angle of rad in degrees, to 2e-11 rad.
#[must_use]
pub fn degrees(angle_rad: f64) -> String {
    format!("{:.9}", angle_rad.to_degrees() + 0.0)
}

/// Writer of a table of exterior orientations.
#[derive(Debug)]
pub struct OrientationTable<W: Write> {
    rows: csv::Writer<W>,
}

impl<W: Write> OrientationTable<W> {
    /// Begins a table.
    pub fn new(sink: W) -> Self {
        Self {
            rows: csv::Writer::from_writer(sink),
        }
    }

    /// Writes the row of an image; its place must be Cartesian. Of all images, or of none, σ is
    /// known.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn write(&mut self, image: &str, orientation: &ImageOrientation) -> io::Result<()> {
        let place = match orientation.place {
            Place::Cartesian(place) => place,
            Place::Geographic(_) => [f64::NAN; 3],
        };
        let [x_m, y_m, z_m] = place.map(metres);
        let attitude = orientation.attitude;
        let place = PlaceColumns {
            image,
            x_m,
            y_m,
            z_m,
            pitch_deg: degrees(attitude.pitch_rad),
            roll_deg: degrees(attitude.roll_rad),
            yaw_deg: degrees(attitude.yaw_rad),
        };
        let velocity = VelocityColumns::of(orientation.velocity_m_s);
        let written = match orientation.sigma() {
            Some(sigma) => self
                .rows
                .serialize((place, SigmaColumns::of(&sigma), velocity)),
            None => self.rows.serialize((place, velocity)),
        };
        Ok(written?)
    }

    /// Ends the table.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn end(mut self) -> io::Result<()> {
        self.rows.flush()
    }
}
