"""Points of a flight, corrected in Polars: CAMERA RECORDS POINTS.parquet OUT.parquet."""

import sys

import polars as pl

import fmc_camera
from fmc_camera import arrow

camera, records, points, out = sys.argv[1:]
frames = fmc_camera.Camera.from_toml(camera).frames(records)
table = pl.scan_parquet(points).map_batches(lambda part: arrow.correct(part, frames))
table.collect().write_parquet(out)
