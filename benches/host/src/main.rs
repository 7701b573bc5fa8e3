//! Time per point on this PC, as CSV on standard output.
use std::hint::black_box;
mod timing;
use fmc_camera_kernel::Coefficients;
use fmc_camera_kernel::host::{Batch, Level, Terms};
use timing::{Contender, by_turns};

fn main() {
    let form = Coefficients {
        cx: 0.01,
        cy: 0.05,
        k0: 1e-5,
        k1: -1e-7,
        k2: 1e-11,
        k3: 1e-15,
        hx: 1e-8,
        hy: 2e-8,
        gx: 1e-8,
        gy: 3e-9,
        b1: 1e-5,
        b2: 1e-5,
        tx: 1e-6,
        ty: 1e-6,
    };
    let which: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse::<f64>().ok())
        .map(|f| f as usize)
        .collect();
    for n in which {
        let x: Vec<f32> = (0..n).map(|i| (i % 8001) as f32 * 0.01 - 40.0).collect();
        let y: Vec<f32> = (0..n).map(|i| (i % 7919) as f32 * 0.01 - 39.0).collect();
        let pairs: Vec<[f32; 2]> = x.iter().zip(&y).map(|(x, y)| [*x, *y]).collect();
        let (mut ax, mut ay) = (vec![0f32; n], vec![0f32; n]);
        let mut ap = vec![[0f32; 2]; n];
        let cell = std::cell::RefCell::new((&mut ax, &mut ay, &mut ap));
        let k = Batch::new(form, Terms::Short).threaded_from(0);
        let mut c = vec![];
        c.push(Contender::new("memcpy", || {
            let mut b = cell.borrow_mut();
            b.0.copy_from_slice(black_box(&x));
            b.1.copy_from_slice(black_box(&y));
            black_box(&mut *b);
        }));
        c.push(Contender::new("memcpy pairs", || {
            let mut b = cell.borrow_mut();
            b.2.copy_from_slice(black_box(&pairs));
            black_box(&mut *b);
        }));
        for level in Level::all() {
            for (terms, t) in [(Terms::Short, "short"), (Terms::Full, "full")] {
                for (stream, s) in [(usize::MAX, ""), (0, " stream")] {
                    let k = Batch::new(form, terms)
                        .at(level)
                        .in_one_thread()
                        .streamed_from(stream);
                    let (cell, x, y, pairs) = (&cell, &x, &y, &pairs);
                    c.push(Contender::new(format!("{level} {t} into{s}"), move || {
                        let mut b = cell.borrow_mut();
                        let b = &mut *b;
                        k.xy_into([black_box(x), black_box(y)], [b.0, b.1]);
                        black_box(b);
                    }));
                    c.push(Contender::new(
                        format!("{level} {t} pairs into{s}"),
                        move || {
                            let mut b = cell.borrow_mut();
                            let b = &mut *b;
                            k.pairs_into(black_box(pairs), b.2);
                            black_box(b);
                        },
                    ));
                    if stream > 0 {
                        c.push(Contender::new(format!("{level} {t} inplace"), move || {
                            let mut b = cell.borrow_mut();
                            let b = &mut *b;
                            k.xy(b.0, b.1);
                            black_box(b);
                        }));
                        c.push(Contender::new(
                            format!("{level} {t} pairs inplace"),
                            move || {
                                let mut b = cell.borrow_mut();
                                let b = &mut *b;
                                k.pairs(b.2);
                                black_box(b);
                            },
                        ));
                    }
                }
            }
        }
        c.push(Contender::new("threads into", || {
            let mut b = cell.borrow_mut();
            let b = &mut *b;
            k.xy_into([black_box(&x), black_box(&y)], [b.0, b.1]);
            black_box(b);
        }));
        let times = by_turns(
            &mut c,
            std::env::var("ROUNDS")
                .ok()
                .and_then(|r| r.parse().ok())
                .unwrap_or(41),
        );
        for t in &times {
            println!(
                "{n},{},{:.3},{:.3},{:.3}",
                t.name,
                1e9 * t.best() / n as f64,
                1e9 * t.median() / n as f64,
                t.ratio(&times[0])
            );
        }
    }
}
