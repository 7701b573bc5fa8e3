//! Following error of a healthy stage with the gains of the library, and its limits.

use super::loop_settings::LoopSettings;

/// Bounds that a stage keeps to with the gains of [`LoopSettings::tuned`], µm: its largest true
/// following error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowingErrorBounds {
    /// In cruise, 5 ms after the run-up.
    pub cruise_um: f32,
    /// Change of the error within 10 ms of that, which smears the image.
    pub smear_um: f32,
    /// In run-ups, stops, and the first 5 ms of cruise.
    pub ramp_um: f32,
    /// In fly-backs, and 20 ms after any stop.
    pub fly_back_um: f32,
    /// At rest, later than that.
    pub rest_um: f32,
    /// At any time, as the camera measures it: set point less reading.
    pub seen_um: f32,
}

/// Margins of the open loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopMargins {
    /// Frequency at which the loop's gain is 1, Hz.
    pub crossover_hz: f32,
    /// Phase above -180° at that frequency, °.
    pub phase_deg: f32,
    /// Factor of the gain that makes the loop oscillate; no smaller one does.
    pub gain: f32,
}

impl LoopSettings {
    /// Margins with latencies of 0.1 ms each, on the plant that the gains are for.
    pub const MARGINS: LoopMargins = LoopMargins {
        crossover_hz: 86.4,
        phase_deg: 33.8,
        gain: 2.54,
    };

    /// Bounds for the stage of [`Plant::REFERENCE`](super::loop_settings::Plant::REFERENCE).
    pub const NOMINAL: FollowingErrorBounds = FollowingErrorBounds {
        cruise_um: 0.16,
        smear_um: 0.15,
        ramp_um: 1.3,
        fly_back_um: 1.8,
        rest_um: 1.3,
        seen_um: 1.5,
    };

    /// Bounds for the same stage with an encoder of 0.5 µm instead of 0.1 µm.
    pub const COARSE: FollowingErrorBounds = FollowingErrorBounds {
        cruise_um: 0.5,
        smear_um: 0.7,
        ramp_um: 1.5,
        fly_back_um: 1.9,
        rest_um: 1.7,
        seen_um: 1.9,
    };

    /// Bounds with mass, friction and force each 30 % more or less than in the settings, encoders
    /// of 0.1 µm and 0.5 µm, latencies of 0.1 ms and 0.2 ms each; after two strokes to and fro, in
    /// which the loop learns.
    pub const LEARNED: FollowingErrorBounds = FollowingErrorBounds {
        cruise_um: 0.9,
        smear_um: 0.92,
        ramp_um: 2.2,
        fly_back_um: 3.5,
        rest_um: 2.2,
        seen_um: 3.0,
    };

    /// The same in the first motion ever.
    pub const UNLEARNED: FollowingErrorBounds = FollowingErrorBounds {
        cruise_um: 7.0,
        smear_um: 4.0,
        ramp_um: 9.0,
        fly_back_um: 14.0,
        rest_um: 6.5,
        seen_um: 12.5,
    };

    /// Following error, µm, that no healthy motion shows once the loop has learned. Every stage
    /// that jams or reverses shows it within 5 ms, at 5 mm/s and more, at its start and in cruise.
    ///
    /// The table gives the least following error, µm, that the camera has measured by each time
    /// after a jam, or after motor or encoder is reversed:
    ///
    /// | fault | at | 2 ms | 3 ms | 4 ms | 5 ms | 6 ms |
    /// |---|---|---|---|---|---|---|
    /// | jam | 5 mm/s | 4.8 | 9.8 | 14.8 | 19.8 | 24.8 |
    /// | jam | 17 mm/s | 16.2 | 33.2 | 50.2 | 67.2 | 84.2 |
    /// | jam | start | 1.5 | 3.9 | 7.3 | 11.7 | 16.7 |
    /// | motor | 5 mm/s | 1.1 | 4.7 | 10.7 | 19.9 | 34.5 |
    /// | motor | 17 mm/s | 2.1 | 8.4 | 20.3 | 40.4 | 72.1 |
    /// | motor | start | 1.7 | 5.5 | 12.9 | 25.9 | 47.6 |
    /// | encoder | 5 mm/s | 9.9 | 21.8 | 40.2 | 68.7 | 111.6 |
    /// | encoder | 17 mm/s | 34.0 | 73.6 | 129.7 | 201.6 | 288.1 |
    /// | encoder | start | 2.8 | 7.9 | 17.3 | 33.5 | 61.0 |
    ///
    /// In the first motion ever, with settings 30 % off, a healthy stage reaches 12.2 µm
    /// ([`Self::UNLEARNED`]): until the loop has learned, [`Self::FOLLOWING_LIMIT_UNLEARNED_UM`]
    /// holds.
    pub const FOLLOWING_LIMIT_UM: f32 = 10.0;

    /// The same for the first two strokes; a jam at 5 mm/s then takes 5 ms in cruise, and 6 ms at
    /// the start, to show.
    pub const FOLLOWING_LIMIT_UNLEARNED_UM: f32 = 15.0;
}
