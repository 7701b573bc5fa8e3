//! `dmz`: the publication repeated, its way beside ours, against truth.

mod figure;
mod findings;
mod images;
mod pair;
mod places;
mod relief;
mod uniformity;

use fmc_composition::scene::Scene;
use fmc_report::composition::page::CompositionPage;

use findings::Findings;

use super::scene as scene_command;
use crate::cli::DmzArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

/// Runs `dmz`.
pub(in crate::command) fn run(args: &DmzArgs) -> Result<(), Failure> {
    let scene = Scene::new(scene_command::request(&args.scene));
    let folder = OutputFolder::create(&args.out)?;
    let of_scene = OutputFolder::create(&folder.path().join("scene"))?;
    scene_command::write(&scene, &of_scene, 4)?;
    let mut findings = Findings::default();
    let ways = images::compose(&scene, &of_scene, &folder, &mut findings)?;
    relief::over_relief(&scene.request, ways.both(), &mut findings)?;
    pair::stereo(&scene, &ways.rig, &ways.planes, &mut findings)?;
    let passed = findings.checks.iter().all(|check| check.passed);
    let failed: Vec<&str> = findings
        .checks
        .iter()
        .filter(|check| !check.passed)
        .map(|check| check.what.as_str())
        .collect();
    let page = CompositionPage {
        title: format!("{}: Zhao et al. 2013, and beside it", scene.rig.name),
        findings: findings.lines.clone(),
        sections: std::iter::once(findings.table())
            .chain(findings.sections)
            .collect(),
        passed: Some(passed),
    };
    let html = page
        .html()
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    folder.write("report.html", |sink| sink.write_all(html.as_bytes()))?;
    folder.write_json("summary.json", &findings.checks)?;
    output::write(None, |sink| {
        for line in &findings.lines {
            writeln!(sink, "{line}")?;
        }
        for check in &findings.checks {
            let verdict = if check.passed { "passed" } else { "FAILED" };
            writeln!(
                sink,
                "{verdict}: {}: {:.3}; {}",
                check.what, check.found, check.limit
            )?;
        }
        Ok(())
    })?;
    note(format_args!(
        "{}: report.html, figure.svg, summary.json, scene, virtual_8_10, virtual_8_11",
        folder.path().display()
    ));
    if passed {
        Ok(())
    } else {
        Err(Failure::check(format!(
            "beyond its limit: {}",
            failed.join("; ")
        )))
    }
}
