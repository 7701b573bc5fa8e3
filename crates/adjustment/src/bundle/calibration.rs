//! Calibration by a network: orientation, adjustment, search for gross errors, and its judgement.

use fmc_camera_file::InputError;

use super::error::{BundleCalibrationError, BundleError, Misfit};
use super::geometry;
use super::interior::{Interior, InteriorElement};
use super::network::{Network, PointRole};
use super::network_of_tables::{TabledNetwork, Unknowns};
use super::orientation::network_orientation::{Unoriented, orient};
use super::parameters::Parameter;
use super::plausibility;
use super::separation;
use super::snooping::{Snooped, snooped};
use super::solution::{DatumChoice, Solution, adjust, with_datum};
use super::state::State;
use super::suspect_control;
use super::tables::NetworkTables;
use crate::linear::element::element;

/// Factor by which control that does not fit may enlarge σ0.
pub const MOST_ENLARGEMENT: f64 = 1.5;

/// σ of the principal distance or of the principal point, as a fraction of the principal distance,
/// above which they count as not determined.
pub const MOST_INTERIOR_SIGMA: f64 = 0.2;

/// Gross errors: rejected, or only tested.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum GrossErrors {
    /// Image points beyond the critical value are rejected.
    #[default]
    Reject,
    /// All observations stay in the adjustment.
    Keep,
}

/// Choices of a calibration.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CalibrationOptions {
    /// Shared unknowns and their priors.
    pub unknowns: Unknowns,
    /// Datum.
    pub datum: DatumChoice,
    /// Gross errors.
    pub gross_errors: GrossErrors,
}

/// A network after its calibration.
#[derive(Debug, Clone)]
pub struct BundleCalibration {
    /// Lines of the image points in their file, in the order of the network.
    pub lines: Vec<u64>,
    /// `true` if all image points came with σ.
    pub has_sigma: bool,
    /// Datum as asked for.
    pub choice: DatumChoice,
    /// Interior orientation before the adjustment.
    pub start: Interior,
    /// Result of the search for gross errors.
    pub snooped: Snooped,
    /// Adjustment of all observations, before any was rejected.
    pub unrejected: Solution,
}

impl BundleCalibration {
    /// Calibrates by the observations of some tables, starting from an interior orientation.
    ///
    /// # Errors
    /// [`BundleCalibrationError`]: what is wrong with the files, or what they leave undetermined.
    pub fn new(
        tables: &NetworkTables,
        start: Interior,
        options: &CalibrationOptions,
    ) -> Result<Self, BundleCalibrationError> {
        let tabled = tables.network(start, &options.unknowns)?;
        check_rays(&tabled.network, &tables.image_points.file)?;
        Self::of(tabled, tables, start, options).map_err(|error| match error {
            BundleCalibrationError::Adjustment(BundleError::Datum { .. }) => error,
            error => {
                let (unknowns, datum) = (&options.unknowns, options.datum);
                if let Some(reading) = plausibility::reading(tables, start, unknowns, datum) {
                    return reading.into();
                }
                match error {
                    BundleCalibrationError::Adjustment(error) => {
                        suspect_control::refined(tables, start, unknowns, datum, error).into()
                    }
                    error @ BundleCalibrationError::Input(_) => error,
                }
            }
        })
    }

    /// Orients and adjusts a network.
    fn of(
        mut tabled: TabledNetwork,
        tables: &NetworkTables,
        start: Interior,
        options: &CalibrationOptions,
    ) -> Result<Self, BundleCalibrationError> {
        let unoriented = orient(&mut tabled.network, tabled.known.clone());
        if let Some(image) = unoriented.images.first() {
            return Err(BundleError::Unoriented {
                image: image_name(&tabled.network, *image),
            }
            .into());
        }
        check_groups(&tabled.network, &tables.image_points.file)?;
        drop_unknown_points(&mut tabled, &unoriented.points, &tables.image_points.file)?;
        let network = with_datum(&tabled.network, options.datum);
        let initial = State::initial(&network);
        let unrejected = adjust(&network, options.datum, &initial)
            .or_else(|error| by_stages(&network, options.datum, &initial, error))
            .map_err(|error| of_orientation(&network, &unoriented, error))?;
        plausibility::check(
            tables,
            start,
            &options.unknowns,
            options.datum,
            (&network, &unrejected),
        )?;
        let snooped = match options.gross_errors {
            GrossErrors::Reject => snooped(&network, options.datum, &unrejected.state)?,
            GrossErrors::Keep => Snooped::unrejected(&network, &unrejected)?,
        };
        check_misfits(&snooped)?;
        check_determined(&snooped)?;
        Ok(Self {
            lines: tabled.lines,
            has_sigma: tabled.has_sigma,
            choice: options.datum,
            start,
            snooped,
            unrejected,
        })
    }

    /// Returns true if an element of the interior orientation is estimated.
    #[must_use]
    pub fn estimates(&self, element: InteriorElement) -> bool {
        let parameter = Parameter::Interior(element);
        self.snooped.solution.layout.column(parameter).is_some()
    }
}

/// Adjusts with the interior orientation held, then with all unknowns; where these do not converge,
/// looks for control that prevents it.
fn by_stages(
    network: &Network,
    choice: DatumChoice,
    initial: &State,
    error: BundleError,
) -> Result<Solution, BundleError> {
    if matches!(error, BundleError::Datum { .. }) {
        return Err(error);
    }
    let mut held = network.clone();
    held.estimated.clear();
    held.priors.clear();
    let Ok(first) = adjust(&held, choice, initial) else {
        return Err(error);
    };
    adjust(network, choice, &first.state).map_err(|error| {
        let found = snooped(&held, choice, &first.state).map(|found| check_misfits(&found));
        match found {
            Ok(Err(control)) => control,
            _ => error,
        }
    })
}

/// Returns the error of a network that does not converge from images that were only taken for
/// vertical ones: they cannot be oriented.
fn of_orientation(network: &Network, unoriented: &Unoriented, error: BundleError) -> BundleError {
    match (error, unoriented.taken_for_vertical.first()) {
        (BundleError::NotConverged, Some(image)) => BundleError::Unoriented {
            image: image_name(network, *image),
        },
        (error, _) => error,
    }
}

fn image_name(network: &Network, number: usize) -> String {
    network
        .images
        .get(number)
        .map_or_else(String::new, |image| image.name.clone())
}

/// Checks that every tie point is in two images at least.
fn check_rays(network: &Network, file: &str) -> Result<(), InputError> {
    for observed in network.by_point() {
        let [single] = observed else { continue };
        let point = network.points.get(single.point);
        if let Some(point) = point.filter(|point| point.role == PointRole::Tie) {
            return Err(InputError::invalid(format!(
                "{file}: point {} is in one image alone, {}; a point with unknown coordinates needs two",
                point.name,
                image_name(network, single.image)
            )));
        }
    }
    Ok(())
}

/// Checks that the images are one network, or that every part of it has control of its own.
fn check_groups(network: &Network, file: &str) -> Result<(), InputError> {
    let groups = geometry::groups(network);
    if groups.len() < 2 {
        return Ok(());
    }
    for members in &groups {
        let mut control: Vec<usize> = network
            .image_points
            .iter()
            .filter(|observed| members.contains(&observed.image))
            .map(|observed| observed.point)
            .filter(|point| {
                network
                    .points
                    .get(*point)
                    .is_some_and(|point| point.role == PointRole::Control)
            })
            .collect();
        control.sort_unstable();
        control.dedup();
        let positions = members
            .iter()
            .filter_map(|image| network.images.get(*image)?.observed)
            .count();
        if control.len() < 3 && positions < 3 {
            let names: Vec<String> = groups
                .iter()
                .filter_map(|members| members.first())
                .map(|image| image_name(network, *image))
                .collect();
            return Err(InputError::invalid(format!(
                "{file}: the images fall into {} groups that share no point, those of images {}; only control points in each \
                 could tie them together",
                groups.len(),
                names.join(", ")
            )));
        }
    }
    Ok(())
}

/// Leaves out the image points of check points without coordinates; refuses tie points.
fn drop_unknown_points(
    tabled: &mut TabledNetwork,
    points: &[usize],
    file: &str,
) -> Result<(), InputError> {
    for number in points {
        if let Some(point) = tabled.network.points.get(*number) {
            return Err(InputError::invalid(format!(
                "{file}: the rays of point {} are parallel or meet above a lens; it has no position",
                point.name
            )));
        }
    }
    Ok(())
}

/// Refuses control that enlarges σ0 grossly, by the name of the points.
fn check_misfits(snooped: &Snooped) -> Result<(), BundleError> {
    let enlargement = snooped.solution.sigma0() / snooped.sigma0_without_misfits;
    if snooped.misfits.is_empty() || enlargement <= MOST_ENLARGEMENT {
        return Ok(());
    }
    Err(BundleError::Control {
        points: snooped
            .misfits
            .iter()
            .map(|misfit| Misfit {
                point: snooped
                    .network
                    .points
                    .get(misfit.point)
                    .map_or_else(String::new, |point| point.name.clone()),
                difference_m: misfit.difference_m,
            })
            .collect(),
        or: Vec::new(),
        sigma0: snooped.solution.sigma0(),
        without: snooped.sigma0_without_misfits,
    })
}

/// Refuses a principal distance or principal point that the observations leave open, by the name of
/// what imitates them.
fn check_determined(snooped: &Snooped) -> Result<(), BundleError> {
    let (solution, network) = (&snooped.solution, &snooped.network);
    let shared = separation::shared(network, &solution.layout, &snooped.cofactors.border);
    if let Some(unknowns) = shared {
        return Err(BundleError::Inseparable { unknowns });
    }
    let f = solution.state.parameters.interior.principal_distance_mm;
    for unknown in [
        InteriorElement::PrincipalDistance,
        InteriorElement::X0,
        InteriorElement::Y0,
    ] {
        let Some(column) = solution.layout.column(Parameter::Interior(unknown)) else {
            continue;
        };
        let sigma =
            element(&snooped.cofactors.border, column, column).sqrt() * solution.sigma0().min(1.0);
        if sigma > MOST_INTERIOR_SIGMA * f || f <= 0.0 {
            let mut unknowns = vec![unknown.name().to_owned()];
            if let Ok(weakest) =
                separation::weakest(network, &solution.layout, &solution.state, &solution.held)
            {
                for name in weakest {
                    if !unknowns.contains(&name) {
                        unknowns.push(name);
                    }
                }
            }
            return Err(BundleError::Inseparable { unknowns });
        }
    }
    Ok(())
}
