"""Yuan et al. 2012, eqs. 10-11: the weight of the mean over the exposure.

Shows: the weight is 1 if the curve of the line integral is the path of the principal point, and the arc length of the hodograph
if it is the distortion's; where the two means differ to leading order; how much they differ on published lenses and near
the principal point.
"""

import numpy as np
import sympy as sp

from common import brown, grid, holds, published, section

print(__doc__.strip())

section("The line integral of the first kind")
c, x, y, K1, delta = sp.symbols("c x y K1 delta", real=True)
path = sp.Matrix([0, c])  # principal point, offset c along y
hodograph = sp.Matrix(brown(x, y - c, (0, K1, 0, 0)))
speed = lambda curve: sp.sqrt(sum(e**2 for e in sp.diff(curve, c)))
holds("ds = dc along the path of the principal point", speed(path) - 1)
print("ds/dc along the hodograph of a K1 lens:", sp.factor(speed(hodograph)))
holds("which vanishes where the principal point stands, and for K1 = 0",
      [speed(hodograph).subs({x: 0, y: 0}).subs(c, 0), speed(hodograph).subs(K1, 0)])

section("Leading order of the difference, at x = 0")
along = K1 * (y - c) ** 3
w = 3 * K1 * (y - c) ** 2  # |dD/dc| for K1 > 0
arc = sp.integrate(sp.expand(along * w), (c, -delta / 2, delta / 2)) / sp.integrate(sp.expand(w), (c, -delta / 2, delta / 2))
plain = sp.integrate(sp.expand(along), (c, -delta / 2, delta / 2)) / delta
leading = sp.series(sp.simplify(arc - plain), delta, 0, 3).removeO()
print("arc-length mean minus plain mean:", sp.factor(leading), "+ O(δ⁴)")
holds("centred on the principal point both are 0", [arc.subs(y, 0), plain.subs(y, 0)])

section("Published lenses, V/H = 0.17 1/s, t = 1/100 s, 21 x 21 points: largest difference on dx or dy, and as a vector")
a, weight = np.polynomial.legendre.leggauss(200)


def difference(gx, gy, k, p, start, travel):
    """Arc-length mean minus plain mean, nm."""
    offset = (start + travel * (a + 1) / 2)[:, None]
    dx, dy = brown(gx[None, :], gy[None, :] - offset, k, p)
    h = 1e-3  # central difference: exact enough, as the step is far below the distance to the principal point
    px, py = brown(gx[None, :], gy[None, :] - offset - h, k, p)
    qx, qy = brown(gx[None, :], gy[None, :] - offset + h, k, p)
    arc = np.hypot(px - qx, py - qy) / (2 * h) * weight[:, None]
    light = np.broadcast_to(weight[:, None], dx.shape)
    mean = lambda d, by: (d * by).sum(axis=0) / by.sum(axis=0)
    return [1e6 * (mean(d, arc) - mean(d, light)) for d in (dx, dy)]


worst = 0.0
for name, f, (px, py), (hx, hy), k, p in published():
    gx, gy = grid(hx, hy)
    v = f * 0.17
    travel = v * 0.01
    row = []
    for label, start in (("centred", -travel / 2), ("from calibrated", 0.0), ("from rest", v * v / 2000 + v * 0.005)):
        dx, dy = difference(gx - px, gy - py, k, p, start, travel)
        vector = float(np.max(np.hypot(dx, dy)))
        worst = max(worst, vector)
        row.append(f"{label} {max(np.abs(dx).max(), np.abs(dy).max()):.2f} / {vector:.2f}")
    print(f"{name}: {', '.join(row)} nm")
print(f"largest: {worst:.2f} nm")

section("Near the principal point of a 1.2 % K1 lens (corner of 80.64 mm square), δ = 0.17 mm, opening at 0")
k1 = 0.012 / (2 * 40.32**2)
near = np.linspace(-0.5, 0.5, 101)
gx, gy = (g.ravel() for g in np.meshgrid(near + 0.0007, near + 0.0007))
offset = 0.17 * (a + 1)[:, None] / 2
X, Y = gx[None, :] + 0 * offset, gy[None, :] - offset
dx, dy = brown(X, Y, (0, k1, 0, 0))
arc = k1 * np.hypot(2 * X * Y, X * X + 3 * Y * Y) * weight[:, None]
light = np.broadcast_to(weight[:, None], dx.shape)
mean = lambda d, by: (d * by).sum(axis=0) / by.sum(axis=0)
vector = 1e6 * np.hypot(*[mean(d, arc) - mean(d, light) for d in (dx, dy)])
print(f"|K1|·δ³ = {1e6 * k1 * 0.17**3:.3f} nm; largest difference within 0.17 mm: {vector[np.hypot(gx, gy - 0.085) < 0.17].max():.3f} nm")
