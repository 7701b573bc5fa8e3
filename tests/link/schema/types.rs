//! Types of the messages, as `serde` writes them: names, order, numbers of variants.

use fmc_camera::flight::bring_up::{NotTried, Trial, TrialEnd};
use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::{CameraParameters, FrameError, Mechanism};
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::drive::settings::EncoderSide;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge, Supply};
use fmc_camera::flight::exposure::{CorrectionModel, FlightDirection};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::flag::Flag;
use fmc_camera::flight::frame_record::{Outcome, Reason};
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::flight::input_settings::{BrakeInput, Edge, LimitLevel};
use fmc_camera::flight::stage::RunUp;
use fmc_camera::flight::vh::{VhSample, VhSource};
use fmc_camera::geometry::calibration::{CalibrationError, Polynomial};
use fmc_camera::geometry::camera_grids::CameraGridsError;
use fmc_camera::geometry::estimation::fit::FitError;
use fmc_camera::geometry::estimation::options::StaticDecentring;
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::geometry::focus_table::FocusRow;
use fmc_camera::geometry::frame_correction::Terms;
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums, GridError};
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::format::{MeshFormat, PixelAxis};
use fmc_camera::geometry::mesh::vertex::MeshError;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::FmcAxis;
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::io::link::after_reset::{FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::message::{Answer, Ending, Header, Refusal, Request, ResetCause};
use fmc_camera::io::link::records_in_flash::RecordsInFlash;
use fmc_camera::io::store::{
    NotStored, NothingStored, OriginError, SlotFault, StoreStep, StoredIdentity,
};
use serde_reflection::{Registry, Samples, Tracer, TracerConfig};

/// Returns all types that messages and a camera's parameters consist of.
///
/// # Panics
/// Where an enumeration in a message is missing below, with its name.
pub(super) fn registry() -> Registry {
    let mut tracer = Tracer::new(TracerConfig::default());
    let samples = Samples::new();
    macro_rules! trace {
        ($($kind:ty),* $(,)?) => {
            $(tracer.trace_type::<$kind>(&samples).unwrap();)*
        };
    }
    trace!(Header, Request, Answer, CameraParameters);
    // Behind the parameters.
    trace!(GridChecksums, FocusRow);
    // Each enumeration: only the first variant of one within another message is found from there.
    trace!(
        Action,
        BrakeInput,
        CalibrationError,
        CameraGridsError,
        Command,
        CorrectionModel,
        DistortError,
        DriveKind,
        Edge,
        EncoderSide,
        Ending,
        Event,
        Fault,
        FitError,
        Flag,
        FlightAfterReset,
        FlightDirection,
        FmcAxis,
        FocusSign,
        FrameError,
        GridCarrier,
        GridError,
        GridMemoryError,
        LimitLevel,
        Mechanism,
        MeshError,
        MeshFormat,
        NotStored,
        NotTried,
        OriginError,
        Outcome,
        Parameter,
        PixelAxis,
        Polynomial,
        Quantity,
        Reason,
        RecordsInFlash,
        Refusal,
        Regressor,
        ResetCause,
        Result<StoredIdentity, NothingStored>,
        RunUp,
        ShutterEdge,
        ShutterProfile,
        SlotFault,
        State,
        StaticDecentring,
        Storage,
        StoreStep,
        Supply,
        Terms,
        Trial,
        TrialEnd,
        VhSample,
        VhSource,
        WithoutEyes,
    );
    tracer.registry().unwrap()
}
