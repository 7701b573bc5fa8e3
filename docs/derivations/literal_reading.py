"""Yuan et al. 2012, eqs. 9, 12, 13 and 22: totals that are called changes.

Shows: (9) and (10)-(11) are values of the whole distortion; their sum (12)-(13) holds the static distortion twice, added to (1)
as in steps 4-6 of section 4.1 three times; read as differences they sum to the exposure mean.
"""

import numpy as np
import sympy as sp

from common import brown, grid, holds, longest, section, uniform_mean

print(__doc__.strip())

x, y, c, D, delta, K1, K2 = sp.symbols("x y c D delta K1 K2")
static = sp.Matrix(brown(x, y, (0, K1, K2, 0)))
at = lambda offset: sp.Matrix(brown(x, y - offset, (0, K1, K2, 0)))
opening = at(D)
mean = (sp.integrate(at(c).expand(), (c, D, D + delta)) / delta).applyfunc(sp.simplify)

section("(9), plain mean for (10)-(11), (12)-(13)")
still = {D: 0}
limit = lambda e: e.subs(still).applyfunc(lambda t: sp.limit(sp.expand(t), delta, 0))
holds("no motion: (9) is the whole static distortion", opening.subs(still) - static)
holds("no motion: so is the mean", limit(mean) - static)
holds("no motion: (12)-(13) as printed give twice the static distortion", limit(opening + mean) - 2 * static)
holds("no motion: steps 4 and 5 of section 4.1 give three times", limit(static + opening + mean) - 3 * static)
holds("no motion: (22) with K_m1 = K1 + k1', k1' = K1 for Δf = 0, gives twice",
      sp.Matrix(brown(x, y, (0, K1 + K1, K2 + K2, 0))) - 2 * static)
change1, change2 = opening - static, mean - opening
holds("as differences: static + [D(Δδ) - D(0)] + [mean - D(Δδ)] = mean", static + change1 + change2 - mean)

section("80.64 mm square, K1 lens, δ = 0.17 mm, Δδ = 0, 21 x 21 points: largest error against the exposure mean")
gx, gy = grid(40.32, 40.32)
for relative in (0.0003, 0.012):
    k = (0, relative / (2 * 40.32**2), 0, 0)
    exact = uniform_mean(lambda offset: brown(gx, gy - offset, k), 0.0, 0.17)
    whole = np.array(brown(gx, gy, k))
    print(f"{100 * relative:g} % at the corner: (12)-(13) {longest(whole + exact - exact):.1f} µm, "
          f"steps 4 and 5 {longest(2 * whole):.1f} µm, consistent 0")
