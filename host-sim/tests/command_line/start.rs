//! The commands of `docs/start.md`, in its order.

use std::fs;

use crate::command_line::support::Bench;

const PAGE: &str = include_str!("../../../docs/start.md");
const CAMERA: &str = include_str!("../../cameras/phase-one-ixm-rs150f-50.toml");
const OF_THE_MISSION: &str = include_str!("../../scenarios/cameras/mission.toml");
const POINTS: &[u8] = include_bytes!("../../../examples/data/points.csv");

/// Returns kind and text of the blocks of code.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let fences = page.split("```");
    let inside = fences.skip(1).step_by(2);
    inside.filter_map(|block| block.split_once('\n')).collect()
}

#[test]
fn every_command_of_the_page_answers_as_it_shows() {
    let bench = Bench::with(CAMERA, POINTS);
    fs::write(bench.path("mission.toml"), OF_THE_MISSION).unwrap();
    let blocks = blocks(PAGE);
    let (mut run, mut compared) = (0, 0);
    for (place, (kind, text)) in blocks.iter().enumerate() {
        if *kind != "text" {
            continue;
        }
        for line in text.lines() {
            let Some(arguments) = line.strip_prefix("host-sim ") else {
                assert!(line.starts_with("cargo build "), "{line}");
                continue;
            };
            let arguments: Vec<&str> = arguments.split(' ').collect();
            let answer = bench.run(&arguments).ok();
            run += 1;
            if let Some(("output", shown)) = blocks.get(place + 1) {
                assert!(
                    answer.stdout.starts_with(shown),
                    "{line}\n{}",
                    answer.stdout
                );
                compared += 1;
            }
        }
    }
    assert_eq!((run, compared), (6, 3));
    for file in ["lens/export.json", "flight/report.html", "block/images.txt"] {
        assert!(bench.path(file).exists(), "{file}");
    }
}
