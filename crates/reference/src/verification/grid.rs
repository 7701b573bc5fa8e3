//! Exposures and points of a verification (Yuan et al. 2012, section 4.1).

use fmc_camera::io::link::message::Grid;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, MechanismName, Strategy};

/// Smallest and largest V/H, 1/s.
pub const VH_PER_S: [f64; 2] = [0.05, 0.17];
/// Number of V/H values, evenly spaced.
pub const VH_STEPS: u8 = 10;
/// Denominators of the exposure times, 1/n s.
pub const EXPOSURE_FRACTIONS: [f64; 6] = [100.0, 175.0, 200.0, 300.0, 500.0, 700.0];
/// Number of exposure times.
pub const EXPOSURE_STEPS: u8 = 6;
/// Points along each side of the sensor, edges included.
pub const SIDE_POINTS: u8 = 21;

/// One exposure of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridExposure {
    /// Run-up strategy; `None` for TDI, which has none.
    pub strategy: Option<Strategy>,
    /// η = V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
}

impl GridExposure {
    /// Returns the name of the run-up strategy in reports, or `tdi`.
    #[must_use]
    pub fn strategy_name(&self) -> &'static str {
        self.strategy.map_or("tdi", Strategy::name)
    }
}

/// Returns every exposure, strategy by strategy: those of the paper if the camera's limits allow
/// them, and otherwise as many spread over the part that the limits allow.
#[must_use]
pub fn exposures(camera: &CameraFile) -> Vec<GridExposure> {
    let strategies = match camera.fmc.mechanism {
        MechanismName::Stage => Strategy::ALL.map(Some).to_vec(),
        MechanismName::Tdi => vec![None],
    };
    let vh = spread(common(VH_PER_S, camera.limits.vh_per_s), VH_STEPS);
    let [shortest, longest] = camera.limits.exposure_s;
    let mut times = EXPOSURE_FRACTIONS.map(f64::recip).to_vec();
    if times.iter().any(|time| *time < shortest || *time > longest) {
        let [first, .., last] = EXPOSURE_FRACTIONS;
        let range = common([last.recip(), first.recip()], camera.limits.exposure_s);
        times = spread(range, EXPOSURE_STEPS);
    }
    let mut exposures = Vec::new();
    for strategy in strategies {
        for vh_per_s in &vh {
            for exposure_s in &times {
                exposures.push(GridExposure {
                    strategy,
                    vh_per_s: *vh_per_s,
                    exposure_s: *exposure_s,
                });
            }
        }
    }
    exposures
}

/// Returns the paper's exposures, 10 V/H x 6 times, whatever the camera's limits are.
#[must_use]
pub fn of_the_paper(strategy: Option<Strategy>) -> Vec<GridExposure> {
    spread(VH_PER_S, VH_STEPS)
        .into_iter()
        .flat_map(|vh_per_s| {
            EXPOSURE_FRACTIONS.map(|fraction| GridExposure {
                strategy,
                vh_per_s,
                exposure_s: fraction.recip(),
            })
        })
        .collect()
}

/// Returns as many exposures, spread evenly over the camera's limits.
#[must_use]
pub fn over_the_limits(camera: &CameraFile, strategy: Option<Strategy>) -> Vec<GridExposure> {
    let times = spread(camera.limits.exposure_s, EXPOSURE_STEPS);
    spread(camera.limits.vh_per_s, VH_STEPS)
        .into_iter()
        .flat_map(|vh_per_s| {
            times.iter().map(move |exposure_s| GridExposure {
                strategy,
                vh_per_s,
                exposure_s: *exposure_s,
            })
        })
        .collect()
}

/// Returns the range that the wanted one and the limits share, or the limits if they share none.
fn common([from, to]: [f64; 2], [least, most]: [f64; 2]) -> [f64; 2] {
    let (low, high) = (from.max(least), to.min(most));
    if low <= high {
        [low, high]
    } else {
        [least, most]
    }
}

/// Returns `count` numbers spread evenly over a range, ends included.
fn spread([from, to]: [f64; 2], count: u8) -> Vec<f64> {
    (0..count)
        .map(|index| f64::from(index) / f64::from(count - 1))
        // In this form the last number is exactly `to`.
        .map(|share| from * (1.0 - share) + to * share)
        .collect()
}

/// Returns points over a sensor of the given half format, edges included, mm, rounded to single
/// precision as the camera receives them.
#[must_use]
pub fn points([half_width, half_height]: [f64; 2]) -> Grid {
    let side = |half: f64| {
        (0..SIDE_POINTS)
            .map(|index| 2.0 * f64::from(index) / f64::from(SIDE_POINTS - 1) - 1.0)
            .map(|place| single(place * half))
            .collect()
    };
    Grid {
        x_mm: side(half_width),
        y_mm: side(half_height),
    }
}

#[cfg(test)]
mod tests {
    use fmc_camera::SensorPoint;

    use super::*;

    fn camera(more: &str) -> CameraFile {
        let text = format!(
            "name = \"t\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 1000\nheight_px = 500\npixel_um = 10.0\n{more}"
        );
        CameraFile::parse("test", &text).unwrap().0
    }

    #[test]
    fn grid_is_that_of_the_paper() {
        let exposures = exposures(&camera(""));
        assert_eq!(exposures.len(), 2 * 10 * 6);
        let last = exposures.last().unwrap();
        assert!((last.vh_per_s - 0.17).abs() < 1e-15);
        assert!((last.exposure_s - 1.0 / 700.0).abs() < 1e-15);
        let grid = points([10.0, 5.0]);
        assert_eq!(grid.points().count(), 441);
        assert_eq!(grid.points().last(), Some(SensorPoint::new(10.0, 5.0)));
    }

    #[test]
    fn grid_of_the_paper_ignores_the_limits() {
        let exposures = of_the_paper(None);
        assert_eq!(exposures.len(), 60);
        assert!((exposures[0].vh_per_s - 0.05).abs() < 1e-15);
        assert!((exposures[0].exposure_s - 0.01).abs() < 1e-15);
    }

    #[test]
    fn grid_stays_within_the_limits_of_the_camera() {
        let narrow = camera("[limits]\nvh_per_s = [0.1, 0.12]\nexposure_s = [0.002, 0.003]\n");
        for exposure in exposures(&narrow) {
            assert!((0.1..=0.12).contains(&exposure.vh_per_s));
            assert!((0.002..=0.003).contains(&exposure.exposure_s));
        }
    }

    #[test]
    fn tdi_has_no_run_up_to_choose() {
        let exposures = exposures(&camera("[fmc]\nmechanism = \"tdi\"\n"));
        assert_eq!(exposures.len(), 10 * 6);
        assert_eq!(exposures[0].strategy_name(), "tdi");
    }
}
