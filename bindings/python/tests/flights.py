"""The flight of examples/data, and tables of exposures."""

import csv

from conftest import ROOT

import fmc_camera

RECORDS = ROOT / "examples/data/records.csv"
CAMERA = ROOT / "host-sim/scenarios/cameras/mission.toml"


def camera():
    return fmc_camera.Camera.from_toml(CAMERA)


def frames():
    return camera().frames(RECORDS)


def columns():
    """The records as a dictionary of columns of text, None where a cell is empty."""
    with RECORDS.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] or None for row in rows] for name in rows[0]}


def exposures(count):
    """A table of exposures with another V/H each."""
    return {
        "sequence": list(range(1, count + 1)),
        "vh_per_s": [0.05 + 0.1 * number / count for number in range(count)],
        "exposure_s": [0.004] * count,
    }
