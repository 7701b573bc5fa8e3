//! Motion of the principal point.

use crate::content::Certificate;
use crate::content::motion::{Motion, MotionRow};
use crate::document::block::{Block, Section, Table, numbers, words};
use crate::document::wording::{NOT_STATED, cell, number, pair, range, with_unit};
use crate::stated::Stated;

/// Mechanism, shutter, and the tables over V/H and exposure time.
pub(super) fn motion(certificate: &Certificate) -> Section {
    let motion = &certificate.motion;
    let blocks = vec![
        Block::Pairs(mechanism(motion)),
        Block::Text(format!(
            "Exposures over the camera's limits, flown along {}. Stage speed v = f·V/H, travel \
             δ = v·t, offset at opening Δδ, offset of the exposure centroid c̄, all along {0} from \
             the calibrated position; in flight against the axis they change their sign. \
             Principal point and centroid time, counted from first light, belong together: use \
             them as a pair.",
            motion.axis
        )),
        Block::Table(path(motion)),
        Block::Table(effect(motion)),
        Block::Text(
            "Change of the distortion: the largest over the sensor by which the exposure mean \
             differs from the static distortion about the calibrated principal point. Left out: \
             bound of what the correction does not take into account. Smear of the lens: what the \
             gradient of its distortion smears in an exposure whose motion is perfectly \
             compensated; an error of V/H adds its share of δ."
                .to_owned(),
        ),
        Block::Text(forbidden(motion)),
        Block::Table(reach(motion)),
    ];
    Section {
        title: "Motion".to_owned(),
        blocks,
    }
}

fn mechanism(motion: &Motion) -> Vec<[String; 2]> {
    let limit = |stated: &Option<_>, unit| match stated {
        Some(_) => with_unit(Option::as_ref(stated), unit),
        None => "unlimited".to_owned(),
    };
    let powers = ["µm", "µm/mm", "µm/mm²", "µm/mm³", "µm/mm⁴"];
    let run_out: Vec<String> = motion
        .run_out_um
        .iter()
        .zip(powers)
        .map(|(stated, unit)| with_unit(stated.as_ref(), unit))
        .collect();
    let mut pairs = vec![
        pair("FMC axis", motion.axis),
        pair("mechanism", motion.mechanism),
    ];
    if let Some(strategy) = motion.strategy {
        pairs.push(pair("run-up", strategy));
        pairs.push(pair(
            "acceleration",
            with_unit(motion.acceleration_mm_s2.as_ref(), "mm/s²"),
        ));
        pairs.push(pair(
            "settling",
            with_unit(motion.settling_ms.as_ref(), "ms"),
        ));
        pairs.push(pair("largest jerk", limit(&motion.jerk_mm_s3, "mm/s³")));
        pairs.push(pair("largest speed", limit(&motion.max_speed_mm_s, "mm/s")));
    } else {
        pairs.push(pair(
            "first transfer",
            with_unit(motion.first_transfer.as_ref(), "row periods"),
        ));
    }
    let [opening, closing] = &motion.ramps;
    let [opening, closing] = [opening, closing].map(|ramp| number(ramp.as_ref()));
    pairs.extend([
        pair(
            "stroke",
            format!(
                "{}, half of it on either side",
                with_unit(motion.stroke_mm.as_ref(), "mm")
            ),
        ),
        pair(
            "run-out over the stage position",
            if run_out.is_empty() {
                NOT_STATED.to_owned()
            } else {
                run_out.join(", ")
            },
        ),
        pair(
            "focus shift over the temperature of the lens",
            focus(motion),
        ),
        pair(
            "shutter",
            format!(
                "{}, opening {opening} and closing {closing} of the exposure",
                motion.shutter
            ),
        ),
        pair("limits of V/H", range(&motion.vh_per_s, "1/s")),
        pair("limits of the exposure", range(&motion.exposure_s, "s")),
    ]);
    pairs
}

fn focus(motion: &Motion) -> String {
    let row = |[celsius, shift_um]: &[Option<Stated>; 2]| {
        format!(
            "{} at {}",
            with_unit(shift_um.as_ref(), "µm"),
            with_unit(celsius.as_ref(), "°C")
        )
    };
    let rows: Vec<String> = motion.focus.iter().map(row).collect();
    if rows.is_empty() {
        return NOT_STATED.to_owned();
    }
    rows.join(", ")
}

/// Returns the first two cells of a row, and then those of its exposure, or why it is refused.
fn cells<const N: usize>(
    row: &MotionRow,
    numbers: impl Fn(&crate::content::motion::ExposureNumbers) -> [String; N],
) -> Vec<String> {
    let mut cells = vec![cell(row.vh_per_s.as_ref()), cell(row.exposure_ms.as_ref())];
    if let Some(frame) = &row.frame {
        cells.extend(numbers(frame));
    } else {
        let reason = row.refused.as_deref().unwrap_or(NOT_STATED);
        let refused = |index| if index == 0 { reason } else { "–" };
        cells.extend((0..N).map(refused).map(str::to_owned));
    }
    cells
}

fn path(motion: &Motion) -> Table {
    let rows = motion.exposures.iter().map(|row| {
        cells(row, |frame| {
            let [x, y] = &frame.principal_point_mm;
            [
                &frame.speed_mm_s,
                &frame.travel_um,
                &frame.opening_offset_um,
                &frame.centroid_offset_um,
                x,
                y,
                &frame.centroid_time_ms,
            ]
            .map(|stated| cell(stated.as_ref()))
        })
    });
    Table {
        title: "Path of the principal point".to_owned(),
        columns: [
            "V/H\n1/s",
            "t\nms",
            "v\nmm/s",
            "δ\nµm",
            "Δδ\nµm",
            "c̄\nµm",
            "principal\npoint x, mm",
            "principal\npoint y, mm",
            "centroid\ntime, ms",
        ]
        .map(numbers)
        .into(),
        rows: rows.collect(),
    }
}

fn effect(motion: &Motion) -> Table {
    let rows = motion.exposures.iter().map(|row| {
        cells(row, |frame| {
            [&frame.change_um, &frame.left_out_nm, &frame.lens_smear_um]
                .map(|stated| cell(stated.as_ref()))
        })
    });
    Table {
        title: "Effect of the motion".to_owned(),
        columns: [
            "V/H\n1/s",
            "t\nms",
            "change of the\ndistortion, µm",
            "left out\nnm",
            "smear of\nthe lens, µm",
        ]
        .map(numbers)
        .into(),
        rows: rows.collect(),
    }
}

fn reach(motion: &Motion) -> Table {
    let rows = motion.reach.iter().map(|row| {
        vec![
            cell(row.vh_per_s.as_ref()),
            cell(row.longest_ms.as_ref()),
            row.bound.to_owned(),
        ]
    });
    Table {
        title: "Longest exposure".to_owned(),
        columns: vec![
            numbers("V/H\n1/s"),
            numbers("longest t\nms"),
            words("bound by"),
        ],
        rows: rows.collect(),
    }
}

fn forbidden(motion: &Motion) -> String {
    let refused = motion.exposures.iter().any(|row| row.refused.is_some());
    let is_bound = motion.reach.iter().any(|row| row.bound != "limits");
    if refused || is_bound {
        "Exposures longer than those below do not fit the stroke, or ask for more than the largest \
         speed; the camera refuses them, and their triggers have a record with that reason."
            .to_owned()
    } else {
        "Neither stroke nor speed forbids an exposure within the camera's limits.".to_owned()
    }
}
