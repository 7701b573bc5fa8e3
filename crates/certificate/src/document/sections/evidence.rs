//! Proof, exchange and signatures.

use crate::content::Certificate;
use crate::document::block::{Block, Section, Table, numbers, words};
use crate::document::wording::{NOT_STATED, cell, number, pair, place, range, with_unit};

/// Comparison with the strict solver.
pub(super) fn proof(certificate: &Certificate) -> Section {
    let proof = &certificate.proof;
    let nm = |stated: &Option<_>| with_unit(Option::as_ref(stated), "nm");
    let um = |stated: &Option<_>| with_unit(Option::as_ref(stated), "µm");
    let verdict = match (proof.passed, proof.points) {
        (true, _) => "passed",
        (false, 0) => "not checked: stroke or speed forbid every exposure of the comparison",
        (false, _) => "FAILED",
    };
    let pairs = vec![
        pair("verdict", verdict),
        pair("computed by", proof.device.clone()),
        pair(
            "points",
            match proof.forbidden {
                0 => format!("{} in {} exposures", proof.points, proof.exposures),
                forbidden => format!(
                    "{} in {} exposures; {forbidden} that stroke or speed forbid are left out",
                    proof.points, proof.exposures
                ),
            },
        ),
        pair("range of V/H", range(&proof.vh_per_s, "1/s")),
        pair("range of the exposure", range(&proof.exposure_ms, "ms")),
        pair("range of δ", range(&proof.travel_um, "µm")),
        pair(
            "largest error of dx, dy",
            format!(
                "{} at {}, limit {}",
                nm(&proof.error_max_nm),
                place(&proof.error_at_mm),
                nm(&proof.error_limit_nm)
            ),
        ),
        pair("RMS error of dx, dy", nm(&proof.error_rms_nm)),
        pair(
            "largest error of a coordinate",
            format!(
                "{}, limit {}",
                nm(&proof.coordinate_max_nm),
                nm(&proof.coordinate_limit_nm)
            ),
        ),
        pair(
            "static calibration instead",
            format!(
                "{} largest, {} RMS",
                um(&proof.static_max_um),
                um(&proof.static_rms_um)
            ),
        ),
        pair(
            "error of the strict solver",
            format!(
                "at most {}, limit {}",
                nm(&proof.solver_error_nm),
                nm(&proof.solver_limit_nm)
            ),
        ),
        pair(
            "least scale",
            format!("{}: one-to-one above 0", number(proof.least_scale.as_ref())),
        ),
    ];
    Section {
        title: "Proof".to_owned(),
        blocks: vec![
            Block::Text(
                "The correction that the camera computes in single precision, compared with the \
                 exposure mean of the same calibration by quadrature in double precision, over the \
                 whole sensor, with both run-up strategies of a stage. It shows that the camera \
                 applies this calibration; it does not show that the calibration is that of the \
                 lens."
                    .to_owned(),
            ),
            Block::Pairs(pairs),
        ],
    }
}

/// A line per program.
pub(super) fn exchange(certificate: &Certificate) -> Section {
    let rows = certificate.exchange.iter().map(|line| {
        let remark = match (&line.refused, line.not_held.is_empty()) {
            (Some(reason), _) => format!("not written: {reason}"),
            (None, true) => String::new(),
            (None, false) => format!("no place for {}", line.not_held.join(", ")),
        };
        vec![
            line.format.to_owned(),
            line.model.unwrap_or("–").to_owned(),
            cell(line.residual_max_um.as_ref()),
            cell(line.residual_rms_um.as_ref()),
            cell(line.residual_max_px.as_ref()),
            remark,
        ]
    });
    let table = Table {
        title: "Residual over the sensor, of the camera at its calibrated position".to_owned(),
        columns: vec![
            words("format"),
            words("model"),
            numbers("largest\nµm"),
            numbers("RMS\nµm"),
            numbers("largest\npx"),
            words("remark"),
        ],
        rows: rows.collect(),
    };
    Section {
        title: "Exchange".to_owned(),
        blocks: vec![
            Block::Text(
                "What the camera files of other programs leave of this calibration, with the model \
                 that an export takes unless it is told another."
                    .to_owned(),
            ),
            Block::Table(table),
        ],
    }
}

/// Places to sign.
pub(super) fn signatures(certificate: &Certificate) -> Section {
    let identity = &certificate.identity;
    let name = |text: &Option<String>| text.clone().unwrap_or_else(|| NOT_STATED.to_owned());
    let mut places: Vec<[String; 2]> = identity
        .persons
        .iter()
        .map(|person| [name(&person.name), name(&person.role)])
        .collect();
    if places.is_empty() {
        places.push([format!("name {NOT_STATED}"), format!("role {NOT_STATED}")]);
    }
    let how = match &identity.signing_key_sha256 {
        Some(key) => format!(
            "The files of this certificate are listed with their SHA-256 in SHA256SUMS, which is \
             signed (Ed25519) in SHA256SUMS.sig by the key whose SHA-256 is {key}."
        ),
        None => "The files of this certificate are listed with their SHA-256 in SHA256SUMS, which \
                 is not signed."
            .to_owned(),
    };
    Section {
        title: "Signatures".to_owned(),
        blocks: vec![Block::Text(how), Block::Signatures(places)],
    }
}
