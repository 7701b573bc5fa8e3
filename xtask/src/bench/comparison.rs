//! Comparison of the cost of a point on every core, for this project and for others.

use serde::{Deserialize, Serialize};

use super::{cost::Instructions, cycles::Cycles};

/// Counted row with which others are compared: the function that a user would call on a core.
const OURS: &str = "correct_slice";

/// End of the name of the timed row with which others are compared; the row of the widest vectors
/// comes first.
pub(super) const OURS_ON_A_PC: &str = " short x, y";

/// Counted rows that are compared.
pub(super) const COMPARED: [&str; 16] = [
    OURS,
    "correct_slice_xy",
    "correct_slice_full",
    "correct_slice_xy_full",
    "correct",
    "correct_full",
    "distort_slice",
    "distort_slice_full",
    "distort",
    "distort_full",
    "mesh_row",
    "mesh_row_k3",
    "mesh_source_row",
    "opencv_ros_camera_undistort",
    "opencv_ros_camera_distort",
    "opencv_ros_camera_project",
];

/// Row of `docs/performance.csv`; costs are per point, or per what `unit` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) core: String,
    pub(super) kernel: String,
    #[serde(rename = "instructions_per_point")]
    pub(super) instructions: Option<f64>,
    pub(super) unit: String,
    pub(super) compiler: String,
    /// Number of points per call, for timed rows.
    pub(super) points: Option<u32>,
    #[serde(rename = "cycles_per_point")]
    pub(super) cycles: Option<f64>,
    /// Model of the cycles, or the clock by which a time was converted into cycles.
    pub(super) cycles_by: String,
    #[serde(rename = "ns_per_point")]
    pub(super) ns: Option<f64>,
    /// Time relative to that of copying the same bytes.
    pub(super) of_memcpy: Option<f64>,
    /// Cost relative to that of the correction of the same points on this core: instructions, on a
    /// PC time.
    pub(super) of_ours: Option<f64>,
}

/// Returns all rows, counted, modelled and timed, in one table.
pub(super) fn rows(counted: &[Instructions], cycles: &[Cycles], timed: Vec<Row>) -> Vec<Row> {
    let counted = counted.iter().map(|row| {
        let is_it = |cycles: &&Cycles| (cycles.core, cycles.kernel) == (&*row.core, &*row.kernel);
        let cycles = cycles.iter().find(is_it);
        Row {
            core: row.core.clone(),
            kernel: row.kernel.clone(),
            instructions: Some(row.count),
            unit: row.unit.clone(),
            compiler: row.compiler.clone(),
            points: None,
            cycles: cycles.map(|cycles| rounded(cycles.per_point)),
            cycles_by: cycles.map(|cycles| cycles.by.clone()).unwrap_or_default(),
            ns: None,
            of_memcpy: None,
            of_ours: None,
        }
    });
    let mut rows: Vec<Row> = counted.chain(timed).collect();
    let ours: Vec<Row> = rows.iter().filter(|row| row.is_ours()).cloned().collect();
    for row in rows.iter_mut().filter(|row| row.unit == "point") {
        let ours = ours.iter().find(|ours| ours.is_of_same(row));
        row.of_ours = ours.and_then(|ours| Some(rounded(row.cost()? / ours.cost()?)));
    }
    rows
}

impl Row {
    /// Returns true if others are compared with this row.
    fn is_ours(&self) -> bool {
        self.kernel == OURS || self.kernel.ends_with(OURS_ON_A_PC)
    }

    /// Returns true if two rows are of the same core and, on a PC, of the same number of points.
    fn is_of_same(&self, other: &Self) -> bool {
        self.core == other.core && (self.ns.is_none() || self.points == other.points)
    }

    fn cost(&self) -> Option<f64> {
        self.ns.or(self.instructions)
    }

    /// Returns true if the row belongs to the comparison.
    pub(super) fn is_compared(&self) -> bool {
        self.ns.is_some() || COMPARED.contains(&&*self.kernel)
    }
}

/// Rounds to three decimals; a model or a clock is not more accurate.
pub(super) fn rounded(number: f64) -> f64 {
    (1000.0 * number).round() / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::documented;

    fn counted(core: &str, kernel: &str, count: f64, unit: &str) -> Instructions {
        Instructions {
            core: core.to_owned(),
            kernel: kernel.to_owned(),
            count,
            unit: unit.to_owned(),
            compiler: String::new(),
        }
    }

    fn timed(kernel: &str, points: u32, ns: f64) -> Row {
        Row {
            core: "host".to_owned(),
            kernel: kernel.to_owned(),
            instructions: None,
            unit: "point".to_owned(),
            compiler: String::new(),
            points: Some(points),
            cycles: None,
            cycles_by: String::new(),
            ns: Some(ns),
            of_memcpy: None,
            of_ours: None,
        }
    }

    #[test]
    fn costs_are_by_ours_on_the_same_core_and_of_as_many_points() {
        let counted = [
            counted("m4f", "correct_slice", 24.0, "point"),
            counted("m4f", "distort", 96.0, "point"),
            counted("m4f", "frame_fold", 960.0, "frame"),
            counted("m55", "correct_slice", 8.0, "point"),
            counted("m55", "distort", 96.0, "point"),
        ];
        let timed = vec![
            timed("wide short x, y", 10, 0.5),
            timed("narrow short x, y", 10, 1.0),
            timed("other", 10, 50.0),
            timed("wide short x, y", 1000, 0.25),
            timed("other", 1000, 50.0),
        ];
        let cycles = [Cycles {
            core: "m4f",
            kernel: "correct_slice",
            per_point: 28.6667,
            by: "manual".to_owned(),
        }];
        let rows = rows(&counted, &cycles, timed);
        let of_ours: Vec<_> = rows.iter().map(|row| row.of_ours).collect();
        let expected = [
            Some(1.0),
            Some(4.0),
            None,
            Some(1.0),
            Some(12.0),
            Some(1.0),
            Some(2.0),
            Some(100.0),
            Some(1.0),
            Some(200.0),
        ];
        assert_eq!(of_ours, expected);
        let modelled: Vec<_> = rows.iter().filter_map(|row| row.cycles).collect();
        assert_eq!(modelled, [28.667]);
    }

    /// The committed table has at least the claimed ratios.
    #[test]
    fn committed_ratios_are_those_that_are_claimed() {
        let table: Vec<Row> = documented::table("docs/performance.csv");
        for (kernel, least) in [
            ("opencv_ros_camera_undistort", 7.0),
            ("opencv_ros_camera_project", 3.3),
            ("undistortPoints", 75.0),
            ("opencv-ros-camera undistort", 75.0),
        ] {
            let rows = table.iter().filter(|row| row.kernel.ends_with(kernel));
            let ratios: Vec<f64> = rows.map(|row| row.of_ours.unwrap()).collect();
            assert!(ratios.len() >= 3, "{kernel}");
            assert!(
                ratios.iter().all(|ratio| *ratio >= least),
                "{kernel}: {ratios:?}"
            );
        }
        // Beyond the caches, no form of the widest vectors takes more than a tenth longer than a
        // copy.
        let large = table.iter().filter(|row| row.points == Some(10_000_000));
        let streamed =
            large.filter(|row| row.kernel.starts_with("avx512") && !row.kernel.ends_with("stored"));
        let ratios: Vec<f64> = streamed.filter_map(|row| row.of_memcpy).collect();
        assert!(
            ratios.len() >= 8 && ratios.iter().all(|ratio| *ratio <= 1.1),
            "{ratios:?}"
        );
    }
}
