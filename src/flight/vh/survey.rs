//! Values of all sensors and ways to V/H at an instant, and those in use.

use super::agreement::{Agreement, Choice, Limits};
use super::finding::VhChannel;
use super::held::Held;
use super::settings::VhSettings;

/// Values of sensors and ways at an instant, the best first, and those in use.
pub(super) struct Survey {
    speeds: [Option<Held>; 2],
    heights: [Option<Held>; 2],
    ways: [Option<Held>; 3],
    speed: Option<Choice>,
    height: Option<Choice>,
    pub(super) way: Option<Choice>,
}

impl Survey {
    /// Returns the quantity or V/H in use and another that contradicts it.
    pub(super) fn against(&self) -> Option<[f32; 2]> {
        [self.speed, self.height, self.way]
            .into_iter()
            .flatten()
            .find_map(|choice| Some([choice.held.value, choice.against?]))
    }
}

/// Limits by which speeds, heights and ways are compared.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurveyLimits {
    pub(super) speeds: Limits,
    pub(super) heights: Limits,
    pub(super) ways: Limits,
}

/// Agreement of the two speeds, of the two heights of altimeters, and of the three ways.
#[derive(Debug, Clone, Copy)]
pub(super) struct Agreements {
    speeds: Agreement,
    heights: Agreement,
    ways: Agreement,
}

impl Agreements {
    pub(super) const NEW: Self = Self {
        speeds: Agreement::NEW,
        heights: Agreement::NEW,
        ways: Agreement::NEW,
    };

    /// Returns the values of all sensors and ways that are not lost, and the choice among them;
    /// `held` returns those of the sensors.
    pub(super) fn survey(
        &self,
        settings: &VhSettings,
        limits: &SurveyLimits,
        held: impl Fn(VhChannel) -> Option<Held>,
    ) -> Survey {
        let speeds = [held(VhChannel::GroundSpeed), held(VhChannel::InertialSpeed)];
        let mut heights = [
            held(VhChannel::LaserHeight),
            held(VhChannel::HeightAboveGround),
        ];
        let speed = self.speeds.choose(&speeds, &limits.speeds);
        // A height that gives no V/H is none.
        if let Some(speed) = &speed {
            let [least, most] = settings.direct.range;
            for height in &mut heights {
                let speed_m_s = speed.held.value;
                height
                    .take_if(|it| !(speed_m_s >= least * it.value && speed_m_s <= most * it.value));
            }
        }
        let height = self.heights.choose(&heights, &limits.heights);
        let over_terrain = held(VhChannel::Altitude)
            .zip(held(VhChannel::TerrainHeight))
            .map(|(altitude, terrain)| {
                let [least_m, _] = settings.height_above_ground.range;
                altitude.less(&terrain, least_m)
            })
            .filter(|height| is_within(settings.height_above_ground.range, height.value));
        let quotient = |height: Option<Held>| Some(speed?.held.over(&height?));
        let ways = [
            held(VhChannel::Direct),
            quotient(height.map(|height| height.held)),
            quotient(over_terrain),
        ]
        .map(|way| way.filter(|way| is_within(settings.direct.range, way.value)));
        Survey {
            way: self.ways.choose(&ways, &limits.ways),
            speeds,
            heights,
            ways,
            speed,
            height,
        }
    }

    /// Learns from the values at a sample that is used.
    pub(super) fn learn(&mut self, survey: &Survey, limits: &SurveyLimits) {
        if let Some(choice) = &survey.speed {
            self.speeds.learn(&survey.speeds, choice, &limits.speeds);
        }
        if let Some(choice) = &survey.height {
            self.heights.learn(&survey.heights, choice, &limits.heights);
        }
        if let Some(choice) = &survey.way {
            self.ways.learn(&survey.ways, choice, &limits.ways);
        }
    }
}

/// Returns `true` if a value lies in a range.
pub(super) fn is_within([least, most]: [f32; 2], value: f32) -> bool {
    value >= least && value <= most
}
