"""Interior orientation and lens distortion of an airborne mapping camera whose detector moves.

    import fmc_camera

    camera = fmc_camera.Camera.from_toml("camera.toml")
    frame = camera.frame(vh=0.17, exposure_s=1 / 200)
    ideal = frame.correct(points)  # (N, 2), mm from the middle of the sensor

Guide: docs/python.md of the project.
"""

from fmc_camera._core import (
    Budget,
    Camera,
    Error,
    Figure,
    Folds,
    Frame,
    Frames,
    InvalidFile,
    Layout,
    NoFrame,
    NotFitted,
    OutOfRange,
    PointOffSensor,
    Speed,
    Stroke,
    Time,
    __version__,
)

__all__ = [
    "Budget",
    "Camera",
    "Error",
    "Figure",
    "Folds",
    "Frame",
    "Frames",
    "InvalidFile",
    "Layout",
    "NoFrame",
    "NotFitted",
    "OutOfRange",
    "PointOffSensor",
    "Speed",
    "Stroke",
    "Time",
    "__version__",
]
