"""Types of the package."""

from collections.abc import Mapping
from os import PathLike
from typing import Any, Literal, TypedDict, TypeVar, final, overload, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

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

__version__: str

_Number = TypeVar("_Number", np.float32, np.float64)
_Points = NDArray[_Number]
_Answer = Literal["ideal", "ideal-shifted", "measured-shifted"]
_OffSensor = Literal["extrapolate", "nan", "error"]
_Program = Literal[
    "opencv",
    "ros",
    "kalibr",
    "colmap",
    "metashape",
    "opensfm",
    "opf",
    "pix4d",
    "opentrackio",
    "micmac",
    "australis",
    "photomodeler",
    "arcgis",
    "frames",
]

class Error(ValueError): ...

class OutOfRange(Error):
    quantity: str
    value: float
    least: float
    most: float

class Folds(Error):
    polynomial: Literal["static", "fitted"]
    scale: float
    x_mm: float
    y_mm: float

class Stroke(Error):
    from_mm: float
    to_mm: float
    half_stroke_mm: float

class Speed(Error):
    wanted_mm_s: float
    max_mm_s: float

class Time(Error):
    needed_s: float
    available_s: float

class NotFitted(Error): ...

class InvalidFile(Error):
    help: str | None

class Layout(Error):
    argument: str

class NoFrame(Error):
    frame: str

class PointOffSensor(Error):
    index: int
    x_mm: float
    y_mm: float

@final
class Camera:
    @staticmethod
    def from_toml(path: str | PathLike[str]) -> Camera: ...
    @staticmethod
    def from_text(
        text: str, name: str = "camera.toml", grids: Mapping[str, bytes] | None = None
    ) -> Camera: ...
    @property
    def name(self) -> str: ...
    @property
    def principal_distance_mm(self) -> float: ...
    @property
    def principal_point_mm(self) -> tuple[float, float]: ...
    @property
    def size_px(self) -> tuple[int, int]: ...
    @property
    def pixel_um(self) -> float: ...
    @property
    def calibration_crc32(self) -> str: ...
    def keys(self) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...
    def frame(
        self,
        vh: float,
        exposure_s: float,
        *,
        direction: Literal["forward", "reverse"] = "forward",
        focus_shift_um: float = 0.0,
        opening_offset_mm: float | None = None,
        focus_sign: Literal["physical", "printed"] = "physical",
        model: Literal["exact", "fitted", "static"] = "exact",
    ) -> Frame: ...
    def frames(self, records: Any, *, images: Mapping[int, str] | None = None) -> Frames: ...
    @overload
    def reference(
        self,
        points: _Points[_Number],
        frame: Frame,
        *,
        out: _Points[_Number] | None = None,
        inplace: bool = False,
    ) -> _Points[_Number]: ...
    @overload
    def reference(
        self, points: ArrayLike, frame: Frame, *, out: None = None, inplace: bool = False
    ) -> NDArray[Any]: ...
    def budget(
        self,
        *,
        height_m: float = 1000.0,
        focus_um: float = 5.0,
        vh_error_percent: float = 1.0,
        relief_percent: float = 10.0,
        drift_deg: float = 1.0,
        rate_deg_s: float = 1.0,
        encoder_um: float = 1.0,
        timing_ms: float = 0.1,
    ) -> Budget: ...
    def export(
        self,
        program: _Program,
        folder: str | PathLike[str],
        *,
        model: str | None = None,
        container: Literal["yaml", "json", "xml"] | None = None,
        binary: bool = False,
        id: str | None = None,
        max_residual_um: float | None = None,
        records: Any = None,
        images: str | Mapping[int, str] | None = None,
        overwrite: bool = False,
    ) -> dict[str, Any]: ...
    def plot(self, frame: Frame | None = None) -> Figure: ...

@type_check_only
class _Term(TypedDict):
    source: str
    kind: Literal["position", "smear"]
    removed: bool
    paper_um: float | None
    limits_um: float
    limits_px: float
    limits_ground_cm: float

@final
class Budget:
    @property
    def camera(self) -> str: ...
    @property
    def height_m(self) -> float: ...
    @property
    def terms(self) -> list[_Term]: ...
    def plot(self) -> Figure: ...
    def _repr_html_(self) -> str: ...

@final
class Figure:
    @property
    def svg(self) -> str: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def _repr_svg_(self) -> str: ...
    def _repr_html_(self) -> str: ...

@final
class Frame:
    @property
    def vh_per_s(self) -> float: ...
    @property
    def exposure_s(self) -> float: ...
    @property
    def model(self) -> Literal["exact", "fitted", "static"]: ...
    @property
    def principal_point_mm(self) -> tuple[float, float]: ...
    @property
    def principal_distance_mm(self) -> float: ...
    @property
    def opening_offset_mm(self) -> float: ...
    @property
    def travel_mm(self) -> float: ...
    @property
    def centroid_offset_mm(self) -> float: ...
    @property
    def centroid_time_s(self) -> float: ...
    @property
    def focus_shift_mm(self) -> float: ...
    @property
    def enlargement(self) -> float: ...
    @property
    def left_out_nm(self) -> float: ...
    @overload
    def correct(
        self,
        points: _Points[_Number],
        *,
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> _Points[_Number]: ...
    @overload
    def correct(
        self,
        points: ArrayLike,
        *,
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> NDArray[Any]: ...
    @overload
    def distort(
        self,
        points: _Points[_Number],
        *,
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> _Points[_Number]: ...
    @overload
    def distort(
        self,
        points: ArrayLike,
        *,
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> NDArray[Any]: ...
    @overload
    def correct_px(
        self,
        points: _Points[_Number],
        *,
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> _Points[_Number]: ...
    @overload
    def correct_px(
        self,
        points: ArrayLike,
        *,
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> NDArray[Any]: ...
    @overload
    def distort_px(
        self,
        points: _Points[_Number],
        *,
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> _Points[_Number]: ...
    @overload
    def distort_px(
        self,
        points: ArrayLike,
        *,
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> NDArray[Any]: ...
    def mesh(self, spacing: int = 16) -> NDArray[np.float64]: ...
    def _kernel_seconds(
        self, points: NDArray[np.float32], out: NDArray[np.float32], calls: int
    ) -> float: ...

@final
class Frames:
    def __len__(self) -> int: ...
    @property
    def sequence(self) -> NDArray[np.uint32]: ...
    @property
    def is_exposed(self) -> NDArray[np.bool_]: ...
    @property
    def reasons(self) -> list[str | None]: ...
    @property
    def principal_point_mm(self) -> NDArray[np.float64]: ...
    @property
    def principal_point_sigma_mm(self) -> NDArray[np.float64]: ...
    @property
    def principal_point_frame_sigma_mm(self) -> NDArray[np.float64]: ...
    @property
    def principal_point_common_sigma_mm(self) -> NDArray[np.float64]: ...
    @property
    def centroid_offset_mm(self) -> NDArray[np.float64]: ...
    @property
    def travel_mm(self) -> NDArray[np.float64]: ...
    @property
    def centroid(self) -> NDArray[np.timedelta64]: ...
    @property
    def centroid_utc(self) -> NDArray[np.datetime64]: ...
    @property
    def utc_sigma_s(self) -> NDArray[np.float64]: ...
    def find(self, sequence: ArrayLike) -> NDArray[np.int64]: ...
    @overload
    def correct(
        self,
        points: _Points[_Number],
        index: ArrayLike,
        *,
        answer: _Answer = "ideal",
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> _Points[_Number]: ...
    @overload
    def correct(
        self,
        points: ArrayLike,
        index: ArrayLike,
        *,
        answer: _Answer = "ideal",
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "extrapolate",
    ) -> NDArray[Any]: ...
    @overload
    def distort(
        self,
        points: _Points[_Number],
        index: ArrayLike,
        *,
        answer: _Answer = "ideal",
        out: _Points[_Number] | None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> _Points[_Number]: ...
    @overload
    def distort(
        self,
        points: ArrayLike,
        index: ArrayLike,
        *,
        answer: _Answer = "ideal",
        out: None = None,
        inplace: bool = False,
        off_sensor: _OffSensor = "nan",
    ) -> NDArray[Any]: ...
    def _places(self, names: Any) -> NDArray[np.int64]: ...
    def _columns(
        self, x: Any, y: Any, places: Any, answer: str, is_distorted: bool
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.uint8]]: ...
