//! Sentences with numbers of the tables, as documents and sources have them.

use super::super::{
    comparison::Row,
    cost_problem::MAX_RISE,
    cycles::KERNELS,
    documented::{self, COMPILER, count},
    limit::{self, LIMITS, Limit},
    load,
};
use crate::stack::{EXCEPTION_FRAME_BYTES, TIGHT};

use super::{CHANGELOG, CONTROL_LOOP, PERFORMANCE, README, ROWS};

const MESH: &str = "src/geometry/mesh.rs";
const POINT_KERNEL: &str = "src/geometry/point_kernel.rs";
const INVERSE: &str = "src/geometry/inverse.rs";

const M4F: &str = "cortex-m4f";
const M55: &str = "cortex-m55";

/// A sentence, or part of one, and the file that must contain it.
pub(super) struct Quote {
    pub(super) file: &'static str,
    pub(super) sentence: String,
}

fn of(file: &'static str, sentences: Vec<String>) -> impl Iterator<Item = Quote> {
    let quotes = sentences.into_iter();
    quotes.map(move |sentence| Quote { file, sentence })
}

/// Returns every sentence that quotes a table.
pub(super) fn quotes() -> Vec<Quote> {
    of(README, readme())
        .chain(of(CHANGELOG, changelog()))
        .chain(of(PERFORMANCE, points()))
        .chain(of(PERFORMANCE, frames_and_rows()))
        .chain(of(PERFORMANCE, limits()))
        .chain(of(PERFORMANCE, stack()))
        .chain(of(PERFORMANCE, times()))
        .chain(of(CONTROL_LOOP, control_loop()))
        .chain(of_sources())
        .collect()
}

fn m4f(kernel: &str) -> f64 {
    count(M4F, kernel)
}

/// Rounds to the nearest multiple.
fn nearest(multiple: f64, number: f64) -> f64 {
    multiple * (number / multiple).round()
}

/// Returns the cost of a call, from slices of 256 and of 1024 points.
fn call(core: &str, kernel: &str) -> f64 {
    let few = count(core, &format!("{kernel}_256"));
    (few - count(core, kernel)) / (1.0 / 256.0 - 1.0 / 1024.0)
}

/// Returns the cost of a point without the call.
fn without_call(core: &str, kernel: &str) -> f64 {
    count(core, kernel) - call(core, kernel) / 1024.0
}

/// Returns the cost per row of the detector, for the frames' mean over transfers.
fn per_tdi_row() -> f64 {
    (m4f("frame_fold_tdi_worst") - m4f("frame_fold_worst")) / 1024.0
}

fn readme() -> Vec<String> {
    vec![
        format!(
            "{:.0} instructions per point on a Cortex-M4F",
            m4f("correct_slice")
        ),
        format!(
            "rises by more than {:.0} % over the row of the same compiler",
            100.0 * MAX_RISE
        ),
    ]
}

fn changelog() -> Vec<String> {
    vec![
        format!("in {:.0} instructions on a Cortex-M4F", m4f("frame_fold")),
        format!(
            "{:.1} instructions to a point, {:.1} with all terms",
            count(M55, "correct_slice"),
            count(M55, "correct_slice_full")
        ),
        format!(
            "on Cortex-M4F and M7 ({:.0} and, in the full form, {:.0})",
            m4f("distort"),
            m4f("distort_full")
        ),
        format!(
            "in {:.0} instructions per point on a Cortex-M4F, {:.0} with K3, and over whole rows {:.1} to {:.1} from 16 to 128 pixels of 3.76 µm apart; {:.1} and {:.1} at 64 and 128 pixels of 10 µm over 104 mm",
            m4f("mesh_row"),
            m4f("mesh_row_k3"),
            m4f("mesh_row_k3_16px"),
            m4f("mesh_row_k3_128px"),
            m4f("mesh_row_k3_64px_104mm"),
            m4f("mesh_row_k3_128px_104mm")
        ),
    ]
}

/// Returns the quotes about points on a microcontroller.
fn points() -> Vec<String> {
    let of_ours = |core| count(core, "opencv_ros_camera_undistort") / count(core, "correct_slice");
    let calls = [M4F, M55].map(|core| {
        let kernels = ["correct_slice", "correct_slice_full"];
        kernels.map(|kernel| nearest(10.0, call(core, kernel)))
    });
    let calls = calls.as_flattened();
    let least = calls.iter().copied().fold(f64::INFINITY, f64::min);
    let most = calls.iter().copied().fold(0.0, f64::max);
    let performance: Vec<Row> = documented::table("docs/performance.csv");
    let is_short = |row: &&Row| row.core == M4F && row.kernel == "correct_slice";
    let cycles = performance.iter().find(is_short).unwrap().cycles.unwrap();
    let is_distort = |row: &&Row| row.core == M4F && row.kernel == "distort_slice";
    let of_a_node = performance.iter().find(is_distort).unwrap().cycles.unwrap();
    let [parts, rest] = [23 + 17 + 15 + 21, 17];
    assert_eq!(
        format!("{}", parts + rest),
        format!("{:.0}", m4f("distort_slice"))
    );
    vec![
        format!(
            "in {:.0} times the instructions on the M4F and {:.0} times on the M55",
            of_ours(M4F),
            of_ours(M55)
        ),
        format!("a call costs {least} to {most} instructions"),
        format!(
            "23 arithmetic, 4 loads and stores for 6 points, 2 of the loop for 6: {:.1}",
            without_call(M4F, "correct_slice")
        ),
        format!(
            "23 arithmetic, 4 to load and store, 1 of the loop: {:.0}",
            4.0 * without_call(M55, "correct_slice")
        ),
        format!(
            "`distort_slice` is 23 instructions for a start along the radius, 17 for value and slope there, 15 for the Jacobian, 21 for one Newton step and its test, one of them a division, {rest} for the rest"
        ),
        format!("on the M4F against {cycles:.1}"),
        format!(
            "a point of `distort_slice` does: {:.0} cycles per vertex on the M4F",
            6.0 * of_a_node / 64.0
        ),
        format!("9.3 instead of {:.1}", count(M55, "correct_slice_xy")),
    ]
}

/// Returns the quotes about frames, and about rows of a mesh.
fn frames_and_rows() -> Vec<String> {
    let whole_rows = ["16px", "32px", "64px", "128px", "64px_104mm"];
    let whole_rows = whole_rows.map(|spacing| m4f(&format!("mesh_row_k3_{spacing}")));
    vec![
        format!(
            "takes {:.0} instructions per row of the detector",
            per_tdi_row()
        ),
        format!(
            "leave 82 points to a row and a point costs {:.1} instructions on the M4F; in all others it is at most {:.1}",
            m4f("mesh_row_k3_128px_104mm"),
            whole_rows.into_iter().fold(0.0, f64::max)
        ),
    ]
}

/// Returns the quotes about limits.
fn limits() -> Vec<String> {
    vec![
        format!("Counts are those of {COMPILER};"),
        format!("and may be {:.0} % dearer", 100.0 * MAX_RISE),
        format!(
            "[limits.csv]({}) has one for every row of instructions.csv and footprint.csv",
            LIMITS.trim_start_matches("docs/")
        ),
        format!(
            "a margin over the count: {:.0} %",
            100.0 * (limit::MARGIN - 1.0)
        ),
        format!("and {} instructions at least", limit::LEAST_OF_A_STEP),
        format!(
            "more than {:.0} % above the dearest count",
            100.0 * (limit::LOOSEST - 1.0)
        ),
    ]
}

/// Returns the quotes about the stack.
fn stack() -> Vec<String> {
    vec![
        format!("and {EXCEPTION_FRAME_BYTES} bytes for each"),
        format!("At least {TIGHT} of it has to have been used"),
    ]
}

/// Returns the quotes about points on a PC.
fn times() -> Vec<String> {
    let table: Vec<Row> = documented::table("docs/performance.csv");
    let clocks = table.iter().filter_map(|row| {
        let clock = row.cycles_by.strip_prefix("clock ")?;
        clock.strip_suffix(" GHz")?.parse::<f64>().ok()
    });
    let clocks: Vec<_> = clocks.collect();
    let is_it = |row: &&Row| row.kernel == "avx512 short x, y" && row.points == Some(1000);
    let cycles = table.iter().find(is_it).unwrap().cycles.unwrap();
    let operations = f64::from(KERNELS[0].operations);
    vec![
        format!(
            "clock of that run was {:.1} to {:.1} GHz",
            clocks.iter().copied().fold(f64::INFINITY, f64::min),
            clocks.iter().copied().fold(0.0, f64::max)
        ),
        format!("a thousand points take {cycles:.2} each"),
        format!(
            "{operations} operations, none joined, on two vector units of 16 lanes are {:.2} cycles",
            operations / 32.0
        ),
    ]
}

fn control_loop() -> Vec<String> {
    // The link has 921,600 bits per second, ten to a byte.
    let link = 92.0 * m4f("interrupt_receive");
    let [slow, fast] = [25_000.0, 168_000.0];
    let rmc = m4f("nmea_rmc");
    vec![
        format!("fails below {:.0} %", 100.0 * load::LEAST_IDLE),
        format!("takes {:.0} of them in each", nearest(100.0, link)),
        format!(
            "{:.0} % of a core at 25 MHz, {:.0} % at 168 MHz",
            100.0 * link / slow,
            100.0 * link / fast
        ),
        format!(
            "a sentence of {:.0},{:03} instructions lasts {:.2} ms at 168 MHz, but at 25 MHz, {:.2} ms",
            (rmc / 1000.0).floor(),
            rmc % 1000.0,
            rmc / fast,
            rmc / slow
        ),
        format!("takes {:.0} instructions per row", per_tdi_row()),
        format!(
            "at 168 MHz they add {:.2} ms",
            m4f("frame_fold_tdi_worst") / fast
        ),
    ]
}

/// Returns the quotes in the sources' documentation.
fn of_sources() -> impl Iterator<Item = Quote> {
    let rows = vec![
        format!(
            "A point costs {:.0} instructions on a Cortex-M4F, {:.0} with K3",
            m4f("mesh_row"),
            m4f("mesh_row_k3")
        ),
        format!(
            "a row costs {:.0} and a frame {:.0}",
            m4f("mesh_row_setup"),
            nearest(100.0, m4f("mesh_rows_setup"))
        ),
        format!(
            "{:.1} per point with K3 where two starts serve 82 points",
            m4f("mesh_row_k3_128px_104mm")
        ),
    ];
    let point_kernel = vec![format!(
        "It takes {:.1} instructions per point with the short kernel and {:.1} with the full one on Cortex-M4F and M7, and {:.1} and {:.1} on a Cortex-M55 compiled for its vectors, in slices of 1024 points; a call takes about {:.0}",
        m4f("correct_slice"),
        m4f("correct_slice_full"),
        count(M55, "correct_slice"),
        count(M55, "correct_slice_full"),
        nearest(100.0, call(M4F, "correct_slice"))
    )];
    let inverse = vec![
        format!(
            "{:.0} with the short kernel and {:.0} with the full one (`docs/instructions.csv`)",
            m4f("distort"),
            m4f("distort_full")
        ),
        format!(
            "{:.0} with the short kernel and {:.0} with the full one.",
            m4f("distort_slice"),
            m4f("distort_slice_full")
        ),
        format!(
            "a call per point would load the coefficients again: {:.0} instructions",
            m4f("distort") - m4f("distort_slice")
        ),
    ];
    let limits: Vec<Limit> = documented::table(LIMITS);
    let limit = |kernel| {
        let is_it = |limit: &&Limit| limit.on == M4F && limit.cost == kernel;
        limits.iter().find(is_it).unwrap().most
    };
    let mesh_test = vec![format!(
        "keeps a point within {} instructions at 64 pixels from point to point and within {} at 128",
        limit("mesh_row_k3_64px_104mm"),
        limit("mesh_row_k3_128px_104mm")
    )];
    let mesh = vec![format!(
        "It is computed by differences, in {:.0} instructions per point",
        m4f("mesh_row")
    )];
    of(ROWS, rows)
        .chain(of(MESH, mesh))
        .chain(of(POINT_KERNEL, point_kernel))
        .chain(of(INVERSE, inverse))
        .chain(of("tests/geometry/mesh.rs", mesh_test))
}
