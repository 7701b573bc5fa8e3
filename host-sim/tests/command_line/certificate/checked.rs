//! The check of a certificate.

use std::fs;

use fmc_report::hash;

use super::super::mission;
use super::super::support::{Answer, Bench, CAMERA};
use super::bench::{ALL, bench, content, make};

fn check(bench: &Bench, more: &[&str]) -> Answer {
    bench.run(&[&["certificate", "check", "out"], more].concat())
}

fn read(bench: &Bench, name: &str) -> Vec<u8> {
    fs::read(bench.path(&format!("out/{name}"))).unwrap()
}

fn write(bench: &Bench, name: &str, bytes: &[u8]) {
    fs::write(bench.path(&format!("out/{name}")), bytes).unwrap();
}

/// Lists the files of the folder anew, as one would who has no key.
fn list_anew(bench: &Bench) {
    let names = [
        "certificate.pdf",
        "certificate.html",
        "certificate.json",
        "camera.toml",
    ];
    let line = |name: &str| format!("{}  {name}\n", hash::sha256(&read(bench, name)));
    write(bench, "SHA256SUMS", names.map(line).concat().as_bytes());
}

fn fails(bench: &Bench, more: &[&str], words: &[&str]) {
    let answer = check(bench, more);
    assert_eq!(answer.code, 1, "{}{}", answer.stdout, answer.stderr);
    for word in words {
        assert!(answer.stderr.contains(word), "{word}: {}", answer.stderr);
    }
    assert!(answer.stdout.contains("FAILED"), "{}", answer.stdout);
}

#[test]
fn certificate_as_it_was_made_passes() {
    let bench = bench();
    make(&bench, &[]).ok();
    let answer = check(&bench, &[]).ok();
    assert!(answer.stdout.contains("not signed"), "{}", answer.stdout);
    make(&bench, &ALL).ok();
    let answer = check(&bench, &["--key", "out/public-key.pem"]).ok();
    assert!(!answer.stdout.contains("FAILED"), "{}", answer.stdout);
    assert!(
        answer.stdout.contains("is the signature by the key"),
        "{}",
        answer.stdout
    );
    // One that is made again without a key has no signature of the one before.
    make(&bench, &[]).ok();
    assert!(!bench.path("out/SHA256SUMS.sig").exists());
    check(&bench, &[]).ok();
}

#[test]
fn camera_file_that_has_changed_since_is_named_with_both_hashes() {
    let bench = bench();
    make(&bench, &ALL).ok();
    let changed = CAMERA.replace("k1 = -1.0e-6", "k1 = -1.1e-6");
    write(&bench, "camera.toml", changed.as_bytes());
    let [before, after] = [CAMERA, &changed].map(|text| hash::sha256(text.as_bytes()));
    let words = [
        "camera.toml: changed since",
        &before,
        &after,
        "k1",
        "CRC-32",
    ];
    fails(&bench, &[], &words);
    // A comment changes the file, and no number.
    write(&bench, "camera.toml", format!("{CAMERA}# new\n").as_bytes());
    let answer = check(&bench, &[]);
    assert_eq!(answer.code, 1);
    assert!(
        answer.stdout.contains("ok      camera.toml: CRC-32"),
        "{}",
        answer.stdout
    );
}

#[test]
fn pages_of_another_camera_are_found_without_a_signature() {
    let (one, other) = (bench(), bench());
    make(&one, &[]).ok();
    let camera = CAMERA.replace(
        "principal_distance_mm = 100.0",
        "principal_distance_mm = 100.001",
    );
    fs::write(other.path("camera.toml"), camera).unwrap();
    make(&other, &[]).ok();
    for (name, word) in [
        ("certificate.pdf", "principal_distance_mm 100"),
        ("certificate.html", "principal_distance_mm 100"),
        ("certificate.json", "the certificate is for"),
        ("camera.toml", "changed since"),
    ] {
        let original = read(&one, name);
        write(&one, name, &read(&other, name));
        fails(&one, &[], &[name, "SHA256SUMS has"]);
        list_anew(&one);
        fails(&one, &[], &[name, word]);
        write(&one, name, &original);
        list_anew(&one);
        check(&one, &[]).ok();
    }
}

#[test]
fn files_that_are_missing_or_damaged_are_named() {
    let bench = bench();
    make(&bench, &ALL).ok();
    for name in [
        "certificate.pdf",
        "certificate.html",
        "camera.toml",
        "SHA256SUMS",
        "SHA256SUMS.sig",
    ] {
        let original = read(&bench, name);
        fs::remove_file(bench.path(&format!("out/{name}"))).unwrap();
        fails(&bench, &[], &[name, "no such file"]);
        for length in [0, 7, original.len() / 2, original.len() - 1] {
            write(&bench, name, &original[..length]);
            fails(&bench, &[], &[name]);
        }
        write(&bench, name, &original);
    }
    check(&bench, &[]).ok();
    for text in ["", "{}", "[]", "{\"identity\":{}}"] {
        write(&bench, "certificate.json", text.as_bytes());
        check(&bench, &[]).refused(&["certificate.json", "no certificate"]);
    }
    bench
        .run(&["certificate", "check", "nowhere"])
        .refused(&["nowhere"]);
}

#[test]
fn no_file_outside_of_the_folder_is_read() {
    let bench = bench();
    make(&bench, &[]).ok();
    let text = String::from_utf8(read(&bench, "certificate.json")).unwrap();
    for name in ["../camera.toml", "/etc/passwd", "a/b", "..", ""] {
        let text = text.replace("\"name\": \"camera.toml\"", &format!("\"name\": {name:?}"));
        write(&bench, "certificate.json", text.as_bytes());
        check(&bench, &[]).refused(&["no name of a camera file"]);
    }
}

#[test]
fn signature_of_another_key_or_list_is_refused() {
    let bench = bench();
    make(&bench, &ALL).ok();
    // A key that differs in one byte of its seed.
    let other = super::bench::KEY.replace("INTuctv5", "INTuctv6");
    fs::write(bench.path("other.pem"), other).unwrap();
    let certificate = [
        "certificate",
        "--camera",
        "camera.toml",
        "--sign",
        "other.pem",
    ];
    bench
        .run(&[&certificate[..], &["--out", "other"]].concat())
        .ok();
    let words = ["is not the signature", "names the key"];
    fails(&bench, &["--key", "other/public-key.pem"], &words);
    // All files of the other one, so that it is consistent in itself, and still not by this key.
    let key = fs::read(bench.path("out/public-key.pem")).unwrap();
    fs::write(bench.path("known.pem"), key).unwrap();
    let known = ["certificate", "check", "other", "--key", "known.pem"];
    assert_eq!(bench.run(&known).code, 1);
    bench.run(&["certificate", "check", "other"]).ok();
    // The list is written anew and not signed.
    let mut list = read(&bench, "SHA256SUMS");
    list.push(b'\n');
    write(&bench, "SHA256SUMS", &list);
    fails(&bench, &["--key", "known.pem"], &["is not the signature"]);
    check(&bench, &["--key", "camera.toml"]).refused(&["no public key"]);
}

#[test]
fn flight_with_this_calibration_passes_and_another_is_named() {
    let bench = bench();
    make(&bench, &[]).ok();
    let crc = content(&bench)["identity"]["camera_file"]["crc32"].clone();
    let crc = crc.as_str().unwrap();
    let csv = |second: &str| {
        let rows = format!("1,exposed,{crc}\n2,refused,{second}\n3,exposed,{crc}\n");
        format!("sequence,outcome,calibration_crc32\n{rows}")
    };
    fs::write(bench.path("records.csv"), csv(crc)).unwrap();
    let answer = check(&bench, &["--records", "records.csv"]).ok();
    assert!(
        answer.stdout.contains("all 3 records carry CRC-32"),
        "{}",
        answer.stdout
    );
    fs::write(bench.path("records.csv"), csv("00000000")).unwrap();
    let words = ["records.csv", crc, "1 with 00000000, the first is 2"];
    fails(&bench, &["--records", "records.csv"], &words);
    fs::write(bench.path("records.csv"), "sequence,calibration_crc32\n").unwrap();
    check(&bench, &["--records", "records.csv"]).refused(&["no records"]);
}

#[test]
fn records_of_a_flown_mission_carry_the_crc_of_the_certificate() {
    let bench = mission::bench(mission::MISSION);
    mission::fly(&bench, &["--exposures", "6"]).ok();
    let certificate = [
        "certificate",
        "--camera",
        "cameras/mission.toml",
        "--out",
        "out",
    ];
    bench.run(&certificate).ok();
    for records in ["report/records.csv", "report/records.json"] {
        let answer = check(&bench, &["--records", records]).ok();
        assert!(answer.stdout.contains("all 6 records"), "{}", answer.stdout);
    }
    let certificate = ["certificate", "--camera", "camera.toml", "--out", "out"];
    bench.run(&certificate).ok();
    fails(
        &bench,
        &["--records", "report/records.csv"],
        &["6 with", "the first is 1"],
    );
}
