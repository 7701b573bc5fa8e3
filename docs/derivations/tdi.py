"""Charge transfer in whole rows, which Yuan et al. 2012, section 1, includes in its claim.

Shows: mean offset of the staircase against the smooth path v·τ, in row pitches, for N rows of travel and a first transfer φ row
periods after opening: the lag is φ - 1/2 for a whole N, and depends on N otherwise.
"""

import sympy as sp

from common import holds, section

print(__doc__.strip())


def lag(rows, first):
    """Mean of the smooth path minus mean number of transfers, both in row pitches; exact."""
    transfers = sp.Integer(0)
    at = first
    while at < rows:
        transfers += rows - at  # every transfer counts from its own time to the end
        at += 1
    return rows / 2 - transfers / rows


section("Whole number of rows")
N, k, phi = sp.symbols("N k phi", positive=True)
mean_transfers = sp.summation(N - (k + phi), (k, 0, N - 1)) / N
holds("lag φ - 1/2, 0 <= φ <= 1", N / 2 - mean_transfers - (phi - sp.Rational(1, 2)))
for rows in (1, 2, 10, 1024):
    holds(f"N = {rows}: 1/2 for φ = 1, 0 for φ = 1/2",
          [lag(sp.Integer(rows), sp.Integer(1)) - sp.Rational(1, 2), lag(sp.Integer(rows), sp.Rational(1, 2))])

section("Other numbers of rows: lag in pixels")
for rows in (sp.Rational(1, 2), sp.Rational(3, 2), sp.Rational(5, 2), sp.Rational(21, 2)):
    print(f"N = {float(rows)}: φ = 1: {float(lag(rows, sp.Integer(1))):.3f}, φ = 1/2: {float(lag(rows, sp.Rational(1, 2))):.3f}")
