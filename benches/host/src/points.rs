//! Points that all contenders get, and space for their results.

use std::cell::RefCell;

/// Points over the sensor of an RC30 scanned at 8.75 µm, in mm and in pixels.
pub(crate) struct Points {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) pairs: Vec<[f32; 2]>,
    pub(crate) answers: RefCell<Answers>,
}

/// Space for results.
pub(crate) struct Answers {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) pairs: Vec<[f32; 2]>,
    /// Distortion.
    pub(crate) dx: Vec<f32>,
    pub(crate) dy: Vec<f32>,
}

impl Points {
    pub(crate) fn new(count: usize) -> Self {
        let pairs: Vec<[f32; 2]> = (0_u16..=u16::MAX)
            .cycle()
            .take(count)
            .map(|index| {
                [
                    f32::from(index % 8_009) * 0.01 - 40.0,
                    f32::from(index % 7_919) * 0.01 - 39.5,
                ]
            })
            .collect();
        let (x, y): (Vec<f32>, Vec<f32>) = pairs.iter().map(|[x, y]| (*x, *y)).unzip();
        let answers = RefCell::new(Answers {
            x: x.clone(),
            y: y.clone(),
            pairs: pairs.clone(),
            dx: x.clone(),
            dy: y.clone(),
        });
        Self {
            x,
            y,
            pairs,
            answers,
        }
    }
}
