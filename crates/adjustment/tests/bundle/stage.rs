//! Scale, axis angle and run-out of the stage from flights: without bias, covered by their σ, and
//! what the flight has to vary for it.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::stage::{Stage, StageElement};
use fmc_adjustment::bundle::state::State;

use crate::aerial::{CROSSED, Flight, Platform, Strip, oriented, strip};

const ALL: [Parameter; 3] = [
    Parameter::Stage(StageElement::Scale),
    Parameter::Stage(StageElement::AxisAngle),
    Parameter::Stage(StageElement::RunOut),
];
const Y0: Parameter = Parameter::Interior(InteriorElement::Y0);
const X0: Parameter = Parameter::Interior(InteriorElement::X0);
const F: Parameter = Parameter::Interior(InteriorElement::PrincipalDistance);

/// Larger than any real one, so that a flight sees it.
const LARGE: Stage = Stage {
    scale: 0.4,
    axis_angle_rad: -0.25,
    run_out_mm_per_mm: 0.15,
};

fn flight(strips: Vec<Strip>, stage: Stage) -> Flight {
    Flight {
        strips,
        platform: Platform::default(),
        tilt_rad: 0.02,
        control: 6,
        stage: Some(stage),
    }
}

/// Cross strips at two heights 1 : 1.4, with speeds and exposures that vary.
fn varied() -> Vec<Strip> {
    let speeds = [60.0, 90.0, 75.0, 90.0, 60.0, 75.0, 90.0, 60.0];
    let strips = speeds
        .into_iter()
        .zip([0.0, 180.0, 90.0, 270.0].into_iter().cycle());
    strips
        .enumerate()
        .map(|(number, (speed, heading))| Strip {
            height_m: if number < 4 { 700.0 } else { 980.0 },
            exposure_s: if number % 2 == 0 {
                1.0 / 300.0
            } else {
                1.0 / 1000.0
            },
            ..strip(heading, speed)
        })
        .collect()
}

#[test]
fn probe() {
    let shift = Parameter::Shift { strip: 0, axis: 0 };
    let arm: Vec<_> = (0..3).map(Parameter::LeverArm).collect();
    let boresight: Vec<_> = (0..3).map(Parameter::Boresight).collect();
    let to_fro = vec![
        strip(0.0, 90.0),
        strip(180.0, 60.0),
        strip(0.0, 90.0),
        strip(180.0, 60.0),
    ];
    for (name, strips) in [
        ("varied", varied()),
        ("crossed", CROSSED.to_vec()),
        ("to and fro", to_fro),
    ] {
        for (unknowns, more) in [
            ("stage", vec![]),
            ("+x0y0", vec![X0, Y0]),
            ("+f,x0,y0", vec![F, X0, Y0]),
            (
                "+f,x0,y0,boresight",
                [&[F, X0, Y0], &boresight[..]].concat(),
            ),
            ("+arm", arm.clone()),
            ("+x0,y0,arm", [&[X0, Y0], &arm[..]].concat()),
            ("+f,x0,y0,arm", [&[F, X0, Y0], &arm[..]].concat()),
            (
                "+f,x0,y0,arm,dt",
                [&[F, X0, Y0, Parameter::TimeOffset], &arm[..]].concat(),
            ),
            ("+f,x0,y0,shift", vec![F, X0, Y0, shift]),
        ] {
            for control in [0, 6] {
                let flight = Flight {
                    control,
                    ..flight(strips.clone(), LARGE)
                };
                let unknowns_ = Unknowns {
                    estimated: [&ALL[..], &more].concat(),
                    priors: vec![],
                };
                let network = oriented(&flight.with_records(1), &unknowns_);
                match adjust(&network, DatumChoice::Auto, &State::initial(&network)) {
                    Ok(solution) => {
                        let cofactors = Cofactors::of(&network, &solution).unwrap();
                        let out: Vec<String> = ALL
                            .iter()
                            .map(|p| {
                                let column = solution.layout.column(*p).unwrap();
                                format!(
                                    "{:.4} ± {:.4}",
                                    solution.state.parameters.value(*p),
                                    cofactors.border[(column, column)].sqrt()
                                )
                            })
                            .collect();
                        eprintln!(
                            "{name} {unknowns} control {control}: σ0 {:.3} {out:?}",
                            solution.sigma0()
                        );
                    }
                    Err(error) => eprintln!("{name} {unknowns} control {control}: {error}"),
                }
            }
        }
    }
}
