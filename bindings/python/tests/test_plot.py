"""Figures."""

import pickle
import re
import xml.etree.ElementTree as ElementTree

import gridded
import numpy as np
import pytest
from test_camera import BARE

import fmc_camera

ARROW = 'stroke="#005AA0"'


def exposure(camera):
    limits = camera.keys()["limits"]
    return camera.frame(limits["vh_per_s"][1], limits["exposure_s"][0])


def test_figure_of_the_lens_has_an_arrow_or_a_dot_for_each_point(camera):
    svg = camera.plot().svg
    ElementTree.fromstring(svg)
    assert "Static distortion, measured − ideal" in svg and camera.name in svg
    assert "NaN" not in svg and "inf" not in svg
    # One arrow is the legend's.
    drawn = svg.count(ARROW) + svg.count("<circle")
    assert drawn == 21 * 21 + (ARROW in svg)


def test_figure_of_a_frame_shows_what_its_exposure_changes(camera):
    frame = exposure(camera)
    svg = camera.plot(frame).svg
    assert "Dynamic change: strict exposure mean − static" in svg
    assert f"V/H {frame.vh_per_s:.4f}".rstrip("0") in svg
    given = camera.frame(frame.vh_per_s, frame.exposure_s, opening_offset_mm=0.0125)
    assert "opening offset 12.5 µm" in camera.plot(given).svg and "run-up" not in camera.plot(given).svg
    still = camera.frame(frame.vh_per_s, frame.exposure_s, model="static")
    assert "zero at every point" in camera.plot(still).svg


def test_longest_arrow_is_the_largest_distortion(ixm):
    svg = ixm.plot().svg
    (exaggeration,) = re.findall(r"arrows drawn ([0-9,.]+) times their length", svg)
    half = np.array(ixm.size_px) * ixm.pixel_um / 2000
    points = np.stack(np.meshgrid(*[np.linspace(-one, one, 21) for one in half]), -1)
    points = points.reshape(-1, 2)
    still = ixm.frame(0.05, 1 / 500, model="static")
    largest_mm = np.hypot(*(points - still.correct(points)).T).max()
    spacing_mm = np.sqrt(np.prod(2 * half)) / 20
    drawn_mm = float(exaggeration.replace(",", "")) * largest_mm
    # The longest arrow is 0.9 spacings long, by an exaggeration of two digits.
    assert 0.8 * spacing_mm < drawn_mm <= 0.9 * spacing_mm


def test_camera_without_distortion_and_one_with_grids_have_figures(tmp_path):
    bare = fmc_camera.Camera.from_text(BARE)
    assert "zero at every point" in bare.plot().svg
    grids = fmc_camera.Camera.from_toml(gridded.write(tmp_path))
    lines = gridded.CAMERA.split("[fmc]")
    polynomial = fmc_camera.Camera.from_text("[fmc]".join(lines))
    assert grids.plot().svg != polynomial.plot().svg
    assert "NaN" not in grids.plot(exposure(grids)).svg


def test_notebook_shows_the_figure_as_wide_as_the_page(ixm):
    figure = ixm.plot()
    assert figure._repr_svg_() == figure.svg
    html = figure._repr_html_()
    root = ElementTree.fromstring(html)
    assert root.get("viewBox").startswith("0 0 1200 ") and root.get("width") is None
    style = root.get("style")
    assert "width:100%" in style and "--width:1200" in style


def test_figure_is_the_same_in_another_process_and_in_a_file(ixm, tmp_path):
    figure = ixm.budget().plot()
    assert pickle.loads(pickle.dumps(figure)).svg == figure.svg
    path = tmp_path / "figure.svg"
    figure.save(path)
    assert path.read_text(encoding="utf-8") == figure.svg
    assert [one.name for one in tmp_path.iterdir()] == ["figure.svg"]
    with pytest.raises(FileNotFoundError, match="nowhere"):
        figure.save(tmp_path / "nowhere" / "figure.svg")
    with pytest.raises(IsADirectoryError, match=str(tmp_path)):
        figure.save(tmp_path)


def test_frame_of_another_camera_and_what_is_no_frame_are_refused(ixm):
    other = fmc_camera.Camera.from_text(BARE)
    with pytest.raises(fmc_camera.Error, match="frame: of another camera"):
        ixm.plot(exposure(other))
    with pytest.raises(TypeError):
        ixm.plot("frame")
