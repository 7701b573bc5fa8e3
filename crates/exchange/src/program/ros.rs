//! ROS: `camera_info`, as `camera_calibration` writes it.

use fmc_camera_file::InputError;

use crate::calibrated::Calibrated;
use crate::decimal::list;
use crate::fields::Field;
use crate::found::{Formula, Found, unsupported};
use crate::pinhole::Pinhole;
use crate::program::model::{BROWN_3, Model, RATIONAL, TWO_FOCALS};
use crate::program::opencv;
use crate::source::Source;

/// Models.
pub(crate) const MODELS: &[Model] = &[
    Model::new("plumb_bob", BROWN_3, TWO_FOCALS),
    Model::new("rational_polynomial", RATIONAL, TWO_FOCALS),
];

/// Name of the file.
pub(crate) const FILE: &str = "camera_info.yaml";

/// Writes the file.
pub(crate) fn write(camera: &Calibrated, pinhole: &Pinhole, model: &Model) -> String {
    let count = if model.name == "plumb_bob" { 5 } else { 8 };
    let [width, height] = camera.size_px;
    let [fx, fy] = pinhole.focal_px;
    let [cx, cy] = pinhole.centre_px;
    let projection = [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0];
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    format!(
        "image_width: {width}\nimage_height: {height}\ncamera_name: camera\n\
         camera_matrix:\n  rows: 3\n  cols: 3\n  data: [{}]\ndistortion_model: {}\n\
         distortion_coefficients:\n  rows: 1\n  cols: {count}\n  data: [{}]\n\
         rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [{}]\n\
         projection_matrix:\n  rows: 3\n  cols: 4\n  data: [{}]\n",
        list(&opencv::matrix(pinhole)),
        model.name,
        list(&opencv::coefficients(pinhole, count)),
        list(&identity),
        list(&projection),
    )
}

/// Reads the file.
pub(crate) fn read(source: &Source<'_>) -> Result<Found, InputError> {
    let tree = source.yaml()?;
    let root = Field::root(*source, &tree);
    let model = root.get("distortion_model")?.word()?;
    if !["plumb_bob", "rational_polynomial"].contains(&model) {
        return Err(unsupported(source, model, "plumb_bob, rational_polynomial"));
    }
    let mut pinhole = opencv::from_matrix(&root.get("camera_matrix")?)?;
    let data = root.get("distortion_coefficients")?.get("data")?;
    opencv::put_coefficients(&mut pinhole, &data)?;
    let size = [
        root.get("image_width")?.count()?,
        root.get("image_height")?.count()?,
    ];
    let name = match root.find("camera_name") {
        Some(field) => field.word().unwrap_or("camera"),
        None => "camera",
    };
    Found::new(name, Formula::Pinhole(pinhole))
        .sized(size)
        .checked(source)
}
