//! The ranges of section 10 that belong to one quantity.

use crate::conventions::document::{names, rows};
use fmc_camera::geometry::range::Quantity;

/// The listed quantities; does not compile while one is missing.
macro_rules! quantities {
    ($($variant:ident),* $(,)?) => {{
        const _: fn(Quantity) = |quantity| match quantity {
            $(Quantity::$variant => {})*
        };
        [$(Quantity::$variant),*]
    }};
}

/// The unit that a name ends in.
fn unit_in(name: &str) -> Option<&'static str> {
    let units = [
        ("_mm_s2", "mm/s²"),
        ("_mm_s3", "mm/s³"),
        ("_mm_s", "mm/s"),
        ("_deg_s", "°/s"),
        ("_deg", "°"),
        ("_percent", "%"),
        ("_per_s", "1/s"),
        ("_m_s", "m/s"),
        ("_mm", "mm"),
        ("_um", "µm"),
        ("_px", "px"),
        ("_ms", "ms"),
        ("_m", "m"),
        ("_s", "s"),
    ];
    let name = name.split('[').next()?;
    let (_, unit) = units
        .into_iter()
        .find(|(suffix, _)| name.ends_with(suffix))?;
    Some(unit)
}

fn printed(end: f32) -> String {
    if end.abs() < f32::MAX {
        end.to_string()
    } else {
        "any".to_owned()
    }
}

#[test]
fn documented_ranges_are_those_of_the_code() {
    let quantities = quantities!(
        PrincipalDistanceMm,
        ExitPupilMm,
        PrincipalPointX,
        PrincipalPointY,
        WidthPx,
        HeightPx,
        PixelUm,
        K0,
        K1,
        K2,
        K3,
        P1,
        P2,
        B1,
        B2,
        Km0,
        Km1,
        Km2,
        Kd1,
        Pm1,
        AccelerationMmS2,
        SettlingMs,
        StrokeMm,
        FlatnessUm,
        FirstTransfer,
        TdiRows,
        OpeningFraction,
        ClosingFraction,
        VhPerS,
        ExposureS,
        OpeningOffsetMm,
        CentroidOffsetMm,
        TravelMm,
        FocusShiftUm,
        XMm,
        YMm,
        DxUm,
        DyUm,
        SigmaUm,
        ReliefPercent,
        PitchDeg,
        RollDeg,
        DriftDeg,
        PitchRateDegS,
        RollRateDegS,
        YawRateDegS,
        JerkMmS3,
        MaxSpeedMmS,
        GroundSpeedMS,
        HeightAboveGroundM,
        AltitudeM,
        TerrainHeightM,
        SourcePeriodS,
        SourceValidityS,
        SourceSlew,
        SourceSigma,
        SourceFrozenS,
        DisagreementPercent,
    );
    let of_the_code = quantities.map(|quantity| {
        let (least, most) = quantity.range();
        (quantity.name(), printed(least), printed(most))
    });
    let rows = rows("quantity");
    let documented: Vec<_> = rows
        .iter()
        .flat_map(|row| names(row[0]).into_iter().map(move |name| (name, row)))
        .collect();
    for (name, row) in &documented {
        if let Some(unit) = unit_in(name) {
            assert_eq!(row[3], unit, "{name}");
        }
    }
    let documented: Vec<_> = documented
        .into_iter()
        .map(|(name, row)| (name, row[1].to_owned(), row[2].to_owned()))
        .collect();
    assert_eq!(
        documented, of_the_code,
        "every quantity once, in the order of the code"
    );
}
