"""Work of a worker of Dask that is killed in the middle of a block."""

import os
import pathlib
import runpy
import signal

EXAMPLE = pathlib.Path(__file__).resolve().parents[1] / "examples/dask_points.py"


def correct_or_die(part, frames, marker):
    """Corrects a part as the example does; the worker that first has one from the middle dies."""
    if len(part) and 20_000 <= part["id"].iloc[0] and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return runpy.run_path(str(EXAMPLE))["correct"](part, frames)
