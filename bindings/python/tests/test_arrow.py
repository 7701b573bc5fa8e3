"""Points in tables of Arrow."""

import flights
import numpy as np
import pandas
import polars
import pyarrow as pa
import pytest
from numpy.testing import assert_array_equal

import fmc_camera
from fmc_camera import arrow

FRAMES = flights.frames()
ANSWERS = ["ideal", "ideal-shifted", "measured-shifted"]


def batch_of(count=4000, dtype=np.float64, refused=False, seed=0):
    random = np.random.default_rng(seed)
    points = random.uniform(-35, 35, (count, 2)).astype(dtype)
    places = random.choice(np.flatnonzero(FRAMES.is_exposed), count)
    if refused:
        places[::7] = 8
    columns = {
        "y": points[:, 1].copy(),
        "name": [f"point {number}" for number in range(count)],
        "frame": FRAMES.sequence[places].astype(np.int64),
        "x": points[:, 0].copy(),
    }
    return pa.RecordBatch.from_pydict(columns), points, places


def points_of(table):
    return np.column_stack([np.asarray(table.column("x")), np.asarray(table.column("y"))])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("answer", ANSWERS)
def test_batch_has_the_bits_of_arrays_and_keeps_its_other_columns(dtype, answer):
    batch, points, places = batch_of(dtype=dtype)
    for call, method in [(arrow.correct, FRAMES.correct), (arrow.distort, FRAMES.distort)]:
        found = call(batch, FRAMES, answer=answer)
        assert type(found) is pa.RecordBatch and found.schema == batch.schema
        assert_array_equal(points_of(found), method(points, places, answer=answer))
        for name in ["frame", "name"]:
            assert found.column(name).equals(batch.column(name))


class Capsule:
    """A table of a program that is known by its methods alone."""

    def __init__(self, batch):
        self.batch = batch

    def __arrow_c_array__(self, requested_schema=None):
        return self.batch.__arrow_c_array__(requested_schema)


class Stream:
    def __init__(self, table):
        self.table = table

    def __arrow_c_stream__(self, requested_schema=None):
        return self.table.__arrow_c_stream__(requested_schema)


def test_every_table_of_arrow_is_one():
    batch, points, places = batch_of()
    expected = FRAMES.correct(points, places)
    table = pa.Table.from_batches([batch.slice(0, 1000), batch.slice(1000)])
    for given, kind in [
        (Capsule(batch), pa.RecordBatch),
        (Stream(table), pa.Table),
        (table, pa.Table),
        (batch.to_pandas(), pa.Table),
    ]:
        found = arrow.correct(given, FRAMES)
        assert type(found) is kind
        assert_array_equal(points_of(found), expected)
    frame = polars.DataFrame(table)
    found = arrow.correct(frame, FRAMES)
    assert type(found) is polars.DataFrame and found.schema == frame.schema
    assert_array_equal(found.select("x", "y").to_numpy(), expected)


@pytest.mark.parametrize(
    "kind",
    [
        pa.int8(), pa.uint8(), pa.int16(), pa.int32(), pa.uint32(), pa.int64(), pa.uint64(),
        pa.dictionary(pa.int32(), pa.int64()), pa.dictionary(pa.uint8(), pa.uint32()),
    ],
    ids=str,
)  # fmt: skip
def test_frame_of_every_whole_type(kind):
    batch, points, places = batch_of()
    column = batch.column("frame")
    if pa.types.is_dictionary(kind):
        column = column.cast(kind.value_type).dictionary_encode().cast(kind)
    else:
        column = column.cast(kind)
    changed = batch.set_column(2, "frame", column)
    found = arrow.correct(changed, FRAMES)
    assert found.schema.field("frame").type == kind
    assert_array_equal(points_of(found), FRAMES.correct(points, places))


def test_frame_by_the_name_of_its_image():
    camera = flights.camera()
    frames = camera.frames(flights.exposures(3), images={1: "a.tif", 2: "b.tif", 3: "7"})
    points = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [1.0, 2.0]])
    names = pa.array(["b.tif", "a.tif", "b.tif", "3"])
    expected = frames.correct(points, [1, 0, 1, 2])
    for kind in [pa.string(), pa.large_string(), pa.string_view(), "dictionary"]:
        column = names.dictionary_encode() if kind == "dictionary" else names.cast(kind)
        batch = pa.RecordBatch.from_pydict({"frame": column, "x": points[:, 0], "y": points[:, 1]})
        assert_array_equal(points_of(arrow.correct(batch, frames)), expected)
    table = polars.DataFrame(
        {"frame": polars.Series(names.to_pylist(), dtype=polars.Categorical), "x": points[:, 0],
         "y": points[:, 1]}
    )  # fmt: skip
    assert_array_equal(arrow.correct(table, frames).select("x", "y").to_numpy(), expected)


def test_frame_without_record_is_an_error_or_null_and_is_counted():
    batch, points, places = batch_of(600, refused=True)
    sequence = batch.column("frame").to_numpy().copy()
    sequence[[5, 599]] = [99, -3]
    batch = batch.set_column(2, "frame", pa.array(sequence))
    with pytest.raises(fmc_camera.NoFrame, match="row 0: frame 9: a point of refused") as caught:
        arrow.correct(batch, FRAMES)
    lost = np.isin(sequence, [9, 99, -3])
    assert caught.value.frame == "9" and caught.value.points == lost.sum()
    flown = batch.filter(pa.array(sequence != 9))
    with pytest.raises(fmc_camera.NoFrame, match="row 4: frame 99: a point of frames without"):
        arrow.correct(flown, FRAMES)
    counts = arrow.Counts()
    found = arrow.correct(batch, FRAMES, missing="null", counts=counts)
    refused = int((sequence == 9).sum())
    assert counts == arrow.Counts(600, 0, 2, refused)
    arrow.correct(batch, FRAMES, missing="null", counts=counts)
    assert counts == arrow.Counts(1200, 0, 4, 2 * refused)
    for name in ["x", "y"]:
        assert_array_equal(found.column(name).is_null().to_numpy(zero_copy_only=False), lost)
    kept = found.filter(pa.array(~lost))
    assert_array_equal(points_of(kept), FRAMES.correct(points[~lost], places[~lost]))


def test_point_off_the_sensor_is_an_error_or_null():
    batch = pa.RecordBatch.from_pydict(
        {"frame": [1, 1, 2], "x": [0.0, 200.0, 1.0], "y": [0.0, 0.5, 1.0]}
    )
    with pytest.raises(fmc_camera.PointOffSensor, match="row 1: frame 1: a point off") as caught:
        arrow.correct(batch, FRAMES)
    error = caught.value
    assert (error.index, error.x_mm, error.y_mm, error.points) == (1, 200.0, 0.5, 1)
    counts = arrow.Counts()
    found = arrow.correct(batch, FRAMES, missing="null", counts=counts)
    assert counts.off_sensor == 1 and found.column("x").null_count == 1


def test_null_stays_null_and_nan_stays_nan():
    nan = float("nan")
    batch = pa.RecordBatch.from_pydict(
        {
            "frame": pa.array([1, None, 2, 3, 4], pa.int32()),
            "x": pa.array([1.0, 2.0, None, nan, 5.0], from_pandas=False),
            "y": pa.array([1.0, 2.0, 3.0, 4.0, 5.0]),
        }
    )
    found = arrow.correct(batch, FRAMES)
    assert [value is None for value in found.column("x").to_pylist()] == [False, True, True, False, False]
    assert np.isnan(found.column("x")[3].as_py()) and np.isnan(found.column("y")[3].as_py())
    assert found.column("y").is_null().to_pylist() == [False, True, True, False, False]
    assert_array_equal(
        [found.column("x")[4].as_py(), found.column("y")[4].as_py()],
        FRAMES.correct(np.array([[5.0, 5.0]]), [3])[0],
    )
    nothing = pa.RecordBatch.from_pydict({"frame": pa.nulls(1), "x": [1.0], "y": [1.0]})
    assert arrow.correct(nothing, FRAMES).column("x").null_count == 1


def test_empty_batches_and_tables():
    batch, _, _ = batch_of(10)
    empty = batch.slice(0, 0)
    assert arrow.correct(empty, FRAMES).equals(empty)
    table = pa.Table.from_batches([], batch.schema)
    assert arrow.correct(table, FRAMES).schema == batch.schema
    assert len(arrow.correct(polars.DataFrame(table), FRAMES)) == 0


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [
        ({"x": [1.0], "y": [1.0]}, "column frame is missing; found x, y"),
        ({"frame": [1], "x": [1.0]}, "column y is missing"),
        ({"frame": [1], "x": [1], "y": [1]}, "columns x and y of the types int64 and int64"),
        ({"frame": [1], "x": [1.0], "y": np.float32([1])}, "types double and float"),
        ({"frame": [1.0], "x": [1.0], "y": [1.0]}, "column frame of the type double"),
        ({"frame": [b"a"], "x": [1.0], "y": [1.0]}, "column frame of the type binary"),
    ],
)
def test_columns_of_another_kind_are_named(columns, sentence):
    with pytest.raises(fmc_camera.Error, match=sentence):
        arrow.correct(pa.RecordBatch.from_pydict(columns), FRAMES)


def test_what_is_no_table_is_refused():
    batch, _, _ = batch_of(3)
    twice = pa.RecordBatch.from_arrays([batch.column("x")] * 2, names=["x", "x"])
    for wrong, sentence in [
        (twice, "column frame is missing"),
        ([1, 2], "a batch of the type <class 'list'>"),
        (None, "a batch of the type"),
    ]:
        with pytest.raises(fmc_camera.Error, match=sentence):
            arrow.correct(wrong, FRAMES)
    with pytest.raises(fmc_camera.Error, match="missing = 'skip': must be"):
        arrow.correct(batch, FRAMES, missing="skip")
    with pytest.raises(fmc_camera.Error, match="answer = 'x': must be"):
        arrow.correct(batch, FRAMES, answer="x")


def test_duplicated_records_are_refused():
    table = pandas.read_csv(flights.RECORDS)
    with pytest.raises(fmc_camera.InvalidFile, match="sequence 3 appears twice"):
        flights.camera().frames(pandas.concat([table, table[2:3]]))
