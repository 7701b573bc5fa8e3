//! Rows of rectified images.

use fastrand::Rng;
use fmc_camera_kernel::host::Level;
use fmc_rectification::{Centre, Rectification, Request, Resampling, RowError, SourceBand, Window};

use crate::cameras::{Case, random};

fn made(case: &Case, window: Window, resampling: Resampling) -> Rectification {
    let request = Request {
        window,
        centre: Centre::PrincipalPoint,
        resampling,
    };
    Rectification::new(&case.correction, case.principal_point, &request).unwrap()
}

#[test]
fn every_row_needs_the_rows_it_says_and_no_level_or_band_changes_it() {
    let mut rng = Rng::with_seed(31);
    let windows = [
        Window::Same,
        Window::Inside,
        Window::Full,
        Window::Size([700, 90]),
    ];
    let mut border_rows = 0;
    for number in 0..20 {
        let case = random(&mut rng, 500);
        let sensor = case.correction.sensor();
        let size_px = [sensor.width_px(), sensor.height_px()];
        let [width, height] = size_px.map(|side| side as usize);
        let image: Vec<u16> = (0..3 * width * height).map(|_| rng.u16(..)).collect();
        let rows: Vec<&[u16]> = image.chunks(3 * width).collect();
        let all = SourceBand::new(size_px, 3, 0, &rows).unwrap();
        let made = made(&case, windows[number % 4], Resampling::ALL[number % 5]);
        let [out_width, out_height] = made.output_size_px();
        let mut out = vec![0; 3 * out_width as usize];
        let mut mask = vec![0; out_width as usize];
        for row in 0..out_height {
            let border = made.row(row, &all, &mut out, &mut mask).unwrap();
            let on: u32 = mask.iter().map(|mask| u32::from(*mask)).sum();
            assert_eq!(out_width - on, border);
            let needed = made.source_rows(row..row + 1);
            border_rows += u32::from(border == out_width);
            if needed.is_empty() {
                assert_eq!(border, out_width);
            }
            let some = &rows[needed.start as usize..needed.end as usize];
            let band = SourceBand::new(size_px, 3, needed.start, some).unwrap();
            for level in Level::all() {
                let (mut again, mut mask_again) = (vec![9; out.len()], vec![9; mask.len()]);
                let made = made.clone().at(level);
                let found = made.row(row, &band, &mut again, &mut mask_again).unwrap();
                let same = found == border && again == out && mask_again == mask;
                assert!(same, "{}, {level}, row {row}", case.name);
            }
            let wide = made.source_rows(row.saturating_sub(40)..(row + 40).min(out_height));
            let within = wide.start <= needed.start && needed.end <= wide.end;
            assert!(needed.is_empty() || within, "{wide:?}, {needed:?}");
        }
    }
    assert!(border_rows > 0, "no row was all border");
}

#[test]
fn what_does_not_fit_is_an_error_that_names_it() {
    let mut rng = Rng::with_seed(37);
    let case = random(&mut rng, 400);
    let sensor = case.correction.sensor();
    let size_px = [sensor.width_px(), sensor.height_px()];
    let [width, height] = size_px.map(|side| side as usize);
    let image = vec![0_u8; width * height];
    let rows: Vec<&[u8]> = image.chunks(width).collect();
    let made = made(&case, Window::Same, Resampling::Bicubic);
    let all = SourceBand::new(size_px, 1, 0, &rows).unwrap();
    let (mut out, mut mask) = (vec![0; width], vec![0; width]);
    let height_px = size_px[1];
    let off = made.row(height_px, &all, &mut out, &mut mask);
    let row_px = height_px;
    assert_eq!(off, Err(RowError::OffImage { row_px, height_px }));
    let few = SourceBand::new(size_px, 1, 0, &rows[..2]).unwrap();
    let missing = made.row(height_px / 2, &few, &mut out, &mut mask);
    let missing = missing.unwrap_err().to_string();
    assert!(missing.contains("rows [0, 2] are there"), "{missing}");
    let short = made.row(0, &all, &mut out[1..], &mut mask);
    assert!(matches!(short, Err(RowError::Length { .. })));
    let small = SourceBand::new([size_px[0], 2], 1, 0, &rows[..2]).unwrap();
    let other = made.row(0, &small, &mut out, &mut mask);
    assert!(matches!(other, Err(RowError::Size { .. })));
    let empty = Request {
        window: Window::Size([0, 10]),
        ..Request::default()
    };
    let empty = Rectification::new(&case.correction, case.principal_point, &empty);
    let empty = empty.unwrap_err().to_string();
    assert!(
        empty.contains("0 x 10 pixels, outside 1 to 100000"),
        "{empty}"
    );
}
