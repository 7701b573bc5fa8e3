"""Points of a flight, corrected in DuckDB: CAMERA RECORDS POINTS.parquet OUT.parquet."""

import sys

import duckdb
import pyarrow as pa

import fmc_camera
from fmc_camera import arrow

camera, records, points, out = sys.argv[1:]
frames = fmc_camera.Camera.from_toml(camera).frames(records)
# One connection reads while the other writes.
source = duckdb.connect()
given = source.read_parquet(points).to_arrow_reader(1_000_000)
parts = (arrow.correct(part, frames) for part in given)
corrected = pa.RecordBatchReader.from_batches(given.schema, parts)
duckdb.from_arrow(corrected).write_parquet(out)
