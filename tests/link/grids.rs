//! Residual grids in parts: whatever happens on their way, the camera corrects with those that its
//! calibration states, or with the calibration before and its own.

use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::frame_record::Outcome;
use fmc_camera::flight::grid_memory::{GridMemory, GridMemoryError};
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::geometry::camera_grids::{CameraGrids, CameraGridsError};
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::grid::{
    GridCarrier, GridChecksums, GridError, GridHeader, MAX_FILE_BYTES, ResidualGrid,
};
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::digest;
use fmc_camera::io::link::loading::{Upload, grid_requests};
use fmc_camera::io::link::message::{Answer, Grid, Header, Part, Refusal, Request, ResetCause};
use fmc_camera::io::link::station::LinkEvent;

use crate::geometry::spline::{file, noise, wave};
use crate::link::board::Board;
use crate::link::pc::{Pc, SESSION, camera_parameters};

/// An exposure from rest, whose grid of the lens has moved.
const EXPOSURE: Exposure = Exposure {
    opening_offset_mm: Some(0.1),
    ..Exposure::new(0.15, 0.01)
};

/// Returns the file of a grid that covers the camera and its stroke.
pub(crate) fn grid(carrier: GridCarrier, coefficient: impl Fn(u16, u16) -> [i16; 2]) -> Vec<u8> {
    let header = GridHeader {
        carrier,
        columns: 33,
        rows: 27,
        first_node: SensorPoint::new(-32.0, -26.0),
        pitch_mm: 2.0,
        scale_mm: 3e-3 / 32767.0,
    };
    file(&header, coefficient)
}

fn crc32(grid: &[u8]) -> u32 {
    ResidualGrid::parse(grid).unwrap().crc32()
}

/// Returns the camera that states grids.
pub(crate) fn stating(lens: Option<&[u8]>, sensor: Option<&[u8]>) -> CameraParameters {
    CameraParameters {
        grids: GridChecksums {
            lens: lens.map(crc32),
            sensor: sensor.map(crc32),
        },
        ..camera_parameters()
    }
}

/// Returns a PC whose camera has memory for grids, and a calibration without.
fn with_memory() -> Pc {
    let mut pc = Pc::connected();
    pc.station
        .keep_grids_in(Box::leak(Box::new(GridMemory::EMPTY)));
    assert!(matches!(pc.load(&camera_parameters()), Answer::Loaded(_)));
    pc
}

/// Sends a grid in all its parts: the answer to the last, or the first refusal.
pub(crate) fn send(pc: &mut Pc, grid: &[u8]) -> Answer {
    let mut last = None;
    for request in grid_requests(grid).unwrap() {
        let answer = pc.ask(&request);
        if let Answer::Refused(_) = answer {
            return answer;
        }
        last = Some(answer);
    }
    last.unwrap()
}

/// Points over the whole sensor.
fn points() -> Vec<SensorPoint> {
    let place = |index: u8| f32::from(index) / 7.0 - 0.5;
    (0..8)
        .flat_map(|row| {
            (0..8).map(move |column| SensorPoint::new(53.3 * place(column), 40.0 * place(row)))
        })
        .collect()
}

fn corrected(pc: &mut Pc) -> Vec<Corrected> {
    match pc.ask(&Request::Correct(points().into_iter().collect())) {
        Answer::Points(points) => points.to_vec(),
        other => panic!("{other:?}"),
    }
}

/// Checks all answers of the frame of [`EXPOSURE`] against the library on the PC, bit for bit.
fn assert_corrects_with(pc: &mut Pc, lens: Option<&[u8]>, sensor: Option<&[u8]>) {
    let camera = Camera::new(camera_parameters()).unwrap();
    let parsed = |file: Option<&'static [u8]>| file.map(|file| ResidualGrid::parse(file).unwrap());
    let leaked = |file: Option<&[u8]>| parsed(file.map(|file| &*file.to_vec().leak()));
    let grids = CameraGrids::new(camera.calibration(), leaked(lens), leaked(sensor)).unwrap();
    let frame = camera.frame(&EXPOSURE).unwrap();
    let expected = GriddedFrame::new(&frame, &grids);
    let answer = pc.ask(&Request::Expose(EXPOSURE));
    assert_eq!(answer, Answer::InteriorOrientation(expected.interior));
    let answer = pc.ask(&Request::InteriorOrientation);
    assert_eq!(answer, Answer::InteriorOrientation(expected.interior));
    let correct = |point: SensorPoint| expected.correction.correct(point);
    let ideal: Vec<_> = points().into_iter().map(correct).collect();
    assert_eq!(corrected(pc), ideal);
    // Points within, since the ideal points of those at the edge may lie beyond.
    let within = || {
        points()
            .into_iter()
            .map(|p| SensorPoint::new(0.9 * p.x_mm, 0.9 * p.y_mm))
    };
    let measured = within().map(|point| expected.correction.distort(point).unwrap());
    let answer = pc.ask(&Request::Distort(within().collect()));
    assert_eq!(answer, Answer::Points(measured.collect()));
    let lines = Grid {
        x_mm: [-20.0, 3.5, 26.0].into_iter().collect(),
        y_mm: [-19.0, 0.0, 18.5].into_iter().collect(),
    };
    let answer = pc.ask(&Request::Digest(lines.clone()));
    let digest = digest::of_grid(&expected.correction, &lines);
    assert_eq!(answer, Answer::Digest(digest));
    let row = VertexRow {
        first_col_px: 1000,
        row_px: 2000,
        spacing_px: 64,
        count: 40,
        origin_px: [0, 0],
    };
    let mut bytes = vec![0; 40 * MeshFormat::Single.bytes()];
    row.write_words(
        &SourceMesh::new(&expected.correction, 64),
        MeshFormat::Single,
        &mut bytes,
    )
    .unwrap();
    let answer = pc.ask(&Request::Mesh(row, MeshFormat::Single));
    assert_eq!(answer, Answer::Mesh(bytes.into_iter().collect()));
    let has_grids = lens.is_some() || sensor.is_some();
    let refused = pc.ask(&Request::Corrections(row)) == Answer::Refused(Refusal::PolynomialMesh);
    assert_eq!(refused, has_grids);
}

#[test]
fn grids_are_in_use_with_the_calibration_that_states_them() {
    let (lens, other_lens) = (
        grid(GridCarrier::Lens, wave),
        grid(GridCarrier::Lens, noise),
    );
    let sensor = grid(GridCarrier::Sensor, |column, row| wave(row, column));
    let mut pc = with_memory();
    assert_corrects_with(&mut pc, None, None);
    for (lens, sensor) in [
        (Some(&lens), None),
        (Some(&other_lens), None),
        (Some(&lens), Some(&sensor)),
        (None, Some(&sensor)),
    ] {
        let [lens, sensor] = [lens, sensor].map(|grid| grid.map(Vec::as_slice));
        for grid in [lens, sensor].into_iter().flatten() {
            let carrier = ResidualGrid::parse(grid).unwrap().header().carrier;
            assert_eq!(send(&mut pc, grid), Answer::GridLoaded(carrier));
        }
        let loaded = pc.load(&stating(lens, sensor));
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
        assert_corrects_with(&mut pc, lens, sensor);
    }
    // The camera before, whose grid is still there, and one without grids.
    assert!(matches!(
        pc.load(&stating(Some(&lens), None)),
        Answer::Loaded(_)
    ));
    assert_corrects_with(&mut pc, Some(&lens), None);
    assert!(matches!(pc.load(&camera_parameters()), Answer::Loaded(_)));
    assert_corrects_with(&mut pc, None, None);
}

#[test]
fn grids_are_part_of_the_identity_and_no_camera_without_has_another() {
    let plain = camera_parameters();
    let postcard = postcard_bytes(&plain);
    let bytes: Vec<_> = Upload::of(&plain)
        .unwrap()
        .parts(64)
        .flat_map(|part| part.bytes)
        .collect();
    assert_eq!(bytes, postcard);
    let [a, b] = [wave, noise].map(|of| grid(GridCarrier::Lens, of));
    let crc = |record: &CameraParameters| digest::of_camera(record);
    let crcs = [
        crc(&plain),
        crc(&stating(Some(&a), None)),
        crc(&stating(Some(&b), None)),
        crc(&stating(None, Some(&a))),
        crc(&stating(Some(&a), Some(&b))),
    ];
    for (index, one) in crcs.iter().enumerate() {
        assert!(!crcs[..index].contains(one), "{crcs:08x?}");
    }
}

fn postcard_bytes(record: &CameraParameters) -> Vec<u8> {
    postcard::to_allocvec(record).unwrap()
}

#[test]
fn camera_whose_grid_is_missing_is_refused_and_the_one_before_stays() {
    let lens = grid(GridCarrier::Lens, wave);
    let sensor = grid(GridCarrier::Sensor, wave);
    let mut pc = with_memory();
    let missing = |carrier, grid: &[u8]| {
        let crc32 = crc32(grid);
        Answer::Refused(Refusal::Grids(GridMemoryError::Missing { carrier, crc32 }))
    };
    let both = stating(Some(&lens), Some(&sensor));
    assert_eq!(pc.load(&both), missing(GridCarrier::Lens, &lens));
    send(&mut pc, &lens);
    assert_eq!(pc.load(&both), missing(GridCarrier::Sensor, &sensor));
    assert_corrects_with(&mut pc, None, None);
    send(&mut pc, &sensor);
    assert!(matches!(pc.load(&both), Answer::Loaded(_)));
    assert_corrects_with(&mut pc, Some(&lens), Some(&sensor));
    // A grid of the sensor is none of the lens, although its CRC-32 is stated.
    let swapped = stating(Some(&sensor), None);
    assert_eq!(pc.load(&swapped), missing(GridCarrier::Lens, &sensor));
    assert_corrects_with(&mut pc, Some(&lens), Some(&sensor));
    // A camera without memory refuses cameras with grids, and grids.
    let mut small = Pc::loaded();
    let refused = Answer::Refused(Refusal::NoGridMemory);
    assert_eq!(small.load(&both), refused);
    assert_eq!(send(&mut small, &lens), refused);
    assert_corrects_with(&mut small, None, None);
}

#[test]
fn load_that_is_cut_at_any_part_leaves_the_grids_in_use() {
    let (lens, other) = (
        grid(GridCarrier::Lens, wave),
        grid(GridCarrier::Lens, noise),
    );
    let mut pc = with_memory();
    send(&mut pc, &lens);
    pc.load(&stating(Some(&lens), None));
    let requests: Vec<_> = grid_requests(&other).unwrap().collect();
    assert!(requests.len() > 7, "{}", requests.len());
    for cut in 1..requests.len() {
        for request in &requests[..cut] {
            assert!(matches!(pc.ask(request), Answer::Loading(_)));
        }
        let connected = pc.ask(&Request::Connect);
        assert!(matches!(connected, Answer::Connected(_)));
        assert_eq!(pc.ask(&requests[cut]), Answer::Refused(Refusal::NoLoad));
        assert!(matches!(
            pc.load(&stating(Some(&other), None)),
            Answer::Refused(Refusal::Grids(GridMemoryError::Missing { .. }))
        ));
    }
    assert_corrects_with(&mut pc, Some(&lens), None);
    // Calibration and grid end each other's load.
    let parameters: Vec<_> = Upload::of(&camera_parameters())
        .unwrap()
        .requests()
        .collect();
    pc.ask(&requests[0]);
    assert_eq!(pc.ask(&parameters[0]), Answer::Loading(0));
    assert_eq!(pc.ask(&requests[1]), Answer::Refused(Refusal::NoLoad));
    assert!(matches!(pc.ask(&parameters[1]), Answer::Loading(_)));
    assert_eq!(pc.ask(&requests[0]), Answer::Loading(0));
    assert_eq!(pc.ask(&parameters[1]), Answer::Refused(Refusal::NoLoad));
    assert_corrects_with(&mut pc, Some(&lens), None);
}

#[test]
fn damaged_and_wrong_grids_are_refused_and_those_in_use_stay() {
    let lens = grid(GridCarrier::Lens, wave);
    let mut pc = with_memory();
    send(&mut pc, &lens);
    pc.load(&stating(Some(&lens), None));
    let carrier = GridCarrier::Lens;
    // One wrong bit anywhere, all other bytes as announced.
    let other = grid(carrier, noise);
    for place in [0, 4, 8, 20, 28, 1000, other.len() - 1] {
        let mut requests: Vec<_> = grid_requests(&other).unwrap().collect();
        let (part, byte) = (1 + place / 512, place % 512);
        let Request::GridPart(damaged) = &mut requests[part] else {
            panic!("no part");
        };
        damaged.bytes[byte] ^= 0x10;
        let answers: Vec<_> = requests.iter().map(|request| pc.ask(request)).collect();
        let last = answers.last().unwrap();
        assert!(
            matches!(
                last,
                Answer::Refused(Refusal::Grid {
                    carrier: GridCarrier::Lens,
                    ..
                })
            ),
            "{place}: {last:?}"
        );
    }
    // One that says it is of the sensor, and one that is not the one announced.
    let length = u32::try_from(other.len()).unwrap();
    let begin = |carrier, crc| Request::BeginGrid {
        carrier,
        length,
        crc,
    };
    let sensor = grid(GridCarrier::Sensor, wave);
    pc.ask(&begin(carrier, crc32(&sensor)));
    let given_as = carrier;
    let unfit = GridMemoryError::Unfit(CameraGridsError::Carrier { given_as });
    let parts = grid_requests(&sensor).unwrap().skip(1);
    let last = parts.map(|request| pc.ask(&request)).last().unwrap();
    assert_eq!(last, Answer::Refused(Refusal::Grids(unfit)));
    pc.ask(&begin(carrier, 7));
    let mut last = None;
    for request in grid_requests(&other).unwrap().skip(1) {
        let Request::GridPart(part) = request else {
            panic!("no part");
        };
        last = Some(pc.ask(&Request::GridPart(Part { crc: 7, ..part })));
    }
    let computed = crc32(&other);
    assert_eq!(last, Some(Answer::Refused(Refusal::LoadCrc { computed })));
    // Too long, and of no length.
    let bytes = MAX_FILE_BYTES + 1;
    let error = GridError::TooLong { bytes };
    let length = u32::try_from(bytes).unwrap();
    assert_eq!(
        pc.ask(&Request::BeginGrid {
            carrier,
            length,
            crc: 7
        }),
        Answer::Refused(Refusal::Grid { carrier, error })
    );
    let empty = Request::GridPart(Part {
        crc: 7,
        offset: 0,
        bytes: std::iter::empty().collect(),
    });
    let begin = |length| Request::BeginGrid {
        carrier,
        length,
        crc: 7,
    };
    assert_eq!(pc.ask(&begin(0)), Answer::Loading(0));
    let error = GridError::Length {
        bytes: 0,
        expected: 32,
    };
    assert_eq!(
        pc.ask(&empty),
        Answer::Refused(Refusal::Grid { carrier, error })
    );
    // Sound by itself, and too steep for any camera; and one that covers too little of this one.
    let steep = |column: u16, _| {
        [if column.is_multiple_of(2) {
            i16::MAX
        } else {
            -i16::MAX
        }; 2]
    };
    let mut header = *ResidualGrid::parse(&other).unwrap().header();
    header.scale_mm = 5e-6;
    let steep = file(&header, steep);
    header.pitch_mm = 1.9;
    let small = file(&header, |_, _| [0, 0]);
    for unfit in [steep, small] {
        assert_eq!(send(&mut pc, &unfit), Answer::GridLoaded(carrier));
        assert!(matches!(
            pc.load(&stating(Some(&unfit), None)),
            Answer::Refused(Refusal::Grids(GridMemoryError::Unfit(_)))
        ));
    }
    assert_corrects_with(&mut pc, Some(&lens), None);
}

#[test]
fn part_whose_answer_was_lost_is_answered_again_and_taken_once() {
    let lens = grid(GridCarrier::Lens, wave);
    let mut pc = with_memory();
    let requests = grid_requests(&lens).unwrap();
    for request in requests.chain(Upload::of(&stating(Some(&lens), None)).unwrap().requests()) {
        let header = Header {
            session: SESSION,
            sequence: pc.next,
        };
        let first = pc.ask(&request);
        assert_eq!(pc.ask_as(header, &request), first, "{request:?}");
        assert_eq!(pc.event, Some(LinkEvent::Repeated));
    }
    assert_corrects_with(&mut pc, Some(&lens), None);
}

#[test]
fn records_of_a_flight_state_what_the_grid_of_the_lens_leaves_out() {
    // Without any order, so that its curvature shows in a short exposure.
    let lens = grid(GridCarrier::Lens, noise);
    let flown = |camera: &CameraParameters| {
        let mut board = Board::connected(ResetCause::PowerOn, 0);
        let memory = Box::leak(Box::new(GridMemory::EMPTY));
        board.pc.station.keep_grids_in(memory);
        for request in grid_requests(&lens).unwrap() {
            board.pc.ask(&request);
        }
        let loaded = board.pc.load(camera);
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
        assert_eq!(board.prepare(), Answer::Prepared);
        board.arm();
        board.trigger(0);
        let record = board.record(1);
        let Answer::Flown(1, flown) = board.pc.ask(&Request::Flown) else {
            panic!("no frame");
        };
        let Outcome::Exposed(exposed) = record.outcome else {
            panic!("{record:?}");
        };
        assert_eq!(flown, exposed.interior);
        (exposed.interior, record.calibration.unwrap().crc)
    };
    let (plain, plain_crc) = flown(&camera_parameters());
    let stating = stating(Some(&lens), None);
    let (gridded, crc) = flown(&stating);
    assert_eq!(crc, digest::of_camera(&stating));
    assert_ne!(crc, plain_crc);
    let second = gridded.motion.moments.second;
    let parsed = ResidualGrid::parse(&lens).unwrap();
    let grid_nm = 1e6 * parsed.bounds().second_moment_mm(second, false);
    assert!(grid_nm > 0.01, "{grid_nm}");
    let stated = gridded.left_out_nm - plain.left_out_nm;
    assert!(
        (stated - grid_nm).abs() < 1e-3 + 0.01 * grid_nm,
        "{stated} {grid_nm}"
    );
    assert_eq!(gridded.model, CorrectionModel::Exact);
}

#[test]
fn board_puts_grids_of_its_own_store_into_the_memory_of_the_camera() {
    let mut pc = Pc::connected();
    assert!(pc.station.grid_memory_mut().is_none());
    pc.station
        .keep_grids_in(Box::leak(Box::new(GridMemory::EMPTY)));
    let file = grid(GridCarrier::Lens, wave);
    let spare = pc.station.grid_memory_mut().unwrap();
    spare.spare_mut(GridCarrier::Lens).add(&file).unwrap();
    spare.spare_mut(GridCarrier::Lens).check().unwrap();
    let camera = stating(Some(&file), None);
    assert!(pc.station.load(&camera, Storage::Stored).is_ok());
    let memory = pc.station.grid_memory_mut().unwrap();
    assert_eq!(memory.file_in_use(GridCarrier::Lens), Some(&file[..]));
}
