//! Identity, parameters and static distortion.

use crate::content::Certificate;
use crate::content::distortion::StaticDistortion;
use crate::content::observed::Observed;
use crate::content::parameters::{CalibrationLine, CorrelationMatrix, ParameterSection};
use crate::content::radial::RadialRow;
use crate::details::Instrument;
use crate::document::block::{Block, Figure, Section, Table, numbers, words};
use crate::document::wording::{NOT_STATED, cell, number, pair, place, range, with_unit};
use crate::figure::Drawing;

/// Who, what and when, with the hashes and the conventions.
pub(super) fn identity(certificate: &Certificate) -> Section {
    let identity = &certificate.identity;
    let text = |text: &Option<String>| text.clone().unwrap_or_else(|| NOT_STATED.to_owned());
    let date =
        |date: Option<_>| date.map_or_else(|| NOT_STATED.to_owned(), |date| format!("{date}"));
    let laboratory = &identity.laboratory;
    let file = &identity.camera_file;
    let mut pairs = vec![
        pair("certificate number", text(&identity.number)),
        pair("camera", instrument(&identity.camera)),
        pair("name in the camera file", identity.name.clone()),
        pair(
            "version of the calibration",
            identity
                .calibration_version
                .map_or_else(|| NOT_STATED.to_owned(), |version| version.to_string()),
        ),
        pair("lens", instrument(&identity.lens)),
        pair("stage", instrument(&identity.stage)),
        pair("encoder", instrument(&identity.encoder)),
        pair("laboratory", text(&laboratory.name)),
        pair("address", text(&laboratory.address)),
        pair("accreditation", text(&laboratory.accreditation)),
        pair("calibrated on", date(identity.calibrated_on)),
        pair("issued on", date(identity.issued_on)),
        pair("valid until", date(identity.valid_until)),
        pair("procedure", text(&identity.procedure)),
        pair("traceability", text(&identity.traceability)),
        pair("environment", text(&identity.environment)),
        pair("remarks", text(&identity.remarks)),
        pair("software", identity.software.clone()),
        pair("camera file", file.name.clone()),
        pair("SHA-256 of the camera file", file.sha256.clone()),
        pair("CRC-32 in every frame record", file.crc32.clone()),
    ];
    if let Some(key) = &identity.signing_key_sha256 {
        pairs.push(pair("SHA-256 of the signing key", key.clone()));
    }
    let mut blocks = vec![Block::Pairs(pairs)];
    if file.crc32_depends_on_settings {
        blocks.push(Block::Text(
            "The camera file states no largest V/H. The CRC-32 is that of a flight with the \
             default settings; with other settings the records may carry another one, unless the \
             file states the limit."
                .to_owned(),
        ));
    }
    blocks.extend(certificate.conventions.iter().cloned().map(Block::Text));
    Section {
        title: "Identity".to_owned(),
        blocks,
    }
}

fn instrument(instrument: &Instrument) -> String {
    let part = |text: &Option<String>| text.clone().unwrap_or_default();
    let name = [part(&instrument.maker), part(&instrument.model)];
    let name: Vec<String> = name.into_iter().filter(|part| !part.is_empty()).collect();
    let name = if name.is_empty() {
        format!("make {NOT_STATED}")
    } else {
        name.join(" ")
    };
    match &instrument.serial {
        Some(serial) => format!("{name}, serial number {serial}"),
        None if name.starts_with("make") => NOT_STATED.to_owned(),
        None => format!("{name}, serial number {NOT_STATED}"),
    }
}

/// Parameters with σ, and how they were found.
pub(super) fn parameters(certificate: &Certificate) -> Section {
    let parameters = &certificate.parameters;
    let [columns, rows] = parameters.size_px;
    let mut blocks = vec![Block::Pairs(vec![
        pair("array", format!("{columns} x {rows} px")),
        pair("pixel pitch", with_unit(parameters.pixel_um.as_ref(), "µm")),
        pair("format", {
            let [width, height] = &parameters.format_mm;
            let [width, height] = [width, height].map(|side| number(side.as_ref()));
            format!("{width} x {height} mm")
        }),
    ])];
    blocks.push(Block::Table(values(parameters)));
    if parameters.calibrations.is_empty() {
        blocks.push(Block::Text(format!(
            "How the parameters were found, their standard deviations and correlations, \
             observations, redundancy, residuals, gross errors, and the part of the sensor that \
             was observed: {NOT_STATED}."
        )));
    }
    blocks.extend(parameters.calibrations.iter().map(calibration));
    blocks.extend(parameters.correlations.iter().map(correlations));
    match &parameters.observed {
        Some(observed) => blocks.push(Block::Text(observed_text(observed))),
        None if !parameters.calibrations.is_empty() => blocks.push(Block::Text(format!(
            "How far out points were observed, and which part of the sensor is extrapolated: \
             {NOT_STATED}."
        ))),
        None => {}
    }
    Section {
        title: "Parameters".to_owned(),
        blocks,
    }
}

fn values(parameters: &ParameterSection) -> Table {
    let rows = parameters.values.iter().map(|line| {
        vec![
            line.symbol.clone(),
            line.name.clone(),
            number(line.value.as_ref()),
            number(line.sigma.as_ref()),
            line.unit.to_owned(),
            line.calibration.clone().unwrap_or_default(),
        ]
    });
    Table {
        title: "Parameters; distortion as measured minus ideal".to_owned(),
        columns: vec![
            words("symbol"),
            words("name"),
            numbers("value"),
            numbers("σ"),
            words("unit"),
            words("σ from"),
        ],
        rows: rows.collect(),
    }
}

fn calibration(line: &CalibrationLine) -> Block {
    let count =
        |count: Option<u64>| count.map_or_else(|| NOT_STATED.to_owned(), |count| count.to_string());
    let text = |text: &Option<String>| text.clone().unwrap_or_else(|| NOT_STATED.to_owned());
    let mut pairs = vec![
        pair("calibration", line.file.clone()),
        pair("SHA-256", line.sha256.clone()),
        pair("method", text(&line.method)),
        pair("datum", text(&line.datum)),
        pair("observations", count(line.observations)),
        pair("unknowns", count(line.unknowns)),
        pair("redundancy", number(line.redundancy.as_ref())),
        pair("σ0", with_unit(line.sigma0.as_ref(), line.sigma0_unit)),
        pair(
            "RMS of the residuals",
            with_unit(line.rms_um.as_ref(), "µm"),
        ),
        pair(
            "largest residual",
            with_unit(line.largest_um.as_ref(), "µm"),
        ),
        pair("gross errors rejected", count(line.rejected)),
        pair("iterations", count(line.iterations)),
    ];
    if !line.held_grids.is_empty() {
        let held = line.held_grids.join("; ");
        pairs.push(pair("residual grids held", held));
    }
    pairs.extend(
        line.warnings
            .iter()
            .map(|warning| pair("warning", warning.clone())),
    );
    Block::Pairs(pairs)
}

fn correlations(matrix: &CorrelationMatrix) -> Block {
    let columns = matrix
        .names
        .iter()
        .map(|name| numbers(&name.replace('_', "\n")));
    let rows = matrix.names.iter().zip(&matrix.rows).map(|(name, row)| {
        let cells = row.iter().map(|stated| cell(stated.as_ref()));
        std::iter::once(name.clone()).chain(cells).collect()
    });
    Block::Table(Table {
        title: format!("Correlations, {}", matrix.calibration),
        columns: std::iter::once(words("")).chain(columns).collect(),
        rows: rows.collect(),
    })
}

fn observed_text(observed: &Observed) -> String {
    if observed.is_a_line {
        return format!(
            "Points were observed along one line, up to {} from the principal point, x {}, y {}; \
             the farthest corner of the sensor is at {}. What does not turn about the optical \
             axis, decentring and affinity, shows on no line: off it the polynomial is \
             extrapolated.",
            with_unit(observed.radius_mm.as_ref(), "mm"),
            range(&observed.x_mm, "mm"),
            range(&observed.y_mm, "mm"),
            with_unit(observed.corner_radius_mm.as_ref(), "mm"),
        );
    }
    format!(
        "Points were observed up to {} from the principal point, x {}, y {}; the farthest corner \
         of the sensor is at {}. Of the sensor's area {} lies beyond: there the polynomial is \
         extrapolated.",
        with_unit(observed.radius_mm.as_ref(), "mm"),
        range(&observed.x_mm, "mm"),
        range(&observed.y_mm, "mm"),
        with_unit(observed.corner_radius_mm.as_ref(), "mm"),
        with_unit(observed.extrapolated_percent.as_ref(), "%"),
    )
}

/// Distortion of the camera at rest.
pub(super) fn distortion(certificate: &Certificate) -> Section {
    let distortion = &certificate.static_distortion;
    let mm = |stated: &Option<_>| with_unit(Option::as_ref(stated), "mm");
    let um = |stated: &Option<_>| with_unit(Option::as_ref(stated), "µm");
    let axis = match &distortion.decentring_axis_deg {
        Some(axis) => format!("{axis}° from +x towards +y"),
        None => "no decentring".to_owned(),
    };
    let blocks = vec![
        Block::Text(format!(
            "f is the principal distance that goes with the coefficients as they stand. K0 is a \
             gauge: coefficients with K0 at f describe the same rays as the others divided by \
             1 - K0, without K0, at f/(1 - K0) = {}, which is what programs without K0 are given. \
             Gaussian radial distortion is counted from f; balanced radial distortion from the \
             principal distance {}, at which its largest value over the sensor is least.",
            mm(&distortion.principal_distance_without_k0_mm),
            mm(&distortion.balanced_principal_distance_mm),
        )),
        Block::Pairs(vec![
            pair(
                "largest distortion",
                format!(
                    "{}, at {}",
                    um(&distortion.largest_um),
                    place(&distortion.largest_at_mm)
                ),
            ),
            pair(
                "largest radial, Gaussian",
                um(&distortion.gaussian_largest_um),
            ),
            pair(
                "largest radial, balanced",
                um(&distortion.balanced_largest_um),
            ),
            pair("axis of the decentring", axis),
            pair(
                "largest effect of B1, B2",
                um(&distortion.affinity_largest_um),
            ),
        ]),
        Block::Figures(vec![
            Figure {
                drawing: Drawing::vectors(certificate),
                caption: "Distortion of the camera at rest, measured minus ideal: each arrow \
                          starts at a measured point."
                    .to_owned(),
            },
            Figure {
                drawing: Drawing::radial(distortion),
                caption: radial_caption(distortion),
            },
        ]),
        Block::Table(radial_table("At even field angles", &distortion.at_angles)),
        Block::Table(radial_table(
            "At even distances from the principal point; the last is the farthest corner",
            &distortion.at_radii,
        )),
        Block::Text(format!(
            "σ is that of the radial distortion at f, from those of K0 to K3 and their \
             correlations{}. Decentring: P(r) = r²·√(P1² + P2²); its tangential component is at \
             most P(r), its radial component at most three times P(r).",
            if has_sigma(distortion) {
                String::new()
            } else {
                format!(": {NOT_STATED}")
            }
        )),
    ];
    Section {
        title: "Static distortion".to_owned(),
        blocks,
    }
}

fn has_sigma(distortion: &StaticDistortion) -> bool {
    distortion.profile.iter().any(|row| row.sigma_um.is_some())
}

fn radial_caption(distortion: &StaticDistortion) -> String {
    let band = if has_sigma(distortion) {
        "the band is ±1 σ".to_owned()
    } else {
        format!("σ {NOT_STATED}")
    };
    format!(
        "Radial distortion over the radius of the measured point, Gaussian and balanced, and the \
         decentring profile; {band}."
    )
}

fn radial_table(title: &str, rows: &[RadialRow]) -> Table {
    let row = |row: &RadialRow| {
        vec![
            cell(row.angle_deg.as_ref()),
            cell(row.radius_mm.as_ref()),
            cell(row.gaussian_um.as_ref()),
            cell(row.balanced_um.as_ref()),
            cell(row.sigma_um.as_ref()),
            cell(row.decentring_um.as_ref()),
        ]
    };
    Table {
        title: title.to_owned(),
        columns: vec![
            numbers("field angle\n°"),
            numbers("radius, measured\nmm"),
            numbers("radial, Gaussian\nµm"),
            numbers("radial, balanced\nµm"),
            numbers("σ\nµm"),
            numbers("decentring P(r)\nµm"),
        ],
        rows: rows.iter().map(row).collect(),
    }
}
