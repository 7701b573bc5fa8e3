//! Link: a message from its first byte to the last byte of its answer.

use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{Grid, Header, Identity, Points, Request, ResetCause};
use fmc_camera::io::link::packet::Packet;
use fmc_camera::io::link::station::{LinkEvent, Station};

use crate::counter::Counter;
use crate::specimen::{EXPOSURE, points, short};
use crate::stack;

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let identity = Identity::new("", "", true, ResetCause::PowerOn);
    let mut station = Station::new(identity, stack::used_bytes);
    let batch: Points = points().iter().step_by(16).copied().collect();
    let side = || {
        points()
            .iter()
            .step_by(33)
            .map(|point| point.x_mm)
            .collect()
    };
    let vertices = VertexRow {
        first_col_px: 4800,
        row_px: 800,
        spacing_px: 16,
        count: 64,
        origin_px: [0, 0],
    };
    let grid = Grid {
        x_mm: side(),
        y_mm: heapless::Vec::from_slice(&[-10.0, 10.0]).ok()?,
    };
    // The last part of a calibration takes longest: with it the whole is read and validated.
    let [begin, first, last] = upload()?;
    let requests = [
        (Some("link_connect"), Request::Connect),
        (None, begin),
        (None, first),
        (Some("link_load"), last),
        (Some("link_expose"), Request::Expose(EXPOSURE)),
        (Some("link_correct_64"), Request::Correct(batch.clone())),
        (Some("link_distort_64"), Request::Distort(batch)),
        (Some("link_digest_64"), Request::Digest(grid)),
        (
            Some("link_mesh_64"),
            Request::Mesh(vertices, MeshFormat::S16Q3),
        ),
        (Some("link_corrections_64"), Request::Corrections(vertices)),
        (Some("link_counters"), Request::Counters),
        (
            Some("link_prepare"),
            Request::Prepare(FlightSettings::default()),
        ),
        // The first round finds the stage, the second is one of many.
        (None, round(1)),
        (Some("link_rig"), round(2)),
    ];
    let mut frame = Packet::EMPTY;
    for (sequence, (kernel, request)) in (0..).zip(requests) {
        let header = Header {
            session: 1,
            sequence,
        };
        request.write(header, &mut frame)?;
        match kernel {
            Some(kernel) => {
                counter.count(kernel, (1, "message"), || exchange(&mut station, &frame))?;
            }
            None => {
                exchange(&mut station, &frame)?;
            }
        }
    }
    Some(())
}

/// Returns a round of the control loop on a test rig, in standby and without events.
fn round(millisecond: u64) -> Request {
    Request::Rig(RigStep {
        time: Time::from_us(1_000_000 + 1000 * millisecond),
        ..RigStep::default()
    })
}

/// Returns the requests that load a calibration; `None` unless it comes in two parts.
fn upload() -> Option<[Request; 3]> {
    let upload = Upload::of(&short())?;
    let mut requests = upload.requests();
    let loading = [requests.next()?, requests.next()?, requests.next()?];
    requests.next().is_none().then_some(loading)
}

/// Receives all bytes of a request and takes the answer away; `None` unless the request was
/// answered.
fn exchange(station: &mut Station, frame: &Packet) -> Option<LinkEvent> {
    let mut event = None;
    for byte in frame.bytes() {
        event = station.receive(*byte);
    }
    let length = station.to_send().len();
    station.sent(length);
    event.filter(|event| !matches!(event, LinkEvent::Refused(_) | LinkEvent::Lost(_)))
}
