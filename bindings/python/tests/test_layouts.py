"""Shapes, strides, types and memory of arrays."""

import gc
import mmap
import resource
import subprocess
import sys
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.testing import assert_array_equal

import fmc_camera
from conftest import IXM

FRAME = fmc_camera.Camera.from_toml(IXM).frame(0.17, 1 / 200)
POINTS = np.random.default_rng(1).uniform(-19, 19, (600, 2))


@pytest.mark.parametrize(
    ("points", "sentence"),
    [
        (np.zeros((4, 3)), r"shape \(4, 3\): must be \(N, 2\)"),
        (np.zeros((2, 5)), r"shape \(2, 5\): must be \(N, 2\)"),
        (np.zeros(2), r"shape \(2\): must be \(N, 2\)"),
        (np.zeros((2, 2, 2)), r"shape \(2, 2, 2\): must be"),
        (np.zeros((3, 2), int), "type int64: must be float32 or float64"),
        (np.zeros((3, 2), np.float16), "type float16: must be"),
        (np.zeros((3, 2), object), "type object: must be"),
        (np.zeros((3, 2), complex), "type complex128: must be"),
        (np.zeros((3, 2), np.longdouble), "type float128|type longdouble"),
        (np.zeros((3, 2), ">f8"), "in this machine's byte order"),
        (np.ma.masked_array(np.zeros((3, 2))), "a masked array"),
        ([[1, 2], [3, 4]], "type int64: must be"),
        ("points", "must be float32 or float64"),
        (None, "must be float32 or float64"),
    ],
)
def test_points_of_another_layout_are_refused(points, sentence):
    for method in [FRAME.correct, FRAME.distort, FRAME.correct_px]:
        with pytest.raises(fmc_camera.Layout, match=sentence) as caught:
            method(points)
        assert caught.value.argument == "points"
        assert isinstance(caught.value, ValueError)


def read_only():
    out = np.empty_like(POINTS)
    out.flags.writeable = False
    return out


@pytest.mark.parametrize(
    ("out", "sentence"),
    [
        (read_only(), "out: read-only"),
        (np.empty((3, 2)), "out: shape"),
        (np.empty((600, 2), np.float32), "out: numbers of the type float32: must be float64"),
        (np.empty((2, 600)).T, "out: not contiguous in C order"),
        (np.empty((1200, 2))[::2], "out: not contiguous in C order"),
        ([1, 2], "out: not an array of NumPy"),
        (POINTS, "out: shares memory with points"),
        (POINTS[:], "out: shares memory with points"),
    ],
)
def test_out_of_another_layout_is_refused(out, sentence):
    before = POINTS.copy()
    with pytest.raises(fmc_camera.Layout, match=sentence) as caught:
        FRAME.correct(POINTS, out=out)
    assert caught.value.argument == "out"
    assert_array_equal(POINTS, before)


def test_out_that_overlaps_points_is_refused():
    memory = np.zeros(24)
    points, out = memory[:20].reshape(10, 2), memory[4:].reshape(10, 2)
    with pytest.raises(fmc_camera.Layout, match="shares memory"):
        FRAME.correct(points, out=out)
    # The same memory by two owners.
    raw = bytearray(160)
    one, other = (np.frombuffer(raw).reshape(10, 2) for _ in range(2))
    with pytest.raises(fmc_camera.Layout, match="shares memory"):
        FRAME.correct(one, out=other)


def test_inplace_needs_an_array_that_can_be_written():
    with pytest.raises(fmc_camera.Layout, match="read-only"):
        FRAME.correct(read_only(), inplace=True)
    with pytest.raises(fmc_camera.Layout, match="not contiguous"):
        FRAME.correct(np.asfortranarray(POINTS), inplace=True)
    with pytest.raises(fmc_camera.Layout, match="not an array of NumPy"):
        FRAME.correct(POINTS.tolist(), inplace=True)
    with pytest.raises(fmc_camera.Layout, match="given with inplace=True"):
        FRAME.correct(POINTS, inplace=True, out=np.empty_like(POINTS))


def test_points_that_are_not_contiguous_are_copied_once_or_refused_with_out():
    expected = FRAME.correct(POINTS)
    fortran = np.asfortranarray(POINTS)
    wide = np.zeros((1200, 4))
    wide[::2, 1::2] = POINTS
    backwards = POINTS[::-1].copy()[::-1]
    for points in [fortran, wide[::2, 1::2], backwards]:
        assert not points.flags.c_contiguous
        assert_array_equal(FRAME.correct(points), expected)
        with pytest.raises(fmc_camera.Layout, match=r"points.copy\(\) copies them"):
            FRAME.correct(points, out=np.empty_like(POINTS))
    unaligned = np.zeros(600 * 16 + 1, np.uint8)[1:].view(np.float64).reshape(600, 2)
    unaligned[:] = POINTS
    assert_array_equal(FRAME.correct(unaligned), expected)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_every_view_has_the_answers_of_its_copy(data):
    dtype = data.draw(st.sampled_from([np.float32, np.float64]))
    numbers = st.floats(-30, 30, width=32) | st.just(float("nan"))
    shape = data.draw(st.tuples(st.integers(0, 70), st.integers(2, 5)))
    base = data.draw(arrays.arrays(dtype, shape, elements=numbers))
    step = data.draw(st.sampled_from([-3, -1, 1, 2]))
    first = data.draw(st.integers(0, shape[1] - 2))
    view = base[::step, first : first + 2]
    order = data.draw(st.sampled_from(["C", "F", "K"]))
    view = view if order == "K" else np.array(view, order=order)
    for method in [FRAME.correct, FRAME.distort]:
        expected = method(np.ascontiguousarray(view))
        found = method(view)
        assert found.dtype == dtype and found.flags.c_contiguous
        assert_array_equal(found, expected)


def test_threads_of_python_run_while_a_call_computes():
    """A thread counts while the other corrects: with the interpreter locked it could not."""
    points = np.zeros((30_000_000, 2), np.float32)
    done, counts = threading.Event(), []

    def correct():
        FRAME.correct(points, inplace=True)
        done.set()

    thread = threading.Thread(target=correct)
    thread.start()
    count = 0
    while not done.is_set():
        count += 1
        counts.append(count)
    thread.join()
    assert count > 1000


def test_threads_have_the_bits_of_one():
    points = np.random.default_rng(2).uniform(-19, 19, (200_000, 2))
    expected = FRAME.correct(points)
    answers = [np.empty_like(points) for _ in range(2)]

    def work(out):
        for _ in range(20):
            FRAME.correct(points, out=out)

    threads = [threading.Thread(target=work, args=(out,)) for out in answers]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for out in answers:
        assert_array_equal(out, expected)


def test_calls_keep_no_memory():
    points = np.random.default_rng(3).uniform(-19, 19, (100_000, 2))
    strided = np.asfortranarray(points)

    def peak():
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    for _ in range(5):
        FRAME.correct(strided)
    before = peak()
    for _ in range(300):
        FRAME.correct(strided)
        with pytest.raises(fmc_camera.Layout):
            FRAME.correct(points[:, :1])
    # 300 answers are 480 MB; a tenth of one call may stay.
    assert peak() - before < 20_000


def zeros(count):
    """Points (0, 0) in single precision without memory, until they are written."""
    flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | getattr(mmap, "MAP_NORESERVE", 0x4000)
    return np.frombuffer(mmap.mmap(-1, 8 * count, flags=flags), np.float32).reshape(-1, 2)


def test_more_points_than_32_bits_count_are_possible():
    points = zeros(2**31 + 2)
    points[-1] = 1e6
    with pytest.raises(fmc_camera.PointOffSensor) as caught:
        FRAME.correct(points, inplace=True, off_sensor="error")
    assert caught.value.index == 2**31 + 1
    assert not points[0].any()


WITHOUT_MEMORY = """
import resource, sys
import numpy as np
import fmc_camera

frame = fmc_camera.Camera.from_toml(sys.argv[1]).frame(0.17, 1 / 200)
points = np.zeros((2**26, 2))
with open("/proc/self/status") as status:
    used = next(int(line.split()[1]) << 10 for line in status if line.startswith("VmSize"))
resource.setrlimit(resource.RLIMIT_AS, (used + 2**29, -1))
for many in [points, points[:, ::-1]]:
    for method in [frame.correct, frame.correct_px]:
        try:
            method(many)
        except MemoryError:
            continue
        sys.exit("no MemoryError")
"""


def test_points_without_memory_for_their_answers_are_an_error_of_python():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_MEMORY, IXM], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_one_point_that_stands_for_many_is_refused_where_it_would_be_copied():
    many = np.broadcast_to(POINTS[0], (2**31, 2))
    for options in [{"inplace": True}, {"out": POINTS}]:
        with pytest.raises(fmc_camera.Layout, match="points: not contiguous in C order"):
            FRAME.correct(many, **options)
