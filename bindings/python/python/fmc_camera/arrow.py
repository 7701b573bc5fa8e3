"""Points in tables of Arrow: what pyarrow, Polars, DuckDB, Dask and Spark hand from one to another.

    import fmc_camera.arrow

    corrected = fmc_camera.arrow.correct(batch, frames)

`batch` is a RecordBatch or a Table of pyarrow, a DataFrame of Polars, or any object with the
methods of Arrow's PyCapsule interface. It has the columns `x` and `y`, mm, and `frame`, the sequence
number of a frame or the name of its image; in any order, beside any others. The answer has the same
columns, with `x` and `y` replaced. pyarrow does the conversions; it is needed here alone.
"""

import dataclasses

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

import fmc_camera

__all__ = ["Counts", "correct", "distort"]

# Flags of the answers.
_OFF_SENSOR, _NO_FRAME, _REFUSED = 1, 2, 3

_WORDS = {
    _OFF_SENSOR: "off the sensor",
    _NO_FRAME: "of frames without a record",
    _REFUSED: "of refused triggers",
}


@dataclasses.dataclass
class Counts:
    """Numbers of points, added up over the calls to which they are given."""

    points: int = 0
    off_sensor: int = 0
    without_frame: int = 0
    refused: int = 0


def correct(batch, frames, *, answer="ideal", missing="error", counts=None):
    """Return a batch of measured points with their ideal points in place of x and y.

    A point that has no answer (off the sensor, of a frame without a record, of a refused trigger)
    is an error before anything is returned, or null in x and y with `missing="null"`; `counts`
    says how many there were. A null stays null, a NaN stays NaN.
    """
    return _answered(batch, frames, answer, missing, counts, is_distorted=False)


def distort(batch, frames, *, answer="ideal", missing="error", counts=None):
    """Return a batch of points that `correct` has answered with, with their measured points."""
    return _answered(batch, frames, answer, missing, counts, is_distorted=True)


def _answered(batch, frames, answer, missing, counts, *, is_distorted):
    if missing not in ("error", "null"):
        raise fmc_camera.Error(f"missing = {missing!r}: must be 'error' or 'null'")
    if isinstance(batch, pa.RecordBatch):
        return _of_batch(batch, frames, answer, missing, counts, is_distorted)
    if not isinstance(batch, pa.Table) and hasattr(batch, "__arrow_c_array__"):
        return _of_batch(
            pa.record_batch(batch), frames, answer, missing, counts, is_distorted
        )
    if not hasattr(batch, "__arrow_c_stream__"):
        raise fmc_camera.Error(
            f"a batch of the type {type(batch)}: must be a table of Arrow, with the methods of its "
            "PyCapsule interface"
        )
    table = pa.table(batch)
    parts = [
        _of_batch(part, frames, answer, missing, counts, is_distorted)
        for part in table.to_batches() or [_empty(table.schema)]
    ]
    answers = pa.Table.from_batches(parts)
    if type(batch).__module__.split(".")[0] == "polars":
        import polars

        return polars.from_arrow(answers)
    return answers


def _empty(schema):
    return pa.RecordBatch.from_pylist([], schema=schema)


def _of_batch(batch, frames, answer, missing, counts, is_distorted):
    columns = {name: _column(batch, name) for name in ("frame", "x", "y")}
    kind = columns["x"].type
    if kind not in (pa.float32(), pa.float64()) or columns["y"].type != kind:
        raise fmc_camera.Error(
            f"columns x and y of the types {kind} and {columns['y'].type}: both must be float, or "
            "both double"
        )
    places, is_null = _places(columns["frame"], frames)
    coordinates = []
    for name in ("x", "y"):
        numbers, is_missing = _numbers(columns[name])
        coordinates.append(numbers)
        is_null = _either(is_null, is_missing)
    x, y, flags = frames._columns(*coordinates, places, answer, is_distorted)
    if is_null is not None:
        flags[is_null] = 0
    has_lack = flags.any()
    if counts is not None:
        _add(counts, flags)
    if has_lack and missing == "error":
        _refuse(flags, columns["frame"], coordinates)
    mask = _either(is_null, flags != 0 if has_lack else None)
    for name, numbers in (("x", x), ("y", y)):
        place = batch.schema.get_field_index(name)
        field = batch.schema.field(place)
        if mask is not None:
            field = field.with_nullable(True)
        batch = batch.set_column(place, field, pa.array(numbers, type=kind, mask=mask))
    return batch


def _column(batch, name):
    places = batch.schema.get_all_field_indices(name)
    if len(places) != 1:
        fault = "is missing" if not places else "appears twice"
        names = ", ".join(batch.schema.names)
        raise fmc_camera.Error(f"column {name} {fault}; found {names}")
    return batch.column(places[0])


def _numbers(column):
    """Return the numbers of a column, NaN for null, and where it is null."""
    if column.null_count == 0:
        return column.to_numpy(zero_copy_only=True), None
    is_null = column.is_null().to_numpy(zero_copy_only=False)
    return column.fill_null(float("nan")).to_numpy(zero_copy_only=False), is_null


def _places(column, frames):
    """Return the places of the frames that a column names, and where it is null."""
    is_null = None
    if column.null_count:
        is_null = column.is_null().to_numpy(zero_copy_only=False)
    kind = column.type
    if pa.types.is_integer(kind):
        return frames._places(_filled(column).to_numpy(zero_copy_only=True)), is_null
    if pa.types.is_null(kind):
        return np.full(len(column), -1), is_null
    if not pa.types.is_dictionary(kind):
        if not _is_text(kind):
            raise fmc_camera.Error(
                f"column frame of the type {kind}: must be whole numbers, or names of images"
            )
        column = pc.dictionary_encode(column.cast(pa.large_string()))
    values = column.dictionary
    if _is_text(values.type):
        # A null among the values is a name that no image has.
        names = [name or "" for name in values.to_pylist()]
        places = frames._places(names) if names else np.empty(0, np.int64)
    elif pa.types.is_integer(values.type):
        places = frames._places(_filled(values).to_numpy(zero_copy_only=False))
    else:
        raise fmc_camera.Error(
            f"column frame of the type {kind}: must be whole numbers, or names of images"
        )
    indices = _filled(column.indices)
    if len(places) == 0:
        return np.full(len(column), -1), is_null
    return places[indices.to_numpy(zero_copy_only=False)], is_null


def _filled(numbers):
    """Return whole numbers with 0 for null; what it stands for is masked."""
    return numbers.fill_null(0) if numbers.null_count else numbers


def _is_text(kind):
    is_view = getattr(pa.types, "is_string_view", lambda _: False)
    return pa.types.is_string(kind) or pa.types.is_large_string(kind) or is_view(kind)


def _either(one, other):
    if one is None or other is None:
        return other if one is None else one
    return one | other


def _add(counts, flags):
    _, off_sensor, without_frame, refused = np.bincount(flags, minlength=4)
    counts.points += len(flags)
    counts.off_sensor += int(off_sensor)
    counts.without_frame += int(without_frame)
    counts.refused += int(refused)


def _refuse(flags, column, coordinates):
    row = int(np.flatnonzero(flags)[0])
    flag = int(flags[row])
    count = int((flags != 0).sum())
    frame = str(column[row].as_py())
    text = (
        f"row {row}: frame {frame}: a point {_WORDS[flag]}; {count} of {len(flags)} points have no "
        'answer (missing="null" leaves them empty)'
    )
    if flag == _OFF_SENSOR:
        error = fmc_camera.PointOffSensor(text)
        error.index = row
        error.x_mm, error.y_mm = (float(numbers[row]) for numbers in coordinates)
    else:
        error = fmc_camera.NoFrame(text)
    error.frame = frame
    error.points = count
    raise error
