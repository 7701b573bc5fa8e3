//! Side by side: what a point costs on every core, ours and others'.

use serde::{Deserialize, Serialize};

use super::{cost::Instructions, cycles::Cycles};

/// What a user would take on a core, which others are measured by.
const OURS: &str = "correct_slice";

/// The same among what is timed, by the end of its name; that of the widest vectors stands first.
const OURS_ON_A_PC: &str = " short x, y";

/// Rows that are compared, of those that are counted.
pub(super) const COMPARED: [&str; 15] = [
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
    "opencv_ros_camera_undistort",
    "opencv_ros_camera_distort",
    "opencv_ros_camera_project",
];

/// A row of `docs/performance.csv`; costs are per point, or per what `unit` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) core: String,
    pub(super) kernel: String,
    #[serde(rename = "instructions_per_point")]
    pub(super) instructions: Option<f64>,
    pub(super) unit: String,
    pub(super) compiler: String,
    /// To a call, of what is timed.
    pub(super) points: Option<u32>,
    #[serde(rename = "cycles_per_point")]
    pub(super) cycles: Option<f64>,
    /// The model they are from, or the clock by which time became cycles.
    pub(super) cycles_by: String,
    #[serde(rename = "ns_per_point")]
    pub(super) ns: Option<f64>,
    /// Time by that of copying the same bytes.
    pub(super) of_memcpy: Option<f64>,
    /// Cost by that of the correction of the same points on this core: instructions, on a PC time.
    pub(super) of_ours: Option<f64>,
}

/// What was counted, modelled and timed, in one table.
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
    /// Whether others are measured by it.
    fn is_ours(&self) -> bool {
        self.kernel == OURS || self.kernel.ends_with(OURS_ON_A_PC)
    }

    /// Whether two rows are of the same core, and on a PC of as many points.
    fn is_of_same(&self, other: &Self) -> bool {
        self.core == other.core && (self.ns.is_none() || self.points == other.points)
    }

    fn cost(&self) -> Option<f64> {
        self.ns.or(self.instructions)
    }

    /// Whether it belongs to the comparison.
    pub(super) fn is_compared(&self) -> bool {
        self.ns.is_some() || COMPARED.contains(&&*self.kernel)
    }
}

fn rounded(number: f64) -> f64 {
    (1000.0 * number).round() / 1000.0
}
