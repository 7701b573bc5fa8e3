//! A folder with everything that a certificate is made of.

use std::fs;

use fmc_certificate::pdf_reader::ReadPdf;
use serde_json::Value;

use super::super::support::{Answer, Bench};

/// Private key of RFC 8410, section 10.3.
pub(super) const KEY: &str = "-----BEGIN PRIVATE KEY-----\n\
                              MC4CAQAwBQYDK2VwBCIEINTuctv5E1hK1bbY8fdp+K06/nwoy/HU++CXqI9EdVhC\n\
                              -----END PRIVATE KEY-----\n";

pub(super) const DETAILS: &str = r#"number = "2026-0117"
calibrated_on = 2026-03-14
issued_on = 2026-03-20
valid_until = 2028-03-14
procedure = "Test field, images rolled by a right angle."
[laboratory]
name = "Optical laboratory"
[lens]
maker = "Rodenstock"
serial = "RS-192"
[[person]]
name = "A. Berg"
role = "head of the laboratory"
"#;

/// Calibration of the camera of `Bench`, with σ and correlations.
pub(super) const SUMMARY: &str = r#"{"method":"bundle","camera":"Test camera","sigma0":1.0234,
"redundancy":20812,"datum":"control","observations":21650,"unknowns":838,"residual_rms_um":0.412,
"residual_max_um":1.83,"iterations":6,"rejected":[{"image":"a","point":"7"}],"warnings":[],
"parameters":[{"name":"principal_distance_mm","value":100.0,"sigma":0.00074},
{"name":"x0_mm","value":0.02,"sigma":0.0013},{"name":"y0_mm","value":-0.01,"sigma":0.00093},
{"name":"k1","value":-1e-6,"sigma":2.3e-10},{"name":"k2","value":2e-10,"sigma":7.1e-14},
{"name":"k3","value":0,"sigma":0}],
"correlations":[{"a":"k1","b":"k2","value":-0.96},{"a":"principal_distance_mm","b":"k1","value":0.31}],
"observed":{"radius_mm":48.5,"x_mm":[-38.0,38.5],"y_mm":[-39.0,37.5]}}"#;

/// Writes details, summary and key beside the camera file.
pub(super) fn bench() -> Bench {
    let bench = Bench::new();
    for (name, text) in [
        ("details.toml", DETAILS),
        ("summary.json", SUMMARY),
        ("key.pem", KEY),
    ] {
        fs::write(bench.path(name), text).unwrap();
    }
    bench
}

/// Makes a certificate in the folder `out`, with more arguments.
pub(super) fn make(bench: &Bench, more: &[&str]) -> Answer {
    let mut arguments = vec!["certificate", "--camera", "camera.toml", "--out", "out"];
    arguments.extend(more);
    bench.run(&arguments)
}

/// Arguments of a certificate with all that it can state.
pub(super) const ALL: [&str; 6] = [
    "--details",
    "details.toml",
    "--calibration",
    "summary.json",
    "--sign",
    "key.pem",
];

pub(super) fn content(bench: &Bench) -> Value {
    let text = fs::read_to_string(bench.path("out/certificate.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

pub(super) fn pdf(bench: &Bench) -> ReadPdf {
    ReadPdf::parse(&fs::read(bench.path("out/certificate.pdf")).unwrap()).unwrap()
}
