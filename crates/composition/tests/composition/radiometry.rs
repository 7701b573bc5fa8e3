//! Radiometry of a synthetic detector.

use fmc_camera_file::InputError;
use fmc_composition::image::Plane;
use fmc_composition::radiometry::{
    Correction, DetectorFigures, Falloff, Levels, Method, SATURATION_DN, SampleRows, correction,
    levels, response,
};
use fmc_composition::rig::Rig;
use fmc_composition::scene::{Detector, Scene, SceneRequest};

/// A frame in memory.
struct Rows {
    name: String,
    plane: Plane,
    next: usize,
}

impl SampleRows for Rows {
    fn name(&self) -> &str {
        &self.name
    }

    fn read_row(&mut self, row: &mut [u16]) -> Result<(), InputError> {
        row.copy_from_slice(self.plane.row(self.next));
        self.next += 1;
        Ok(())
    }
}

fn rows(name: &str, planes: &[Plane]) -> Vec<Rows> {
    let frames = planes.iter().enumerate();
    frames
        .map(|(number, plane)| Rows {
            name: format!("{name}_{number:02}.tif"),
            plane: plane.clone(),
            next: 0,
        })
        .collect()
}

struct Laboratory {
    scene: Scene,
    rig: Rig,
    detectors: Vec<Detector>,
    flats: Vec<Vec<Plane>>,
    darks: Vec<Vec<Plane>>,
}

fn laboratory() -> Laboratory {
    let scene = Scene::new(SceneRequest {
        scale: 16,
        ..SceneRequest::default()
    });
    let detectors: Vec<Detector> = (0..6).map(|number| scene.detector(number)).collect();
    let flats = detectors.iter().enumerate().map(|(number, detector)| {
        (0..scene.flats())
            .map(|set| scene.flat(set, number, detector).unwrap())
            .collect()
    });
    let darks = detectors
        .iter()
        .enumerate()
        .map(|(number, detector)| vec![scene.dark(0, number, detector)]);
    Laboratory {
        rig: scene.rig.clone(),
        flats: flats.collect(),
        darks: darks.collect(),
        detectors,
        scene,
    }
}

type Found = (Falloff, Vec<(Correction, DetectorFigures)>);

impl Laboratory {
    fn calibrate(&self, method: Method) -> Result<Found, InputError> {
        let mut of_detectors = Vec::new();
        for ((sub, flats), darks) in self.rig.sub.iter().zip(&self.flats).zip(&self.darks) {
            let (mut flats, mut darks) = (rows("flat", flats), rows("dark", darks));
            of_detectors.push(levels(
                sub.size_px(),
                &mut flats,
                &mut darks,
                SATURATION_DN,
            )?);
        }
        let joined = Levels::joined(&of_detectors)?;
        let mut responses = Vec::new();
        for ((sub, flats), darks) in self.rig.sub.iter().zip(&self.flats).zip(&self.darks) {
            let (mut flats, mut darks) = (rows("flat", flats), rows("dark", darks));
            let (flats, darks) = (&mut flats, &mut darks);
            responses.push(response(
                &self.rig,
                sub,
                &joined,
                flats,
                darks,
                SATURATION_DN,
            )?);
        }
        correction(&self.rig, responses, method)
    }

    fn refused(mut self, change: impl Fn(&mut Self)) -> String {
        change(&mut self);
        self.calibrate(Method::OffsetAndGain)
            .unwrap_err()
            .to_string()
    }
}

#[test]
fn offset_and_gain_leave_0_4_and_0_2_percent_and_the_template_leaves_more() {
    let laboratory = laboratory();
    let (falloff, own) = laboratory.calibrate(Method::OffsetAndGain).unwrap();
    let (_, template) = laboratory.calibrate(Method::Template).unwrap();
    let percent = |list: &[(Correction, DetectorFigures)], number: usize, level: f64| {
        let detector = &laboratory.detectors[number];
        100.0
            * laboratory
                .scene
                .uniformity(number, detector, &list[number].0, level)
                .unwrap()
    };
    println!("{falloff:?}");
    for number in 0..6 {
        for (level, limit) in [(0.1, 0.4), (0.3, 0.2), (0.6, 0.2), (0.9, 0.2)] {
            let (own, of_template) = (
                percent(&own, number, level),
                percent(&template, number, level),
            );
            println!("{number} {level}: {own:.3} {of_template:.3}");
            assert!(own <= limit, "sub-image {}: {own} % at {level}", number + 1);
            // Near the mean level of its flats, a template is as good.
            assert!(
                of_template > own || (0.5..0.7).contains(&level),
                "{number} {level}"
            );
        }
        assert!((2.0..6.0).contains(&percent(&template, number, 0.1)));
        let figures = own[number].1;
        println!("{figures:?}");
        assert!(
            (figures.gain_dn_per_e / (16_383.0 / 60_000.0) - 1.0).abs() < 0.03,
            "{figures:?}"
        );
        // One dark: its noise is that of the flats, known to a fifth.
        assert!(
            (16.0..24.0).contains(&figures.temporal_dark_noise_e),
            "{figures:?}"
        );
        let listed = &own[number].0.defects;
        for defect in laboratory.detectors[number].defects() {
            assert!(listed.contains(defect), "{defect:?} {listed:?}");
        }
        assert!(
            listed.len() <= laboratory.detectors[number].defects().len() + 3,
            "{listed:?}"
        );
    }
    println!("{falloff:?}");
    assert!(
        (falloff.on_axis - 1.0).abs() > 0.0 && falloff.misfit < 0.005,
        "{falloff:?}"
    );
}

#[test]
fn figures_of_emva_1288_are_those_of_the_detector() {
    let mut laboratory = laboratory();
    for (number, darks) in laboratory.darks.iter_mut().enumerate() {
        let detector = &laboratory.detectors[number];
        darks.push(laboratory.scene.dark(1, number, detector));
    }
    let (_, found) = laboratory.calibrate(Method::OffsetAndGain).unwrap();
    for (_, figures) in &found {
        // 0.9 % of the pixels and 6 DN; the noise of 19 sets and of two darks is subtracted.
        assert!((0.87..0.93).contains(&figures.prnu_percent), "{figures:?}");
        assert!((5.8..6.2).contains(&figures.dsnu_dn), "{figures:?}");
        // Read with 20 electrons; saturated at 16,100 DN, 15,700 above dark.
        assert!(
            (19.5..20.5).contains(&figures.temporal_dark_noise_e),
            "{figures:?}"
        );
        assert!(
            (56_000.0..59_000.0).contains(&figures.saturation_capacity_e),
            "{figures:?}"
        );
    }
}

#[test]
fn flats_that_say_nothing_are_refused_by_name() {
    let change = |value: fn(u16) -> u16, list: &mut [Plane]| {
        for plane in list {
            for sample in plane.values_mut() {
                *sample = value(*sample);
            }
        }
    };
    let saturated = laboratory().refused(|one| change(|_| 16_383, &mut one.flats[2][18..]));
    assert!(
        saturated.contains("flat_18.tif") && saturated.contains("saturated"),
        "{saturated}"
    );
    let level = laboratory().refused(|one| {
        for flats in &mut one.flats {
            let first = flats[0].clone();
            flats.fill(first);
        }
    });
    assert!(level.contains("one level"), "{level}");
    let dark = laboratory().refused(|one| change(|value| value + 9000, &mut one.darks[1]));
    assert!(
        dark.contains("flat_00.tif") && dark.contains("brighter"),
        "{dark}"
    );
    let pattern = laboratory().refused(|one| {
        let width = one.rig.sub[3].width_px;
        for (index, sample) in one.flats[3][7].values_mut().iter_mut().enumerate() {
            *sample -= if (index % width / 20).is_multiple_of(2) {
                *sample / 5
            } else {
                0
            };
        }
    });
    assert!(
        pattern.contains("flat_07.tif") && pattern.contains("not flat"),
        "{pattern}"
    );
}
