"""Points against the strict solver."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from test_points import grid

import fmc_camera

# Largest error of a coordinate per axis, mm, of a 50 mm lens. In exposures longer than 1/100 s single
# precision leaves out larger terms, of which the frame states a bound.
SINGLE_MM, DOUBLE_MM, LONGEST_S = 2.5e-6, 0.2e-6, 1 / 100

FIFTY = ["phase-one-ixm-rs150f-50", "phase-one-ixu-rs1000-50"]


@pytest.mark.parametrize("name", FIFTY)
@pytest.mark.parametrize("strategy", ["centred", "from-rest"])
def test_coordinates_are_those_of_the_strict_solver(root, name, strategy):
    text = (root / f"host-sim/cameras/{name}.toml").read_text()
    camera = fmc_camera.Camera.from_text(text + f'\n[fmc]\nstrategy = "{strategy}"\n')
    for vh, exposure in [(0.05, 0.001), (0.17, 1 / 200), (0.17, 1 / 100), (0.17, 1 / 50)]:
        for options in [{}, {"direction": "reverse", "focus_shift_um": 8.0}]:
            frame = camera.frame(vh, exposure, **options)
            left_out_mm = 1e-6 * frame.left_out_nm if exposure > LONGEST_S else 0.0
            for dtype, most in [(np.float32, SINGLE_MM + left_out_mm), (np.float64, DOUBLE_MM)]:
                points = grid(camera, 13, dtype)
                truth = camera.reference(points.astype(np.float64), frame)
                assert np.abs(frame.correct(points) - truth).max() <= most
                if dtype is np.float64:
                    # Measured - ideal is that at the measured point on both ways.
                    again = frame.distort(truth)
                    assert np.nanmax(np.abs(again - points)) <= 2 * most
                    assert np.isnan(again).mean() < 0.2


def test_frames_of_a_flight_have_the_double_precision_of_single_ones(ixm):
    table = {"sequence": [1, 2], "vh_per_s": [0.17, 0.1], "exposure_s": [1 / 50, 1 / 60]}
    frames, points = ixm.frames(table), grid(ixm, 13)
    for place in range(2):
        frame = ixm.frame(table["vh_per_s"][place], table["exposure_s"][place])
        found = frames.correct(points, np.full(len(points), place))
        assert_array_equal(found, frame.correct(points))
        alone = [frames.correct(point[None], [place]) for point in points]
        assert_array_equal(np.concatenate(alone), found)


@pytest.mark.parametrize("model", ["exact", "static"])
def test_reference_is_that_of_host_sim(ixm, root, host_sim, tmp_path, model):
    points = grid(ixm, 5)
    np.save(tmp_path / "points.npy", points)
    host_sim(
        "reference", "--camera", root / "host-sim/cameras/phase-one-ixm-rs150f-50.toml", "--vh",
        "0.17", "--exposure", "1/200", "--focus-shift-um", "3" if model == "exact" else "0",
        "--model", model, tmp_path / "points.npy", "--out", tmp_path / "truth.npy",
    )  # fmt: skip
    frame = ixm.frame(0.17, 1 / 200, focus_shift_um=3 if model == "exact" else 0, model=model)
    assert_array_equal(ixm.reference(points, frame), np.load(tmp_path / "truth.npy")[:, :2])


def test_frame_of_another_camera_is_refused(ixm):
    other = fmc_camera.Camera.from_text(
        'name = "x"\nprincipal_distance_mm = 50\n[sensor]\nwidth_px = 9\nheight_px = 9\npixel_um = 9'
    )
    with pytest.raises(fmc_camera.Error, match="frame: of another camera"):
        other.reference(np.zeros((1, 2)), ixm.frame(0.1, 0.004))


def test_mesh_has_the_sources_of_distort_px(camera):
    limits = camera.keys()["limits"]
    frame = camera.frame(limits["vh_per_s"][0], limits["exposure_s"][0])
    spacing = 257
    mesh = frame.mesh(spacing)
    columns, rows = camera.size_px
    assert mesh.shape == (-(-(rows - 1) // spacing) + 1, -(-(columns - 1) // spacing) + 1, 2)
    row, column = np.mgrid[: mesh.shape[0], : mesh.shape[1]] * float(spacing)
    vertices = np.stack([column, row], axis=-1).reshape(-1, 2)
    found = frame.distort_px(vertices)
    on = ~np.isnan(found).any(axis=1)
    assert on.sum() > 0.8 * len(vertices)
    assert np.abs(found - mesh.reshape(-1, 2))[on].max() < 5e-6 * 1000 / camera.pixel_um
    with pytest.raises(fmc_camera.OutOfRange, match="spacing = 0 is outside 1 to 65535"):
        frame.mesh(0)
