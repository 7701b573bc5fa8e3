//! Section 3: sign and terms of the distortion.

use super::{Example, Given, Results};
use crate::conventions::camera;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::frame_correction::FrameCorrection;

pub(super) const EXAMPLES: &[Example] = &[
    ("barrel lens", barrel),
    ("decentring P1", |given| {
        let p1 = given.number("P1", "mm⁻¹");
        displacement(
            given,
            Brown {
                p1,
                ..Brown::default()
            },
        )
    }),
    ("decentring P2", |given| {
        let p2 = given.number("P2", "mm⁻¹");
        displacement(
            given,
            Brown {
                p2,
                ..Brown::default()
            },
        )
    }),
    ("K0 moved into the principal distance", gauge_of_k0),
];

fn displacement(given: &Given, lens: Brown) -> Results {
    let measured = given.point("x̄", "ȳ");
    let d = lens.displacement(measured.x_mm, measured.y_mm);
    vec![("Dx", "mm", d.dx_mm.into()), ("Dy", "mm", d.dy_mm.into())]
}

fn barrel(given: &Given) -> Results {
    let lens = Brown {
        k1: given.number("K1", "mm⁻²"),
        ..Brown::default()
    };
    let calibration = Calibration::new(CalibrationParameters {
        distortion: lens,
        ..camera::record().calibration
    })
    .unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let ideal = correction.correct(given.point("x̄", "ȳ")).point;
    let mut results = displacement(given, lens);
    results.push(("ideal", "mm", ideal.x_mm.into()));
    results
}

fn gauge_of_k0(given: &Given) -> Results {
    let [f, k0, k1]: [f32; 3] =
        [("f", "mm"), ("K0", ""), ("K1", "mm⁻²")].map(|(symbol, unit)| given.number(symbol, unit));
    let (other_f, other_k1) = (f / (1.0 - k0), k1 / (1.0 - k0));
    let lens = Brown {
        k0,
        k1,
        ..Brown::default()
    };
    let other = Brown {
        k1: other_k1,
        ..Brown::default()
    };
    for r in [5.0, 20.0, 40.0] {
        let tangent = (r - lens.displacement(r, 0.0).dx_mm) / f;
        let other_tangent = (r - other.displacement(r, 0.0).dx_mm) / other_f;
        assert!((tangent - other_tangent).abs() < 1e-7, "the same ray");
    }
    vec![
        ("f/(1-K0)", "mm", other_f.into()),
        ("K1/(1-K0)", "mm⁻²", other_k1.into()),
    ]
}
