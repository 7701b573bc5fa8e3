//! The error budget of the whole verification grid: maximum, root mean square and bias.

use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::{CameraParameters, Exposure, SensorPoint};
use fmc_reference::strict::MAX_SOLVER_ERROR_NM;
use fmc_reference::verification::result::{
    CameraResult, MAX_COORDINATE_ERROR_NM, MAX_ERROR_NM, Treatment, Verification,
};
use fmc_reference::verification::run;
use host_sim::device::{CorrectingDevice, Device, DeviceError, Evidence, InProcess};

use crate::reference::support::published;

/// Root mean square of dx and dy over the camera where it is largest, nm.
const RMS_NM: f64 = 0.1;
/// Mean of dx and dy, nm.
const BIAS_NM: f64 = 0.01;

#[test]
fn camera_agrees_with_the_strict_solver_on_the_whole_grid() {
    let mut device = InProcess::default();
    let verification = Verification {
        device: "sil".to_owned(),
        not_in_qemu: None,
        evidence: Evidence::default(),
        link: None,
        difference: None,
        cameras: published()
            .iter()
            .map(|camera| run::camera(&mut device, camera, || ()).unwrap())
            .collect(),
    };
    assert_eq!(verification.points(), 264_600);
    for camera in &verification.cameras {
        let errors = camera.errors(Treatment::Camera);
        assert!(1e6 * errors.max_mm() <= MAX_ERROR_NM, "{}", camera.name);
        assert!(
            1e6 * errors.rms_mm() <= RMS_NM,
            "{}: rms {}",
            camera.name,
            1e6 * errors.rms_mm()
        );
        assert!(
            1e6 * errors.bias_mm().abs() <= BIAS_NM,
            "{}: bias {}",
            camera.name,
            1e6 * errors.bias_mm()
        );
        let coordinate = camera.coordinate_errors().max_mm();
        assert!(
            1e6 * coordinate <= MAX_COORDINATE_ERROR_NM,
            "{}",
            camera.name
        );
        assert!(1e6 * camera.solver_error_mm() <= MAX_SOLVER_ERROR_NM);
        // The check can fail: omitting the motion gives a hundred times the limit.
        assert!(1e3 * camera.errors(Treatment::Static).max_mm() > 0.04);
    }
    assert!(verification.passed());
}

/// A camera that answers wrongly.
struct Wrong {
    camera: InProcess,
    fault: Fault,
}

#[derive(Clone, Copy)]
enum Fault {
    /// K1 is one part in 10⁵ off: 6 nm at the corner of the first published camera.
    K1,
    /// dx is NaN.
    NotANumber,
    /// The last point has no answer.
    OneTooFew,
    /// No point has an answer.
    Nothing,
    /// The sign of dy is reversed.
    Sign,
}

impl CorrectingDevice for Wrong {
    type Error = DeviceError;

    fn description(&self) -> String {
        "wrong".to_owned()
    }

    fn load(&mut self, camera: &CameraParameters) -> Result<(), DeviceError> {
        let mut camera = *camera;
        if matches!(self.fault, Fault::K1) {
            camera.calibration.distortion.k1 *= 1.000_01;
        }
        self.camera.load(&camera)
    }

    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, DeviceError> {
        self.camera.expose(exposure)
    }

    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        let mut answers = self.camera.correct(measured)?;
        match self.fault {
            Fault::K1 => {}
            Fault::NotANumber => answers
                .iter_mut()
                .for_each(|a| a.distortion.dx_mm = f32::NAN),
            Fault::OneTooFew => answers.truncate(measured.len() - 1),
            Fault::Nothing => answers.clear(),
            Fault::Sign => answers.iter_mut().for_each(|a| a.distortion.dy_mm *= -1.0),
        }
        Ok(answers)
    }

    fn evidence(&self) -> Evidence {
        self.camera.evidence()
    }
}

impl Device for Wrong {
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        self.camera.distort(ideal)
    }

    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError> {
        self.camera.mesh(row, format)
    }

    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError> {
        self.camera.corrections(row)
    }
}

fn verified(fault: Fault) -> Result<CameraResult, DeviceError> {
    let mut device = Wrong {
        camera: InProcess::default(),
        fault,
    };
    run::camera(&mut device, &published().remove(0), || ())
}

#[test]
fn verification_fails_when_the_camera_is_wrong() {
    let wrong = verified(Fault::K1).unwrap();
    assert!(!wrong.passed());
    assert!(
        (3.0..12.0).contains(&wrong.worst.error_nm),
        "{}",
        wrong.worst.error_nm
    );
    assert!(!verified(Fault::Sign).unwrap().passed());
    let none = verified(Fault::NotANumber).unwrap();
    assert!(!none.passed());
    assert!(none.worst.error_nm.is_infinite());
}

#[test]
fn answers_that_are_missing_are_an_error() {
    for (fault, answered) in [(Fault::OneTooFew, 440), (Fault::Nothing, 0)] {
        let asked = 441;
        assert_eq!(verified(fault), Err(DeviceError::Count { asked, answered }));
    }
}
