//! Contents of answers that are written from where they lie.

use serde::{Serialize, Serializer};

use super::message::Points;
use super::point_correction::PointCorrection;
use crate::flight::rig::RigAnswer;

/// Contents of a long [`Answer`](super::message::Answer), written as the answer itself would be,
/// byte for byte: an answer is not filled and moved first.
#[derive(Debug, Clone, Copy)]
pub(super) enum Contents<'a> {
    /// The corrected points of measured ones on the sensor: `Answer::Points`.
    Corrected(&'a PointCorrection<'a>, &'a Points),
    /// Outputs of the camera in a round: `Answer::Rig`.
    Rig(&'a RigAnswer),
}

impl Serialize for Contents<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Corrected(correction, measured) => {
                let points = Corrections(correction, measured);
                serializer.serialize_newtype_variant("Answer", 3, "Points", &points)
            }
            Self::Rig(answer) => serializer.serialize_newtype_variant("Answer", 12, "Rig", answer),
        }
    }
}

/// Points that are corrected while they are written.
struct Corrections<'a>(&'a PointCorrection<'a>, &'a Points);

impl Serialize for Corrections<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self(correction, measured) = self;
        let measured = measured.iter();
        match correction {
            PointCorrection::Polynomial(correction) => {
                serializer.collect_seq(measured.map(|point| correction.correct(*point)))
            }
            PointCorrection::Gridded(correction) => {
                serializer.collect_seq(measured.map(|point| correction.correct(*point)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::event::Action;
    use crate::geometry::calibration::{Calibration, CalibrationParameters};
    use crate::geometry::frame_correction::FrameCorrection;
    use crate::geometry::sensor::SensorPoint;
    use crate::io::link::message::{Answer, Header, write};
    use crate::io::link::packet::Packet;

    /// Returns the packet of contents and that of the answer.
    fn packets(contents: &Contents<'_>, answer: &Answer) -> [Packet; 2] {
        let header = Header {
            session: 7,
            sequence: 300,
        };
        let [mut written, mut whole] = [Packet::EMPTY, Packet::EMPTY];
        write(contents, header, &mut written).unwrap();
        answer.write(header, &mut whole).unwrap();
        [written, whole]
    }

    #[test]
    fn outputs_are_written_as_their_answer() {
        let mut rig = RigAnswer {
            duty: -0.25,
            powered: true,
            ..RigAnswer::silent()
        };
        rig.actions.push(Action::ReleaseStage).unwrap();
        let [written, whole] = packets(&Contents::Rig(&rig), &Answer::Rig(rig.clone()));
        assert_eq!(written, whole);
    }

    #[test]
    fn points_are_written_as_their_answer_for_every_number_of_them() {
        let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
        parameters.distortion.k1 = -1.6056e-5;
        let calibration = Calibration::new(parameters).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let mut measured = Points::new();
        loop {
            let corrected = measured.iter().map(|point| correction.correct(*point));
            let answer = Answer::Points(corrected.collect());
            let points = PointCorrection::Polynomial(&correction);
            let [written, whole] = packets(&Contents::Corrected(&points, &measured), &answer);
            assert_eq!(written, whole, "{} points", measured.len());
            #[expect(clippy::cast_precision_loss, reason = "64 points at most")]
            let point = SensorPoint::new(0.4 * measured.len() as f32, -11.0);
            if measured.push(point).is_err() {
                break;
            }
        }
    }
}
