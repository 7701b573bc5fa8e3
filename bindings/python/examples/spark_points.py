"""Points of a flight, corrected by the workers of Spark: CAMERA RECORDS POINTS.parquet OUT_FOLDER."""

import sys

from pyspark.sql import SparkSession

import fmc_camera
from fmc_camera import arrow

camera, records, points, out = sys.argv[1:]
frames = fmc_camera.Camera.from_toml(camera).frames(records)
spark = SparkSession.builder.master("local[2]").getOrCreate()
table = spark.read.parquet(points)
corrected = table.mapInArrow(
    lambda parts: (arrow.correct(part, frames) for part in parts), table.schema
)
corrected.write.mode("overwrite").parquet(out)
