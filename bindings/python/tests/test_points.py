"""Correction and distortion of the points of one frame."""

import math

import numpy as np
import pytest
from conftest import IXM
from numpy.testing import assert_array_equal

import fmc_camera


def grid(camera, rows=41, dtype=np.float64):
    """Points over the whole sensor, mm."""
    columns, lines = camera.size_px
    half = np.array([columns, lines]) * camera.pixel_um / 2000.0
    x, y = np.meshgrid(np.linspace(-half[0], half[0], rows), np.linspace(-half[1], half[1], rows))
    return np.stack([x.ravel(), y.ravel()], axis=1).astype(dtype)


def bits(array):
    return np.ascontiguousarray(array).view(np.uint8)


def test_answer_of_the_readme(ixm):
    """The table of README.md, whose points host-sim corrects."""
    frame = ixm.frame(0.17, 1 / 200, opening_offset_mm=0.2)
    points = np.loadtxt(
        IXM.parents[2] / "examples/data/points.csv", delimiter=",", skiprows=1, usecols=(1, 2)
    )
    ideal = frame.correct(points.astype(np.float32))
    expected = [
        [-0.000000246, -0.000000730],
        [20.151123047, 15.110325813],
        [20.158834457, -15.124866486],
        [26.213899612, -0.004679148],
    ]
    # The table has nine decimals.
    assert np.abs(ideal - np.array(expected)).max() < 1e-9
    assert np.abs(frame.correct(points) - expected).max() < 4e-6


def test_single_precision_has_the_bits_of_host_sim(camera, request, host_sim, tmp_path):
    points = grid(camera, 21, np.float32)
    np.save(tmp_path / "points.npy", points)
    name = request.node.callspec.params["camera"]
    vh = sum(camera.keys()["limits"]["vh_per_s"]) / 4
    exposure = camera.keys()["limits"]["exposure_s"][0] * 1.5
    options = ["--camera", name, "--vh", repr(vh), "--exposure", repr(exposure)]
    for command in ["correct", "distort"]:
        out = tmp_path / f"{command}.npy"
        # A point of the edge may be off the sensor by rounding.
        inner = np.float32(0.99 if command == "correct" else 0.95) * points
        np.save(tmp_path / "points.npy", inner)
        host_sim(command, *options, tmp_path / "points.npy", "--out", out)
        frame = camera.frame(vh, exposure)
        found = getattr(frame, command)(inner)
        assert_array_equal(bits(found), bits(np.load(out)[:, :2]))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_out_and_inplace_have_the_same_bits(ixm, dtype):
    frame = ixm.frame(0.17, 1 / 200, focus_shift_um=8)
    points = grid(ixm, 77, dtype)
    for method in [frame.correct, frame.distort, frame.correct_px, frame.distort_px]:
        answers = method(points)
        assert answers.dtype == dtype and answers.shape == points.shape
        out = np.full_like(points, 7)
        assert method(points, out=out) is out
        assert_array_equal(bits(out), bits(answers))
        replaced = points.copy()
        assert method(replaced, inplace=True) is replaced
        assert_array_equal(bits(replaced), bits(answers))


def test_double_precision_keeps_the_digits_of_its_coordinates(ixm):
    """The distortion is that of the point in single precision; the coordinate is not rounded."""
    frame = ixm.frame(0.17, 1 / 200)
    points = grid(ixm)
    ideal = frame.correct(points)
    singles = points.astype(np.float32)
    distortion = singles.astype(np.float64) - frame.correct(singles)
    # Half a unit in the last place of 26 mm, twice.
    assert np.abs((points - ideal) - distortion).max() < 2.0 * 2.0**-20
    # A step of a tenth of that unit moves the ideal point, too, but for the slope of the distortion,
    # at most 3 %, times the unit by which the point in single precision may step.
    moved = frame.correct(points + 1e-7)
    assert np.abs(moved - ideal - 1e-7).max() < 0.03 * 2.0**-19


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_distort_is_the_inverse(camera, dtype):
    limits = camera.keys()["limits"]
    frame = camera.frame(limits["vh_per_s"][0], limits["exposure_s"][0])
    points = grid(camera, 33, dtype) * dtype(0.99)
    again = frame.distort(frame.correct(points))
    unit = np.spacing(np.float32(np.abs(points).max()))
    assert np.abs(again - points).max() <= 3 * unit


def test_pixels_are_those_of_the_sensor_frame(ixm):
    frame = ixm.frame(0.17, 1 / 200)
    columns, rows = ixm.size_px
    pixels = np.array([[0.0, 0.0], [columns - 1.0, rows - 1.0], [1234.5, 9876.25]])
    pitch = ixm.pixel_um / 1000

    def to_mm(px):
        return np.stack(
            [(px[:, 0] - (columns - 1) / 2) * pitch, ((rows - 1) / 2 - px[:, 1]) * pitch], axis=1
        )

    assert np.abs(to_mm(frame.correct_px(pixels)) - frame.correct(to_mm(pixels))).max() < 1e-10
    back = frame.distort_px(frame.correct_px(pixels))
    assert np.nanmax(np.abs(back - pixels)) < 1e-4


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_nan_in_is_nan_out_and_touches_no_other_point(ixm, dtype):
    frame = ixm.frame(0.17, 1 / 200)
    points = grid(ixm, 30, dtype) * dtype(0.9)
    clean = {name: getattr(frame, name)(points) for name in ["correct", "distort"]}
    for where in [(0, 0), (17, 1), (899, 0), (512, 1)]:
        points[where] = math.nan
    is_nan = np.isnan(points).any(axis=1)
    assert is_nan.sum() == 4
    for name, expected in clean.items():
        for off_sensor in ["extrapolate", "nan", "error"]:
            found = getattr(frame, name)(points, off_sensor=off_sensor)
            assert np.isnan(found[is_nan]).all()
            assert_array_equal(bits(found[~is_nan]), bits(expected[~is_nan]))


def test_points_off_the_sensor(ixm):
    frame = ixm.frame(0.17, 1 / 200)
    points = np.array([[0.0, 0.0], [40.0, 0.0], [1.0, 2.0]])
    assert np.isfinite(frame.correct(points)).all()
    marked = frame.correct(points, off_sensor="nan")
    assert np.isnan(marked).all(axis=1).tolist() == [False, True, False]
    before = points.copy()
    with pytest.raises(fmc_camera.PointOffSensor, match=r"points\[1\] = \(40, 0\) mm") as caught:
        frame.correct(points, inplace=True, off_sensor="error")
    assert (caught.value.index, caught.value.x_mm, caught.value.y_mm) == (1, 40.0, 0.0)
    assert_array_equal(points, before)
    assert np.isnan(frame.distort(points)).all(axis=1).tolist() == [False, True, False]
    with pytest.raises(fmc_camera.PointOffSensor, match="no measured point"):
        frame.distort(points, off_sensor="error")
    with pytest.raises(fmc_camera.Error, match="off_sensor = 'x': must be 'extrapolate'"):
        frame.correct(points, off_sensor="x")


def test_no_points(ixm):
    frame = ixm.frame(0.17, 1 / 200)
    for dtype in [np.float32, np.float64]:
        none = np.empty((0, 2), dtype)
        for method in [frame.correct, frame.distort, frame.correct_px]:
            assert method(none).shape == (0, 2)
            assert method(none, inplace=True) is none


def test_lists_of_numbers_are_points(ixm):
    frame = ixm.frame(0.17, 1 / 200)
    found = frame.correct([[1.0, 2.0], [3.0, 4.0]])
    assert_array_equal(found, frame.correct(np.array([[1.0, 2.0], [3.0, 4.0]])))


def test_frame_states_its_interior_orientation(ixm):
    frame = ixm.frame(0.17, 1 / 200, opening_offset_mm=0.2, direction="reverse")
    assert frame.travel_mm == pytest.approx(-0.17 / 200 * 51.3712, rel=1e-6)
    assert frame.opening_offset_mm == pytest.approx(0.2)
    x, y = frame.principal_point_mm
    assert x == pytest.approx(0.0584) and y == pytest.approx(-0.0239 + frame.centroid_offset_mm)
    assert frame.principal_distance_mm == pytest.approx(51.3712)
    assert frame.centroid_time_s == pytest.approx(1 / 400)
    assert 0 < frame.left_out_nm < 0.5 and frame.model == "exact"
    assert "Phase One" in repr(frame)
