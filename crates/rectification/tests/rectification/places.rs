//! Places of output pixels against double precision.

use fastrand::Rng;
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::grid::{GridCarrier, GridHeader};
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::GridFiles;
use fmc_rectification::{Centre, Rectification, Request, Resampling, Window};
use fmc_reference::residual_splines::ResidualSplines;

use crate::cameras::{Case, published_in_flight, random};

/// Returns the distortion by the evaluation form, term by term.
fn distortion(correction: &FrameCorrection, [x, y]: [f64; 2]) -> [f64; 2] {
    let form = correction.form();
    let [k0, k1, k2, k3] = [form.k0, form.k1, form.k2, form.k3].map(f64::from);
    let [hx, hy, gx, gy] = [form.hx, form.hy, form.gx, form.gy].map(f64::from);
    let [b1, b2, tx, ty] = [form.b1, form.b2, form.tx, form.ty].map(f64::from);
    let x = x - f64::from(correction.centre().x_mm);
    let y = y - f64::from(correction.centre().y_mm);
    let r2 = x * x + y * y;
    let gain = k0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3) + hx * x + hy * y;
    [
        x * gain + gx * r2 + b1 * x + b2 * y + tx,
        y * gain + gy * r2 + ty,
    ]
}

/// Residual grids of a case in double precision, by another formula than that of the mesh: splines
/// by recursion, at the place of the frame.
#[derive(Default)]
struct Residual {
    splines: ResidualSplines,
    shift_mm: [f64; 2],
    scale: f64,
}

impl Residual {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let of_lens = [
            (x - self.shift_mm[0]) / self.scale,
            (y - self.shift_mm[1]) / self.scale,
        ];
        let ([lx, ly], [sx, sy]) = (
            self.splines.of_lens(of_lens),
            self.splines.of_sensor([x, y]),
        );
        [lx + sx, ly + sy]
    }
}

/// Returns the exact place of an output pixel in the source image.
fn exact(
    correction: &FrameCorrection,
    residual: &Residual,
    middle: SensorPoint,
    size_px: [u32; 2],
    pixel: [u32; 2],
) -> [f64; 2] {
    exact_of_point(correction, residual, middle, size_px, pixel.map(f64::from))
}

/// Returns the exact place of a point of the output image in the source image of a camera without
/// grids, pixels; the centre of the first pixel is (0, 0) in both.
pub(crate) fn exact_place(
    correction: &FrameCorrection,
    middle: SensorPoint,
    size_px: [u32; 2],
    point: [f64; 2],
) -> [f64; 2] {
    let residual = Residual {
        scale: 1.0,
        ..Residual::default()
    };
    exact_of_point(correction, &residual, middle, size_px, point)
}

fn exact_of_point(
    correction: &FrameCorrection,
    residual: &Residual,
    middle: SensorPoint,
    size_px: [u32; 2],
    [col, row]: [f64; 2],
) -> [f64; 2] {
    let sensor = correction.sensor();
    let p = f64::from(sensor.pixel_mm());
    let [width, height] = size_px.map(f64::from);
    let ideal = [
        (col - (width - 1.0) / 2.0) * p + f64::from(middle.x_mm),
        ((height - 1.0) / 2.0 - row) * p + f64::from(middle.y_mm),
    ];
    let mut d = [0.0, 0.0];
    for _ in 0..100 {
        let measured = [ideal[0] + d[0], ideal[1] + d[1]];
        let ([px, py], [rx, ry]) = (distortion(correction, measured), residual.at(measured));
        let step = (px + rx - d[0]).hypot(py + ry - d[1]);
        d = [px + rx, py + ry];
        if step < 1e-14 {
            break;
        }
    }
    [
        (f64::from(sensor.width_px()) - 1.0) / 2.0 + (ideal[0] + d[0]) / p,
        (f64::from(sensor.height_px()) - 1.0) / 2.0 - (ideal[1] + d[1]) / p,
    ]
}

/// Compares random pixels of a frame, and all along its edges; returns the largest error by the
/// bound.
fn compare(case: &Case, rng: &mut Rng, window: Window, centre: Centre) -> f64 {
    let correction = GriddedCorrection::from(&case.correction);
    let residual = Residual {
        scale: 1.0,
        ..Residual::default()
    };
    compare_with(case, (&correction, &residual), rng, window, centre)
}

/// Compares a frame with residual grids.
fn compare_with(
    case: &Case,
    (correction, residual): (&GriddedCorrection<'_>, &Residual),
    rng: &mut Rng,
    window: Window,
    centre: Centre,
) -> f64 {
    let name = &case.name;
    let request = Request {
        window,
        centre,
        resampling: Resampling::Bicubic,
    };
    let made = Rectification::new(*correction, case.principal_point, &request);
    let made = made.unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(
        made.mesh_bound_px() <= 0.001,
        "{name}: {}",
        made.mesh_bound_px()
    );
    let middle = match centre {
        Centre::PrincipalPoint => case.principal_point,
        Centre::Frame => SensorPoint::default(),
    };
    let size_px = made.output_size_px();
    let [width, height] = size_px;
    let sensor = case.correction.sensor();
    let mut largest = 0.0_f64;
    let mut compared = 0;
    let mut check = |col: u32, row: u32| {
        let [x, y] = exact(&case.correction, residual, middle, size_px, [col, row]);
        let within = |place: f64, side: u32| (-0.5..=f64::from(side) - 0.5).contains(&place);
        let is_on = within(x, sensor.width_px()) && within(y, sensor.height_px());
        if !is_on {
            return;
        }
        let place = made.mesh().place_px([col, row]);
        let [found_x, found_y] = place
            .unwrap_or_else(|| panic!("{name}: no place of {col}, {row}, which is at {x}, {y}"));
        let error = (found_x - x).hypot(found_y - y);
        assert!(
            error <= made.mesh_bound_px(),
            "{name}: {col}, {row}: {error} px, bound {}",
            made.mesh_bound_px()
        );
        let rows = made.source_rows(row..row + 1);
        let within_rows =
            |place: f64| (f64::from(rows.start)..f64::from(rows.end)).contains(&place);
        let nearest = y.clamp(0.0, f64::from(sensor.height_px()) - 1.0).round();
        assert!(
            within_rows(nearest),
            "{name}: {col}, {row} at {y}, rows {rows:?}"
        );
        largest = largest.max(error);
        compared += 1;
    };
    for _ in 0..100 {
        check(rng.u32(0..width), rng.u32(0..height));
    }
    for _ in 0..20 {
        let (col, row) = (rng.u32(0..width), rng.u32(0..height));
        for depth in 0..20.min(width.min(height)) {
            check(col, depth);
            check(col, height - 1 - depth);
            check(depth, row);
            check(width - 1 - depth, row);
        }
    }
    assert!(compared >= 10, "{name}: {compared} places compared");
    largest / made.mesh_bound_px()
}

#[test]
fn the_bound_of_the_mesh_is_never_exceeded() {
    let mut rng = Rng::with_seed(19);
    let windows = [
        Window::Same,
        Window::Inside,
        Window::Full,
        Window::Size([333, 777]),
    ];
    let mut reached = 0.0_f64;
    for case in published_in_flight() {
        reached = reached.max(compare(
            &case,
            &mut rng,
            Window::Full,
            Centre::PrincipalPoint,
        ));
    }
    for number in 0..100 {
        let side_px = rng.u32(300..4000);
        let case = random(&mut rng, side_px);
        let centre = [Centre::PrincipalPoint, Centre::Frame][number % 2];
        reached = reached.max(compare(&case, &mut rng, windows[number % 4], centre));
    }
    println!("{reached}");
    // A bound that is far above every error would say nothing.
    assert!(reached > 0.3, "at most {reached} of the bound");
}

/// Returns the file of a grid that covers a camera, of random structure with waves of a few nodes.
fn grid(rng: &mut Rng, carrier: GridCarrier, half_mm: [f64; 2]) -> Vec<u8> {
    let pitch_mm = 0.1 * half_mm[0];
    let nodes = half_mm.map(|half| 2 * ((half + 2.2) / pitch_mm).ceil() as u16 + 4);
    let first = nodes.map(|nodes| -0.5 * f64::from(nodes - 1) * pitch_mm);
    let header = GridHeader {
        carrier,
        columns: nodes[0],
        rows: nodes[1],
        first_node: SensorPoint::new(first[0] as f32, first[1] as f32),
        pitch_mm: pitch_mm as f32,
        scale_mm: 2e-7,
    };
    let mut file = header.to_bytes().to_vec();
    for _ in 0..2 * usize::from(nodes[0]) * usize::from(nodes[1]) {
        file.extend(rng.i16(-15_000..15_000).to_le_bytes());
    }
    file.extend(GridHeader::checksum(&file).to_le_bytes());
    file
}

/// Grids of up to 3 µm bend the map more than most polynomials: the mesh becomes finer, and its
/// bound holds.
#[test]
fn the_bound_of_the_mesh_holds_with_residual_grids() {
    let mut rng = Rng::with_seed(21);
    let windows = [Window::Same, Window::Inside, Window::Full];
    let mut reached = 0.0_f64;
    for number in 0..18 {
        let side_px = rng.u32(300..1200);
        let mut case = random(&mut rng, side_px);
        case.file.fmc.flatness_um = vec![0.0, 20.0];
        let half_mm = case.file.half_format_mm();
        let part =
            |rng: &mut Rng, carrier, is_there: bool| is_there.then(|| grid(rng, carrier, half_mm));
        let lens = part(&mut rng, GridCarrier::Lens, number % 3 != 0);
        let sensor = part(&mut rng, GridCarrier::Sensor, number % 3 != 1);
        let files = GridFiles::new(lens, sensor);
        let camera = Camera::new(case.file.parameters()).unwrap();
        let grids = files.grids(camera.calibration()).unwrap();
        let [vh_per_s, exposure_s] = case.exposure;
        let frame = camera.frame(&Exposure::new(vh_per_s, exposure_s)).unwrap();
        let gridded = GriddedFrame::new(&frame, &grids);
        case.correction = frame.correction;
        case.principal_point = frame.interior.principal_point;
        let centroid_mm = f64::from(frame.interior.motion.centroid_mm);
        let residual = Residual {
            splines: ResidualSplines::of(&grids),
            shift_mm: case.file.fmc.axis.unit().map(|axis| centroid_mm * axis),
            scale: 1.0 + f64::from(frame.interior.enlargement),
        };
        let centre = [Centre::PrincipalPoint, Centre::Frame][number % 2];
        let judged = (&gridded.correction, &residual);
        reached = reached.max(compare_with(
            &case,
            judged,
            &mut rng,
            windows[number % 3],
            centre,
        ));
    }
    println!("{reached}");
    assert!(reached > 0.05, "at most {reached} of the bound");
}
