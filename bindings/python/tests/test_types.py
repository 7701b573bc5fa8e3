"""The typed stubs against the package, and against code that uses it."""

import pathlib
import subprocess
import sys

PACKAGE = pathlib.Path(__file__).resolve().parents[1]

USE = """
import numpy as np
from numpy.typing import NDArray
import fmc_camera

camera = fmc_camera.Camera.from_toml("camera.toml")
frame = camera.frame(0.17, 1 / 200, direction="reverse")
singles: NDArray[np.float32] = frame.correct(np.zeros((2, 2), np.float32))
doubles: NDArray[np.float64] = frame.distort(np.zeros((2, 2)))
frames = camera.frames("records.csv")
share: float = camera.budget(height_m=441).terms[0]["limits_px"]
camera.plot(frame).save("change.svg")
residual: float = camera.export("colmap", "folder", binary=True)["residual_max_px"]
many: NDArray[np.float64] = frames.correct(np.zeros((2, 2)), [0, 1], answer="ideal-shifted")
"""


def mypy(tool, *arguments):
    return subprocess.run(
        [sys.executable, "-m", tool, *map(str, arguments)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def test_stubs_are_those_of_the_package():
    done = mypy("mypy.stubtest", "fmc_camera", "--ignore-missing-stub")
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_are_found_and_wrong_words_are_seen(tmp_path):
    for change, is_right in [("", True), ("frame.correct([[1.0, 2.0]], off_sensor='x')\n", False)]:
        path = tmp_path / f"use_{is_right}.py"
        path.write_text(USE + change)
        cache = tmp_path / "cache"
        done = mypy("mypy", "--strict", "--cache-dir", cache, path)
        assert (done.returncode == 0) == is_right, done.stdout + done.stderr
