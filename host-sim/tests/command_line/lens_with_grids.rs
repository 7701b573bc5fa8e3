//! Image points through a lens with residual grids.

use std::fmt::Write as _;

use fmc_reference::residual_splines::ResidualSplines;

/// Lens over the sensor in one exposure, with a polynomial of K1 alone.
pub(crate) struct Lens<'a> {
    pub(crate) principal_point_mm: [f64; 2],
    pub(crate) k1: f64,
    /// c̄ along +y, mm.
    pub(crate) offset_mm: f64,
    /// 1+κ.
    pub(crate) scale: f64,
    pub(crate) grids: &'a ResidualSplines,
}

impl Lens<'_> {
    /// Returns the measured point with the grids of the ray whose measured point without them is
    /// given: ρ - K1·r²ρ - G is the same, by iteration.
    pub(crate) fn measured(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x0, y0] = self.principal_point_mm;
        let mut rho = [x - x0, y - y0 - self.offset_mm].map(|mm| mm / self.scale);
        let distortion = |[x, y]: [f64; 2]| [x, y].map(|mm| mm * self.k1 * (x * x + y * y));
        let [dx, dy] = distortion(rho);
        let aim = [rho[0] - dx, rho[1] - dy];
        let point = |[x, y]: [f64; 2]| [x0 + self.scale * x, y0 + self.offset_mm + self.scale * y];
        for _ in 0..60 {
            let measured = point(rho);
            let motion = [0.0, self.offset_mm];
            let added = self.grids.moved(measured, motion, self.scale - 1.0);
            let distortion = distortion(rho);
            rho = [0, 1].map(|axis| aim[axis] + distortion[axis] + added[axis]);
        }
        point(rho)
    }
}

/// Returns a table with the two columns of points replaced.
pub(crate) fn with_points(
    text: &str,
    mut point: impl FnMut(&[&str], [f64; 2]) -> [f64; 2],
) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let place = |name: &str| header.split(',').position(|one| one == name).unwrap();
    let places = [place("x_mm"), place("y_mm")];
    let mut changed = format!("{header}\n");
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let found = point(&cells, places.map(|place| cells[place].parse().unwrap()));
        let cells: Vec<String> = (0..)
            .zip(&cells)
            .map(
                |(place, cell)| match places.iter().position(|one| *one == place) {
                    Some(axis) => format!("{:.12}", found[axis]),
                    None => (*cell).to_owned(),
                },
            )
            .collect();
        writeln!(changed, "{}", cells.join(",")).unwrap();
    }
    changed
}
