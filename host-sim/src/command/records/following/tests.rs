use std::fs;
use std::path::PathBuf;

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::clock_drift::ClockDrift;
use fmc_camera::flight::controller::Counts;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::fault::Faults;
use fmc_camera::flight::findings::Findings;
use fmc_camera::flight::frame_record::{ExposedFrame, Flags};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::after_reset::{AfterReset, FlightAfterReset};
use fmc_camera::io::link::records_in_flash::RecordsInFlash;
use fmc_camera_file::CameraFile;
use fmc_frames::record_files::{CSV, JSON, RecordFiles};
use serde_json::Value;
use tempfile::TempDir;

use super::*;

/// σ of a record as the camera makes it, mm.
const SIGMA: PrincipalPointSigma = PrincipalPointSigma {
    frame_mm: 3e-4,
    common_mm: 4e-4,
};

/// A camera that flies: in each look at its status the next frame is finished.
struct Flying {
    out: TempDir,
    interruption: Interruption,
    /// Number of frames before the end.
    frames: u32,
    /// Called once they are over.
    end: fn(&mut Flying) -> Result<(), DeviceError>,
    /// Called with the number of a record before it is acknowledged.
    before_safe: fn(&mut Flying, u32),
    /// Called with the number from which a record is asked for, before the answer.
    before_fetch: fn(&mut Flying, u32),
    /// Number of the record whose acknowledgement does not arrive, as the link is cut.
    cut_at: Option<u32>,
    /// Folders of earlier records.
    earlier: Vec<PathBuf>,
    after_reset: AfterReset,
    kept: Vec<FrameRecord>,
    fetched: Vec<FrameRecord>,
    triggers: u32,
    in_doubt: Option<InDoubt>,
}

fn camera() -> Camera {
    let text = "name = \"bare\"\nprincipal_distance_mm = 100.0\n\
                [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";
    CameraFile::parse("bare.toml", text).unwrap().1
}

fn exposed(sequence: u32) -> FrameRecord {
    let at = |us: u64| Time::from_us(1_000_000 * u64::from(sequence) + us);
    FrameRecord {
        sequence,
        trigger: at(0),
        outcome: Outcome::Exposed(ExposedFrame {
            opened: at(30_000),
            closed: at(34_000),
            centroid: at(32_000),
            centroid_utc: None,
            vh: None,
            planned_opening_mm: -0.02,
            planned_travel_mm: 0.04,
            interior: camera().frame(&Exposure::new(0.1, 0.004)).unwrap().interior,
            principal_point_sigma: SIGMA,
            smear_um: 0.5,
            smear_px: 0.06,
        }),
        faults: Faults::NONE,
        flags: Flags::NONE,
        calibration: None,
        boot: 1,
        flight: 1,
    }
}

/// The error of a link that is cut.
fn closed() -> DeviceError {
    DeviceError::Link {
        device: "fake".to_owned(),
        error: LinkError::Closed,
    }
}

/// A record of another flight.
fn of_another_flight(sequence: u32) -> FrameRecord {
    let record = exposed(sequence);
    FrameRecord {
        trigger: record.trigger.plus_s(1000.0),
        ..record
    }
}

impl Flying {
    fn new(frames: u32) -> Self {
        Self {
            out: TempDir::new().unwrap(),
            interruption: Interruption::default(),
            frames,
            end: |flying| {
                flying.interruption.ask();
                Ok(())
            },
            before_safe: |_, _| (),
            before_fetch: |_, _| (),
            cut_at: None,
            earlier: Vec::new(),
            after_reset: AfterReset::FIRST,
            kept: Vec::new(),
            fetched: Vec::new(),
            triggers: 0,
            in_doubt: None,
        }
    }

    fn follow(&mut self) -> Result<(), Failure> {
        let out = self.out.path().to_owned();
        let interruption = self.interruption.clone();
        let earlier = EarlierRecords::read(&self.earlier).unwrap();
        follow(self, &out, earlier, &interruption)
    }

    /// Another session prepares another flight, which has four records at once.
    fn prepare_again(&mut self) {
        self.after_reset.flight += 1;
        self.kept = (1..=4).map(of_another_flight).collect();
        self.triggers = 4;
    }

    /// Follows into another folder what comes after a flight that has ended, up to a number of
    /// frames, beside what has been fetched.
    fn go_on(&mut self, frames: u32) {
        let before = std::mem::replace(&mut self.out, TempDir::new().unwrap());
        self.earlier.push(before.keep());
        self.interruption = Interruption::default();
        self.cut_at = None;
        self.frames = frames;
    }

    /// The numbers of the rows of the table.
    fn rows(&self) -> Vec<u32> {
        let table = self.table();
        let rows = table.lines().skip(1);
        let number = |row: &str| row.split(',').next().unwrap().parse().unwrap();
        rows.map(number).collect()
    }

    /// Puts exposures in doubt, as the controller does.
    fn doubt(&mut self, exposures: InDoubt) {
        self.in_doubt = Some(exposures);
        for record in &mut self.kept {
            record.doubt(&exposures);
        }
    }

    fn table(&self) -> String {
        fs::read_to_string(self.out.path().join(CSV)).unwrap()
    }

    /// σ of the principal points in both files, mm.
    fn sigmas_mm(&self) -> Vec<f64> {
        RecordFiles::read(self.out.path()).unwrap();
        let json = fs::read(self.out.path().join(JSON)).unwrap();
        let json: Value = serde_json::from_slice(&json).unwrap();
        let records = json["records"].as_array().unwrap();
        let of = |record: &Value| record["principal_point_sigma_mm"].as_f64().unwrap();
        let sigmas: Vec<f64> = records.iter().map(of).collect();
        let table = self.table();
        let mut table = csv::Reader::from_reader(table.as_bytes());
        let mut column = table.headers().unwrap().iter();
        let column = column.position(|name| name == "principal_point_sigma_mm");
        let rows = table
            .records()
            .map(|row| row.unwrap()[column.unwrap()].parse());
        assert_eq!(rows.collect::<Result<Vec<f64>, _>>().unwrap(), sigmas);
        sigmas
    }
}

impl RecordSource for Flying {
    fn fetch(&mut self, from_sequence: u32) -> Result<Option<FrameRecord>, DeviceError> {
        (self.before_fetch)(self, from_sequence);
        let mut kept = self.kept.iter().copied();
        let found = kept.find(|record| record.sequence >= from_sequence);
        self.fetched.extend(found);
        Ok(found)
    }

    fn flight_status(&mut self) -> Result<Status, DeviceError> {
        if !self.kept.is_empty() {
            // The last frame waits to be acknowledged.
        } else if self.triggers == self.frames {
            (self.end)(self)?;
        } else {
            self.triggers += 1;
            self.kept.push(exposed(self.triggers));
        }
        Ok(Status {
            state: State::Armed,
            counts: Counts {
                triggers: self.triggers,
                ..Counts::default()
            },
            kept: 0,
            is_place_lost: false,
            offset_mm: None,
            following_rms_um: 0.0,
            findings: Findings::default(),
            last_finding: None,
            clock_drift: None::<ClockDrift>,
            calibration: None,
            index_mm: None,
            in_doubt: self.in_doubt,
            after_reset: self.after_reset,
            in_flash: RecordsInFlash::NotKept,
        })
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        (self.before_safe)(self, through);
        if self.cut_at == Some(through) {
            return Err(closed());
        }
        let kept = self.kept.first().copied();
        let mut fetched = self.fetched.iter().rev();
        if kept != fetched.find(|record| record.sequence == through).copied() {
            return Err(DeviceError::Link {
                device: "fake".to_owned(),
                error: LinkError::Refused {
                    request: "acknowledge",
                    refusal: Refusal::NotFetched { sequence: through },
                },
            });
        }
        self.kept.clear();
        Ok(0)
    }
}

#[test]
fn record_is_a_whole_row_on_the_disk_before_the_camera_forgets_it() {
    let mut flying = Flying::new(3);
    flying.before_safe = |flying, sequence| {
        let table = flying.table();
        assert!(table.ends_with('\n'), "{table}");
        assert_eq!(table.lines().count(), 1 + sequence as usize);
        let last = table.lines().last().unwrap();
        assert!(last.starts_with(&format!("{sequence},")), "{last}");
        assert_eq!(last.matches(',').count(), 47);
        assert!(!flying.out.path().join(JSON).exists());
    };
    flying.follow().unwrap();
    assert_eq!(flying.sigmas_mm().len(), 3);
    // The files are those of `records` without `--follow`.
    let mut whole = Vec::new();
    let records: Vec<FrameRecord> = (1..=3).map(exposed).collect();
    fmc_report::records::write_csv(&records, &mut whole).unwrap();
    assert_eq!(flying.table().into_bytes(), whole);
}

#[test]
fn files_are_complete_where_the_link_is_cut_and_are_not_replaced() {
    let mut flying = Flying::new(2);
    flying.end = |_| Err(closed());
    let failure = flying.follow().unwrap_err();
    assert_eq!(
        (failure.code(), failure.text().as_str()),
        (3, "fake: the port closed")
    );
    assert_eq!(flying.sigmas_mm().len(), 2);
    let before = flying.table();
    flying.triggers = 0;
    let failure = flying.follow().unwrap_err();
    assert!(failure.text().contains(CSV), "{}", failure.text());
    assert_eq!(flying.table(), before);
}

#[test]
fn exposures_in_doubt_are_marked_once_before_and_after_the_camera_forgets_them() {
    let mut flying = Flying::new(4);
    flying.before_safe = |flying, sequence| {
        if sequence == 3 && flying.in_doubt.is_none() {
            flying.doubt(InDoubt::between([2, 3], 0.0012, true));
        }
    };
    flying.follow().unwrap();
    let sigma = f64::from(SIGMA.total_mm());
    let doubted = f64::from(SIGMA.in_doubt_by(0.0012).total_mm());
    for (found, expected) in flying
        .sigmas_mm()
        .iter()
        .zip([sigma, doubted, doubted, sigma])
    {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    let table = flying.table();
    let marked = |row: &&str| row.contains(Flag::Unreferenced.name());
    let rows: Vec<&str> = table.lines().skip(1).filter(marked).collect();
    assert_eq!(rows.len(), 2, "{table}");
    assert!(rows.iter().all(|row| row.contains(Fault::Encoder.name())));
}

#[test]
fn camera_that_is_prepared_again_ends_the_flight_with_its_records_as_they_are() {
    let mut flying = Flying::new(2);
    flying.end = |flying| {
        flying.frames = 0;
        flying.triggers = 0;
        flying.in_doubt = Some(InDoubt::between([1, 1], 1.0, true));
        Ok(())
    };
    flying.follow().unwrap();
    let sigma = f64::from(SIGMA.total_mm());
    assert!(
        flying
            .sigmas_mm()
            .iter()
            .all(|found| (found - sigma).abs() < 1e-9)
    );
}

#[test]
fn flight_that_another_session_prepares_keeps_its_records() {
    // While no record is there, after one is on the disk, and before it can be forgotten.
    let prepare: [fn(&mut Flying); 2] = [
        |flying| {
            flying.before_fetch = |flying, from| {
                if from == 3 && flying.after_reset.flight == 0 {
                    flying.prepare_again();
                }
            };
        },
        |flying| {
            flying.before_safe = |flying, through| {
                if through == 2 && flying.after_reset.flight == 0 {
                    flying.prepare_again();
                }
            };
        },
    ];
    for prepare in prepare {
        let mut flying = Flying::new(3);
        prepare(&mut flying);
        flying.follow().unwrap();
        let theirs: Vec<FrameRecord> = (1..=4).map(of_another_flight).collect();
        assert_eq!(flying.kept, theirs);
        let mut ours = Vec::new();
        let records: Vec<FrameRecord> = (1..=2).map(exposed).collect();
        fmc_report::records::write_csv(&records, &mut ours).unwrap();
        assert_eq!(flying.table().into_bytes(), ours);
        assert_eq!(flying.sigmas_mm().len(), 2);
    }
}

#[test]
fn record_that_an_earlier_folder_has_is_marked_and_forgotten_and_not_written_again() {
    for is_killed in [false, true] {
        let mut flying = Flying::new(3);
        flying.cut_at = Some(2);
        let failure = flying.follow().unwrap_err();
        assert_eq!(failure.text(), "fake: the port closed");
        assert_eq!((flying.rows(), flying.kept.len()), (vec![1, 2], 1));
        flying.go_on(3);
        let table = flying.earlier[0].join(CSV);
        if is_killed {
            fs::remove_file(flying.earlier[0].join(JSON)).unwrap();
            // The beginning of a row that the camera has not forgotten.
            let begun = fs::read_to_string(&table).unwrap() + "3,30";
            fs::write(&table, begun).unwrap();
        }
        flying.doubt(InDoubt::between([1, 2], 0.0012, true));
        flying.before_safe = |flying, through| {
            let table = fs::read_to_string(flying.earlier[0].join(CSV)).unwrap();
            assert_eq!(table.matches(Flag::Unreferenced.name()).count(), 2);
            assert!(table.ends_with('\n') && table.lines().count() == 3);
            assert!((2..=3).contains(&through));
        };
        flying.follow().unwrap();
        assert_eq!((flying.rows(), flying.kept.len()), (vec![3], 0));
        assert_eq!(flying.earlier[0].join(JSON).exists(), !is_killed);
        let marked = fs::read_to_string(&table).unwrap();
        assert!(EarlierRecords::read(&flying.earlier).is_ok());

        // Another record of that number is one of another flight, and stays.
        flying.go_on(3);
        flying.kept = vec![of_another_flight(2)];
        let failure = flying.follow().unwrap_err();
        assert!(
            failure.text().contains("its record 2"),
            "{}",
            failure.text()
        );
        assert_eq!((failure.code(), flying.kept.len()), (2, 1));
        assert_eq!(fs::read_to_string(&table).unwrap(), marked);
        for folder in &flying.earlier {
            fs::remove_dir_all(folder).unwrap();
        }
    }
}

#[test]
fn records_after_a_reset_are_of_the_flight_before_though_time_has_begun_anew() {
    let damaged = FrameRecord {
        trigger: Time::START,
        outcome: Outcome::Refused(fmc_camera::flight::frame_record::Reason::Unusable),
        ..exposed(2)
    };
    let after = FrameRecord {
        trigger: Time::from_us(500_000),
        ..exposed(3)
    };
    for (outcome, record, rows) in [
        (FlightAfterReset::FliesOn, after, Some(vec![3])),
        (FlightAfterReset::FliesOn, damaged, Some(vec![])),
        (FlightAfterReset::Nothing, after, None),
    ] {
        let mut flying = Flying::new(2);
        flying.follow().unwrap();
        flying.go_on(3);
        flying.after_reset.outcome = outcome;
        (flying.kept, flying.triggers) = (vec![record], 3);
        let followed = flying.follow();
        if let Some(rows) = rows {
            followed.unwrap();
            assert_eq!((flying.rows(), flying.kept.len()), (rows, 0));
        } else {
            let text = followed.unwrap_err().text();
            assert!(text.contains("trigger_us 2000000"), "{text}");
            assert_eq!(flying.kept.len(), 1);
        }
        fs::remove_dir_all(&flying.earlier[0]).unwrap();
    }
}

#[test]
fn failure_is_what_has_ended_the_flight_though_the_files_cannot_be_completed() {
    let mut flying = Flying::new(2);
    flying.end = |flying| {
        fs::create_dir_all(flying.out.path().join(JSON).join("in the way")).unwrap();
        Err(closed())
    };
    let failure = flying.follow().unwrap_err();
    assert_eq!(failure.text(), "fake: the port closed");
    assert_eq!(flying.rows(), [1, 2]);
}

#[test]
fn line_of_a_record_says_what_was_exposed_or_why_not() {
    let mut record = exposed(7);
    record.flags.insert(Flag::OffCentre);
    let text = line(&record);
    assert!(
        text.starts_with("7 exposed, 0.004000 s, V/H 0.1000 1/s"),
        "{text}"
    );
    assert!(
        text.ends_with("σ 0.50 µm, smear 0.06 px; flags: off centre"),
        "{text}"
    );
    record.outcome = Outcome::Refused(fmc_camera::flight::frame_record::Reason::NotArmed);
    record.flags = Flags::NONE;
    record.faults.insert(Fault::Stall);
    assert_eq!(line(&record), "7 refused: not armed; faults: stall");
}
