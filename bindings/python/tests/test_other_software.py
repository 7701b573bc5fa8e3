"""Exports, read by the programs for which they are."""

import cv2
import numpy as np
import pycolmap
import pytest
from test_points import grid

import fmc_camera


def rays(camera, points):
    """Ideal rays (x/z, y/z) of measured points, y down as images have it."""
    frame = camera.frame(
        camera.keys()["limits"]["vh_per_s"][0],
        camera.keys()["limits"]["exposure_s"][0],
        model="static",
    )
    ideal = frame.correct(points) - camera.principal_point_mm
    return ideal / camera.principal_distance_mm * [1, -1]


def pixels(camera, points):
    columns, rows = camera.size_px
    pitch = camera.pixel_um / 1000
    return np.stack(
        [points[:, 0] / pitch + (columns - 1) / 2, (rows - 1) / 2 - points[:, 1] / pitch], axis=1
    )


def test_opencv_projects_to_the_measured_points(camera, tmp_path):
    stated = camera.export("opencv", tmp_path)
    (name,) = stated["files"]
    storage = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_READ)
    matrix = storage.getNode("camera_matrix").mat()
    coefficients = storage.getNode("distortion_coefficients").mat()
    points = grid(camera, 15) * 0.98
    spatial = np.column_stack([rays(camera, points), np.ones(len(points))])
    found, _ = cv2.projectPoints(spatial, np.zeros(3), np.zeros(3), matrix, coefficients)
    error = np.abs(found[:, 0] - pixels(camera, points)).max()
    assert error <= stated["residual_max_px"] + 1e-3


def test_colmap_projects_to_the_measured_points(camera, tmp_path):
    stated = camera.export("colmap", tmp_path)
    assert set(stated["files"]) >= {"cameras.txt"}
    (line,) = [
        line for line in (tmp_path / "cameras.txt").read_text().splitlines() if line[0] != "#"
    ]
    _, model, width, height, *numbers = line.split()
    theirs = pycolmap.Camera(
        model=model, width=int(width), height=int(height), params=[float(one) for one in numbers]
    )
    points = grid(camera, 15) * 0.98
    spatial = np.column_stack([rays(camera, points), np.ones(len(points))])
    found = np.array([theirs.img_from_cam(one) for one in spatial])
    # COLMAP counts from the corner of the first pixel.
    error = np.abs(found - 0.5 - pixels(camera, points)).max()
    assert error <= stated["residual_max_px"] + 1e-3


def test_statement_has_the_numbers_of_host_sim(ixm, root, host_sim, tmp_path):
    import json

    path = root / "host-sim/cameras/phase-one-ixm-rs150f-50.toml"
    host_sim("export", "metashape", "--camera", path, "--out", tmp_path / "theirs")
    theirs = json.loads((tmp_path / "theirs/export.json").read_text())
    ours = ixm.export("metashape", tmp_path / "ours")
    for key, value in ours.items():
        assert value == theirs[key], key
    for name in ours["files"]:
        files = [(tmp_path / one / name).read_bytes() for one in ("ours", "theirs")]
        assert files[0] == files[1]


def test_programs_and_models_that_are_not_known(ixm, tmp_path):
    with pytest.raises(fmc_camera.Error, match="program = 'inpho': must be one of opencv, ros"):
        ixm.export("inpho", tmp_path / "out")
    with pytest.raises(fmc_camera.InvalidFile, match="colmap has no such model"):
        ixm.export("colmap", tmp_path / "out", model="FISHEYE")
    assert not (tmp_path / "out").exists()
