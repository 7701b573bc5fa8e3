//! Samples of the aircraft's sensors.

/// A sample of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VhSample {
    /// V/H, 1/s.
    Direct(f32),
    /// Ground speed of the satellite receiver, m/s.
    GroundSpeed(f32),
    /// Height above the ground, from a radar altimeter, m.
    HeightAboveGround(f32),
    /// Altitude above sea level, m.
    Altitude(f32),
    /// Height of the terrain above sea level, m.
    TerrainHeight(f32),
    /// Ground speed of the inertial unit, m/s.
    InertialSpeed(f32),
    /// Height above the ground, from a laser altimeter, m.
    LaserHeight(f32),
}
