use std::fs;

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
use fmc_camera::io::link::after_reset::AfterReset;
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
            kept: Vec::new(),
            fetched: Vec::new(),
            triggers: 0,
            in_doubt: None,
        }
    }

    fn follow(&mut self) -> Result<(), Failure> {
        let out = self.out.path().to_owned();
        let interruption = self.interruption.clone();
        let earlier = EarlierRecords::read(&[]).unwrap();
        follow(self, &out, earlier, &interruption)
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
            after_reset: AfterReset::FIRST,
        })
    }

    fn are_safe(&mut self, through: u32) -> Result<u32, DeviceError> {
        (self.before_safe)(self, through);
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
        assert_eq!(last.matches(',').count(), 45);
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
    flying.end = |_| {
        Err(DeviceError::Link {
            device: "fake".to_owned(),
            error: LinkError::Closed,
        })
    };
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
