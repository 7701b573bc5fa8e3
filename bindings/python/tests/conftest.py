"""Cameras and flights of the project, for all tests."""

import os
import pathlib
import subprocess

import pytest

import fmc_camera

ROOT = pathlib.Path(__file__).resolve().parents[3]
CAMERAS = sorted((ROOT / "host-sim/cameras").glob("*.toml"))
IXM = ROOT / "host-sim/cameras/phase-one-ixm-rs150f-50.toml"

# The camera of examples/data/records.csv, the default of `host-sim mission`'s scenario.
MISSION = ROOT / "host-sim/scenarios/mission.toml"


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def ixm():
    return fmc_camera.Camera.from_toml(IXM)


@pytest.fixture(params=CAMERAS, ids=lambda path: path.stem)
def camera(request):
    return fmc_camera.Camera.from_toml(request.param)


@pytest.fixture(scope="session")
def host_sim():
    """The program, as a function of its arguments that returns what it prints."""
    program = os.environ.get("HOST_SIM")
    if program is None:
        pytest.skip("HOST_SIM does not name the program host-sim")

    def run(*arguments, code=0):
        done = subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, check=False
        )
        assert done.returncode == code, done.stderr
        return done.stdout

    return run
