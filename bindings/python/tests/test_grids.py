"""Cameras with residual grids."""

import pickle

import gridded
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import fmc_camera


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return gridded.write(tmp_path_factory.mktemp("grids"))


def points(dtype=np.float32):
    return np.random.default_rng(5).uniform([-6, -4.4], [6, 4.4], (2000, 2)).astype(dtype)


def test_grids_move_points_with_the_bits_of_host_sim(path, host_sim, tmp_path):
    camera = fmc_camera.Camera.from_toml(path)
    assert repr(camera).endswith("residual grids>")
    plain = fmc_camera.Camera.from_text(gridded.CAMERA)
    np.save(tmp_path / "points.npy", points() * np.float32(0.97))
    given = np.load(tmp_path / "points.npy")
    options = ["--camera", path, "--vh", "0.17", "--exposure", "1/100"]
    for command in ["correct", "distort"]:
        out = tmp_path / f"{command}.npy"
        host_sim(command, *options, tmp_path / "points.npy", "--out", out)
        found, without = (
            getattr(one.frame(0.17, 1 / 100), command)(given) for one in (camera, plain)
        )
        assert_array_equal(found.view(np.uint32), np.load(out)[:, :2].view(np.uint32))
        # Waves of 2 µm of both.
        assert 1e-3 < np.abs(found - without).max() < 9e-3


def test_double_precision_and_the_way_back(path):
    frame = fmc_camera.Camera.from_toml(path).frame(0.17, 1 / 100)
    doubles, singles = points(np.float64), points()
    assert np.abs(frame.correct(doubles) - frame.correct(singles)).max() < 1e-6
    inner = 0.9 * doubles
    assert np.abs(frame.distort(frame.correct(inner)) - inner).max() < 2e-6


def test_grids_go_to_other_processes(path):
    camera = fmc_camera.Camera.from_toml(path)
    again = pickle.loads(pickle.dumps(camera))
    given = points()
    found, other = (one.frame(0.17, 1 / 100).correct(given) for one in (camera, again))
    assert_array_equal(found, other)


def test_changed_grid_is_refused(path, tmp_path):
    for name in ["camera.toml", "lens.fmcg", "sensor.fmcg"]:
        (tmp_path / name).write_bytes((path.parent / name).read_bytes())
    data = bytearray((tmp_path / "lens.fmcg").read_bytes())
    data[100] ^= 1
    (tmp_path / "lens.fmcg").write_bytes(data)
    with pytest.raises(fmc_camera.InvalidFile, match="camera.toml.*lens"):
        fmc_camera.Camera.from_toml(tmp_path / "camera.toml")
    (tmp_path / "lens.fmcg").unlink()
    with pytest.raises(fmc_camera.InvalidFile, match="lens.fmcg: cannot be read"):
        fmc_camera.Camera.from_toml(tmp_path / "camera.toml")
