//! Check of a certificate: signature, hashes, and that its files say the same.

use std::collections::BTreeMap;

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::{CameraFile, InputError};
use fmc_report::hash;
use serde::Deserialize;

use crate::bundle::{HTML, JSON, PDF, PUBLIC_KEY, SIGNATURE, SUMS};
use crate::content::parameters;
use crate::content::residual::is_plain;
use crate::flown_calibrations::FlownCalibrations;
use crate::pdf_reader::ReadPdf;
use crate::signature::PublicKey;

/// One statement of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statement {
    /// `true` if this is as it must be.
    pub passed: bool,
    /// Things compared, with both sides where they differ.
    pub text: String,
}

/// The files of a certificate as they were found, by name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// The keys of `certificate.json` that are compared.
#[derive(Debug, Deserialize)]
pub struct Stated {
    identity: Identity,
    parameters: Parameters,
    #[serde(default)]
    residual_grids: ResidualGrids,
}

#[derive(Debug, Default, Deserialize)]
struct ResidualGrids {
    grids: Vec<GridIdentity>,
}

#[derive(Debug, Deserialize)]
struct GridIdentity {
    part: String,
    file: String,
    sha256: String,
    crc32: String,
}

#[derive(Debug, Deserialize)]
struct Identity {
    camera_file: CameraFileIdentity,
    signing_key_sha256: Option<String>,
}

#[derive(Debug, Deserialize)]
struct CameraFileIdentity {
    name: String,
    sha256: String,
    crc32: String,
    crc32_depends_on_settings: bool,
}

#[derive(Debug, Deserialize)]
struct Parameters {
    values: Vec<Parameter>,
}

#[derive(Debug, Deserialize)]
struct Parameter {
    name: String,
    value: Option<f64>,
}

impl Stated {
    /// Reads `certificate.json`; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] for a file that is none, or names a camera file outside of its folder.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, InputError> {
        let stated: Self = serde_json::from_slice(bytes)
            .map_err(|error| InputError::invalid(format!("{file}: no certificate: {error}")))?;
        for (name, what) in [(stated.camera_file(), "a camera file")]
            .into_iter()
            .chain(stated.grid_files().map(|name| (name, "a residual grid")))
        {
            if !is_plain(name) {
                return Err(InputError::invalid(format!(
                    "{file}: {name:?} is no name of {what} in this folder"
                )));
            }
        }
        Ok(stated)
    }

    /// Name of the camera file, without folders.
    #[must_use]
    pub fn camera_file(&self) -> &str {
        &self.identity.camera_file.name
    }

    /// Names of the files of residual grids, without folders.
    pub fn grid_files(&self) -> impl Iterator<Item = &str> {
        self.residual_grids
            .grids
            .iter()
            .map(|grid| grid.file.as_str())
    }
}

/// Checks the files of a certificate; `key` is the public key that must have signed, and `records`
/// are those of a flight that must have used this calibration.
#[must_use]
pub fn statements(
    stated: &Stated,
    files: &Files,
    key: Option<&PublicKey>,
    records: Option<&FlownCalibrations>,
) -> Vec<Statement> {
    let mut comparison = Comparison {
        stated,
        files,
        statements: Vec::new(),
    };
    comparison.camera_file();
    comparison.hashes();
    comparison.pdf();
    comparison.html();
    comparison.signature(key);
    if let Some(records) = records {
        comparison.records(records);
    }
    comparison.statements
}

/// Largest difference of a number that was written with all its digits and read, as a share of it.
const ROUNDING: f64 = 1e-15;

fn is_same(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= ROUNDING * b.abs(),
        (a, b) => a.is_none() && b.is_none(),
    }
}

struct Comparison<'a> {
    stated: &'a Stated,
    files: &'a Files,
    statements: Vec<Statement>,
}

impl<'a> Comparison<'a> {
    fn note(&mut self, passed: bool, text: String) {
        self.statements.push(Statement { passed, text });
    }

    /// Returns a file, or notes that it is missing.
    fn file(&mut self, name: &str) -> Option<&'a [u8]> {
        let file = self.files.get(name).map(Vec::as_slice);
        if file.is_none() {
            self.note(false, format!("{name}: there is no such file"));
        }
        file
    }

    fn camera_file(&mut self) {
        let stated = &self.stated.identity.camera_file;
        let Some(bytes) = self.file(&stated.name) else {
            return;
        };
        let found = hash::sha256(bytes);
        if found == stated.sha256 {
            self.note(true, format!("{}: SHA-256 {found}", stated.name));
        } else {
            self.note(
                false,
                format!(
                    "{}: changed since: its SHA-256 is {found}, the certificate is for {}",
                    stated.name, stated.sha256
                ),
            );
        }
        let parsed = String::from_utf8(bytes.to_vec())
            .map_err(|error| error.to_string())
            .and_then(|text| self.parsed(&text).map_err(|error| error.to_string()));
        match parsed {
            Err(error) => self.note(false, error),
            Ok(camera) => {
                self.numbers(&camera);
                self.grids(&camera);
            }
        }
    }

    /// Reads the camera file, with its grids from the files that were found.
    fn parsed(&self, text: &str) -> Result<CameraFile, InputError> {
        let name = &self.stated.identity.camera_file.name;
        let read = |grid: &str| {
            self.files.get(grid).cloned().ok_or_else(|| {
                InputError::invalid(format!(
                    "{grid}: there is no such file, and {name} needs it"
                ))
            })
        };
        let (camera, _, _) = CameraFile::parse_with_grids(name, text, &read)?;
        Ok(camera)
    }

    /// Compares the residual grids that the camera file names with those of the content.
    fn grids(&mut self, camera: &CameraFile) {
        let stated = &self.stated.residual_grids.grids;
        for (part, carrier) in [("lens", GridCarrier::Lens), ("sensor", GridCarrier::Sensor)] {
            let line = stated.iter().find(|grid| grid.part == part);
            match (line, camera.grid_name(carrier)) {
                (None, None) => {}
                (Some(line), Some(name)) if line.file == name => {
                    let bytes = self.files.get(name).map(Vec::as_slice).unwrap_or_default();
                    let found = hash::sha256(bytes);
                    let passed = found == line.sha256;
                    let text = if passed {
                        format!("{name}: SHA-256 {found}, CRC-32 {}", line.crc32)
                    } else {
                        format!(
                            "{name}: changed since: its SHA-256 is {found}, the certificate is for {}",
                            line.sha256
                        )
                    };
                    self.note(passed, text);
                }
                (line, name) => {
                    let stated = line.map_or("none", |line| line.file.as_str());
                    let name = name.unwrap_or("none");
                    self.note(
                        false,
                        format!(
                            "residual grid of the {part}: the camera file names {name}, {JSON} {stated}"
                        ),
                    );
                }
            }
        }
    }

    /// Compares the camera file's CRC-32 and parameters with those of the content.
    fn numbers(&mut self, camera: &CameraFile) {
        let stated = &self.stated.identity.camera_file;
        let crc = hash::crc32(camera);
        self.note(
            crc == stated.crc32,
            if crc == stated.crc32 {
                format!("{}: CRC-32 {crc}", stated.name)
            } else {
                format!(
                    "{}: its CRC-32 is {crc}, the certificate is for {}",
                    stated.name, stated.crc32
                )
            },
        );
        let values = &self.stated.parameters.values;
        let differing: Vec<String> = parameters::in_file(camera)
            .into_iter()
            .filter_map(|(name, in_file)| {
                let line = values.iter().find(|line| line.name == name);
                let stated = line.and_then(|line| line.value);
                let is_same = is_same(stated, in_file);
                let text = |value: Option<f64>| {
                    value.map_or_else(|| "nothing".to_owned(), |value| value.to_string())
                };
                (!is_same).then(|| {
                    format!(
                        "{name}: the camera file has {}, {JSON} {}",
                        text(in_file),
                        text(stated)
                    )
                })
            })
            .collect();
        if differing.is_empty() {
            self.note(true, format!("{JSON}: the parameters of the camera file"));
        }
        for text in differing {
            self.note(false, text);
        }
    }

    fn hashes(&mut self) {
        let Some(list) = self.file(SUMS) else {
            return;
        };
        let list = String::from_utf8_lossy(list);
        let entries: BTreeMap<&str, &str> = list
            .lines()
            .filter_map(|line| line.split_once("  "))
            .map(|(hash, name)| (name, hash))
            .collect();
        let stated = self.stated;
        for name in [PDF, HTML, JSON, stated.camera_file()]
            .into_iter()
            .chain(stated.grid_files())
        {
            let Some(bytes) = self.file(name) else {
                continue;
            };
            let found = hash::sha256(bytes);
            match entries.get(name) {
                Some(listed) if *listed == found => {
                    self.note(true, format!("{name}: as listed in {SUMS}"));
                }
                Some(listed) => self.note(
                    false,
                    format!("{name}: its SHA-256 is {found}, {SUMS} has {listed}"),
                ),
                None => self.note(false, format!("{name}: not listed in {SUMS}")),
            }
        }
    }

    fn pdf(&mut self) {
        let Some(bytes) = self.file(PDF) else {
            return;
        };
        let pdf = match ReadPdf::parse(bytes) {
            Ok(pdf) => pdf,
            Err(error) => return self.note(false, format!("{PDF}: cannot be read: {error}")),
        };
        let stated = self.stated;
        for name in [stated.camera_file(), JSON]
            .into_iter()
            .chain(stated.grid_files())
        {
            let is_same = pdf.attachments.get(name) == self.files.get(name);
            let verb = if is_same { "is" } else { "is not" };
            self.note(
                is_same,
                format!("{PDF}: the attached {name} {verb} that of the folder"),
            );
        }
        self.pages(PDF, &pdf.words());
    }

    fn html(&mut self) {
        let Some(bytes) = self.file(HTML) else {
            return;
        };
        let page = String::from_utf8_lossy(bytes);
        let texts = page.split('<').filter_map(|part| part.split('>').nth(1));
        let words: Vec<&str> = texts.flat_map(str::split_whitespace).collect();
        self.pages(HTML, &words);
    }

    /// Notes what the words of the pages do not say.
    fn pages(&mut self, file: &str, words: &[&str]) {
        let missing: Vec<String> = self
            .facts()
            .into_iter()
            .filter(|fact| {
                !words
                    .windows(fact.len())
                    .any(|found| found == fact.as_slice())
            })
            .map(|fact| fact.join(" "))
            .collect();
        self.same_words(file, &missing);
    }

    fn same_words(&mut self, file: &str, missing: &[String]) {
        if missing.is_empty() {
            let text = format!("{file}: hashes and parameters of the camera file");
            self.note(true, text);
        } else {
            let text = format!("{file}: does not say: {}", missing.join("; "));
            self.note(false, text);
        }
    }

    /// Returns what the pages must say: the hashes of the camera file, and each of its parameters
    /// behind its name.
    fn facts(&self) -> Vec<Vec<String>> {
        let stated = &self.stated.identity.camera_file;
        let bytes = self.files.get(&stated.name).cloned().unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let mut facts = vec![vec![hash::sha256(&bytes)]];
        if let Ok(camera) = self.parsed(&text) {
            facts.push(vec![hash::crc32(&camera)]);
            for (name, value) in parameters::in_file(&camera) {
                if let Some(value) = value.and_then(crate::stated::Stated::exact) {
                    facts.push(vec![name.to_owned(), value.text().to_owned()]);
                }
            }
        }
        for grid in &self.stated.residual_grids.grids {
            facts.push(vec![grid.file.clone(), grid.crc32.clone()]);
            facts.push(vec![grid.sha256.clone()]);
        }
        facts
    }

    fn signature(&mut self, key: Option<&PublicKey>) {
        let stated = self.stated.identity.signing_key_sha256.as_deref();
        let signature = self.files.get(SIGNATURE);
        if signature.is_none() && stated.is_none() && key.is_none() {
            return self.note(true, "not signed".to_owned());
        }
        let (Some(signature), Some(list)) = (self.file(SIGNATURE), self.file(SUMS)) else {
            return;
        };
        let in_folder = || {
            let text = String::from_utf8_lossy(self.files.get(PUBLIC_KEY)?);
            PublicKey::parse(PUBLIC_KEY, &text).ok()
        };
        let Some(used) = key.cloned().or_else(in_folder) else {
            return self.note(false, format!("{PUBLIC_KEY}: no public key of Ed25519"));
        };
        let sha256 = used.sha256().unwrap_or_default();
        let passed = used.verifies(list, signature);
        let whose = match key {
            Some(_) => "the key given",
            None => "the key in the folder; --key compares it with one you know",
        };
        let verb = if passed { "is" } else { "is not" };
        self.note(
            passed,
            format!("{SIGNATURE}: {verb} the signature by the key of SHA-256 {sha256}, {whose}"),
        );
        if stated != Some(sha256.as_str()) {
            let stated = stated.unwrap_or("none");
            self.note(
                false,
                format!("{JSON}: names the key of SHA-256 {stated}, not {sha256}"),
            );
        }
    }

    fn records(&mut self, records: &FlownCalibrations) {
        let stated = &self.stated.identity.camera_file;
        let count = records.count();
        let file = &records.file;
        let others: Vec<String> = records
            .calibrations
            .iter()
            .filter(|(crc, _)| **crc != stated.crc32)
            .map(|(crc, (count, first))| format!("{count} with {crc}, the first is {first}"))
            .collect();
        if others.is_empty() {
            let text = format!("{file}: all {count} records carry CRC-32 {}", stated.crc32);
            return self.note(true, text);
        }
        let advice = if stated.crc32_depends_on_settings {
            "; the camera file states no largest V/H, so that a flight with other than the default \
             settings carries another CRC-32"
        } else {
            ""
        };
        self.note(
            false,
            format!(
                "{file}: not all of {count} records carry CRC-32 {}: {}{advice}",
                stated.crc32,
                others.join("; ")
            ),
        );
    }
}
