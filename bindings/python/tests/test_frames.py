"""The frames of a flight: where they come from, what they hold, and their points."""

import pickle
import sys

import duckdb
import flights
import numpy as np
import pandas
import polars
import pyarrow
import pyarrow.csv
import pytest
from numpy.testing import assert_array_equal

import fmc_camera

FRAMES = flights.frames()


def random_points(count, seed=0, dtype=np.float64):
    return np.random.default_rng(seed).uniform(-30, 30, (count, 2)).astype(dtype)


def test_arrays_are_those_of_the_records():
    records = flights.columns()
    assert len(FRAMES) == 15 and FRAMES.sequence.tolist() == list(range(1, 16))
    exposed = [outcome == "exposed" for outcome in records["outcome"]]
    assert FRAMES.is_exposed.tolist() == exposed and exposed.count(False) == 1
    assert [reason for reason in FRAMES.reasons if reason] == ["overlap"]
    for array, column, unit in [
        (FRAMES.principal_point_mm[:, 1], "principal_point_y_mm", 1),
        (FRAMES.principal_point_sigma_mm, "principal_point_sigma_mm", 1),
        (FRAMES.travel_mm, "travel_mm", 1),
        (FRAMES.centroid_offset_mm, "centroid_offset_mm", 1),
        (FRAMES.centroid / np.timedelta64(1, "us"), "centroid_us", 1),
    ]:
        expected = [float("nan") if cell is None else float(cell) for cell in records[column]]
        np.testing.assert_allclose(array, np.multiply(expected, unit), rtol=1e-6, err_msg=column)
    assert np.isnan(FRAMES.principal_point_mm[8]).all()
    assert np.isnat(FRAMES.centroid_utc).all() and FRAMES.centroid_utc.dtype == "M8[us]"


def tables():
    records = flights.columns()
    yield "pandas", pandas.read_csv(flights.RECORDS)
    yield "pandas of text", pandas.read_csv(flights.RECORDS, dtype=str)
    yield "polars", polars.read_csv(flights.RECORDS)
    yield "pyarrow", pyarrow.csv.read_csv(flights.RECORDS)
    yield "dictionary of text", records
    yield "dictionary of arrays", dict(pandas.read_csv(flights.RECORDS).items())


@pytest.mark.parametrize(("kind", "table"), list(tables()), ids=lambda value: str(value)[:20])
def test_every_table_of_records_gives_the_same_frames(kind, table):
    frames = flights.camera().frames(table)
    points, index = random_points(15 * 40), np.repeat(np.arange(15), 40)
    for answer in ["ideal", "ideal-shifted", "measured-shifted"]:
        assert_array_equal(
            frames.correct(points, index, answer=answer),
            FRAMES.correct(points, index, answer=answer),
            err_msg=kind,
        )
    assert_array_equal(frames.centroid, FRAMES.centroid)
    assert_array_equal(frames.principal_point_sigma_mm, FRAMES.principal_point_sigma_mm)


class Stream:
    """A table of a library that is known by the methods of Arrow alone."""

    def __init__(self, table):
        self.table = table

    def __arrow_c_stream__(self, requested_schema=None):
        return self.table.__arrow_c_stream__(requested_schema)


class Array:
    def __init__(self, table):
        self.table = table

    def __arrow_c_array__(self, requested_schema=None):
        return self.table.combine_chunks().to_batches()[0].__arrow_c_array__(requested_schema)


def test_tables_with_the_capsules_of_arrow_give_the_same_frames():
    table = pyarrow.csv.read_csv(flights.RECORDS)
    parts = pyarrow.concat_tables([table.slice(0, 4), table.slice(4)])
    points, index = random_points(15 * 40), np.repeat(np.arange(15), 40)
    relation = duckdb.connect().sql(f"select * from read_csv('{flights.RECORDS}')")
    coded = parts.set_column(2, "outcome", parts.column("outcome").dictionary_encode())
    for records in [Stream(parts), Array(table), relation, Stream(coded), coded]:
        frames = flights.camera().frames(records)
        assert_array_equal(frames.correct(points, index), FRAMES.correct(points, index))
        assert_array_equal(frames.centroid, FRAMES.centroid)


def test_capsules_that_are_no_table_are_refused(monkeypatch):
    numbers = pyarrow.chunked_array([[1, 2]])
    with pytest.raises(fmc_camera.Error, match="^records of the type .*Stream"):
        flights.camera().frames(Stream(numbers))
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(fmc_camera.Error, match="pyarrow reads tables with Arrow's PyCapsule"):
        flights.camera().frames(Stream(numbers))


def test_crc_that_was_read_as_a_number_keeps_its_zeros():
    table = flights.columns()
    table["calibration_crc32"] = [123] * 15
    with pytest.raises(fmc_camera.InvalidFile, match="calibration_crc32 = 00000123: a record of"):
        flights.camera().frames(table)


@pytest.mark.parametrize("command", ["correct", "distort"])
@pytest.mark.parametrize("answer", ["ideal", "ideal-shifted", "measured-shifted"])
def test_points_of_many_frames_are_those_of_host_sim(host_sim, tmp_path, answer, command):
    points = random_points(700, dtype=np.float32) * np.float32(0.9)
    exposed = np.flatnonzero(FRAMES.is_exposed)
    index = np.random.default_rng(1).choice(exposed, 700)
    rows = np.column_stack([FRAMES.sequence[index].astype(np.float32), points])
    np.save(tmp_path / "points.npy", rows)
    out = tmp_path / "answers.npy"
    host_sim(
        command, "--camera", flights.CAMERA, "--records", flights.RECORDS, "--answer", answer,
        tmp_path / "points.npy", "--out", out,
    )  # fmt: skip
    found = getattr(FRAMES, command)(points, index, answer=answer)
    assert_array_equal(found.view(np.uint32), np.load(out)[:, :2].view(np.uint32))


def test_frame_by_frame_has_the_bits_of_one_call():
    table = flights.exposures(9)
    camera = flights.camera()
    frames = camera.frames(table)
    points = random_points(9 * 50)
    together = frames.correct(points, np.repeat(np.arange(9), 50))
    rows = frames.correct(points.reshape(9, 50, 2), np.arange(9))
    assert_array_equal(rows.reshape(-1, 2), together)
    for number in range(9):
        frame = camera.frame(table["vh_per_s"][number], table["exposure_s"][number])
        part = slice(50 * number, 50 * number + 50)
        assert_array_equal(frame.correct(points[part]), together[part])
        shifted = frames.correct(points[part], [number] * 50, answer="ideal-shifted")
        offset = [0, frame.centroid_offset_mm]
        assert_array_equal(shifted, together[part] - np.array(offset))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_any_order_out_and_inplace_have_the_same_bits(dtype):
    count = 5000
    points = random_points(count, dtype=dtype)
    index = np.random.default_rng(3).integers(0, 15, count)
    order = np.argsort(index, kind="stable")
    for answer in ["ideal", "ideal-shifted", "measured-shifted"]:
        for method in [FRAMES.correct, FRAMES.distort]:
            expected = np.empty_like(points)
            expected[order] = method(points[order], index[order], answer=answer)
            assert_array_equal(method(points, index, answer=answer), expected)
            out = np.zeros_like(points)
            assert method(points, index, answer=answer, out=out) is out
            assert_array_equal(out, expected)
            assert_array_equal(
                method(points.copy(), index, answer=answer, inplace=True), expected
            )
            assert np.isnan(expected[index == 8]).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("longest", [1, 3, 9, 40, 700])
def test_runs_of_every_length_have_the_bits_of_their_frames(dtype, longest):
    random = np.random.default_rng(longest)
    lengths = random.integers(1, longest + 1, 60 if longest > 9 else 600)
    index = np.repeat(random.integers(0, 15, len(lengths)), lengths)
    points = random_points(len(index), dtype=dtype)
    points[random.integers(0, len(index), 9), 0] = np.nan
    expected = np.empty_like(points)
    for place in range(15):
        part = index == place
        expected[part] = FRAMES.correct(points[part], np.full(part.sum(), place))
    assert np.isnan(expected[index == 8]).all() and not np.isnan(expected[index == 3]).all()
    for start in range(8):
        out = np.full((len(index) + 9, 2), 7, dtype)
        room = out[start : start + len(index)]
        FRAMES.correct(points, index, out=room)
        assert_array_equal(room, expected)
        assert (np.delete(out, range(start, start + len(index)), axis=0) == 7).all()
        again = np.concatenate([out[:start], points])[start:]
        assert_array_equal(FRAMES.correct(again, index, inplace=True), expected)


def test_points_that_do_not_fit_the_caches_have_the_bits_of_their_frames():
    lengths = np.random.default_rng(7).integers(900, 1100, 900)
    index = np.repeat(np.arange(900) % 15, lengths)
    points = random_points(len(index), dtype=np.float32)
    together = FRAMES.correct(points, index)
    assert points.nbytes > 1.5 * 2**22
    ends = np.cumsum(lengths)
    for place, end, length in zip(np.arange(900) % 15, ends, lengths):
        part = slice(end - length, end)
        assert_array_equal(together[part], FRAMES.correct(points[part], [place] * length))


def test_frames_without_shifted_points_are_an_error_before_anything_is_replaced():
    table = flights.exposures(2) | {"focus_shift_um": [0.0, 9.0], "focus_sign": ["printed"] * 2}
    frames = flights.camera().frames(table)
    points = random_points(20)
    before = points.copy()
    with pytest.raises(fmc_camera.Error, match="frame 2: .*printed"):
        frames.correct(points, np.repeat([0, 1], 10), answer="measured-shifted", inplace=True)
    assert_array_equal(points, before)


@pytest.mark.parametrize("kind", ["int8", "uint8", "int32", "uint32", "int64", "uint64"])
def test_index_of_every_whole_type(kind):
    points, index = random_points(90), np.arange(90) % 15
    expected = FRAMES.correct(points, index)
    assert_array_equal(FRAMES.correct(points, index.astype(kind)), expected)
    assert_array_equal(FRAMES.correct(points, np.repeat(index, 2).astype(kind)[::2]), expected)
    assert_array_equal(FRAMES.correct(points, index.tolist()), expected)


@pytest.mark.parametrize("wrong", [15, -1, 2**31, -(2**63)])
@pytest.mark.parametrize("inplace", [False, True])
def test_index_beyond_the_frames_is_an_error_before_anything_is_replaced(wrong, inplace):
    points, index = random_points(100), np.zeros(100, np.int64)
    index[60] = wrong
    before = points.copy()
    sentence = rf"index\[60\] = {wrong}: must be a place among 15 frames"
    with pytest.raises(fmc_camera.OutOfRange, match=sentence) as caught:
        FRAMES.correct(points, index, inplace=inplace)
    assert (caught.value.quantity, caught.value.value) == ("index", wrong)
    assert (caught.value.least, caught.value.most) == (0, 14)
    assert_array_equal(points, before)


@pytest.mark.parametrize(
    ("index", "sentence"),
    [
        (np.zeros(3), "of whole numbers"),
        (np.zeros((4, 1), int), "2 dimensions"),
        (np.zeros(4, bool), "of whole numbers"),
        (np.ma.masked_array(np.zeros(4, int)), "masked"),
        (np.zeros(3, int), "3 numbers for 4 rows"),
        (["a"] * 4, "of whole numbers"),
    ],
)
def test_index_of_another_layout_is_refused(index, sentence):
    with pytest.raises(fmc_camera.Layout, match=sentence) as caught:
        FRAMES.correct(random_points(4), index)
    assert caught.value.argument == "index"


def test_no_points_and_no_index():
    assert FRAMES.correct(np.empty((0, 2)), []).shape == (0, 2)
    assert FRAMES.correct(np.empty((0, 7, 2)), []).shape == (0, 7, 2)
    assert FRAMES.correct(np.empty((3, 0, 2)), [1, 2, 3]).shape == (3, 0, 2)


def test_point_off_the_sensor_names_its_place_in_all_points():
    points, index = np.zeros((60, 2)), np.repeat([1, 2, 3], 20)
    points[47] = [100.0, 0.0]
    for method in [FRAMES.correct, FRAMES.distort]:
        with pytest.raises(fmc_camera.PointOffSensor) as caught:
            method(points, index, off_sensor="error", answer="ideal-shifted")
        assert (caught.value.index, caught.value.x_mm) == (47, 100.0)
        marked = np.isnan(method(points, index, off_sensor="nan")).all(axis=1)
        assert np.flatnonzero(marked).tolist() == [47]


def test_frames_are_found_by_their_sequence_numbers():
    assert FRAMES.find([1, 15, 9]).tolist() == [0, 14, 8]
    with pytest.raises(fmc_camera.NoFrame, match="frame 16: .*records.csv has no such") as caught:
        FRAMES.find([1, 16])
    assert caught.value.frame == "16"


def test_frames_go_to_other_processes():
    again = pickle.loads(pickle.dumps(FRAMES))
    points, index = random_points(600), np.arange(600) % 15
    assert_array_equal(again.correct(points, index), FRAMES.correct(points, index))
    assert again.reasons == FRAMES.reasons and repr(again) == repr(FRAMES)


def test_records_of_another_camera_are_refused(ixm):
    with pytest.raises(fmc_camera.InvalidFile, match="a record of another calibration") as caught:
        ixm.frames(flights.RECORDS)
    assert "a7cf30ff" in str(caught.value) and "--camera" in caught.value.help


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"travel_mm": ["x"] * 15}, "line 2: travel_mm"),
        ({"sequence": [1] * 15}, "sequence 1 appears twice"),
        ({"sequence": [1, 2]}, "column sequence has 2 rows|column .* has 15 rows"),
        ({"centroid_offset_mm": ["9"] * 15}, "line 2: "),
        ({"outcome": ["flown"] * 15}, "outcome = flown: must be exposed or refused"),
        ({"sequence": [object()] * 15}, "row 0: a value of the type"),
    ],
)
def test_wrong_records_are_named(change, sentence):
    table = flights.columns() | change
    with pytest.raises(fmc_camera.Error, match=sentence):
        flights.camera().frames(table)


def test_what_is_no_table_is_refused(tmp_path):
    camera = flights.camera()
    for wrong in [7, None, object()]:
        with pytest.raises(fmc_camera.Error, match="must be the path of a file, a table"):
            camera.frames(wrong)
    with pytest.raises(fmc_camera.InvalidFile, match="cannot be read"):
        camera.frames(tmp_path / "nowhere.csv")
    with pytest.raises(fmc_camera.InvalidFile, match="column velocity is not known"):
        camera.frames({"sequence": [1], "velocity": [0.1]})
    with pytest.raises(fmc_camera.InvalidFile, match="line 2: vh_per_s"):
        camera.frames({"sequence": [1], "vh_per_s": [3.0], "exposure_s": [0.004]})


def test_images_name_frames():
    camera = flights.camera()
    frames = camera.frames(flights.exposures(3), images={1: "a.tif", 3: "c.tif"})
    assert len(frames) == 3
    with pytest.raises(fmc_camera.NoFrame, match="images: sequence 7 is not in records"):
        camera.frames(flights.exposures(3), images={7: "a.tif"})
