//! Nodes of a residual grid.

use fmc_camera::geometry::grid::{MAX_NODES, MIN_SIDE_NODES};
use fmc_camera_file::InputError;
use fmc_camera_file::number::single;

/// Weights of the four nodes of a cell along one axis.
const ORDER: usize = 4;

/// Places of the nodes of a residual grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    first_mm: [f64; 2],
    pitch_mm: f64,
    columns: u16,
    rows: u16,
}

impl Lattice {
    /// Returns the lattice whose cells cover a rectangle about its middle, with one node beyond on
    /// every side.
    ///
    /// # Errors
    /// [`InputError`] for a pitch that is not a positive number, and for more nodes than a camera
    /// holds.
    pub fn covering(
        [from_x, from_y]: [f64; 2],
        [to_x, to_y]: [f64; 2],
        pitch_mm: f64,
    ) -> Result<Self, InputError> {
        if !(pitch_mm.is_finite() && pitch_mm > 0.0) {
            return Err(InputError::invalid(format!(
                "pitch {pitch_mm} mm; allowed: a positive number"
            )));
        }
        // The cells of a single-precision grid begin and end within a rounding of their place.
        let cells = |from: f64, to: f64| ((to - from) / pitch_mm + 1e-4).ceil().max(1.0);
        let cells = [cells(from_x, to_x), cells(from_y, to_y)];
        let [columns, rows] = cells.map(|cells| cells + f64::from(MIN_SIDE_NODES - 1));
        if columns * rows > f64::from(MAX_NODES) {
            // The side of a square cell of as many as there may be, rounded up to two digits.
            let area = (to_x - from_x) * (to_y - from_y);
            let least = 1.1 * (area / f64::from(MAX_NODES)).sqrt();
            let step = 10.0_f64.powf(least.log10().floor() - 1.0);
            return Err(InputError::invalid(format!(
                "pitch {pitch_mm} mm: {columns} x {rows} nodes over {:.1} x {:.1} mm; allowed: at \
                 most {MAX_NODES}, so {} mm and more",
                to_x - from_x,
                to_y - from_y,
                single((least / step).ceil() * step)
            )));
        }
        let [across, along] = cells;
        let first =
            |from: f64, to: f64, cells: f64| 0.5 * (from + to) - (0.5 * cells + 1.0) * pitch_mm;
        Ok(Self {
            first_mm: [first(from_x, to_x, across), first(from_y, to_y, along)],
            pitch_mm,
            columns: whole(columns),
            rows: whole(rows),
        })
    }

    /// First node, mm.
    #[must_use]
    pub const fn first_mm(&self) -> [f64; 2] {
        self.first_mm
    }

    /// Distance of neighbouring nodes, mm.
    #[must_use]
    pub const fn pitch_mm(&self) -> f64 {
        self.pitch_mm
    }

    /// Nodes along x and y.
    #[must_use]
    pub const fn sides(&self) -> [u16; 2] {
        [self.columns, self.rows]
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Returns the number of the cell of a point; `None` outside the cells.
    #[must_use]
    pub fn cell_at(&self, point_mm: [f64; 2]) -> Option<usize> {
        let [(first, _), ..] = self.weights(point_mm)?;
        Some(first)
    }

    /// Returns the centres of the cells, mm.
    pub fn cell_centres_mm(&self) -> impl Iterator<Item = [f64; 2]> {
        let [first_x, first_y] = self.first_mm;
        let centre = |first: f64, cell: u16| first + (f64::from(cell) - 0.5) * self.pitch_mm;
        (2..self.rows.saturating_sub(1)).flat_map(move |row| {
            (2..self.columns.saturating_sub(1))
                .map(move |column| [centre(first_x, column), centre(first_y, row)])
        })
    }

    /// Returns the nodes on which the value at a point depends, with their weights; `None` outside
    /// the cells.
    #[must_use]
    pub fn weights(&self, [x, y]: [f64; 2]) -> Option<[(usize, f64); ORDER * ORDER]> {
        let [first_x, first_y] = self.first_mm;
        let (column, across) = cell((x - first_x) / self.pitch_mm, self.columns)?;
        let (row, along) = cell((y - first_y) / self.pitch_mm, self.rows)?;
        let mut found = [(0, 0.0); ORDER * ORDER];
        let pairs = (row..).zip(along).flat_map(|(row, along)| {
            let first = row * usize::from(self.columns) + column;
            (first..)
                .zip(across)
                .map(move |(node, across)| (node, across * along))
        });
        for (found, pair) in found.iter_mut().zip(pairs) {
            *found = pair;
        }
        Some(found)
    }
}

/// Returns the first of the four nodes of a cell, and their weights.
fn cell(place: f64, nodes: u16) -> Option<(usize, [f64; ORDER])> {
    let last = f64::from(nodes.checked_sub(3)?);
    if !(place >= 1.0 && place <= last + 1.0) {
        return None;
    }
    let cell = place.floor().min(last);
    let u = place - cell;
    let rest = 1.0 - u;
    let inner = |u: f64| (3.0 * u.powi(3) - 6.0 * u.powi(2) + 4.0) / 6.0;
    let weights = [rest.powi(3) / 6.0, inner(u), inner(rest), u.powi(3) / 6.0];
    Some((usize::from(whole(cell - 1.0)), weights))
}

/// Returns a small whole number.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number between 0 and 4096"
)]
const fn whole(number: f64) -> u16 {
    number as u16
}
