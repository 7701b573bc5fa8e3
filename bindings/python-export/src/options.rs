//! Programs, containers, and options that do not fit a program.

use fmc_exchange::export::Misfit;
use fmc_exchange::program::{Container, Program};
use pyo3::prelude::*;

use crate::error;

/// Returns the program of a name.
///
/// # Errors
/// `fmc_camera.Error` with the names that there are.
pub(crate) fn program(name: &str) -> PyResult<Program> {
    let of_frames = Program::WITH_FRAMES.into_iter();
    let of_frames = of_frames.filter(|program| !Program::WRITTEN.contains(program));
    let all: Vec<Program> = Program::WRITTEN.into_iter().chain(of_frames).collect();
    let found = all.iter().find(|program| program.name() == name);
    found.copied().ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|program| program.name()).collect();
        let names = names.join(", ");
        error::of_text(format!("program = '{name}': must be one of {names}"))
    })
}

/// Returns the container of a name.
///
/// # Errors
/// `fmc_camera.Error` with the names that there are.
pub(crate) fn container(name: &str) -> PyResult<Container> {
    Ok(match name {
        "yaml" => Container::Yaml,
        "json" => Container::Json,
        "xml" => Container::Xml,
        _ => {
            return Err(error::of_text(format!(
                "container = '{name}': must be 'yaml', 'json' or 'xml'"
            )));
        }
    })
}

/// Returns the error of an option that does not fit the program.
pub(crate) fn misfit(misfit: Misfit, program: Program) -> PyErr {
    let name = program.name();
    let option_of =
        |option: &str, program: Program| format!("{option}: an option of {}", program.name());
    error::of_text(match misfit {
        Misfit::Container => option_of("container", Program::OpenCv),
        Misfit::Binary => option_of("binary", Program::Colmap),
        Misfit::Key => option_of("id", Program::OpenSfm),
        Misfit::KeyOfFrames => {
            "id: names one camera; with records every image has a camera of its own".to_owned()
        }
        Misfit::NoFrames => format!("records: missing, and {name} is a format of frames"),
        Misfit::Frames => {
            let others = Program::WITH_FRAMES.map(Program::name).join(", ");
            format!(
                "records: {name} has one camera for all images, for which frames.correct moves the \
                 points of every frame; a camera per image have {others}"
            )
        }
    })
}
