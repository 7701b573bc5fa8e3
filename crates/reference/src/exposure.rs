//! One exposure in double precision: the path of the principal point and the transmission.

use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera_file::{CameraFile, FmcTable, MechanismName, Profile, Strategy};

/// Formula that converts a focus shift into distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FocusFormula {
    /// Enlargement by Δz/L.
    Physical,
    /// Yuan et al. 2012, eqs. 14-17, as printed.
    Printed,
}

/// Request for an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExposureRequest {
    /// η = V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// Δδ if it is given, mm.
    pub opening_offset_mm: Option<f64>,
    /// Δz beyond the run-out, mm.
    pub focus_shift_mm: f64,
    /// Formula for the focus shift.
    pub focus_formula: FocusFormula,
    /// Direction of flight.
    pub direction: FlightDirection,
}

impl ExposureRequest {
    /// Creates the request for an exposure as planned.
    #[must_use]
    pub const fn planned(vh_per_s: f64, exposure_s: f64) -> Self {
        Self {
            vh_per_s,
            exposure_s,
            opening_offset_mm: None,
            focus_shift_mm: 0.0,
            focus_formula: FocusFormula::Physical,
            direction: FlightDirection::Forward,
        }
    }

    /// Returns V/H along the FMC axis, 1/s: negative if the camera flies against it.
    #[must_use]
    pub const fn signed_vh_per_s(&self) -> f64 {
        match self.direction {
            FlightDirection::Forward => self.vh_per_s,
            FlightDirection::Reverse => -self.vh_per_s,
        }
    }
}

/// Returns the length of the run-up from rest to a speed and of the settling at it, mm, with the
/// sign of the speed.
///
/// # Model
/// The acceleration rises to its peak p for p/J, stays, and falls for as long, p² = J|v| but at
/// most the largest: rise and fall together contribute p²/J to the speed. The mean speed is half of
/// the final one, as the acceleration is symmetric in time.
fn run_up_mm(speed: f64, fmc: &FmcTable) -> f64 {
    let limited = fmc.jerk_mm_s3 != 0.0;
    let most = fmc.acceleration_mm_s2;
    let (peak, rise_s) = if limited {
        let peak = (fmc.jerk_mm_s3 * speed.abs()).sqrt().min(most);
        (peak, peak / fmc.jerk_mm_s3)
    } else {
        (most, 0.0)
    };
    let ramp_s = if peak > 0.0 {
        speed.abs() / peak + rise_s
    } else {
        0.0
    };
    speed * (ramp_s / 2.0 + fmc.settling_ms / 1000.0)
}

/// Path of the principal point along the FMC axis and transmission along it, over the fraction u of
/// the exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct ExposurePath {
    /// Δδ, mm.
    pub opening_offset_mm: f64,
    /// δ, mm.
    pub travel_mm: f64,
    /// Offset added to the smooth path by the rows of a TDI sensor, mm.
    pub staircase_mm: f64,
    /// Ramps r₁, r₂ as fractions of the exposure.
    pub ramps: [f64; 2],
}

impl ExposurePath {
    /// Creates the path of an exposure of the camera.
    #[must_use]
    pub fn new(camera: &CameraFile, request: &ExposureRequest) -> Self {
        let speed = camera.principal_distance_mm * request.signed_vh_per_s();
        let ramps = match camera.shutter.profile {
            Profile::Uniform => [0.0, 0.0],
            Profile::Trapezoid => [
                camera.shutter.opening_fraction,
                camera.shutter.closing_fraction,
            ],
        };
        let mut path = Self {
            opening_offset_mm: 0.0,
            travel_mm: speed * request.exposure_s,
            staircase_mm: 0.0,
            ramps,
        };
        path.opening_offset_mm = match (request.opening_offset_mm, camera.fmc.mechanism) {
            (Some(offset_mm), _) => offset_mm,
            (None, MechanismName::Tdi) => 0.0,
            (None, MechanismName::Stage) => match camera.fmc.strategy.unwrap_or_default() {
                Strategy::Centred => -path.travel_mm * path.centroid(),
                Strategy::FromRest => run_up_mm(speed, &camera.fmc),
            },
        };
        if camera.fmc.mechanism == MechanismName::Tdi {
            let pitch_mm = camera.sensor.pixel_um / 1000.0;
            path.staircase_mm = path.staircase_offset(pitch_mm, camera.fmc.first_transfer);
        }
        path
    }

    /// Returns the transmission at the fraction u.
    #[must_use]
    pub fn transmission(&self, u: f64) -> f64 {
        let [opening, closing] = self.ramps;
        if u < opening {
            u / opening
        } else if u > 1.0 - closing {
            (1.0 - u) / closing
        } else {
            1.0
        }
    }

    /// Returns the offset of the principal point from its calibrated position at the fraction u,
    /// mm.
    #[must_use]
    pub fn offset_mm(&self, u: f64) -> f64 {
        self.opening_offset_mm + self.travel_mm * u + self.staircase_mm
    }

    /// c̄: transmission-weighted mean of the offset, mm.
    #[must_use]
    pub fn centroid_mm(&self) -> f64 {
        self.offset_mm(self.centroid())
    }

    /// Ends of the stretches over which the transmission is linear, as fractions u.
    #[must_use]
    pub fn nodes(&self) -> [f64; 4] {
        let [opening, closing] = self.ramps;
        [0.0, opening, 1.0 - closing, 1.0]
    }

    /// Returns the centroid of the transmission as a fraction u, from the areas and centroids of
    /// two triangles and a rectangle.
    fn centroid(&self) -> f64 {
        let [opening, closing] = self.ramps;
        let parts = [
            (opening / 2.0, 2.0 * opening / 3.0),
            (1.0 - opening - closing, (1.0 + opening - closing) / 2.0),
            (closing / 2.0, 1.0 - 2.0 * closing / 3.0),
        ];
        let area: f64 = parts.iter().map(|(area, _)| area).sum();
        parts.iter().map(|(area, place)| area * place).sum::<f64>() / area
    }

    /// Returns the mean of the staircase less the mean of the smooth path, mm: the light that falls
    /// between transfers n and n+1 is recorded n rows further.
    fn staircase_offset(&self, pitch_mm: f64, first_transfer: f64) -> f64 {
        let rows = self.travel_mm.abs() / pitch_mm;
        if rows <= 0.0 {
            return 0.0;
        }
        let transfer = |n: f64| ((first_transfer + n) / rows).min(1.0);
        let mut mean_rows = 0.0;
        let mut count = 0.0;
        while transfer(count) < 1.0 {
            let light = self.light(transfer(count), transfer(count + 1.0));
            count += 1.0;
            mean_rows += count * light;
        }
        let row_mm = pitch_mm.copysign(self.travel_mm);
        row_mm * mean_rows / self.light(0.0, 1.0) - self.travel_mm * self.centroid()
    }

    /// Returns ∫ transmission du over [from, to] by the midpoint rule, which is exact on each
    /// linear stretch.
    fn light(&self, from: f64, to: f64) -> f64 {
        let [a, b, c, d] = self.nodes();
        [(a, b), (b, c), (c, d)]
            .iter()
            .map(|(start, end)| (from.max(*start), to.min(*end)))
            .filter(|(start, end)| end > start)
            .map(|(start, end)| {
                let middle = f64::midpoint(start, end);
                (end - start) * self.transmission(middle)
            })
            .sum()
    }
}
