"""Budgets, against those of host-sim."""

import json
import pickle

import gridded
import pandas
import pytest
from conftest import CAMERAS, IXM
from test_camera import BARE

import fmc_camera

STATED = {
    "height_m": 441.0,
    "focus_um": 3.0,
    "vh_error_percent": 2.0,
    "relief_percent": 20.0,
    "drift_deg": 0.5,
    "rate_deg_s": 2.0,
    "encoder_um": 0.5,
    "timing_ms": 0.2,
}


def options(stated):
    for name, value in stated.items():
        yield "--" + name.replace("_", "-")
        yield value


@pytest.mark.parametrize("path", CAMERAS, ids=lambda path: path.stem)
def test_numbers_and_table_are_those_of_host_sim(path, host_sim, tmp_path):
    camera = fmc_camera.Camera.from_toml(path)
    for stated in [{}, STATED]:
        table = host_sim("budget", "--camera", path, *options(stated), "--out", tmp_path)
        summary = json.loads((tmp_path / "summary.json").read_text())
        budget = camera.budget(**stated)
        assert budget.terms == summary["terms"] and len(budget.terms) > 5
        assert (budget.camera, budget.height_m) == (summary["camera"], summary["height_m"])
        assert repr(budget) == table.rstrip()
        assert budget.plot().svg == (tmp_path / "budget.svg").read_text()


def test_terms_are_rows_of_a_table_the_largest_first(ixm):
    table = pandas.DataFrame(ixm.budget().terms)
    assert table["limits_um"].is_monotonic_decreasing and table["limits_um"].iloc[0] > 0
    pixels = table["limits_um"] / ixm.pixel_um
    assert (table["limits_px"] - pixels).abs().max() < 1e-9
    ground_cm = table["limits_um"] * 1e-4 * 1000 / (ixm.principal_distance_mm / 1000)
    assert (table["limits_ground_cm"] - ground_cm).abs().max() < 1e-9


def test_notebook_shows_a_table_with_escaped_text():
    html = fmc_camera.Camera.from_text(BARE.replace("bare", "<b>&")).budget()._repr_html_()
    assert html.count("<tr>") == 1 + html.count("<tr><td>") > 10
    assert html.startswith("<table>") and "<b>" not in html


def test_budget_is_the_same_in_another_process(ixm):
    budget = ixm.budget(**STATED)
    again = pickle.loads(pickle.dumps(budget))
    assert again.terms == budget.terms and again.height_m == 441.0


@pytest.mark.parametrize("name", STATED)
@pytest.mark.parametrize("value", [-1.0, 1e9, float("nan"), float("inf")])
def test_assumption_outside_its_range_is_an_error_with_its_numbers(ixm, name, value):
    with pytest.raises(fmc_camera.OutOfRange, match=f"{name} = ") as caught:
        ixm.budget(**{name: value})
    error = caught.value
    assert error.quantity == name
    assert not error.least <= error.value <= error.most


def test_words_and_places_are_refused(ixm):
    with pytest.raises(TypeError):
        ixm.budget("high")
    with pytest.raises(TypeError):
        ixm.budget(height_m="high")


def test_camera_with_residual_grids_or_without_an_exposure_has_no_budget(tmp_path):
    camera = fmc_camera.Camera.from_toml(gridded.write(tmp_path))
    with pytest.raises(fmc_camera.InvalidFile, match="residual grids are not used here"):
        camera.budget()
    short = BARE + "[fmc]\nstroke_mm = 0.05\n[limits]\nvh_per_s = [0.2, 0.2]\n"
    short = fmc_camera.Camera.from_text(short + "exposure_s = [0.01, 0.01]\n")
    with pytest.raises(fmc_camera.Error, match="none of the exposures"):
        short.budget()
    assert fmc_camera.Camera.from_toml(IXM).budget().terms
