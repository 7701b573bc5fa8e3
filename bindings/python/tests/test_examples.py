"""The examples for Polars, DuckDB, Dask and Spark, each run as a user runs it."""

import hashlib
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys

import dask.dataframe as dd
import dask.distributed
import dask_worker
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
    # Workers of Spark are of this interpreter, too.
    environment = os.environ | {"PYSPARK_PYTHON": sys.executable}
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
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


def test_dask_has_the_digest_of_one_call(points, tmp_path):
    finish(start("dask_points.py", points, tmp_path / "out"))
    assert digest(whole(tmp_path / "out")) == expected(points)
    names = [path.name for path in (tmp_path / "out").iterdir()]
    assert len(names) == POINTS // EACH and all(name.endswith(".parquet") for name in names)


def test_dask_has_the_digest_of_one_call_also_if_a_worker_is_killed_in_the_middle(
    points, tmp_path
):
    with dask.distributed.Client(n_workers=2, threads_per_worker=1):
        table = dd.read_parquet(points, split_row_groups=True)
        marker, out = tmp_path / "killed", tmp_path / "out"
        answers = table.map_partitions(
            dask_worker.correct_or_die, flights.frames(), marker, meta=table._meta
        )
        answers.to_parquet(out)
    assert marker.exists()
    assert digest(whole(out)) == expected(points)
    assert all(path.name.endswith(".parquet") for path in out.iterdir())


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
