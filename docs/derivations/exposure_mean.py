"""Yuan et al. 2012, eqs. 18-21: what the motion of the principal point adds to the recorded distortion.

Shows: sign and factor of (20)-(21); the exact exposure mean of Brown's polynomial in central moments of the offset, e = +y;
what a fold of the second moment into the static coefficients leaves out; the size of the second-moment terms on real lenses.
"""

import numpy as np
import sympy as sp

from common import brown, grid, holds, longest, published, section, uniform_mean

print(__doc__.strip())

x, y, y0, s = sp.symbols("x y y0 s")
K = sp.symbols("K0:4")
P = sp.symbols("P1:3")
K0, K1, K2, K3 = K
P1, P2 = P

section("(18), (19): derivatives with respect to the principal point")
shifted = [e.subs(y, y - y0) for e in brown(x, y, (0, K1, K2, 0))]
at_zero = [sp.expand(sp.diff(e, y0).subs(y0, 0)) for e in shifted]
rr = sp.sqrt(x**2 + y**2)
dr = sp.diff(rr.subs(y, y - y0), y0).subs(y0, 0)
holds("dr/dy0 = -ȳ/r and dȳ/dy0 = -1", [dr + y / rr, sp.diff(y - y0, y0) + 1])
holds("(18) as printed, with dr/dy0 left in it", at_zero[0] - (2 * K1 * x * rr * dr + 4 * K2 * x * rr**3 * dr))
holds("(19) as printed, with the derivatives left in it",
      at_zero[1] - (2 * K1 * y * rr * dr + 4 * K2 * y * rr**3 * dr + (K1 * rr**2 + K2 * rr**4) * (-1)))

section("(20), (21): sign and factor")
R2 = x**2 + y**2
linear = [sp.expand(e.subs({K2: 0})) for e in at_zero]
holds("per unit of offset, K1: -2K1·x̄ȳ and -2K1·ȳ² - K1·r²", [linear[0] + 2 * K1 * x * y, linear[1] + 2 * K1 * y**2 + K1 * R2])
holds("(20)-(21) as printed are the negative of it", [linear[0] + 2 * K1 * x * y, linear[1] + (2 * K1 * y**2 + K1 * R2)])
D, delta, u = sp.symbols("D delta u")  # D: offset at opening
mean_offset = sp.integrate(D + delta * u, (u, 0, 1))
holds("mean offset of a uniform exposure s = Δδ + δ/2", mean_offset - (D + delta / 2))
holds("K1 terms are Brown's decentring with P2 = -K1·s",
      [a - b for a, b in zip([s * e for e in linear], brown(x, y, p=(0, -K1 * s)))])
K2_term = [sp.factor(sp.expand(e.subs(K1, 0))) for e in at_zero]
print("K2, left out of (20)-(21), per unit of offset:", K2_term[0], ";", K2_term[1])

section("Exact exposure mean, e = +y, about the principal point at the exposure centroid")
X, Y, d = sp.symbols("X Y d")
mu = {k: sp.Symbol(f"mu{k}") for k in range(2, 8)}


def averaged(expression):
    """E[.] over the deviation d from the centroid."""
    total = 0
    for (power,), coefficient in sp.Poly(sp.expand(expression), d).terms():
        total += coefficient * {0: 1, 1: 0}.get(power, mu.get(power))
    return sp.expand(total)


static = brown(X, Y, K, P)
mean = [averaged(e.subs(Y, Y - d)) for e in static]
added = [sp.expand(m - sp.expand(e)) for m, e in zip(mean, static)]
for symbol in (K0, K1, K2, K3, P1, P2):
    for axis, e in zip("xy", added):
        part = sp.collect(sp.expand(e).coeff(symbol), list(mu.values()), sp.factor)
        print(f"{symbol}, D{axis} += {part}")

section("Second moment folded into the static coefficients, e = +y")
m2 = mu[2]
second = [sp.expand(e).coeff(m2) * m2 for e in added]
RR = X**2 + Y**2
held = [X * (3 * m2 * K1 - 2 * m2 * K1 + 6 * m2 * K2 * RR + 12 * m2 * K3 * RR**2) + m2 * P1,
        Y * (3 * m2 * K1 + 6 * m2 * K2 * RR + 12 * m2 * K3 * RR**2) + 3 * m2 * P2]
left = [sp.expand(a - b) for a, b in zip(second, held)]
holds("K1, P1, P2 completely; K2 up to μ2·K2·(-4X³, 4Y³)",
      [left[0].subs(K3, 0) + 4 * m2 * K2 * X**3, left[1].subs(K3, 0) - 4 * m2 * K2 * Y**3])
angle = sp.Symbol("a", real=True)
on_circle = [sp.expand(e.subs({X: sp.cos(angle), Y: sp.sin(angle)}) / m2) for e in left]
values = [np.hypot(*[float(e.subs({K2: 0, K3: 1, angle: float(a)})) for e in on_circle]) for a in np.linspace(0, 2 * np.pi, 73)]
print(f"K3: largest vector left out {max(values):.3f} μ2·|K3|·r⁵")

section("Uniform shutter")
holds("μ2 = δ²/12, μ4 = δ⁴/80, odd moments 0",
      [sp.integrate((delta * (u - sp.Rational(1, 2)))**k, (u, 0, 1)) - e
       for k, e in ((2, delta**2 / 12), (3, 0), (4, delta**4 / 80), (5, 0), (6, delta**6 / 448))])

section("Size: all terms beyond the static polynomial about the centroid, V/H = 0.17 1/s, t = 1/100 s, 21 x 21 points")
most = {}
for name, f, (px, py), (hx, hy), k, p in published():
    gx, gy = grid(hx, hy)
    gx, gy = gx - px, gy - py
    for label, travel in (("δ = f·0.0017", f * 0.0017), ("δ = 0.34 mm", 0.34)):
        exact = uniform_mean(lambda offset: brown(gx, gy - offset, k, p), -travel / 2, travel)
        here = longest(exact - np.array(brown(gx, gy, k, p))) * 1e3
        most[label] = max(most.get(label, 0), here)
        print(f"{name}, {label} ({travel:.3f} mm): {here:.2f} nm")
print("largest: " + ", ".join(f"{label}: {value:.2f} nm" for label, value in most.items()))
