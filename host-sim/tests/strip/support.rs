//! The shipped scenarios, and strips recorded in them.

use std::path::Path;

use fmc_adjustment::adjustment::{Adjusted, AdjustmentError};
use fmc_adjustment::model::Model;
use fmc_simulation::noise::Noise;
use fmc_simulation::strip_experiment::outcome::adjustment;
use fmc_simulation::strip_experiment::scenario::Scenario;
use fmc_simulation::strip_experiment::strip::Strip;
use fmc_simulation::strip_experiment::survey::{Errors, observe};

pub(crate) const SHIPPED: [&str; 2] = ["yuan-2012.toml", "strip.toml"];

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios"))
}

pub(crate) fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap()
}

pub(crate) fn scenario(name: &str) -> Scenario {
    parsed(&text(name))
}

pub(crate) fn parsed(text: &str) -> Scenario {
    Scenario::parse("scenario.toml", text, folder()).unwrap()
}

/// Adjusts the strip once with the share `noise` of the scenario's errors.
pub(crate) fn solved(
    scenario: &Scenario,
    strip: &Strip,
    model: Model,
    noise: f64,
) -> Result<Adjusted, AdjustmentError> {
    let errors = Errors {
        noise,
        ..Errors::of(scenario)
    };
    let observed = observe(strip, &errors, Noise::new(1, 1));
    adjustment(strip, &observed, &errors, model).solve()
}
