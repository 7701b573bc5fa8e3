"""Yuan et al. 2012, eqs. 20-22 used as feed-forward: what is left of the distortion after each correction.

Shows: on a K1 lens the printed terms triple the error they should remove; the mended ones with all K remove it; mended for K1 alone
they are worse than nothing where K1 and K2 compete; five coefficients alone, fitted, do not replace K3 and P.
"""

import numpy as np

from common import brown, grid, longest, published, section, uniform_mean

print(__doc__.strip())

TRAVEL = 0.17  # f = 100 mm, V/H = 0.17 1/s, t = 1/100 s


def left(gx, gy, k, p, travel):
    """Largest vector left, µm: static; printed; literal (22); mended, K1 alone; mended, all terms."""
    s = travel / 2
    r2 = gx**2 + gy**2
    exact = uniform_mean(lambda c: brown(gx, gy - c, k, p), 0.0, travel)
    static = np.array(brown(gx, gy, k, p))
    term = k[1] * np.array([2 * gx * gy, 2 * gy**2 + r2])  # (20)-(21) per unit of travel
    h = 1e-4
    slope = (np.array(brown(gx, gy + h, k, p)) - np.array(brown(gx, gy - h, k, p))) / (2 * h)
    return [longest(exact - e) for e in (
        static,
        static + travel * term,
        static + np.array(brown(gx, gy, (0, k[1], k[2], 0))) + travel * term,
        static - s * term,
        static - s * slope,
    )]


LABELS = ("static alone", "static + (20)-(21) as printed", "(22) as printed, static twice", "static + mended, K1 alone", "static + mended, all terms")

section("K1 lenses, 80.64 mm square, 21 x 21 points, δ = 0.17 mm, opening at the calibrated principal point: largest error left, µm")
gx, gy = grid(40.32, 40.32)
for relative in (0.0003, 0.012):
    k = (0.0, relative / (2 * 40.32**2), 0.0, 0.0)
    values = left(gx, gy, k, (0.0, 0.0), TRAVEL)
    print(f"{100 * relative:g} % at the corner:")
    for label, value in zip(LABELS, values):
        print(f"  {label}: {value:.4f} µm")
    print(f"  printed / static: {values[1] / values[0]:.2f}")

section("Published lenses, V/H = 0.17 1/s, t = 1/100 s, opening at the calibrated principal point: largest error left, µm")
for name, f, (px, py), (hx, hy), k, p in published():
    gx, gy = grid(hx, hy)
    travel = f * 0.0017
    values = left(gx - px, gy - py, k, p, travel)
    print(f"{name}, δ = {travel:.4f} mm: static {values[0]:.4f}, printed {values[1]:.4f}, mended K1 alone {values[3]:.4f}, mended all {values[4]:.4f}; "
          f"|K0|·s {1e3 * abs(k[0]) * travel / 2:.4f}")

section("Five coefficients alone (no K3, no P), fitted without noise to the exposure mean: largest vector left, µm")
EXPOSURES = [(vh, t) for vh in np.linspace(0.05, 0.17, 10) for t in (1 / 100, 1 / 175, 1 / 200, 1 / 300, 1 / 500, 1 / 700)]
for name, f, (px, py), (hx, hy), k, p in published():
    gx, gy = grid(hx, hy)
    gx, gy = gx - px, gy - py
    ux, uy = gx / np.hypot(hx, hy), gy / np.hypot(hx, hy)
    u2 = ux**2 + uy**2

    def worst(travels):
        """The five coefficients fitted to all frames at once."""
        design = np.concatenate([np.concatenate([
            np.stack([ux, ux * u2, ux * u2**2, travel * ux * uy, 0 * ux], axis=1),
            np.stack([uy, uy * u2, uy * u2**2, travel * uy**2, travel * u2], axis=1)]) for travel in travels])
        wanted = np.concatenate([np.concatenate(uniform_mean(lambda c: brown(gx, gy - c, k, p), 0.0, travel)) for travel in travels])
        answer, *_ = np.linalg.lstsq(design, wanted, rcond=None)
        rest = (wanted - design @ answer).reshape(-1, 2, len(gx))
        return longest((rest[:, 0], rest[:, 1]))

    print(f"{name}: one frame {worst([f * 0.0017]):.1f}, the 60 frames of V/H 0.05-0.17 x 1/100-1/700 s {worst([f * vh * t for vh, t in EXPOSURES]):.1f}")
