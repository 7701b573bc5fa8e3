"""Points of a flight, corrected by the workers of Dask: CAMERA RECORDS POINTS.parquet OUT_FOLDER."""

import sys

import dask.dataframe as dd
import pyarrow as pa
from dask.distributed import Client

import fmc_camera
from fmc_camera import arrow


def correct(part, frames):
    batch = pa.RecordBatch.from_pandas(part, preserve_index=False)
    return arrow.correct(batch, frames).to_pandas().set_axis(part.index)


if __name__ == "__main__":
    camera, records, points, out = sys.argv[1:]
    frames = fmc_camera.Camera.from_toml(camera).frames(records)
    with Client(n_workers=2, threads_per_worker=1):
        table = dd.read_parquet(points, split_row_groups=True)
        table.map_partitions(correct, frames, meta=table._meta).to_parquet(out)
