//! Checks of the page in a browser: its bits are the library's, and it serves a user without a
//! mouse, in the dark, on a narrow window, with bad input and without WebAssembly.

#![expect(
    clippy::indexing_slicing,
    reason = "a value of JSON is null where it has no such part"
)]

use std::{
    env::consts::EXE_SUFFIX,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde_json::{Value, json};

use super::{browser::Browser, page};
use crate::{checks::TESTED, workspace::Workspace};

/// Functions that the checks call in the page.
const CHECKS: &str = include_str!("checks.js");

/// Program that computes what the page has to show.
const EXPECTED: &str = "expected";

/// True in a page that has started.
const READY: &str = "document.body?.dataset.ready === 'yes'";

/// A camera with every key and nothing symmetric.
const ALL_KEYS: &str = "name = \"all keys\"\nserial = \"A-17\"\nversion = 3\n\
    principal_distance_mm = 100\nexit_pupil_mm = 90.5\nprincipal_point_mm = [0.35, -0.21]\n\
    [sensor]\nwidth_px = 9216\nheight_px = 6144\npixel_um = 8.75\n\
    [distortion]\nsign = \"correction\"\nk0 = 2e-4\nk1 = -8e-8\nk2 = 3e-12\nk3 = -4e-16\n\
    p1 = 3e-7\np2 = -5e-7\nb1 = 1e-4\nb2 = -6e-5\n\
    [fmc]\naxis = \"-x\"\nstrategy = \"from-rest\"\nacceleration_mm_s2 = 900.0\nsettling_ms = 4\n\
    stroke_mm = 6\nflatness_um = [1.5, -0.75]\njerk_mm_s3 = 100000.0\nmax_speed_mm_s = 60.0\n\
    [shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.25\nclosing_fraction = 0.125\n\
    [limits]\nvh_per_s = [0.02, 0.2]\nexposure_s = [0.001, 0.02]\n\
    [fitted]\nkm0 = 1e-5\nkm1 = 1e-8\nkm2 = 1e-13\nkd1 = 1e-9\npm1 = 1e-9\nper = \"centroid\"\n";

/// A camera that moves charge.
const TDI: &str = "name = \"charge\"\nprincipal_distance_mm = 60.0\n\
    [sensor]\nwidth_px = 4000\nheight_px = 3000\npixel_um = 6.0\n\
    [distortion]\nk1 = -2e-7\n[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 0.25\n";

/// Texts that are refused, with a part of the sentence.
const REFUSED: [(&str, &str); 8] = [
    ("name = \"a\"\nprincipal_distance_mm = = 3\n", "line 2"),
    ("name = \"a\"\n[sensor\nwidth_px = 1\n", "line 2"),
    ("", "name is missing"),
    (
        "name = \"a\"\nprincipal_distance_mm = 1\n[sensor]\nwidth_px = 9\nheight_px = 9\npixel_um = 9\n",
        "line 2: principal_distance_mm = 1 is outside 5 to 5000",
    ),
    (
        "name = \"a\"\nprincipal_distance_mm = 50\n[sensor]\nwidth_px = 9.5\nheight_px = 9\npixel_um = 9\n",
        "line 4: sensor.width_px is not a whole number",
    ),
    (
        "name = \"a\"\nprincipal_distance_mm = 50\nfocal = 3\n[sensor]\nwidth_px = 9\nheight_px = 9\npixel_um = 9\n",
        "line 3: focal is no key of a camera file",
    ),
    (
        "name = \"a\"\nprincipal_distance_mm = 50\n[sensor]\nwidth_px = 9000\nheight_px = 9000\npixel_um = 9\n[distortion]\nk1 = 1.0\n",
        "folds the image",
    ),
    (
        "name = \"a\"\nprincipal_distance_mm = 50\n[sensor]\nwidth_px = 9\nheight_px = 9\npixel_um = 9\n[grid]\nlens = \"l.csv\"\n",
        "line 7: grid names residual grids",
    ),
];

/// Sentences about a V/H of 0 and about none.
const REFUSED_VH: [&str; 2] = ["vh_per_s = 0 is outside", "vh_per_s = NaN"];

/// Longest median time of a slider step, ms: a step that takes a frame of the screen takes 16, and
/// this machine may be at work.
const MOST_MS: f64 = 160.0;

/// Largest relative difference of a term of the budget from that in double precision.
const BUDGET_TOLERANCE: f64 = 1e-4;

/// Drives the page.
///
/// # Errors
/// An error if a check fails.
pub(super) fn check(workspace: &Workspace, program: &Path) -> Result<()> {
    workspace.tell(&format!("browser {}", program.display()));
    let folder = workspace.shell.create_temp_dir()?;
    let out = workspace.target_dir.join("web");
    let mut driver = Driver {
        browser: Browser::start(program, &folder.path().join("profile"))?,
        address: format!("file://{}", out.join("index.html").display()),
        out,
    };
    let mut cameras = page::cameras(&workspace.root)?;
    cameras.insert("all-keys".to_owned(), ALL_KEYS.to_owned());
    cameras.insert("tdi".to_owned(), TDI.to_owned());
    let expected = expected(workspace, folder.path(), &json!(cameras))?;
    driver.start("")?;
    driver.bits(&json!(cameras), &expected)?;
    // The page that is checked in may have a module by another compiler.
    let built = driver.address.clone();
    let kept = workspace.root.join(page::CHECKED_IN);
    driver.address = format!("file://{}", kept.display());
    driver.start("")?;
    driver.bits(&json!(cameras), &expected)?;
    driver.address = built;
    driver.start("")?;
    driver.times()?;
    driver.refusals()?;
    driver.link()?;
    driver.keyboard()?;
    driver.pictures()?;
    driver.without_web_assembly()
}

/// Computes with the library what the page has to show of cameras.
fn expected(workspace: &Workspace, folder: &Path, cameras: &Value) -> Result<Value> {
    let path = folder.join("cameras.json");
    fs::write(&path, cameras.to_string())?;
    // Built as the tests are, so that nothing is built for it alone.
    let build = workspace.cargo(&format!("build {TESTED} --locked --example {EXPECTED}"));
    eprintln!("$ {build}");
    build.run()?;
    let examples = workspace.target_dir.join("debug/examples");
    let program = examples.join(format!("{EXPECTED}{EXE_SUFFIX}"));
    let command = workspace.shell.cmd(program).quiet().arg(path);
    serde_json::from_str(&command.read()?).context("expected")
}

/// A browser and the page in it.
struct Driver {
    browser: Browser,
    address: String,
    out: PathBuf,
}

impl Driver {
    /// Loads the page with settings in its address.
    fn start(&mut self, settings: &str) -> Result<()> {
        self.browser.load("about:blank", "true")?;
        let address = format!("{}{settings}", self.address);
        self.browser.load(&address, READY)?;
        self.browser
            .evaluate(&format!("{CHECKS}\nundefined"))
            .map(drop)
    }

    /// Compares calibration, coordinates and budget of every camera with those of the library.
    fn bits(&mut self, cameras: &Value, expected: &Value) -> Result<()> {
        let found = self.browser.evaluate(&format!("bits({cameras})"))?;
        let all = expected.as_object().context("expected")?;
        ensure!(!all.is_empty(), "no camera is compared");
        let mut exposures = 0;
        for (name, expected) in all {
            let found = &found[name];
            for key in ["crc", "points", "accepted", "corrected"] {
                ensure!(
                    found[key] == expected[key] && found[key].is_u64(),
                    "{name}: {key} is {} in the page and {} in the library",
                    found[key],
                    expected[key]
                );
            }
            exposures += expected["accepted"].as_u64().unwrap_or_default();
            same_budget(&found["budget"], &expected["budget"]).with_context(|| name.clone())?;
        }
        ensure!(exposures >= 60, "{exposures} exposures are too few");
        eprintln!(
            "{}: the bits of the library for {} cameras, {exposures} exposures of 441 points, and its first three terms of the budget",
            self.address,
            all.len()
        );
        Ok(())
    }

    /// Measures slider steps.
    fn times(&mut self) -> Result<()> {
        let times = self.browser.evaluate("times()")?;
        let median = times["median"].as_f64().context("median")?;
        eprintln!(
            "a slider step takes {median:.1} ms, the longest of 200 {} ms",
            times["longest"]
        );
        ensure!(times["fault"] == "", "{}", times["fault"]);
        ensure!(
            median < MOST_MS,
            "a slider step takes {median} ms, and may take {MOST_MS}"
        );
        Ok(())
    }

    /// Enters texts and V/H that are refused.
    fn refusals(&mut self) -> Result<()> {
        let texts = REFUSED.map(|(text, _)| text);
        let answer = self
            .browser
            .evaluate(&format!("refusals({})", json!(texts)))?;
        let said = answer["said"].as_array().context("said")?;
        let parts = REFUSED.map(|(_, part)| part);
        let parts: Vec<_> = parts.into_iter().chain(REFUSED_VH).collect();
        ensure!(said.len() == parts.len(), "{} answers", said.len());
        for (said, part) in said.iter().zip(parts) {
            let text = said[0].as_str().unwrap_or_default();
            ensure!(text.contains(part), "\"{part}\" is not in \"{text}\"");
            ensure!(said[1] == true, "results stand beside \"{text}\"");
        }
        ensure!(
            answer["clean"] == json!(["", ""]),
            "a fault remains: {}",
            answer["clean"]
        );
        Ok(())
    }

    /// Opens the link of a page, for a camera of the page and for one of the user.
    fn link(&mut self) -> Result<()> {
        for prepare in [
            "load(CAMERAS['rc30-5324'], 'rc30-5324'); step('vh-number', '0.123')",
            "load(CAMERAS['rc30-5282'] + '# ä&=%+\\n', null); step('focus-number', '12.5')",
        ] {
            let shown = "[document.getElementById('link').hash, cameraText, document.getElementById('worst').textContent]";
            self.browser.evaluate(prepare)?;
            let before = self.browser.evaluate(shown)?;
            let settings = before[0].as_str().context("address")?.to_owned();
            self.start(&settings)?;
            let after = self.browser.evaluate(shown)?;
            ensure!(
                before == after,
                "the link leads to {after} instead of {before}"
            );
        }
        Ok(())
    }

    /// Goes through the page by Tab, and moves a slider by an arrow key.
    fn keyboard(&mut self) -> Result<()> {
        self.start("")?;
        let names = self.browser.evaluate("names()")?;
        ensure!(
            names["unnamed"] == json!([]),
            "without a name: {}",
            names["unnamed"]
        );
        let count = names["count"].as_u64().context("count")?;
        let mut reached = Vec::new();
        let mut moved = false;
        for _ in 0..2 * count {
            self.press("Tab", 9)?;
            let now = "document.activeElement.id || document.activeElement.tagName";
            let now = self.browser.evaluate(now)?;
            if now == "vh" {
                let travel = "document.getElementById('travel').textContent";
                let before = self.browser.evaluate(travel)?;
                self.press("ArrowRight", 39)?;
                moved = self.browser.evaluate(travel)? != before;
            }
            if now == "BODY" {
                break;
            }
            reached.push(now.as_str().unwrap_or_default().to_owned());
        }
        ensure!(moved, "an arrow key does not move the slider of V/H");
        let order = [
            "known",
            "file",
            "SUMMARY",
            "vh",
            "vh-number",
            "exposure",
            "exposure-number",
            "run-up",
            "focus",
            "focus-number",
            "direction",
            "link",
        ];
        ensure!(
            reached.starts_with(&order.map(str::to_owned)),
            "the keyboard goes through {reached:?}"
        );
        eprintln!("{} controls and links by the keyboard", reached.len());
        Ok(())
    }

    fn press(&mut self, key: &str, code: u8) -> Result<()> {
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({
                "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code,
            });
            self.browser.call("Input.dispatchKeyEvent", &event)?;
        }
        Ok(())
    }

    /// Takes pictures of both widths by day and by night.
    fn pictures(&mut self) -> Result<()> {
        let mut colours = Vec::new();
        for scheme in ["light", "dark"] {
            for width in [500, 1200] {
                let media =
                    json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
                self.browser.call("Emulation.setEmulatedMedia", &media)?;
                let size = json!({
                    "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false,
                });
                self.browser
                    .call("Emulation.setDeviceMetricsOverride", &size)?;
                let over = "document.documentElement.scrollWidth - innerWidth";
                let over = self.browser.evaluate(over)?;
                ensure!(
                    over.as_f64().is_some_and(|px| px <= 0.0),
                    "the page is {over} px wider than {width} px"
                );
                let asked = json!({"format": "png", "captureBeyondViewport": true});
                let picture = self.browser.call("Page.captureScreenshot", &asked)?;
                let picture = picture["data"].as_str().context("picture")?;
                let path = self.out.join(format!("{scheme}-{width}.png"));
                fs::write(&path, STANDARD.decode(picture)?)
                    .with_context(|| path.display().to_string())?;
            }
            let colour = "getComputedStyle(document.body).backgroundColor";
            colours.push(self.browser.evaluate(colour)?);
        }
        ensure!(
            colours.first() != colours.last(),
            "the page is {} by day and by night",
            colours.iter().map(Value::to_string).collect::<String>()
        );
        Ok(())
    }

    /// Loads the page in a browser without WebAssembly.
    fn without_web_assembly(&mut self) -> Result<()> {
        self.browser.open()?;
        let without = json!({"source": "delete globalThis.WebAssembly"});
        self.browser
            .call("Page.addScriptToEvaluateOnNewDocument", &without)?;
        let address = self.address.clone();
        self.browser.load(
            &address,
            "!document.getElementById('fault').hidden && document.getElementById('results').hidden",
        )?;
        let text = "document.getElementById('fault').textContent";
        let text = self.browser.evaluate(text)?;
        ensure!(
            text.as_str()
                .is_some_and(|text| text.contains("no WebAssembly")),
            "without WebAssembly the page says {text}"
        );
        Ok(())
    }
}

/// Compares the rows of the page with the largest terms of the library.
fn same_budget(found: &Value, expected: &Value) -> Result<()> {
    let [found, expected] = [found, expected].map(|rows| rows.as_array().context("rows"));
    let (found, expected) = (found?, expected?);
    ensure!(found.len() == 3 && expected.len() == 3, "three terms");
    for (found, expected) in found.iter().zip(expected) {
        let label = expected[2].as_str().context("label")?;
        let shown = found[2].as_str().context("label")?;
        let [um, expected_um] = [&found[1], &expected[1]].map(Value::as_f64);
        let (um, expected_um) = um.zip(expected_um).context("µm")?;
        ensure!(
            found[0] == expected[0]
                && shown.starts_with(label)
                && found[3] == expected[3]
                && (um - expected_um).abs() <= BUDGET_TOLERANCE * expected_um,
            "the budget has {found} in the page and {expected} in the library"
        );
    }
    Ok(())
}
