"""The examples for Polars, DuckDB, Dask and Spark, each run as a user runs it."""

import hashlib
import importlib.util
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import flights
import numpy as np
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet
import pytest

from fmc_camera import arrow

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
POINTS, EACH = 60_000, 4000


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """A file of points in some groups of rows, in any order."""
    random = np.random.default_rng(11)
    exposed = [number for number in range(1, 16) if number != 9]
    table = pa.table(
        {
            "id": np.arange(POINTS),
            "x": random.uniform(-35, 35, POINTS),
            "frame": random.choice(exposed, POINTS),
            "y": random.uniform(-35, 35, POINTS),
        }
    )
    path = tmp_path_factory.mktemp("points") / "points.parquet"
    pyarrow.parquet.write_table(table, path, row_group_size=EACH)
    return path


def digest(table):
    table = table.sort_by("id")
    numbers = [np.asarray(table.column(name)).tobytes() for name in ["id", "x", "y", "frame"]]
    return hashlib.sha256(b"".join(numbers)).hexdigest()


def expected(points):
    return digest(arrow.correct(pyarrow.parquet.read_table(points), flights.frames()))


def start(example, points, out):
    command = [sys.executable, EXAMPLES / example, flights.CAMERA, flights.RECORDS, points, out]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def finish(process):
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors


@pytest.mark.parametrize("library", ["polars", "duckdb"])
def test_example_has_the_digest_of_one_call(library, points, tmp_path):
    out = tmp_path / "out.parquet"
    finish(start(f"{library}_points.py", points, out))
    assert digest(pyarrow.parquet.read_table(out)) == expected(points)


def whole(folder):
    """The answers of a folder; every file of it can be read."""
    return pyarrow.dataset.dataset(folder, format="parquet").to_table()


def test_dask_has_the_digest_of_one_call_also_if_a_worker_is_killed(points, tmp_path):
    import psutil

    finish(start("dask_points.py", points, tmp_path / "out"))
    assert digest(whole(tmp_path / "out")) == expected(points)
    process = start("dask_points.py", points, tmp_path / "again")
    killed = None
    deadline = time.monotonic() + 120
    while killed is None and process.poll() is None and time.monotonic() < deadline:
        for child in psutil.Process(process.pid).children(recursive=True):
            # Workers import this package when they take their first part.
            maps = (one.path for one in child.memory_maps()) if child.is_running() else ()
            if any("fmc_camera" in path for path in maps):
                os.kill(child.pid, signal.SIGKILL)
                killed = child.pid
                break
    finish(process)
    assert killed is not None
    assert digest(whole(tmp_path / "again")) == expected(points)
    names = [path.name for path in (tmp_path / "again").iterdir()]
    assert all(name.endswith(".parquet") for name in names), names


@pytest.mark.skipif(
    importlib.util.find_spec("pyspark") is None or shutil.which("java") is None,
    reason="no Spark, or no Java",
)
def test_spark_has_the_digest_of_one_call(points, tmp_path):
    finish(start("spark_points.py", points, tmp_path / "out"))
    assert digest(whole(tmp_path / "out")) == expected(points)


def test_worker_without_the_package_says_so():
    code = "import pickle, sys; pickle.loads(sys.stdin.buffer.read())"
    import pickle

    packed = pickle.dumps(flights.frames())
    done = subprocess.run(
        [sys.executable, "-S", "-I", "-c", code], input=packed, capture_output=True, check=False
    )
    assert done.returncode != 0
    assert b"No module named 'fmc_camera'" in done.stderr
