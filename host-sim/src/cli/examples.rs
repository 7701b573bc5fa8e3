//! Examples at the end of each command's help. A test parses all of them.

pub(super) const VERIFY: &str = "\
Examples:
  host-sim verify
  host-sim verify --device sil --camera my.toml --out report
  host-sim verify --images";

pub(super) const CORRECT: &str = "\
Examples:
  host-sim correct --camera my.toml --vh 0.1 --exposure 1/200 points.csv
  host-sim correct --camera my.toml --ground-speed 70 --height 700 \\
      --exposure 1/200 --out ideal.npy measured.npy
  host-sim correct --camera my.toml --records records.csv \\
      --answer ideal-shifted points.csv --out ideal.csv
  host-sim correct --camera my.toml --records records.csv \\
      --answer ideal-shifted --list bingo points.csv --out image.dat
  host-sim correct --camera my.toml --records records.csv \\
      --answer ideal-shifted --trajectory sbet.out --origin 47.5,8.2,450 \\
      --orientation orientation.csv points.csv --out ideal.csv";

pub(super) const DISTORT: &str = "\
Examples:
  host-sim distort --camera my.toml --vh 0.1 --exposure 1/200 ideal.csv
  host-sim distort --camera my.toml --vh 70/700 --exposure 1/200 \\
      --out measured.csv ideal.csv";

pub(super) const REFERENCE: &str = "\
Examples:
  host-sim reference --camera my.toml --vh 0.1 --exposure 1/200 points.csv";

pub(super) const FRAME: &str = "\
Examples:
  host-sim frame --camera my.toml --vh 0.1 --exposure 1/200
  host-sim frame --camera my.toml --vh 0.1 --exposure 1/200 --json
  host-sim frame --camera my.toml --records records.csv \\
      --trajectory sbet.out --out frames.csv";

pub(super) const MESH: &str = "\
Examples:
  host-sim mesh --camera host-sim/cameras/rc30-5324.toml --vh 0.1 \\
      --exposure 1/200 --format gpu --out mesh";

pub(super) const RECTIFY: &str = "\
Examples:
  host-sim rectify --camera my.toml --records records.csv --out rectified \\
      IMG_0001.tif IMG_0002.tif
  host-sim rectify --camera my.toml --records records.csv \\
      --frames frames.csv --out rectified --shard 2/8 --keep-going --resume
  host-sim rectify --camera my.toml --vh 0.1 --exposure 1/200 \\
      --resample keys6 --window full --mask --out rectified frame.tif";

pub(super) const RENDER: &str = "\
Examples:
  host-sim render --camera my.toml --vh 0.17 --exposure 1/100 --scale 8 \\
      --out rendered
  host-sim render --camera my.toml --vh 0.1 --exposure 1/200 \\
      --image mosaic.tif --out rendered";

pub(super) const COMPARE: &str = "\
Examples:
  host-sim compare rendered/rectified.tif answer/frame.tif --out difference
  host-sim compare a.tif b.tif --max-px 0.01";

pub(super) const CALIBRATE_FIVE: &str = "\
Examples:
  host-sim calibrate five observations.csv --camera my.toml --out fitted
  host-sim calibrate five observations.csv --camera my.toml \\
      --regress-on centroid";

pub(super) const CALIBRATE_RESECTION: &str = "\
Examples:
  host-sim calibrate resection image_points.csv --points field.csv \\
      --camera my.toml --out calibrated
  host-sim calibrate resection image_points.csv --points board.csv \\
      --camera my.toml --estimate f,x0,y0,k1,k2,p1,p2,b1";

pub(super) const CALIBRATE_BUNDLE: &str = "\
Examples:
  host-sim calibrate bundle image_points.csv --points control.csv \\
      --camera my.toml --out calibrated
  host-sim calibrate bundle image_points.csv --points control.csv \\
      --images flight.csv --camera my.toml --estimate f,x0,y0,boresight \\
      --prior f=0.005
  host-sim calibrate bundle image_points.csv --points control.csv \\
      --camera my.toml --out calibrated --export colmap
  host-sim calibrate bundle image_points.csv --points control.csv \\
      --images flight.csv --camera my.toml --estimate x0,y0 \\
      --records records.csv --out calibrated
  host-sim calibrate bundle image_points.csv --points control.csv \\
      --images flight.csv --camera my.toml --records records.csv \\
      --estimate x0,y0,stage_scale,run_out --prior run_out=0.001";
pub(super) const CALIBRATE_DLT3D: &str = "\
Examples:
  host-sim calibrate dlt3d points.csv --camera my.toml --out calibrated
  host-sim calibrate dlt3d points.csv --camera my.toml \\
      --estimate k1,k2,k3,p1,p2 --out calibrated";

pub(super) const CALIBRATE_DLT2D: &str = "\
Examples:
  host-sim calibrate dlt2d targets.csv --camera my.toml --out table
  host-sim calibrate dlt2d targets.csv --camera my.toml --out table \\
      --grid --pitch-mm 2
  host-sim calibrate dlt2d targets.csv --camera my.toml \\
      --corners 001,015,136,150 --out table";

pub(super) const CALIBRATE_ANGLES: &str = "\
Examples:
  host-sim calibrate angles angles.csv --camera line.toml --out calibrated
  host-sim calibrate angles angles.csv --camera line.toml --along y \\
      --sigma-l-um 1.3 --sigma-angle-arcsec 0.5
  host-sim calibrate angles field_angles.csv --camera my.toml --out calibrated";

pub(super) const CALIBRATE_GRID: &str = "\
Examples:
  host-sim calibrate grid table.csv --camera my.toml --pitch-mm 2 --out grid
  host-sim calibrate grid table.csv --camera my.toml --pitch-mm 2 \\
      --frame both --estimate k1,k2,k3 --out grid";

pub(super) const SMEAR: &str = "\
Examples:
  host-sim smear --camera my.toml --vh 0.1 --exposure 1/200 --pitch-deg 2
  host-sim smear --camera my.toml --vh 0.1 --exposure 1/200 \\
      --yaw-rate-deg-s 1 --out smear";

pub(super) const SWEEP: &str = "\
Examples:
  host-sim sweep --camera host-sim/cameras/paper-0.03-percent.toml --out sweep";

pub(super) const BUDGET: &str = "\
Examples:
  host-sim budget --camera my.toml
  host-sim budget --camera my.toml --height-m 500 --out budget";

pub(super) const STRIP: &str = "\
Examples:
  host-sim strip --scenario host-sim/scenarios/strip.toml --out strip
  host-sim strip --scenario host-sim/scenarios/yuan-2012.toml --out paper";

pub(super) const BLOCK: &str = "\
Examples:
  host-sim block --scenario host-sim/scenarios/block/ixm-50.toml --out block
  host-sim block --scenario host-sim/scenarios/block/rc30.toml --runs 100";

pub(super) const MISSION: &str = "\
Examples:
  host-sim mission --out mission
  host-sim mission --scenario host-sim/scenarios/faults/stall.toml --out stall";

pub(super) const STATISTICS: &str = "\
Examples:
  host-sim statistics --missions 200 --seed 1 --out statistics
  host-sim statistics --missions 50 --faults one";

pub(super) const CAMPAIGN: &str = "\
Examples:
  host-sim campaign --quick --out campaign
  host-sim campaign --fault counts-lost --pairs 0 --out lost";

pub(super) const RECORDS: &str = "\
Examples:
  host-sim records --device serial:/dev/ttyACM0 --out flight
  host-sim records --device serial:/dev/ttyACM0 --follow --out flight";

pub(super) const SERVE: &str = "\
Examples:
  host-sim serve --device qemu
  host-sim serve --device serial:/dev/ttyACM0 --listen 0.0.0.0:4000";

pub(super) const EXPORT: &str = "\
Examples:
  host-sim export metashape --camera host-sim/cameras/rc30-5324.toml --out lens
  host-sim export opencv --camera my.toml --model opencv8 \\
      --max-residual-um 0.5 --out cv
  host-sim export colmap --camera my.toml --records records.csv \\
      --images map.csv --out block
  host-sim export metashape --camera my.toml --records records.csv \\
      --trajectory sbet.out --trajectory-accuracy smrmsg.out \\
      --origin 47.5,8.2,450 --out block";

pub(super) const CERTIFICATE: &str = "\
Examples:
  host-sim certificate --camera host-sim/cameras/rc30-5324.toml \\
      --out certificate
  host-sim certificate --camera my.toml --calibration summary.json \\
      --details details.toml --require form.toml --sign key.pem \\
      --out certificate";

pub(super) const CERTIFICATE_CHECK: &str = "\
Examples:
  host-sim certificate check certificate --key laboratory.pem \\
      --records flight/records.csv";

pub(super) const IMPORT: &str = "\
Examples:
  host-sim import metashape camera.xml --pixel-um 3.76 --out my.toml
  host-sim import colmap cameras.txt --id 1 --base old.toml --out new.toml
  host-sim import opencv camera.yaml --base old.toml --grid --out new.toml";

pub(super) const CAMERA: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 prepare --camera my.toml
  host-sim camera --device serial:/dev/ttyACM0 referenced
  host-sim camera --device serial:/dev/ttyACM0 arm
  host-sim camera --device serial:/dev/ttyACM0 vh 0.1 --for 60
  host-sim camera --device serial:/dev/ttyACM0 status";

pub(super) const CAMERA_PREPARE: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 prepare --camera my.toml \\
      --settings flight.toml";

pub(super) const CAMERA_RECALIBRATE: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 recalibrate --camera newer.toml \\
      --settings flight.toml";

pub(super) const CAMERA_ARM: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 arm";

pub(super) const CAMERA_DISARM: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 disarm";

pub(super) const CAMERA_CLEAR_FAULT: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 clear-fault";

pub(super) const CAMERA_REFERENCED: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 referenced";

pub(super) const CAMERA_EXPOSURE: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 exposure 1/300";

pub(super) const CAMERA_FOCUS_SHIFT: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 focus-shift 12.5";

pub(super) const CAMERA_TEMPERATURE: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 temperature -12.5";

pub(super) const CAMERA_VH: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 vh 0.1 --for 60
  host-sim camera --device serial:/dev/ttyACM0 vh --ground-speed 70 --height 700";

pub(super) const CAMERA_STORE: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 store --camera my.toml \\
      --signature my.json
  host-sim camera --device qemu --flash flash.bin store --camera my.toml \\
      --signature my.json";

pub(super) const SIGN: &str = "\
Examples:
  host-sim sign --camera my.toml --key keys/private-key.pem --out my.json
  host-sim sign --camera my.toml --key keys/private-key.pem --out my.json \\
      --details details.toml
  host-sim sign --camera older.toml --key keys/private-key.pem \\
      --over stored.json --out older.json";

pub(super) const SIGN_KEY: &str = "\
Examples:
  host-sim sign key --out keys";

pub(super) const CAMERA_STORED: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 stored
  host-sim camera --device qemu --flash flash.bin stored --json";

pub(super) const CAMERA_INPUTS: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 inputs
  host-sim camera --device serial:/dev/ttyACM0 inputs --json";

pub(super) const CAMERA_JOG: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 jog 50
  host-sim camera --device serial:/dev/ttyACM0 jog -50";

pub(super) const CAMERA_DUTY: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 duty 0.05 --for 0.02";

pub(super) const CAMERA_SHUTTER: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 shutter 1/100";

pub(super) const CAMERA_STATUS: &str = "\
Examples:
  host-sim camera --device serial:/dev/ttyACM0 status --json";

pub(super) const CAMERA_FILE_CHECK: &str = "\
Examples:
  host-sim camera-file check host-sim/cameras/rc30-5324.toml";

pub(super) const SCENE_DMZ: &str = "\
Examples:
  host-sim scene dmz --out scene
  host-sim scene dmz --scale 16 --relief 30 --seed 2 --out scene";

pub(super) const CALIBRATE_RADIOMETRY: &str = "\
Examples:
  host-sim calibrate radiometry --rig scene/rig.toml --out radiometry scene
  host-sim calibrate radiometry --rig scene/rig.toml --method template \\
      --out template scene";

pub(super) const CALIBRATE_RIG: &str = "\
Examples:
  host-sim calibrate rig --rig scene/rig.toml --ties scene/ties.csv \\
      --out rig scene/control.csv
  host-sim calibrate rig --rig scene/rig.toml --heights ignore \\
      --exposure 8_10 --ties scene/ties.csv --out ground scene/control.csv";

pub(super) const VIRTUAL: &str = "\
Examples:
  host-sim virtual --rig rig/rig.toml --radiometry radiometry \\
      --out virtual scene/8_10
  host-sim virtual --rig rig/rig.toml --order mosaic-first --out shifted \\
      scene/8_10";

pub(super) const STEREO: &str = "\
Examples:
  host-sim stereo --rig rig/rig.toml --marks marks.csv 8_10/virtual.tif \\
      8_11/virtual.tif";

pub(super) const DMZ: &str = "\
Examples:
  host-sim dmz --out dmz
  host-sim dmz --scale 4 --relief 10 --out dmz";

#[cfg(test)]
mod tests {
    use std::any::TypeId;
    use std::collections::BTreeSet;
    use std::path::Path;

    use clap::{Command, CommandFactory, Parser};

    use super::super::Cli;

    /// Returns every command that does something, under its whole name.
    fn commands() -> Vec<(Vec<String>, Command)> {
        fn below(path: &[String], command: &Command, found: &mut Vec<(Vec<String>, Command)>) {
            let path = [path, &[command.get_name().to_owned()]].concat();
            if command.has_subcommands() {
                for inner in command.get_subcommands() {
                    below(&path, inner, found);
                }
            } else {
                found.push((path, command.clone()));
            }
        }
        let mut found = Vec::new();
        below(&[], &Cli::command(), &mut found);
        found
    }

    /// Returns the words of each example of a command.
    fn examples(command: &Command) -> Vec<Vec<String>> {
        let help = command.get_after_help().map(ToString::to_string);
        let help = help.unwrap_or_default();
        let lines = help.strip_prefix("Examples:\n").unwrap_or_default();
        for line in lines.lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
        let lines = lines.replace("\\\n", "");
        let examples = lines.lines();
        examples
            .map(|line| line.split_whitespace().map(str::to_owned).collect())
            .collect()
    }

    #[test]
    fn every_command_has_examples_that_it_accepts() {
        assert!(commands().len() > 15);
        for (path, command) in commands() {
            let examples = examples(&command);
            assert!(!examples.is_empty(), "{path:?}");
            for words in examples {
                let parsed = Cli::try_parse_from(&words);
                assert!(parsed.is_ok(), "{words:?}: {}", parsed.unwrap_err());
                assert!(path.iter().all(|name| words.contains(name)), "{words:?}");
                for file in words.iter().filter(|word| word.starts_with("host-sim/")) {
                    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
                    assert!(root.join(file).is_file(), "{file}");
                }
            }
        }
    }

    /// A negative number is a value, which is refused by its range, and no unknown option.
    #[test]
    fn numbers_of_options_may_be_negative() {
        let is_number = |option: &&clap::Arg| {
            let kind = option.get_value_parser().type_id();
            kind == TypeId::of::<f64>() || kind == TypeId::of::<f32>()
        };
        let (mut numbers, mut unsigned) = (0, Vec::new());
        for (path, command) in commands() {
            for option in command.get_opts().filter(is_number) {
                numbers += 1;
                if !option.is_allow_negative_numbers_set() {
                    unsigned.push(format!("{} --{}", path.join(" "), option.get_id()));
                }
            }
        }
        assert_eq!(unsigned, [""; 0]);
        assert!(numbers > 20, "{numbers}");
    }

    #[test]
    fn three_options_come_first_unless_more_are_required() {
        for (path, command) in commands() {
            let shown = |first: bool| {
                let options = command.get_arguments().filter(move |option| {
                    !option.is_positional()
                        && !option.is_hide_set()
                        && !["help", "version"].contains(&option.get_id().as_str())
                        && option.get_help_heading().is_none() == first
                });
                options.collect::<Vec<_>>()
            };
            // V/H is required, too, in one of two ways; records may stand for it and the exposure.
            let is_required = |option: &&clap::Arg| {
                option.is_required_set() || ["vh", "exposure"].contains(&option.get_id().as_str())
            };
            let first = shown(true);
            assert!(
                first.len() <= 3 || first.iter().all(is_required),
                "{path:?}: {:?}",
                first
                    .iter()
                    .map(|option| option.get_id())
                    .collect::<BTreeSet<_>>()
            );
            assert!(!shown(false).iter().any(is_required), "{path:?}");
        }
    }
}
