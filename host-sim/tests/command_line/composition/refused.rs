//! Points and images that are refused, with file and field; nothing is written.

use std::fs;
use std::path::Path;

use tiff::encoder::colortype::{ColorType, Gray16, Gray32Float, RGB16};
use tiff::encoder::{TiffEncoder, TiffValue};

use super::{RADIOMETRY, RIG, bench};
use crate::command_line::support::Bench;

/// Replaces the file by what a change makes of its text.
fn change(bench: &Bench, path: &str, change: impl Fn(&str) -> String) {
    let text = fs::read_to_string(bench.path(path)).unwrap();
    fs::write(bench.path(path), change(&text)).unwrap();
}

/// Replaces the samples of an image that this program wrote, which begin behind its first 8 bytes.
fn change_samples(path: &Path, pixels: usize, change: impl Fn(usize, u16) -> u16) {
    let mut bytes = fs::read(path).unwrap();
    let samples = bytes[8..8 + 2 * pixels].chunks_exact_mut(2).enumerate();
    for (index, sample) in samples {
        let value = change(index, u16::from_le_bytes([sample[0], sample[1]]));
        sample.copy_from_slice(&value.to_le_bytes());
    }
    fs::write(path, bytes).unwrap();
}

/// Sub-images of the small scene, px.
const SIZE: [u32; 2] = [256, 448];
const PIXELS: usize = 256 * 448;

#[test]
fn control_and_ties_that_are_wrong_are_named() {
    let bench = bench();
    let control = fs::read_to_string(bench.path("scene/control.csv")).unwrap();
    let rows: Vec<&str> = control.lines().collect();
    let refused = |text: &str, words: &[&str]| {
        fs::write(bench.path("wrong.csv"), text).unwrap();
        bench
            .run(&[&RIG[..], &["wrong.csv"]].concat())
            .refused(words);
        assert!(!bench.path("rig").exists(), "nothing is written");
    };
    let first: Vec<&str> = rows[1].split(',').collect();
    let with = |column: usize, value: &str| {
        let mut cells = first.clone();
        cells[column] = value;
        control.replacen(rows[1], &cells.join(","), 1)
    };
    refused(
        &with(3, "9999"),
        &["wrong.csv, line 2", "outside sub-image", "allowed"],
    );
    let decimal = format!("{}", 10.0 * first[6].parse::<f64>().unwrap() + 700.0);
    refused(
        &with(6, &decimal),
        &["wrong.csv, line 2", first[0], "px from where"],
    );
    refused(&format!("{control}{}\n", rows[1]), &["appears twice"]);
    refused(&with(2, "7"), &["image = 7", "allowed: 1, 2, 3, 4, 5, 6"]);
    refused(&with(5, "nan"), &["x_m"]);
    let on_a_line: Vec<String> = rows
        .iter()
        .map(|row| {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            if cells[2] == "3" {
                cells[3] = format!("{}", 100.0 + 0.1 * cells[4].parse::<f64>().unwrap());
            }
            cells.join(",")
        })
        .collect();
    refused(
        &on_a_line.join("\n"),
        &["wrong.csv", "sub-image 3", "lie on a line"],
    );
    refused(rows[0], &["no control point"]);
    change(&bench, "scene/ties.csv", |text| {
        let mut lines: Vec<&str> = text.lines().collect();
        lines.remove(2);
        lines.join("\n")
    });
    refused(&control, &["ties.csv, line 2", "in one image only"]);
}

#[test]
fn images_that_are_missing_or_say_nothing_are_named() {
    let bench = bench();
    bench.run(&[&RIG[..], &["scene/control.csv"]].concat()).ok();
    let virtual_image = [
        "virtual",
        "--rig",
        "rig/rig.toml",
        "--out",
        "out",
        "scene/8_10",
    ];
    let nominal = [
        "virtual",
        "--rig",
        "scene/rig.toml",
        "--out",
        "out",
        "scene/8_10",
    ];
    bench.run(&nominal).refused(&["rig.toml", "no polynomial"]);
    let green = bench.path("scene/8_10/green.tif");
    let kept = fs::read(&green).unwrap();
    // Of the header of this writer, the pixels stand behind the first 8 bytes.
    let mut flat = kept.clone();
    let end = flat.len() - 1000;
    flat[8..end].fill(30);
    fs::write(&green, &flat).unwrap();
    bench
        .run(&virtual_image)
        .refused(&["green.tif", "do not match"]);
    fs::write(&green, &kept[..400]).unwrap();
    bench.run(&virtual_image).refused(&["green.tif"]);
    fs::write(&green, &kept).unwrap();
    fs::copy(
        bench.path("scene/8_10/green.tif"),
        bench.path("scene/8_10/4.tif"),
    )
    .unwrap();
    bench
        .run(&virtual_image)
        .refused(&["4.tif", "allowed: 256 x 448 px"]);
    fs::remove_file(bench.path("scene/8_10/4.tif")).unwrap();
    bench
        .run(&virtual_image)
        .refused(&["4.tif", "cannot be read"]);
    for dark in ["3_00", "3_01"] {
        fs::remove_file(bench.path(&format!("scene/darks/{dark}.tif"))).unwrap();
    }
    bench.run(&RADIOMETRY).refused(&["darks", "no 3_NN.tif"]);
    assert!(!bench.path("out").exists() && !bench.path("rad").exists());
}

#[test]
fn flats_and_darks_that_say_nothing_are_named() {
    let bench = bench();
    let path = |name: &str| bench.path(&format!("scene/{name}.tif"));
    let refused = |name: &str, change: &dyn Fn(usize, u16) -> u16, words: &[&str]| {
        let kept = fs::read(path(name)).unwrap();
        change_samples(&path(name), PIXELS, change);
        bench.run(&RADIOMETRY).refused(words);
        fs::write(path(name), kept).unwrap();
        assert!(!bench.path("rad").exists(), "nothing is written");
    };
    refused(
        "flats/3_18",
        &|_, _| 16_383,
        &["flats/3_18.tif", "saturated"],
    );
    let stripes = |index: usize, dn: u16| {
        dn - if (index % 256 / 20).is_multiple_of(2) {
            dn / 5
        } else {
            0
        }
    };
    refused("flats/4_07", &stripes, &["flats/4_07.tif", "not flat"]);
    refused(
        "darks/2_00",
        &|_, dn| dn + 18_000,
        &["flats/2_00.tif", "darks/2_00.tif", "must be brighter"],
    );
    let flats: Vec<Vec<u8>> = (1..=6)
        .flat_map(|sub| (0..19).map(move |set| format!("flats/{sub}_{set:02}")))
        .map(|name| fs::read(path(&name)).unwrap())
        .collect();
    let each = (1..=6).flat_map(|sub| (0..19).map(move |set| (sub, set)));
    for (sub, set) in each.clone() {
        let one = &flats[(sub - 1) * 19];
        fs::write(path(&format!("flats/{sub}_{set:02}")), one).unwrap();
    }
    bench
        .run(&RADIOMETRY)
        .refused(&["all 19 sets have one level"]);
    for ((sub, set), bytes) in each.zip(&flats) {
        fs::write(path(&format!("flats/{sub}_{set:02}")), bytes).unwrap();
    }
    // Sets that do not belong together, and light that is not known of all.
    let levels = fs::read_to_string(bench.path("scene/flats/levels.csv")).unwrap();
    for (text, words) in [
        (
            levels.replace("7,0.", "6,0."),
            ["levels.csv, line 9", "set 6 appears twice"],
        ),
        (
            levels.replace("\n7,0.", "\n20,0."),
            ["levels.csv", "no set 7"],
        ),
        (
            levels.replace("\n7,0.", "\n7,-0."),
            ["levels.csv, line 9", "above 0"],
        ),
        (
            levels.replace("\n7,0.", "\nseven,0."),
            ["levels.csv, line 9", "set = seven"],
        ),
    ] {
        fs::write(bench.path("scene/flats/levels.csv"), text).unwrap();
        bench.run(&RADIOMETRY).refused(&words);
    }
    fs::remove_file(bench.path("scene/flats/levels.csv")).unwrap();
    let answer = bench.run(&RADIOMETRY).ok();
    assert!(
        answer.stdout.contains("Not determined: linearity"),
        "{}",
        answer.stdout
    );
    fs::rename(path("flats/5_03"), path("flats/5_30")).unwrap();
    bench
        .run(&RADIOMETRY)
        .refused(&["set 3", "sub-images 1 and 5"]);
    fs::remove_file(path("flats/5_30")).unwrap();
    bench
        .run(&RADIOMETRY)
        .refused(&["set 3", "sub-images 1 and 5"]);
}

fn write_image<Color: ColorType>(path: &Path, samples: &[Color::Inner], orientation: u16)
where
    [Color::Inner]: TiffValue,
{
    let mut encoder = TiffEncoder::new(fs::File::create(path).unwrap()).unwrap();
    let mut image = encoder.new_image::<Color>(SIZE[0], SIZE[1]).unwrap();
    let tag = tiff::tags::Tag::Orientation;
    image.encoder().write_tag(tag, orientation).unwrap();
    image.write_data(samples).unwrap();
}

/// Images that `rectify` refuses as frames.
#[test]
fn images_that_rectify_refuses_are_refused_of_every_kind() {
    let bench = bench();
    bench.run(&[&RIG[..], &["scene/control.csv"]].concat()).ok();
    let virtual_image = [
        "virtual",
        "--rig",
        "rig/rig.toml",
        "--out",
        "out",
        "scene/8_10",
    ];
    for (name, arguments) in [
        ("8_10/3.tif", &virtual_image[..]),
        ("8_10/green.tif", &virtual_image[..]),
        ("flats/3_05.tif", &RADIOMETRY[..]),
        ("darks/3_00.tif", &RADIOMETRY[..]),
    ] {
        let path = bench.path(&format!("scene/{name}"));
        let whole = fs::read(&path).unwrap();
        let refused = |words: &[&str]| {
            bench.run(arguments).refused(&[&[name], words].concat());
            assert!(!bench.path("out").exists() && !bench.path("rad").exists());
        };
        for (bytes, word) in [
            (&b""[..], "empty"),
            (b"P5 300 220 255 ", "not a TIFF"),
            (&whole[..whole.len() / 2], "byte"),
        ] {
            fs::write(&path, bytes).unwrap();
            refused(&[word]);
        }
        // Another size, too, of green.
        write_image::<Gray16>(&path, &vec![900; PIXELS], 6);
        refused(&["Orientation (274) = 6"]);
        write_image::<Gray32Float>(&path, &vec![1.0; PIXELS], 1);
        refused(&["BitsPerSample (258) = 32"]);
        write_image::<RGB16>(&path, &vec![900; 3 * PIXELS], 1);
        refused(if name.contains("green") {
            &["px; allowed"]
        } else {
            &["3 bands"]
        });
        fs::remove_file(&path).unwrap();
        fs::create_dir(&path).unwrap();
        refused(&["folder"]);
        fs::remove_dir(&path).unwrap();
        fs::write(&path, &whole).unwrap();
    }
    let limited = [&virtual_image[..], &["--memory", "1"]].concat();
    bench
        .run(&limited)
        .refused(&["rig.toml", "MiB", "--memory"]);
    bench.run(&virtual_image).ok();
}
