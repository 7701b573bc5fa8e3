"""Cameras of files, and what they refuse."""

import pickle
import tomllib

import pytest
from conftest import CAMERAS, IXM

import fmc_camera

BARE = """name = "bare"
principal_distance_mm = 100.0
[sensor]
width_px = 9216
height_px = 6144
pixel_um = 8.75
"""


@pytest.mark.parametrize("path", CAMERAS, ids=lambda path: path.stem)
def test_every_key_of_the_file_has_its_value(path):
    keys = fmc_camera.Camera.from_toml(path).keys()
    written = tomllib.loads(path.read_text())
    sign = -1.0 if written.get("distortion", {}).get("sign") == "correction" else 1.0
    for key, value in written.items():
        if not isinstance(value, dict):
            assert keys[key] == value
            continue
        for inner, number in value.items():
            if key == "distortion":
                number = "distortion" if inner == "sign" else sign * number
            assert keys[key][inner] == number


def test_notebook_shows_a_table_with_escaped_text():
    camera = fmc_camera.Camera.from_text(BARE.replace("bare", "<b>&"))
    html = camera._repr_html_()
    assert "<td>&lt;b&gt;&amp;</td>" in html and "<b>" not in html
    assert "<td>principal_distance_mm</td><td>100</td>" in html
    assert repr(camera).startswith('<fmc_camera.Camera "<b>&": f 100 mm, 9216 x 6144 px of 8.75')


def test_number_outside_its_range_is_an_error_with_its_numbers(tmp_path):
    path = tmp_path / "camera.toml"
    path.write_text(BARE.replace("100.0", "-1.0"))
    with pytest.raises(fmc_camera.OutOfRange, match="line 2: principal_distance_mm") as caught:
        fmc_camera.Camera.from_toml(path)
    error = caught.value
    assert (error.quantity, error.value) == ("principal_distance_mm", -1.0)
    assert (error.least, error.most) == (5.0, 5000.0)
    assert isinstance(error, ValueError) and isinstance(error, fmc_camera.Error)


def test_distortion_that_folds_is_an_error_with_its_place():
    text = BARE + "[distortion]\nk1 = 1e-3\n"
    with pytest.raises(fmc_camera.Folds, match="folds the image") as caught:
        fmc_camera.Camera.from_text(text)
    assert caught.value.polynomial == "static" and caught.value.scale < 0.5
    assert abs(caught.value.x_mm) <= 50 and abs(caught.value.y_mm) <= 50


def test_distortion_that_is_hardly_believable_is_warned_of(tmp_path):
    path = tmp_path / "camera.toml"
    path.write_text(BARE + "[distortion]\nk1 = 4.5e-5\n")
    with pytest.warns(UserWarning, match="camera.toml: "):
        fmc_camera.Camera.from_toml(path)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("name = [", "camera.toml, line 1"),
        (BARE + "[lens]\nx = 1\n", "lens"),
        (BARE.replace("name", "title"), "title"),
        (BARE + '[grid]\nlens = "a.fmcg"\nlens_crc32 = "00000000"\n', "not among the grids"),
    ],
)
def test_other_faults_of_a_file_are_named(text, sentence):
    with pytest.raises(fmc_camera.InvalidFile, match=sentence):
        fmc_camera.Camera.from_text(text)


def test_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(fmc_camera.InvalidFile, match="nowhere.toml: cannot be read"):
        fmc_camera.Camera.from_toml(tmp_path / "nowhere.toml")


def test_exposures_that_the_camera_refuses(ixm):
    with pytest.raises(fmc_camera.OutOfRange) as caught:
        ixm.frame(0.5, 1 / 200)
    assert (caught.value.quantity, caught.value.most) == ("vh_per_s", pytest.approx(0.3))
    with pytest.raises(fmc_camera.OutOfRange, match="exposure_s"):
        ixm.frame(0.1, 1.0)
    with pytest.raises(fmc_camera.OutOfRange, match="focus_shift_um"):
        ixm.frame(0.1, 0.004, focus_shift_um=1e4)
    with pytest.raises(fmc_camera.NotFitted, match="five-coefficient"):
        ixm.frame(0.1, 0.004, model="fitted")
    with pytest.raises(fmc_camera.Error, match="direction = 'up': must be 'forward' or 'reverse'"):
        ixm.frame(0.1, 0.004, direction="up")
    short = fmc_camera.Camera.from_text(BARE + "[fmc]\nstroke_mm = 0.05\n")
    with pytest.raises(fmc_camera.Stroke) as caught:
        short.frame(0.3, 1 / 100)
    assert caught.value.half_stroke_mm == pytest.approx(0.025)
    assert caught.value.from_mm < -0.025 < caught.value.to_mm
    slow = fmc_camera.Camera.from_text(BARE + "[fmc]\nmax_speed_mm_s = 10.0\n")
    with pytest.raises(fmc_camera.Speed) as caught:
        slow.frame(0.3, 1 / 200)
    assert (caught.value.wanted_mm_s, caught.value.max_mm_s) == (pytest.approx(30), 10)


def test_errors_keep_their_numbers_between_processes(ixm):
    with pytest.raises(fmc_camera.OutOfRange) as caught:
        ixm.frame(0.5, 1 / 200)
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is fmc_camera.OutOfRange
    assert (str(again), again.most) == (str(caught.value), caught.value.most)


def test_cameras_and_frames_go_to_other_processes(ixm):
    again = pickle.loads(pickle.dumps(ixm))
    assert again.keys() == ixm.keys()
    frame = ixm.frame(0.17, 1 / 200, focus_shift_um=3, direction="reverse", opening_offset_mm=0.1)
    other = pickle.loads(pickle.dumps(frame))
    points = [[20.0, 10.0], [-3.0, 4.0]]
    assert (frame.correct(points) == other.correct(points)).all()
    assert repr(frame) == repr(other)


def test_crc_is_that_of_the_records(ixm):
    assert len(ixm.calibration_crc32) == 8
    other = fmc_camera.Camera.from_text(IXM.read_text().replace("51.3712", "51.3713"))
    assert other.calibration_crc32 != ixm.calibration_crc32
