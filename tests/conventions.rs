//! `docs/conventions.md` against the code: names, ranges, constants and worked examples.
//!
//! An example row is `name | given | result`, both sides `symbol = number unit; …`. Results are
//! computed by the library from the given numbers as printed and must agree to half a unit of the
//! last printed digit (and two units of single precision).

#[cfg(test)]
mod conventions {
    use std::collections::BTreeSet;

    use fmc_camera::flight::camera::{Camera, CameraRecord, Frame, FrameError, Mechanism};
    use fmc_camera::flight::exposure::{CorrectionModel, Exposure, Limits};
    use fmc_camera::flight::frame_record::FrameRecord;
    use fmc_camera::flight::stage::{RunUp, StrokeTooShort};
    use fmc_camera::geometry::brown::Brown;
    use fmc_camera::geometry::calibration::{CalibrationError, CalibrationRecord};
    use fmc_camera::geometry::evaluation_form::Displacement;
    use fmc_camera::geometry::five_coefficient::FiveCoefficients;
    use fmc_camera::geometry::frame_correction::SHORT_KERNEL_NM;
    use fmc_camera::geometry::inverse::{LAST_RESIDUAL_NM, MAX_STEPS};
    use fmc_camera::geometry::invertibility::{MAX_DISC_SLOPE, MIN_SCALE};
    use fmc_camera::geometry::moments::CentralMoments;
    use fmc_camera::geometry::principal_distance::{
        FLATNESS_TERMS, Flatness, FocusShift, FocusSign,
    };
    use fmc_camera::geometry::principal_point::{PrincipalPointMotion, StageSample, UniformTravel};
    use fmc_camera::geometry::range::{MAX_FOCUS_FRACTION, OutOfRange, Quantity};
    use fmc_camera::geometry::sensor::{
        FmcAxis, MAX_SIDE_MM, MAX_SIDE_PX, PixelPoint, Sensor, SensorPoint,
    };
    use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
    use fmc_camera::geometry::tdi::{MAX_ROWS, mean_transfers};

    const DOCUMENT: &str = include_str!("../docs/conventions.md");
    const CAMERA_FILE: &str = include_str!("../host-sim/src/formats/camera_file.rs");

    // ---- The document's tables ----

    /// The rows of every table whose first heading is `heading`.
    fn rows(heading: &str) -> Vec<Vec<&'static str>> {
        let mut found = Vec::new();
        let mut current = None;
        for line in DOCUMENT.lines() {
            let Some(inner) = line
                .strip_prefix('|')
                .and_then(|line| line.strip_suffix('|'))
            else {
                current = None;
                continue;
            };
            let cells: Vec<_> = inner.split('|').map(str::trim).collect();
            match current {
                None => current = Some(cells[0]),
                Some(_) if cells[0].starts_with("---") => {}
                Some(first) if first == heading => found.push(cells),
                Some(_) => {}
            }
        }
        assert!(!found.is_empty(), "no table of {heading}");
        found
    }

    /// What stands in backquotes in a cell.
    fn names(cell: &str) -> Vec<&str> {
        cell.split('`').skip(1).step_by(2).collect()
    }

    /// `symbol = number unit`.
    #[derive(Debug)]
    struct Entry {
        symbol: &'static str,
        number: &'static str,
        unit: &'static str,
    }

    fn entries(cell: &'static str) -> Vec<Entry> {
        cell.split(';')
            .map(|entry| {
                let (symbol, value) = entry.split_once('=').expect(entry);
                let (number, unit) = value.trim().split_once(' ').unwrap_or((value.trim(), ""));
                Entry {
                    symbol: symbol.trim(),
                    number,
                    unit,
                }
            })
            .collect()
    }

    /// The given side of a worked example.
    struct Given(Vec<Entry>);

    impl Given {
        fn text(&self, symbol: &str, unit: &str) -> &'static str {
            let entry = self.0.iter().find(|entry| entry.symbol == symbol);
            let entry = entry.unwrap_or_else(|| panic!("{symbol} is not given"));
            assert_eq!(entry.unit, unit, "unit of {symbol}");
            entry.number
        }

        fn single(&self, symbol: &str, unit: &str) -> f32 {
            self.text(symbol, unit).parse().unwrap()
        }

        fn double(&self, symbol: &str, unit: &str) -> f64 {
            self.text(symbol, unit).parse().unwrap()
        }
    }

    type Results = Vec<(&'static str, &'static str, f64)>;

    /// Half a unit of the last printed digit.
    fn half_last_digit(number: &str) -> f64 {
        let decimals = number.split_once('.').map_or(0, |(_, digits)| digits.len());
        0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap())
    }

    // ---- Worked examples, computed by the library ----

    fn sensor(given: &Given) -> Sensor {
        let side = |symbol| given.text(symbol, "px").parse().unwrap();
        Sensor::new(side("W"), side("H"), given.single("p", "µm")).unwrap()
    }

    fn sensor_from_pixel(given: &Given) -> Results {
        let pixel = PixelPoint {
            col_px: given.single("col", "px"),
            row_px: given.single("row", "px"),
        };
        let point = sensor(given).sensor_from_pixel(pixel);
        assert!(sensor(given).contains(point));
        point_results("x", "y", point)
    }

    fn pixel_from_sensor(given: &Given) -> Results {
        let point = SensorPoint::new(given.single("x", "mm"), given.single("y", "mm"));
        let pixel = sensor(given).pixel_from_sensor(point);
        vec![
            ("col", "px", pixel.col_px.into()),
            ("row", "px", pixel.row_px.into()),
        ]
    }

    fn point_results(x: &'static str, y: &'static str, point: SensorPoint) -> Results {
        vec![(x, "mm", point.x_mm.into()), (y, "mm", point.y_mm.into())]
    }

    fn moved(given: &Given, axis: FmcAxis) -> Results {
        let calibrated = SensorPoint::new(given.single("x0", "mm"), given.single("y0", "mm"));
        let moved = axis.sensor_from_offset(calibrated, given.single("c", "mm"));
        point_results("x", "y", moved)
    }

    fn moved_up(given: &Given) -> Results {
        moved(given, FmcAxis::PlusY)
    }

    fn moved_left(given: &Given) -> Results {
        moved(given, FmcAxis::MinusX)
    }

    fn displacement(given: &Given, lens: Brown) -> Results {
        let d = lens.displacement(given.single("x̄", "mm"), given.single("ȳ", "mm"));
        vec![("Dx", "mm", d.dx_mm.into()), ("Dy", "mm", d.dy_mm.into())]
    }

    fn barrel(given: &Given) -> Results {
        let k1 = given.single("K1", "mm⁻²");
        let lens = Brown {
            k1,
            ..Brown::default()
        };
        let camera = Camera::new(CameraRecord {
            calibration: CalibrationRecord {
                distortion: lens,
                ..calibration()
            },
            ..camera_record()
        })
        .unwrap();
        let mut exposure = Exposure::new(0.1, 0.01);
        exposure.model = CorrectionModel::Static;
        let frame = camera.frame(&exposure).unwrap();
        let measured = SensorPoint::new(given.single("x̄", "mm"), given.single("ȳ", "mm"));
        let ideal = frame.correction.correct(measured).point;
        let mut results = displacement(given, lens);
        results.push(("ideal", "mm", ideal.x_mm.into()));
        results
    }

    fn decentring_p1(given: &Given) -> Results {
        let p1 = given.single("P1", "mm⁻¹");
        displacement(
            given,
            Brown {
                p1,
                ..Brown::default()
            },
        )
    }

    fn decentring_p2(given: &Given) -> Results {
        let p2 = given.single("P2", "mm⁻¹");
        displacement(
            given,
            Brown {
                p2,
                ..Brown::default()
            },
        )
    }

    fn gauge_of_k0(given: &Given) -> Results {
        let [f, k0, k1] = [("f", "mm"), ("K0", ""), ("K1", "mm⁻²")]
            .map(|(symbol, unit)| given.single(symbol, unit));
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

    fn calibration() -> CalibrationRecord {
        CalibrationRecord {
            principal_distance_mm: 100.0,
            exit_pupil_mm: 100.0,
            principal_point: SensorPoint::default(),
            width_px: 9216,
            height_px: 9216,
            pixel_um: 8.75,
            distortion: Brown::default(),
            fitted: None,
            axis: FmcAxis::PlusY,
            stroke_mm: 4.0,
            flatness: Flatness::default(),
        }
    }

    fn camera_record() -> CameraRecord {
        CameraRecord {
            calibration: calibration(),
            mechanism: Mechanism::Stage {
                acceleration_mm_s2: 1000.0,
                settling_ms: 5.0,
                run_up: RunUp::Centred,
            },
            shutter: ShutterProfile::Uniform,
            limits: Limits {
                vh_per_s: [0.0, 1.0],
                exposure_s: [1e-4, 0.1],
            },
        }
    }

    /// The record with the mechanism that is given.
    fn record(given: &Given, run_up: RunUp) -> CameraRecord {
        CameraRecord {
            calibration: CalibrationRecord {
                principal_distance_mm: given.single("f", "mm"),
                ..calibration()
            },
            mechanism: Mechanism::Stage {
                acceleration_mm_s2: given.single("a", "mm/s²"),
                settling_ms: given.single("t_settle", "ms"),
                run_up,
            },
            ..camera_record()
        }
    }

    fn exposure(given: &Given) -> Exposure {
        Exposure::new(given.single("V/H", "1/s"), given.single("t", "s"))
    }

    fn travel(given: &Given) -> Results {
        let (f, exposure) = (given.single("f", "mm"), exposure(given));
        let camera = Camera::new(CameraRecord {
            calibration: CalibrationRecord {
                principal_distance_mm: f,
                ..calibration()
            },
            ..camera_record()
        });
        let motion = camera.unwrap().motion(&exposure).unwrap();
        let travel_mm = f64::from(motion.travel_mm);
        vec![
            ("v", "mm/s", travel_mm / f64::from(exposure.exposure_s)),
            ("δ", "mm", travel_mm),
        ]
    }

    fn planned(given: &Given, run_up: RunUp) -> Results {
        let camera = Camera::new(record(given, run_up)).unwrap();
        let motion = camera.motion(&exposure(given)).unwrap();
        vec![
            ("Δδ", "mm", motion.opening_offset_mm.into()),
            ("c̄", "mm", motion.centroid_mm.into()),
        ]
    }

    fn centred(given: &Given) -> Results {
        planned(given, RunUp::Centred)
    }

    fn from_rest(given: &Given) -> Results {
        planned(given, RunUp::FromRest)
    }

    fn uniform() -> Shutter {
        Shutter::new(ShutterProfile::Uniform).unwrap()
    }

    fn tdi_lag(given: &Given) -> Results {
        let rows = given.single("rows", "");
        let mean = mean_transfers(rows, given.single("φ", ""), &uniform()).unwrap();
        vec![("lag", "px", f64::from(rows / 2.0 - mean))]
    }

    fn unequal_ramps(given: &Given) -> Results {
        let shutter = Shutter::new(ShutterProfile::Trapezoid {
            opening_fraction: given.single("r₁", ""),
            closing_fraction: given.single("r₂", ""),
        })
        .unwrap();
        let t = given.single("t", "s");
        vec![
            ("E[τ]", "s", (shutter.centroid() * t).into()),
            ("effective", "s", (shutter.effective_fraction() * t).into()),
        ]
    }

    /// Ground error of a pair (offset, time) that is not the pair of means, at a terrain
    /// `relief_m` above the height that is compensated.
    fn ground_error(
        given: &Given,
        relief_m: f64,
        pair: impl Fn(&PrincipalPointMotion) -> (f32, f32),
    ) -> Results {
        let [f, v, height] = [("f", "mm"), ("V", "m/s"), ("height", "m")]
            .map(|(symbol, unit)| given.single(symbol, unit));
        let travel = UniformTravel {
            opening_offset_mm: 0.0,
            speed_mm_s: f * v / height,
            exposure_s: given.single("t", "s"),
        };
        let motion = PrincipalPointMotion::from_plan(travel, &uniform());
        let (ground_speed, scale) = (f64::from(v), (f64::from(height) - relief_m) / f64::from(f));
        // Mean image of a point below the aircraft at opening, and the point that the pair makes of it.
        let image = f64::from(motion.centroid_mm)
            - ground_speed * f64::from(motion.centroid_time_s) / scale;
        let (offset_mm, time_s) = pair(&motion);
        let ground = (image - f64::from(offset_mm)) * scale + ground_speed * f64::from(time_s);
        vec![("ground", "m", ground.abs())]
    }

    fn centroid_with_opening_time(given: &Given) -> Results {
        ground_error(given, 0.0, |motion| (motion.centroid_mm, 0.0))
    }

    fn pair_of_opening(given: &Given) -> Results {
        ground_error(given, given.double("relief", "m"), |motion| {
            (motion.opening_offset_mm, 0.0)
        })
    }

    fn pair_of_means(given: &Given) -> Results {
        ground_error(given, given.double("relief", "m"), |motion| {
            (motion.centroid_mm, motion.centroid_time_s)
        })
    }

    fn run_up_not_reported(given: &Given) -> Results {
        let [f, v, height] = [("f", "mm"), ("V", "m/s"), ("height", "m")]
            .map(|(symbol, unit)| given.single(symbol, unit));
        let camera = Camera::new(CameraRecord {
            calibration: CalibrationRecord {
                principal_distance_mm: f,
                ..calibration()
            },
            mechanism: Mechanism::Stage {
                acceleration_mm_s2: given.single("a", "mm/s²"),
                settling_ms: 0.0,
                run_up: RunUp::FromRest,
            },
            ..camera_record()
        });
        let plan = camera.unwrap().plan(&Exposure::new(v / height, 0.01));
        let offset_mm = plan.unwrap().opening_mm;
        vec![
            ("Δδ", "mm", offset_mm.into()),
            ("ground", "m", (offset_mm / f * height).into()),
        ]
    }

    fn focus(given: &Given, sign: FocusSign) -> (FocusShift, f64) {
        let shift = FocusShift {
            shift_mm: given.single("Δz", "µm") / 1000.0,
            principal_distance_mm: given.single("f", "mm"),
            exit_pupil_mm: given.single("L", "mm"),
            sign,
        };
        let distortion = shift
            .distortion_at_fixed_distance(&Brown::default())
            .displacement(given.single("r", "mm"), 0.0);
        (shift, f64::from(distortion.dx_mm) * 1000.0)
    }

    fn focus_physical(given: &Given) -> Results {
        let (shift, distortion_um) = focus(given, FocusSign::Physical);
        let (changed_mm, _) = shift.distortion_at_changed_distance(&Brown::default());
        vec![
            ("κ", "", shift.enlargement().into()),
            ("distortion", "µm", distortion_um),
            ("f(1+κ)", "mm", changed_mm.into()),
        ]
    }

    fn focus_printed(given: &Given) -> Results {
        let (_, distortion_um) = focus(given, FocusSign::Printed);
        vec![("distortion", "µm", distortion_um)]
    }

    fn three_models(given: &Given) -> Results {
        let mut record = record(given, RunUp::FromRest);
        let k1 = given.single("K1", "mm⁻²");
        record.calibration.distortion.k1 = k1;
        record.calibration.fitted = Some(FiveCoefficients {
            km1: k1,
            kd1: given.single("Kd1", "mm⁻²"),
            pm1: given.single("Pm1", "mm⁻²"),
            ..FiveCoefficients::default()
        });
        let camera = Camera::new(record).unwrap();
        let point = SensorPoint::new(given.single("x", "mm"), given.single("y", "mm"));
        [
            ("static", CorrectionModel::Static),
            ("exact", CorrectionModel::Exact),
            ("fitted", CorrectionModel::Fitted),
        ]
        .map(|(name, model)| {
            let exposure = Exposure {
                model,
                ..exposure(given)
            };
            let Frame { record, correction } = camera.frame(&exposure).unwrap();
            assert!((record.principal_point.y_mm - record.motion.centroid_mm).abs() < 1e-9);
            let dy_mm = correction.distortion(point).dy_mm;
            (name, "µm", f64::from(dy_mm) * 1000.0)
        })
        .to_vec()
    }

    fn opencv_principal_point(given: &Given) -> Results {
        let pixel = PixelPoint {
            col_px: given.single("cx", "px"),
            row_px: given.single("cy", "px"),
        };
        point_results("x0", "y0", sensor(given).sensor_from_pixel(pixel))
    }

    fn metashape_principal_point(given: &Given) -> Results {
        let sensor = sensor(given);
        let half = |side_mm: f32| side_mm / sensor.pixel_mm();
        let pixel = PixelPoint {
            col_px: half(sensor.half_width_mm()) + given.single("cx", "px") - 0.5,
            row_px: half(sensor.half_height_mm()) + given.single("cy", "px") - 0.5,
        };
        point_results("x0", "y0", sensor.sensor_from_pixel(pixel))
    }

    fn opencv_radial(given: &Given) -> Results {
        let [k1, k2] = ["k1", "k2"].map(|symbol| given.single(symbol, ""));
        let f = given.single("f", "mm");
        let ideal = given.double("ideal", "mm");
        let r2 = (ideal / f64::from(f)).powi(2);
        let measured = ideal * (1.0 + r2 * (f64::from(k1) + r2 * f64::from(k2)));
        let shown: f32 = measured.to_string().parse().unwrap();
        let f2 = f * f;
        let distortion_um = |k1: f32, k2: f32, k3: f32| {
            let lens = Brown {
                k1: k1 / f2,
                k2: k2 / (f2 * f2),
                k3: k3 / (f2 * f2 * f2),
                ..Brown::default()
            };
            f64::from(lens.displacement(shown, 0.0).dx_mm) * 1000.0
        };
        let leading = distortion_um(k1, k2 - 3.0 * k1 * k1, -8.0 * k1 * k2 + 12.0 * k1 * k1 * k1);
        vec![
            ("measured", "mm", measured),
            ("distortion", "µm", (measured - ideal) * 1000.0),
            ("copied", "µm", distortion_um(k1, k2, 0.0)),
            ("leading order", "µm", leading),
        ]
    }

    fn opencv_decentring(given: &Given) -> Results {
        let f = given.single("f", "mm");
        let (cv1, cv2) = (given.single("p1", ""), given.single("p2", ""));
        let lens = Brown {
            p1: cv2 / f,
            p2: -cv1 / f,
            ..Brown::default()
        };
        for (x, y) in [(20.0, 10.0), (-15.0, 25.0), (5.0, -30.0_f32)] {
            let (u, v) = (x / f, -y / f);
            let r2 = u * u + v * v;
            let du = 2.0 * cv1 * u * v + cv2 * (r2 + 2.0 * u * u);
            let dv = cv1 * (r2 + 2.0 * v * v) + 2.0 * cv2 * u * v;
            let Displacement { dx_mm, dy_mm } = lens.displacement(x, y);
            assert!((dx_mm - du * f).abs() < 1e-7 && (dy_mm + dv * f).abs() < 1e-7);
        }
        vec![
            ("P1", "mm⁻¹", lens.p1.into()),
            ("P2", "mm⁻¹", lens.p2.into()),
        ]
    }

    type Example = (&'static str, fn(&Given) -> Results);

    const EXAMPLES: &[Example] = &[
        ("centre of the first pixel", sensor_from_pixel),
        ("outer corner of the first pixel", sensor_from_pixel),
        ("outer corner of the last pixel", sensor_from_pixel),
        ("pixel coordinate of the array's centre", pixel_from_sensor),
        ("pixel coordinate to the right and above", pixel_from_sensor),
        ("principal point for e = +y", moved_up),
        ("principal point for e = -x", moved_left),
        ("barrel lens", barrel),
        ("decentring P1", decentring_p1),
        ("decentring P2", decentring_p2),
        ("K0 moved into the principal distance", gauge_of_k0),
        ("travel while open", travel),
        ("centred", centred),
        ("from rest", from_rest),
        (
            "TDI, whole rows, first transfer after a row period",
            tdi_lag,
        ),
        (
            "TDI, whole rows, first transfer after half a period",
            tdi_lag,
        ),
        (
            "TDI, a row and a half, first transfer after a row period",
            tdi_lag,
        ),
        (
            "TDI, a row and a half, first transfer after half a period",
            tdi_lag,
        ),
        ("centroid of unequal ramps", unequal_ramps),
        (
            "centroid principal point with the time of opening",
            centroid_with_opening_time,
        ),
        ("run-up not reported", run_up_not_reported),
        (
            "pair of opening, terrain above the compensated height",
            pair_of_opening,
        ),
        (
            "pair of means, terrain above the compensated height",
            pair_of_means,
        ),
        ("detector too far from the lens", focus_physical),
        ("the same with the printed sign", focus_printed),
        ("one point, three models", three_models),
        ("OpenCV principal point", opencv_principal_point),
        ("Metashape principal point", metashape_principal_point),
        ("OpenCV radial coefficients", opencv_radial),
        ("OpenCV decentring", opencv_decentring),
    ];

    #[test]
    fn worked_examples_are_what_the_library_computes() {
        let documented = rows("example");
        let names: Vec<_> = documented.iter().map(|row| row[0]).collect();
        let computed: Vec<_> = EXAMPLES.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, computed);
        for (row, (name, compute)) in documented.iter().zip(EXAMPLES) {
            let printed = entries(row[2]);
            let results = compute(&Given(entries(row[1])));
            assert_eq!(printed.len(), results.len(), "{name}");
            for (entry, (symbol, unit, value)) in printed.iter().zip(results) {
                assert_eq!((entry.symbol, entry.unit), (symbol, unit), "{name}");
                let number: f64 = entry.number.parse().unwrap();
                let tolerance =
                    half_last_digit(entry.number) + 2.0 * f64::from(f32::EPSILON) * number.abs();
                assert!(
                    (value - number).abs() <= tolerance,
                    "{name}: {symbol} = {value}, printed {number}"
                );
            }
        }
    }

    // ---- Ranges and constants ----

    /// The listed quantities; does not compile while one is missing.
    macro_rules! every_quantity {
        ($($variant:ident),* $(,)?) => {{
            let exhaustive = |quantity: Quantity| match quantity {
                $(Quantity::$variant => {})*
            };
            [$(Quantity::$variant),*].map(|quantity| {
                exhaustive(quantity);
                quantity
            })
        }};
    }

    fn every_quantity() -> Vec<Quantity> {
        every_quantity!(
            PrincipalDistanceMm,
            ExitPupilMm,
            PrincipalPointX,
            PrincipalPointY,
            WidthPx,
            HeightPx,
            PixelUm,
            K0,
            K1,
            K2,
            K3,
            P1,
            P2,
            B1,
            B2,
            Km0,
            Km1,
            Km2,
            Kd1,
            Pm1,
            AccelerationMmS2,
            SettlingMs,
            StrokeMm,
            FlatnessUm,
            FirstTransfer,
            TdiRows,
            OpeningFraction,
            ClosingFraction,
            VhPerS,
            ExposureS,
            OpeningOffsetMm,
            FocusShiftUm,
        )
        .to_vec()
    }

    /// The unit that a name ends in.
    fn unit_in(name: &str) -> Option<&'static str> {
        [
            ("_mm_s2", "mm/s²"),
            ("_per_s", "1/s"),
            ("_mm", "mm"),
            ("_um", "µm"),
            ("_px", "px"),
            ("_ms", "ms"),
            ("_s", "s"),
        ]
        .into_iter()
        .find(|(suffix, _)| name.split('[').next().unwrap().ends_with(suffix))
        .map(|(_, unit)| unit)
    }

    #[test]
    fn documented_ranges_are_those_of_the_code() {
        let quantities = every_quantity();
        let mut documented = Vec::new();
        for row in rows("quantity") {
            for name in names(row[0]) {
                let quantity = *quantities
                    .iter()
                    .find(|quantity| quantity.name() == name)
                    .unwrap_or_else(|| panic!("no quantity {name}"));
                let end = |cell: &str, unbounded: f32| match cell {
                    "any" => unbounded,
                    number => number.parse().unwrap(),
                };
                let (least, most) = quantity.range();
                let printed = (end(row[1], f32::MIN), end(row[2], f32::MAX));
                assert_eq!(
                    (printed.0.to_bits(), printed.1.to_bits()),
                    ((least + 0.0).to_bits(), most.to_bits()),
                    "{name}: {printed:?}"
                );
                if let Some(unit) = unit_in(name) {
                    assert_eq!(row[3], unit, "{name}");
                }
                documented.push(quantity.name());
            }
        }
        let all: Vec<_> = quantities.iter().map(|quantity| quantity.name()).collect();
        assert_eq!(
            documented, all,
            "every quantity once, in the order of the code"
        );
    }

    #[test]
    fn documented_constants_are_those_of_the_code() {
        let constants = [
            ("MAX_SIDE_PX", f64::from(MAX_SIDE_PX)),
            ("MAX_SIDE_MM", MAX_SIDE_MM.into()),
            ("MAX_ROWS", MAX_ROWS.into()),
            (
                "FLATNESS_TERMS",
                f64::from(u8::try_from(FLATNESS_TERMS).unwrap()),
            ),
            ("MAX_FOCUS_FRACTION", MAX_FOCUS_FRACTION.into()),
            ("MIN_SCALE", MIN_SCALE.into()),
            ("MAX_DISC_SLOPE", MAX_DISC_SLOPE.into()),
            ("SHORT_KERNEL_NM", SHORT_KERNEL_NM.into()),
            ("LAST_RESIDUAL_NM", LAST_RESIDUAL_NM.into()),
            ("MAX_STEPS", MAX_STEPS.into()),
        ];
        let documented = rows("constant");
        assert_eq!(documented.len(), constants.len());
        for (row, (name, value)) in documented.iter().zip(constants) {
            assert_eq!(names(row[0]), [name]);
            let printed: f32 = row[1].parse().unwrap();
            assert!(
                (f64::from(printed) - value).abs() < 1e-12,
                "{name} = {value}"
            );
        }
    }

    #[test]
    fn further_bounds_are_those_the_code_applies() {
        let refused = |change: fn(&mut CameraRecord)| {
            let mut record = camera_record();
            change(&mut record);
            match Camera::new(record) {
                Err(CalibrationError::OutOfRange(error)) => error,
                other => panic!("not refused: {other:?}"),
            }
        };
        let near = |value: f32, expected: f32| (value - expected).abs() <= 1e-5 * expected.abs();

        let off_array = refused(|record| record.calibration.principal_point.x_mm = 41.0);
        assert_eq!(off_array.quantity, Quantity::PrincipalPointX);
        assert!(near(off_array.max, 9216.0 * 0.008_75 / 2.0));

        let too_long = refused(|record| record.calibration.width_px = 60_000);
        assert_eq!(too_long.quantity, Quantity::WidthPx);
        assert!(near(too_long.max, MAX_SIDE_MM / 0.008_75));

        let ramps = refused(|record| {
            record.shutter = ShutterProfile::Trapezoid {
                opening_fraction: 0.3,
                closing_fraction: 0.8,
            };
        });
        assert_eq!(ramps.quantity, Quantity::ClosingFraction);
        assert!(near(ramps.max, 1.0 - 0.3));

        // 600 µm/mm² at half of 4 mm.
        let bent = refused(|record| record.calibration.flatness.coefficients_um[2] = 600.0);
        assert_eq!(bent.quantity, Quantity::FlatnessUm);
        assert!(near(bent.value, 600.0 * 2.0 * 2.0));

        let mut record = camera_record();
        record.calibration.exit_pupil_mm = 50.0;
        let camera = Camera::new(record).unwrap();
        for model in [
            CorrectionModel::Exact,
            CorrectionModel::Fitted,
            CorrectionModel::Static,
        ] {
            let defocused = Exposure {
                focus_shift_um: 501.0,
                model,
                ..Exposure::new(0.1, 0.01)
            };
            let Err(FrameError::OutOfRange(OutOfRange { quantity, max, .. })) =
                camera.frame(&defocused)
            else {
                panic!("not refused");
            };
            assert_eq!(quantity, Quantity::FocusShiftUm);
            assert!(near(max, MAX_FOCUS_FRACTION * 50.0 * 1000.0));
        }

        let beyond = Exposure {
            opening_offset_mm: Some(1.95),
            ..Exposure::new(0.1, 0.01)
        };
        let Err(FrameError::Stroke(StrokeTooShort { half_stroke_mm, .. })) = camera.frame(&beyond)
        else {
            panic!("not refused");
        };
        assert!(near(half_stroke_mm, 2.0));
    }

    // ---- Names ----

    /// `Type.field`, as documented; does not compile for a field that is not there.
    macro_rules! field {
        ($type:ident . $field:ident) => {{
            let _ = |value: $type| {
                let _ = value.$field;
            };
            concat!(stringify!($type), ".", stringify!($field))
        }};
    }

    /// `Type::name`, as documented, of a method or variant that the pattern or path finds.
    macro_rules! path {
        ($type:ident :: $name:ident) => {{
            let _ = $type::$name;
            concat!(stringify!($type), "::", stringify!($name))
        }};
        ($type:ident :: $name:ident {}) => {{
            let _ = |value: $type| matches!(value, $type::$name { .. });
            concat!(stringify!($type), "::", stringify!($name))
        }};
    }

    #[test]
    fn documented_names_are_those_of_the_code() {
        let code: BTreeSet<&str> = BTreeSet::from([
            field!(SensorPoint.x_mm),
            field!(SensorPoint.y_mm),
            field!(PixelPoint.col_px),
            field!(PixelPoint.row_px),
            field!(CalibrationRecord.width_px),
            field!(CalibrationRecord.height_px),
            field!(CalibrationRecord.pixel_um),
            field!(CalibrationRecord.principal_point),
            field!(CalibrationRecord.principal_distance_mm),
            field!(CalibrationRecord.exit_pupil_mm),
            field!(CalibrationRecord.axis),
            field!(CalibrationRecord.stroke_mm),
            field!(Displacement.dx_mm),
            field!(Displacement.dy_mm),
            field!(Brown.k0),
            field!(Brown.k1),
            field!(Brown.k2),
            field!(Brown.k3),
            field!(Brown.p1),
            field!(Brown.p2),
            field!(Brown.b1),
            field!(Brown.b2),
            field!(FiveCoefficients.km0),
            field!(FiveCoefficients.km1),
            field!(FiveCoefficients.km2),
            field!(FiveCoefficients.kd1),
            field!(FiveCoefficients.pm1),
            path!(FmcAxis::sign),
            field!(StageSample.offset_mm),
            field!(StageSample.time_s),
            field!(Exposure.vh_per_s),
            field!(Exposure.exposure_s),
            field!(Exposure.opening_offset_mm),
            field!(UniformTravel.speed_mm_s),
            field!(PrincipalPointMotion.opening_offset_mm),
            field!(PrincipalPointMotion.travel_mm),
            field!(PrincipalPointMotion.centroid_time_s),
            field!(PrincipalPointMotion.centroid_mm),
            field!(CentralMoments.second),
            field!(CentralMoments.third),
            field!(CentralMoments.fourth),
            field!(FrameRecord.principal_point),
            field!(FrameRecord.focus_shift_mm),
            field!(FrameRecord.enlargement),
            path!(ShutterProfile::Trapezoid {}),
            field!(CameraRecord.mechanism),
            path!(RunUp::Centred {}),
            path!(RunUp::FromRest {}),
            path!(Mechanism::Stage {}),
            path!(Mechanism::Tdi {}),
            field!(Flatness.coefficients_um),
            field!(FocusShift.shift_mm),
            path!(FocusShift::enlargement),
        ]);
        let symbols = rows("symbol");
        let documented: BTreeSet<&str> = symbols.iter().flat_map(|row| names(row[3])).collect();
        assert_eq!(documented, code);
    }

    /// The keys of the camera file, with their table, from the fields that are read.
    fn camera_file_keys() -> BTreeSet<String> {
        let mut table = None;
        let mut keys = BTreeSet::new();
        for line in CAMERA_FILE.lines() {
            if let Some(name) = line.strip_prefix("pub struct ") {
                table = match name.trim_end_matches(" {") {
                    "CameraFile" => Some(""),
                    "SensorTable" => Some("sensor."),
                    "DistortionTable" => Some("distortion."),
                    "FmcTable" => Some("fmc."),
                    "ShutterTable" => Some("shutter."),
                    "LimitsTable" => Some("limits."),
                    "FittedTable" => Some("fitted."),
                    other => panic!("unknown table {other}"),
                };
            } else if line == "}" {
                table = None;
            } else if let (Some(table), Some(field)) = (table, line.strip_prefix("    pub ")) {
                let (key, kind) = field.split_once(':').unwrap();
                if !kind.contains("Table") && key != "name" {
                    keys.insert(format!("{table}{key}"));
                }
            }
        }
        keys
    }

    #[test]
    fn documented_keys_are_those_of_the_camera_file() {
        let symbols = rows("symbol");
        let documented: BTreeSet<String> = symbols
            .iter()
            .flat_map(|row| names(row[4]))
            .map(str::to_owned)
            .collect();
        assert_eq!(documented, camera_file_keys());
    }

    #[test]
    fn numbers_with_a_unit_stand_only_in_tables_that_are_checked() {
        const UNITS: &[&str] = &[
            "mm", "µm", "nm", "m", "cm", "px", "s", "ms", "1/s", "mm/s", "m/s", "%", "rows",
        ];
        let checked = ["example", "quantity", "constant"].map(rows).concat();
        let checked: BTreeSet<_> = checked.iter().map(|row| row.join(" | ")).collect();
        for line in DOCUMENT.lines() {
            let cells: Vec<_> = line.trim_matches('|').split('|').map(str::trim).collect();
            if checked.contains(&cells.join(" | ")) {
                continue;
            }
            let words: Vec<_> = line.split_whitespace().collect();
            for pair in words.windows(2) {
                let unit = pair[1].trim_end_matches(['.', ',', ';', ':', ')', '*']);
                let number = pair[0].trim_start_matches(['(', '*']);
                assert!(
                    !(UNITS.contains(&unit) && number.parse::<f64>().is_ok()),
                    "unchecked number: {line}"
                );
            }
        }
    }
}
