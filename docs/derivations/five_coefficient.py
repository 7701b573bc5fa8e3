"""Yuan et al. 2012, eqs. 22-25: coefficients, decomposition and design matrix of the five-coefficient model.

Shows: what (17)-(21) give for the coefficients of (22), printed and mended; that (22) with K_d1 = 2P_m1 is Brown's decentring; the
radial and tangential parts that (23) should state; which rows of (25) follow from (22), and what a fit with the printed rows
leaves; what a single frame cannot separate.
"""

import numpy as np
import sympy as sp

from common import brown, differs, grid, holds, section

print(__doc__.strip())

x, y, delta, s = sp.symbols("x y delta s")
r = sp.Symbol("r", positive=True)
Km0, Km1, Km2, Kd1, Pm1, K1, K2, P1, P2, k0p = sp.symbols("K_m0 K_m1 K_m2 K_d1 P_m1 K1 K2 P1 P2 k0p")
R2 = x**2 + y**2
UNKNOWN = [Km0, Km1, Km2, Kd1, Pm1]
model = sp.Matrix([
    Km0 * x + Km1 * x * R2 + Km2 * x * R2**2 + Kd1 * delta * x * y,
    Km0 * y + Km1 * y * R2 + Km2 * y * R2**2 + Kd1 * delta * y * y + Pm1 * delta * R2,
])


def coefficients(dx, dy):
    """The five coefficients that make (22) equal to the given distortion."""
    equations = []
    for axis, e in enumerate((dx, dy)):
        equations += sp.Poly(sp.expand(model[axis] - e), x, y).coeffs()
    return sp.solve(equations, UNKNOWN, dict=True)[0]


section("(22): coefficients")
focus = [c * (k0p + (1 - k0p) * (K1 * R2 + K2 * R2**2)) for c in (x, y)]  # static + (17)
printed_motion = [2 * K1 * delta * x * y, 2 * K1 * delta * y * y + K1 * R2 * delta]  # (20)-(21), f·η·Δt = δ
shift = sp.Symbol("shift")
moved = [sp.diff(e.subs(y, y - shift), shift).subs(shift, 0) * s for e in brown(x, y, (0, K1, 0, 0))]
for label, motion in (("with (20)-(21) as printed", printed_motion), ("mended, s = Δδ + δ/2", moved)):
    found = coefficients(*[a + b for a, b in zip(focus, motion)])
    print(label + ":", ", ".join(f"{u} = {sp.factor(found[u])}" for u in UNKNOWN))
holds("K_d1 = 2P_m1 in both", [found[Kd1] - 2 * found[Pm1]])
holds("printed K_m1 = K1 + k1' holds K1 once too often", [(K1 + K1 * (1 - k0p)) - found[Km1] - K1])
holds("K_d1 = 2P_m1 is Brown's decentring with P2 = P_m1·δ",
      model.subs({Km0: 0, Km1: 0, Km2: 0, Kd1: 2 * Pm1}) - sp.Matrix(brown(x, y, p=(0, Pm1 * delta))))
print("opening at the calibrated principal point, s = δ/2: K_d1 =", found[Kd1].subs(s, delta / 2), ", P_m1 =", found[Pm1].subs(s, delta / 2))

section("(23): radial and tangential part of the motion terms")
motion = model.subs({Km0: 0, Km1: 0, Km2: 0})
radial = (motion.dot(sp.Matrix([x, y]))) / sp.sqrt(R2)
tangential = (motion.dot(sp.Matrix([-y, x]))) / sp.sqrt(R2)
holds("radial (K_d1 + P_m1)·δ·ȳ·r", radial - (Kd1 + Pm1) * delta * y * sp.sqrt(R2))
holds("tangential, counter-clockwise, P_m1·δ·x̄·r", tangential - Pm1 * delta * x * sp.sqrt(R2))
differs("printed 2δK_d1·ȳ·r from the radial part", sp.expand((2 * Kd1 * delta * y - (Kd1 + Pm1) * delta * y) * r) )
holds("other reading, P_m1·δ·r² along y beside a radial K_d1·δ·ȳ·r: no factor 2",
      motion - (Kd1 * delta * y * sp.sqrt(R2) * sp.Matrix([x, y]) / sp.sqrt(R2) + sp.Matrix([0, Pm1 * delta * R2])))

section("(25): rows of the design matrix")
print("x row:", [sp.factor(sp.diff(model[0], u)) for u in UNKNOWN])
print("y row:", [sp.factor(sp.diff(model[1], u)) for u in UNKNOWN])

section("A fit with the printed rows; 80.64 mm square, 21 x 21 points, no noise, δ = 0.17 mm, s = δ/2, 0.03 % and 1.2 % K1 lens")
gx, gy = grid(40.32, 40.32)
g2 = gx**2 + gy**2
zero = np.zeros_like(gx)
travel = 0.17
x_rows = np.stack([gx, gx * g2, gx * g2**2, travel * gx * gy, zero], axis=1)
y_rows = np.stack([gy, gy * g2, gy * g2**2, travel * gy**2, travel * g2], axis=1)
y_printed = np.stack([gy, gx * g2, gx * g2**2, travel * gx * gy, travel * g2], axis=1)
for relative in (0.0003, 0.012):
    k1 = relative / (2 * 40.32**2)
    dx, dy = brown(gx, gy, (0, k1, 0, 0), (0, -k1 * travel / 2))
    for label, rows in (("right", y_rows), ("printed", y_printed)):
        design = np.concatenate([x_rows, rows])
        scale = np.abs(design).max(axis=0)
        answer, *_ = np.linalg.lstsq(design / scale, np.concatenate([dx, dy]), rcond=None)
        rest = 1e3 * (np.concatenate([dx, dy]) - design / scale @ answer)
        k = answer / scale
        print(f"{100 * relative:g} %, {label} rows: residual rms {np.sqrt(np.mean(rest**2)):.3f} µm, largest {np.abs(rest).max():.2f} µm, "
              f"K_m1/K1 = {k[1] / k1:.3f}, K_d1/K1 = {k[3] / k1:.3f}, P_m1/K1 = {k[4] / k1:.3f}")

section("What one frame cannot separate")
p2_rows = np.stack([2 * gx * gy, g2 + 2 * gy**2], axis=1)
one = np.column_stack([np.concatenate([x_rows, y_rows]), np.concatenate([p2_rows[:, 0], p2_rows[:, 1]])])
rank = lambda m: np.linalg.matrix_rank(m / np.abs(m).max(axis=0), tol=1e-9)
other = one.copy()
other[:, 3:5] *= 0.5
print(f"K_d1, P_m1 and a static P2: rank {rank(one)} of 6 with one frame, {rank(np.concatenate([one, other]))} of 6 with a second of half the travel")
radius = 40.32 * np.sqrt(2)
design = np.concatenate([x_rows, y_rows])
unit = np.concatenate([
    np.stack([gx, gx * g2 / radius**2, gx * g2**2 / radius**4, gx * gy / radius, zero], axis=1),
    np.stack([gy, gy * g2 / radius**2, gy * g2**2 / radius**4, gy**2 / radius, g2 / radius], axis=1)]) / radius
print(f"condition number of the design matrix: {np.linalg.cond(design):.0e} in mm, {np.linalg.cond(unit):.0f} with coordinates over the format radius and δ factored out")
