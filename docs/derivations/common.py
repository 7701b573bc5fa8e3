"""Common parts of the scripts: printing, identities that must hold, and the published lenses."""

import csv
from pathlib import Path

import numpy as np
import sympy as sp

CAMERAS = Path(__file__).parents[2] / "host-sim" / "data" / "cameras.csv"


def section(title):
    print(f"\n{title}\n{'-' * len(title)}")


def holds(claim, difference):
    """Prints the claim if the expression, or each of a matrix, is identically zero; stops if not."""
    for entry in sp.Matrix([difference]):
        rest = sp.simplify(sp.expand(entry))
        if rest != 0:
            raise SystemExit(f"does not hold: {claim}: {rest}")
    print(f"holds: {claim}")


def differs(claim, difference):
    """Prints the claim and the remainder; stops if there is none."""
    rest = [sp.factor(sp.simplify(sp.expand(entry))) for entry in sp.Matrix([difference])]
    if all(entry == 0 for entry in rest):
        raise SystemExit(f"no difference: {claim}")
    print(f"differs: {claim} by {', '.join(str(entry) for entry in rest)}")


def brown(x, y, k=(0, 0, 0, 0), p=(0, 0)):
    """Static distortion, measured - ideal, P1 with x²; symbols, numbers and arrays alike."""
    r2 = x * x + y * y
    radial = k[0] + r2 * (k[1] + r2 * (k[2] + r2 * k[3]))
    dx = x * radial + p[0] * (r2 + 2 * x * x) + 2 * p[1] * x * y
    dy = y * radial + p[1] * (r2 + 2 * y * y) + 2 * p[0] * x * y
    return dx, dy


def grid(half_x, half_y, side=21):
    """side x side points over the format, corners included, mm."""
    x, y = np.meshgrid(np.linspace(-half_x, half_x, side), np.linspace(-half_y, half_y, side))
    return x.ravel(), y.ravel()


def uniform_mean(function, start, length, nodes=16):
    """Mean of function(c) over c in [start, start + length]; exact for polynomials of degree 31."""
    at, weight = np.polynomial.legendre.leggauss(nodes)
    total = 0.0
    for a, w in zip(at, weight):
        total = total + w / 2 * np.array(function(start + length * (a + 1) / 2))
    return total


def longest(vectors):
    """Largest length of the given (dx, dy), in µm for mm."""
    dx, dy = vectors
    return 1e3 * float(np.max(np.hypot(dx, dy)))


def published():
    """The published lenses as (name, f, (x0, y0), half format, k, p), sign measured - ideal."""
    with CAMERAS.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            sign = {"distortion": 1.0, "correction": -1.0}[row["published_sign"]]
            number = lambda key: float(row[key])
            yield (
                row["name"],
                number("principal_distance_mm"),
                (number("x0_mm"), number("y0_mm")),
                (number("width_mm") / 2, number("height_mm") / 2),
                [sign * number(key) for key in ("K0", "K1", "K2", "K3")],
                [sign * number(key) for key in ("P1", "P2")],
            )
