"""Types of the functions on tables of Arrow.

The answer to a RecordBatch or a Table of pyarrow, and to a DataFrame of Polars, is one; that to
another object is pyarrow's.
"""

import dataclasses
from typing import Any, Literal

from fmc_camera import Frames

__all__ = ["Counts", "correct", "distort"]

_Answer = Literal["ideal", "ideal-shifted", "measured-shifted"]

@dataclasses.dataclass
class Counts:
    points: int = 0
    off_sensor: int = 0
    without_frame: int = 0
    refused: int = 0

def correct(
    batch: Any,
    frames: Frames,
    *,
    answer: _Answer = "ideal",
    missing: Literal["error", "null"] = "error",
    counts: Counts | None = None,
) -> Any: ...
def distort(
    batch: Any,
    frames: Frames,
    *,
    answer: _Answer = "ideal",
    missing: Literal["error", "null"] = "error",
    counts: Counts | None = None,
) -> Any: ...
