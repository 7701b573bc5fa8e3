//! Differences that radiometric corrections leave in flats.

use fmc_composition::scene::Scene;
use fmc_report::composition::page::Section;

use super::findings::{Check, Findings};
use crate::command::composition::radiometry::Radiometry;

/// Levels at which the radiometry is judged, with what may be left, percent.
const LEVELS: [(f64, f64); 4] = [(0.1, 0.4), (0.3, 0.2), (0.6, 0.2), (0.9, 0.2)];

/// Table of what the corrections leave of flats.
pub(super) fn judge(scene: &Scene, methods: [&Radiometry; 2], findings: &mut Findings) {
    let mut rows = Vec::new();
    for (level, limit) in LEVELS {
        let worst = methods.map(|method| {
            let each =
                method
                    .detectors
                    .iter()
                    .enumerate()
                    .filter_map(|(number, (correction, _))| {
                        let detector = scene.detector(number);
                        scene.uniformity(number, &detector, correction, level)
                    });
            100.0 * each.fold(0.0, f64::max)
        });
        let [own, template] = worst;
        rows.push(vec![
            format!("{:.0} %", 100.0 * level),
            format!("{own:.3}"),
            format!("{template:.2}"),
        ]);
        findings.checks.push(Check {
            what: format!(
                "radiometry at {:.0} % of full scale, worst detector, % rms",
                100.0 * level
            ),
            found: own,
            limit: format!("at most {limit}"),
            passed: own > 0.0 && own <= limit,
        });
    }
    findings.sections.push(Section {
        heading: "Radiometry".to_owned(),
        columns: ["level", "offset and gain, % rms", "template of Zhao et al., % rms"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        caption: "What is left of a flat without noise, worst of six detectors. A template that is subtracted is right at the mean level of its flats.".to_owned(),
        ..Section::default()
    });
}
