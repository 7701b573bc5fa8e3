//! `sign` and `sign key`: what is signed, and what is refused.

use std::fs;
use std::path::Path;

use crate::command_line::support::{Bench, CAMERA};

/// Private key in the repository.
fn test_key() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("keys/test-private-key.pem");
    path.display().to_string()
}

/// Writes a camera file with serial number and version, `signed.toml`, and its signature by the
/// test key, `my.json`.
pub(crate) fn signed(bench: &Bench) {
    let camera = format!("serial = \"5282\"\nversion = 3\n{CAMERA}");
    fs::write(bench.path("signed.toml"), camera).unwrap();
    let sign = [
        "sign",
        "--camera",
        "signed.toml",
        "--out",
        "my.json",
        "--key",
    ];
    let answer = bench.run(&[&sign[..], &[&test_key()]].concat()).ok();
    assert!(
        answer
            .stdout
            .starts_with("my.json: serial 5282, version 3, CRC-32 ")
    );
}

fn json(bench: &Bench, file: &str) -> serde_json::Value {
    serde_json::from_slice(&fs::read(bench.path(file)).unwrap()).unwrap()
}

#[test]
fn key_that_is_made_signs_and_is_not_replaced() {
    let bench = Bench::new();
    signed(&bench);
    bench.run(&["sign", "key", "--out", "keys"]).ok();
    let private = bench.path("keys/private-key.pem");
    let text = fs::read_to_string(&private).unwrap();
    assert!(text.starts_with("-----BEGIN PRIVATE KEY-----\n"), "{text}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = fs::metadata(&private).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
    let public = fs::read_to_string(bench.path("keys/public-key.pem")).unwrap();
    let again = bench.run(&["sign", "key", "--out", "keys"]);
    again.refused(&["private-key.pem exists and is not replaced"]);
    assert_eq!(fs::read_to_string(&private).unwrap(), text);
    let sign = [
        "sign",
        "--camera",
        "signed.toml",
        "--key",
        "keys/private-key.pem",
        "--out",
    ];
    bench.run(&[&sign[..], &["own.json"]].concat()).ok();
    bench.run(&[&sign[..], &["again.json"]].concat()).ok();
    let own = json(&bench, "own.json");
    assert_eq!(own, json(&bench, "again.json"));
    let test = json(&bench, "my.json");
    for key in ["serial", "version", "crc32", "permission", "lens"] {
        assert_eq!(own[key], test[key]);
    }
    for key in ["signature", "public_key"] {
        assert_ne!(own[key], test[key]);
    }
    // The firmware reads the same bytes from the public key's file as the signature names.
    let key = fmc_camera::io::store::PublicKey::from_pem(&public).unwrap();
    assert_eq!(own["public_key"], format!("{key:?}"));
}

#[test]
fn firmware_trusts_the_test_key_unless_it_is_built_with_another() {
    let bench = Bench::new();
    signed(&bench);
    let trusted = include_str!("../../../src/bin/firmware/test-public-key.pem");
    let key = fmc_camera::io::store::PublicKey::from_pem(trusted).unwrap();
    assert_eq!(json(&bench, "my.json")["public_key"], format!("{key:?}"));
    for text in [trusted, &fs::read_to_string(test_key()).unwrap()] {
        assert!(text.starts_with("TEST KEY, printed in RFC 8410"), "{text}");
    }
}

#[test]
fn details_name_lens_laboratory_and_date_and_over_a_permission() {
    let bench = Bench::new();
    signed(&bench);
    let details = "calibrated_on = 2026-05-17\n[laboratory]\nname = \"Test range\"\n\
                   [lens]\nmodel = \"HR 50\"\nserial = \"1187\"\n";
    fs::write(bench.path("details.toml"), details).unwrap();
    let stored = r#"{"calibration": {"serial": "5282", "crc32": "0000beef"}, "store": 7}"#;
    fs::write(bench.path("stored.json"), stored).unwrap();
    let key = test_key();
    let sign = |more: &[&str]| {
        let sign = [
            "sign",
            "--camera",
            "signed.toml",
            "--out",
            "other.json",
            "--key",
            &key,
        ];
        bench.run(&[&sign[..], more].concat())
    };
    let said = sign(&["--details", "details.toml", "--over", "stored.json"]).ok();
    let permitted = "permitted once, in the place of store 7, CRC-32 0000beef";
    assert!(said.stdout.contains(permitted), "{}", said.stdout);
    let other = json(&bench, "other.json");
    assert_eq!(other["lens"], "HR 50 No. 1187");
    assert_eq!(other["laboratory"], "Test range");
    assert_eq!(other["date"], "2026-05-17");
    assert_eq!(other["permission"]["store"], 7);
    assert_ne!(other["signature"], json(&bench, "my.json")["signature"]);
    fs::write(bench.path("stored.json"), stored.replace("5282", "5283")).unwrap();
    sign(&["--over", "stored.json"]).refused(&["\"5283\"", "\"5282\""]);
    fs::write(
        bench.path("stored.json"),
        "{\"calibration\": null, \"store\": null}",
    )
    .unwrap();
    sign(&["--over", "stored.json"]).refused(&["stored.json: no calibration is stored"]);
    fs::write(
        bench.path("details.toml"),
        details.replace("HR 50", &"x".repeat(33)),
    )
    .unwrap();
    sign(&["--details", "details.toml"]).refused(&["details.toml: the lens has more than 32"]);
}

#[test]
fn what_cannot_be_signed_is_named_and_nothing_is_written() {
    let bench = Bench::new();
    let before = bench.files();
    let key = test_key();
    let sign = |camera: &str, key: &str, out: &str| {
        bench.run(&["sign", "--camera", camera, "--key", key, "--out", out])
    };
    sign("camera.toml", &key, "my.json").refused(&["camera.toml: serial is missing"]);
    sign("none.toml", &key, "my.json").refused(&["none.toml"]);
    sign("camera.toml", "points.csv", "my.json").refused(&["points.csv: no private key"]);
    sign("camera.toml", &key, "camera.toml").refused(&["camera.toml, which is read"]);
    bench.run(&["sign"]).refused(&["--camera"]);
    assert_eq!(bench.files(), before);
    let unversioned = format!("serial = \"5282\"\n{CAMERA}");
    fs::write(bench.path("signed.toml"), unversioned).unwrap();
    sign("signed.toml", &key, "my.json").refused(&["signed.toml: version is missing", "rise"]);
}
