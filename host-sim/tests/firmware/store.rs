//! The calibration in the flash of the firmware in QEMU, through resets and kills of the machine.

use std::fs::{self, OpenOptions};
use std::os::unix::fs::FileExt as _;
use std::path::Path;
use std::process::Command;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use fmc_camera::flight::calibration_id::{SerialNumber, Storage};
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::io::link::message::Refusal;
use fmc_camera::io::store::{NotStored, Origin, Permission, SlotFault, StoreOrder, StoredIdentity};
use fmc_camera::{CalibrationParameters, CameraParameters, Exposure, SensorPoint};
use fmc_camera_file::GridFiles;
use fmc_certificate::calibration_signature::CalibrationSignature;
use fmc_certificate::signature::PrivateKey;
use host_sim::device::link_error::LinkError;
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{
    CorrectingDevice as _, DeviceError, InProcess, KeepingCamera as _, Machine,
};

use crate::firmware::grids;

const MACHINES: [Machine; 2] = [Machine::An386, Machine::An500];
const EXPOSURE: Exposure = Exposure::new(0.1, 0.005);

/// Place of the flash's words in the machine's memory.
const FLASH_AT: u64 = 0x10_0000;
/// Bytes of a sector.
const SECTOR: u64 = 0x2_0000;

fn camera(version: u32) -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion.k1 = -1e-8 * f32::from(u8::try_from(version).unwrap());
    CameraParameters {
        serial: SerialNumber::new("5282").unwrap(),
        version,
        ..CameraParameters::new(lens)
    }
}

fn origin() -> Origin {
    Origin::new("HR 100 No. 7", "Test range", "2026-05-17").unwrap()
}

/// Key that the firmware trusts unless it is built with another: everybody has it.
fn test_key() -> PrivateKey {
    let text = include_str!("../../keys/test-private-key.pem");
    PrivateKey::parse("test-private-key.pem", text).unwrap()
}

fn signed_by(
    key: &PrivateKey,
    (camera, grids): (&CameraParameters, &GridFiles),
    permission: Option<Permission>,
) -> StoreOrder {
    let signature = CalibrationSignature::new(key, camera, grids, &origin(), permission);
    signature.unwrap().order()
}

/// Loads a calibration, and stores it with a signature by the test key.
fn store(
    qemu: &mut Qemu,
    camera: &CameraParameters,
    grids: &GridFiles,
) -> Result<StoredIdentity, DeviceError> {
    qemu.put_into_use(camera, grids).unwrap();
    qemu.store(&signed_by(&test_key(), (camera, grids), None))
}

fn points() -> Vec<SensorPoint> {
    let place = |index: u8| (0.4 * f32::from(index) - 38.0, 28.0 - 0.3 * f32::from(index));
    let points = (0..180).map(place);
    points.map(|(x, y)| SensorPoint::new(x, y)).collect()
}

fn with_flash(machine: Machine, flash: &Path) -> Qemu {
    let options = QemuOptions {
        flash: Some(flash.to_owned()),
        ..QemuOptions::default()
    };
    Qemu::start(machine, &options).unwrap()
}

/// Returns points as the camera corrects them with what it has started with, without a twin.
fn corrected_by_itself(qemu: &mut Qemu) -> Vec<Corrected> {
    qemu.remote()
        .correct_by_itself(&EXPOSURE, &points())
        .unwrap()
}

fn corrected_here(camera: &CameraParameters, grids: &GridFiles) -> Vec<Corrected> {
    let mut twin = InProcess::default();
    twin.load_grids(grids).unwrap();
    twin.load(camera).unwrap();
    twin.expose(&EXPOSURE).unwrap();
    twin.correct(&points()).unwrap()
}

/// Kills the machine after some time, as a failing supply does: the firmware is not asked.
fn killed_after(qemu: &Qemu, time: Duration) -> JoinHandle<()> {
    let id = qemu.process_id().to_string();
    thread::spawn(move || {
        thread::sleep(time);
        let status = Command::new("kill").args(["-9", &id]).status().unwrap();
        assert!(status.success());
    })
}

fn stored(qemu: &mut Qemu) -> StoredIdentity {
    qemu.stored().unwrap().unwrap()
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn stored_calibration_with_grids_is_found_after_a_reset_and_after_a_kill_and_corrects_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for machine in MACHINES {
        let flash = folder.path().join(format!("flash of {machine}"));
        let (mut with_grids, files) = grids::camera(1);
        (with_grids.version, with_grids.serial) = (3, camera(2).serial);
        for (camera, grids) in [(camera(2), GridFiles::default()), (with_grids, files)] {
            let expected = corrected_here(&camera, &grids);
            let mut qemu = with_flash(machine, &flash);
            let record = store(&mut qemu, &camera, &grids).unwrap();
            assert_eq!(record.id.version, camera.version);
            assert_eq!(record.id.storage, Storage::Stored);
            qemu.remote().reset().unwrap();
            assert_eq!(qemu.remote().identity().calibration, Some(record.id));
            assert_eq!(corrected_by_itself(&mut qemu), expected);
            killed_after(&qemu, Duration::ZERO).join().unwrap();
            // The file is free again.
            drop(qemu);

            let mut qemu = with_flash(machine, &flash);
            assert_eq!(qemu.remote().identity().calibration, Some(record.id));
            let found = stored(&mut qemu);
            assert_eq!((found.id, &found.origin), (record.id, &origin()));
            assert!(found.is_sealed);
            assert_eq!(corrected_by_itself(&mut qemu), expected);
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn machine_killed_during_a_store_starts_with_the_calibration_before_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let flash = folder.path().join("flash");
    let next = |version: u32| {
        let (mut camera_with_grids, files) = grids::camera(1);
        (camera_with_grids.version, camera_with_grids.serial) = (version, camera(1).serial);
        (camera_with_grids, files)
    };
    let mut qemu = with_flash(Machine::An386, &flash);
    let (first, files) = next(1);
    qemu.put_into_use(&first, &files).unwrap();
    let order = signed_by(&test_key(), (&first, &files), None);
    let start = Instant::now();
    qemu.store(&order).unwrap();
    // Time that a store takes, on a PC that may have more to do at one time than at another.
    let mut whole = start.elapsed();
    let (mut kept, mut found) = (1, [0, 0]);
    for step in 0..24 {
        let version = 2 + step;
        let (next, files) = next(version);
        qemu.put_into_use(&next, &files).unwrap();
        let order = signed_by(&test_key(), (&next, &files), None);
        let sixths = step % 8;
        let killer = killed_after(&qemu, whole * sixths / 6);
        let answered = qemu.store(&order);
        killer.join().unwrap();
        drop(qemu);
        qemu = with_flash(Machine::An386, &flash);
        let id = stored(&mut qemu).id;
        assert_eq!(qemu.remote().identity().calibration, Some(id));
        assert!([kept, version].contains(&id.version), "{id}, not {kept}");
        if answered.is_ok() {
            assert_eq!(id.version, version, "it was answered");
        }
        let is_new = id.version == version;
        found[usize::from(is_new)] += 1;
        if is_new && sixths < 4 {
            whole = whole * 2 / 3;
        } else if !is_new && sixths > 5 {
            whole = whole * 3 / 2;
        }
        kept = id.version;
    }
    assert!(
        found[0] > 3 && found[1] > 3,
        "kills came on one side of the commit: {found:?}"
    );
    let stored = store(&mut qemu, &camera(100), &GridFiles::default());
    assert_eq!(stored.unwrap().id.version, 100);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn word_that_cannot_be_read_is_a_fault_of_its_slot_and_the_camera_answers() {
    let folder = tempfile::tempdir().unwrap();
    for machine in MACHINES {
        let flash = folder.path().join(format!("flash of {machine}"));
        let mut qemu = with_flash(machine, &flash);
        for version in [1, 2] {
            let stored = store(&mut qemu, &camera(version), &GridFiles::default());
            assert_eq!(u32::from(stored.unwrap().slot) + 1, version);
        }
        drop(qemu);
        for (slot, version) in [(1, Some(1)), (0, None)] {
            let file = OpenOptions::new()
                .read(true)
                .write(true)
                .open(&flash)
                .unwrap();
            // A bit in the third word of the body.
            let at = FLASH_AT + slot * SECTOR + 32 * 10 + 5;
            let mut byte = [0];
            file.read_exact_at(&mut byte, at).unwrap();
            file.write_all_at(&[byte[0] ^ 4], at).unwrap();
            drop(file);
            let mut qemu = with_flash(machine, &flash);
            let unreadable = SlotFault::Unreadable { word: 10 };
            if let Some(version) = version {
                let found = stored(&mut qemu);
                assert_eq!((found.id.version, found.other), (version, Some(unreadable)));
            } else {
                let nothing = qemu.stored().unwrap().unwrap_err();
                assert_eq!(nothing.slots, [unreadable; 2]);
                assert_eq!(qemu.remote().identity().calibration, None);
                let stored = store(&mut qemu, &camera(3), &GridFiles::default());
                assert_eq!(stored.unwrap().id.version, 3);
            }
        }
    }
}

/// Checks that the camera refuses to store what it has been loaded with, for a reason.
fn assert_refused(qemu: &mut Qemu, order: &StoreOrder, reason: NotStored) {
    let Err(DeviceError::Link {
        error: LinkError::Refused { refusal, .. },
        ..
    }) = qemu.store(order)
    else {
        panic!("stored");
    };
    assert_eq!(refusal, Refusal::NotStored(reason));
    assert_eq!(stored(qemu).id.version, 4);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn unsigned_foreign_and_older_calibrations_are_not_stored_and_a_run_without_a_file_is_blank() {
    let none = GridFiles::default();
    for machine in MACHINES {
        let mut qemu = Qemu::start(machine, &QemuOptions::default()).unwrap();
        assert!(qemu.stored().unwrap().unwrap_err().is_blank());
        store(&mut qemu, &camera(4), &none).unwrap();
        // Loaded over the link it is in use, and volatile; without a signature it stays so.
        let next = camera(5);
        qemu.put_into_use(&next, &none).unwrap();
        let unsigned = StoreOrder {
            origin: origin(),
            authentication: None,
        };
        assert_refused(&mut qemu, &unsigned, NotStored::Unsigned);
        let stranger = PrivateKey::of_random(&[1; PrivateKey::BYTES]);
        let foreign = signed_by(&stranger, (&next, &none), None);
        assert_refused(&mut qemu, &foreign, NotStored::WrongSignature);
        let of_another = signed_by(&test_key(), (&camera(6), &none), None);
        assert_refused(&mut qemu, &of_another, NotStored::WrongSignature);
        let in_use = qemu.remote().reset();
        in_use.unwrap();
        let in_use = qemu.remote().identity().calibration.unwrap();
        assert_eq!((in_use.version, in_use.storage), (4, Storage::Stored));

        let mut other = next;
        other.serial = SerialNumber::new("5283").unwrap();
        qemu.put_into_use(&other, &none).unwrap();
        let order = signed_by(&test_key(), (&other, &none), None);
        let own = camera(4).serial;
        assert_refused(&mut qemu, &order, NotStored::OtherCamera { camera: own });
        qemu.put_into_use(&camera(3), &none).unwrap();
        let order = signed_by(&test_key(), (&camera(3), &none), None);
        let older = NotStored::VersionNotRisen { highest: 4 };
        assert_refused(&mut qemu, &order, older);
        // With a permission it is stored, once.
        let at_four = stored(&mut qemu);
        let permission = Permission {
            store: at_four.store,
            crc: at_four.id.crc,
        };
        let permitted = signed_by(&test_key(), (&camera(3), &none), Some(permission));
        assert_eq!(qemu.store(&permitted).unwrap().id.version, 3);
        let at_five = store(&mut qemu, &next, &none).unwrap();
        assert_eq!((at_five.store, at_five.id.version), (3, 5));
        qemu.put_into_use(&camera(3), &none).unwrap();
        assert!(qemu.store(&permitted).is_err());
        assert_eq!(stored(&mut qemu).id.version, 5);
    }
}

/// A signature that is changed in the file of the flash, with the right CRC-32 of word, body and
/// commit word, as somebody with a debugger could write it.
#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn slot_with_a_wrong_signature_is_a_fault_of_its_slot_and_the_camera_answers() {
    let folder = tempfile::tempdir().unwrap();
    for machine in MACHINES {
        let flash = folder.path().join(format!("flash of {machine}"));
        let mut qemu = with_flash(machine, &flash);
        for version in [1, 2] {
            store(&mut qemu, &camera(version), &GridFiles::default()).unwrap();
        }
        drop(qemu);
        for (slot, version) in [(1, Some(1)), (0, None)] {
            change_signature(&flash, slot);
            let mut qemu = with_flash(machine, &flash);
            let wrong = SlotFault::WrongSignature;
            if let Some(version) = version {
                let found = stored(&mut qemu);
                assert_eq!((found.id.version, found.other), (version, Some(wrong)));
            } else {
                let nothing = qemu.stored().unwrap().unwrap_err();
                assert_eq!(nothing.slots, [wrong; 2]);
                assert_eq!(qemu.remote().identity().calibration, None);
                let stored = store(&mut qemu, &camera(2), &GridFiles::default());
                assert_eq!(stored.unwrap().id.version, 2);
            }
        }
    }
}

/// Changes a bit of the signature of a slot, and writes all CRCs anew.
fn change_signature(flash: &Path, slot: u64) {
    let file = OpenOptions::new().read(true).write(true).open(flash);
    let file = file.unwrap();
    let begin = FLASH_AT + slot * SECTOR;
    let word_at = |index: u64| {
        let mut word = [0; 32];
        file.read_exact_at(&mut word, begin + 32 * index).unwrap();
        word.map(|byte: u8| !byte)
    };
    let write = |index: u64, word: [u8; 32]| {
        let inverted = word.map(|byte| !byte);
        file.write_all_at(&inverted, begin + 32 * index).unwrap();
        let check = !crc_of(&word);
        let checks = FLASH_AT + 2 * SECTOR;
        let at = checks + (slot * SECTOR / 32 + index) * 4;
        file.write_all_at(&check.to_le_bytes(), at).unwrap();
    };
    let mut commit = word_at(0);
    let words = u64::from(u16::from_le_bytes([commit[6], commit[7]]));
    let body: Vec<[u8; 32]> = (8..8 + words).map(word_at).collect();
    let mut bytes = body.concat();
    // Behind the length and the origin's texts.
    let texts = ["HR 100 No. 7", "Test range", "2026-05-17"];
    let at = 2 + texts.map(|text| 1 + text.len()).iter().sum::<usize>() + 20;
    bytes[at] ^= 1;
    for (index, word) in (8..).zip(bytes.chunks(32)) {
        write(index, word.try_into().unwrap());
    }
    commit[12..16].copy_from_slice(&crc_of(&bytes).to_le_bytes());
    let crc = crc_of(&commit[..28]);
    commit[28..].copy_from_slice(&crc.to_le_bytes());
    write(0, commit);
}

fn crc_of(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn program_stores_a_camera_file_and_tells_it_in_another_run() {
    let folder = tempfile::tempdir().unwrap();
    let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("cameras/rc30-5324.toml");
    let published = fs::read_to_string(published).unwrap();
    let file = format!("serial = \"5324\"\nversion = 2\n{published}");
    fs::write(folder.path().join("camera.toml"), file).unwrap();
    fs::write(folder.path().join("letter"), "Dear").unwrap();
    let run = |flash: &str, action: &[&str]| {
        let device = ["camera", "--device", "qemu", "--flash", flash];
        let mut command = Command::new(cargo_bin!("host-sim"));
        command.current_dir(folder.path()).args(device).args(action);
        command.output().unwrap()
    };
    let text = |action: &[&str]| {
        let output = run("flash", action);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{stderr}");
        String::from_utf8(output.stdout).unwrap()
    };
    let nothing = text(&["stored"]);
    assert!(
        nothing.contains("none is stored") && nothing.contains("slot 1       blank"),
        "{nothing}"
    );
    let details = "calibrated_on = 2004-06-01\n[laboratory]\nname = \"USGS\"\n";
    fs::write(folder.path().join("details.toml"), details).unwrap();
    let key = Path::new(env!("CARGO_MANIFEST_DIR")).join("keys/test-private-key.pem");
    let sign = [
        "sign",
        "--camera",
        "camera.toml",
        "--details",
        "details.toml",
        "--out",
        "my.json",
        "--key",
    ];
    let mut command = Command::new(cargo_bin!("host-sim"));
    let command = command.current_dir(folder.path()).args(sign).arg(key);
    assert!(command.status().unwrap().success());
    let signature = ["--signature", "my.json"];
    let without = run("flash", &[&["store"], &signature[..]].concat());
    let stderr = String::from_utf8_lossy(&without.stderr).into_owned();
    assert!(
        stderr.contains("no calibration is loaded") && stderr.contains("--camera"),
        "{stderr}"
    );
    let said = text(&[&["store", "--camera", "camera.toml"], &signature[..]].concat());
    let found = text(&["stored"]);
    for text in [&said, &found] {
        for part in [
            "serial 5324, version 2, CRC-32 ",
            "stored\n",
            "USGS",
            "2004-06-01",
            "it stays",
            "number 1; the highest version so far is 2",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
    let json: serde_json::Value = serde_json::from_str(&text(&["stored", "--json"])).unwrap();
    assert_eq!(json["calibration"]["version"], 2);
    assert_eq!(json["laboratory"], "USGS");
    assert_eq!(json["lens"], serde_json::Value::Null);
    assert_eq!(
        (&json["store"], &json["highest_version"]),
        (&1.into(), &2.into())
    );
    assert_eq!(json["slot_faults"][1], "blank");
    let letter = run("letter", &["stored"]);
    let stderr = String::from_utf8_lossy(&letter.stderr).into_owned();
    assert_eq!(letter.status.code(), Some(2), "{stderr}");
    assert!(
        stderr.contains("--flash letter: is not the flash"),
        "{stderr}"
    );
    assert_eq!(fs::read(folder.path().join("letter")).unwrap(), b"Dear");
}
