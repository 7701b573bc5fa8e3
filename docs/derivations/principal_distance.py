"""Yuan et al. 2012, eqs. 14-17: what a detector out of its plane does to the distortion.

Shows: (14)-(17) follow from holding the measured radius fixed while the principal distance is renamed; a detector moved by Δz
away from the lens multiplies the measured radius by 1 + Δz/L; sign, length and the factor on K1, K2 then differ from
the printed ones; the two ways of taking Δz into account describe the same rays.
"""

import sympy as sp

from common import holds, section

print(__doc__.strip())

r, f, L, df, dz, kappa, k1, k2, K1, K2, a = sp.symbols("r f L df dz kappa k1 k2 K1 K2 a")

section("(14)-(17) as printed")
static = k1 * r**3 + k2 * r**5
tan_alpha = (r - static) / f  # (2), (15)
fourteen = static - df * tan_alpha
sixteen = static * (1 + df / f) - df / f * r
holds("(15) put into (14) gives (16)", fourteen - sixteen)
k0p = -df / f
seventeen = k0p * r + k1 * (1 - k0p) * r**3 + k2 * (1 - k0p) * r**5 - static
holds("(16) gives (17)", sixteen - static - seventeen)
holds("(17) plus the static distortion holds it once: K_m0 = k0', K_m1 = k1', K_m2 = k2'",
      static + seventeen - (k0p * r + k1 * (1 - k0p) * r**3 + k2 * (1 - k0p) * r**5))

section("The detector moves; r is the measured radius after the move")
D = lambda radius: K1 * radius**3 + K2 * radius**5
before = r / (1 + kappa)
ideal = before - D(before)  # f·tan α, unchanged by the move
moved = sp.expand(r - ideal)
A = kappa * r / (1 + kappa) + D(before)
holds("(A) f unchanged: D'(r) = κr/(1+κ) + D(r/(1+κ))", moved - A)
B = (1 + kappa) * D(before)
holds("(B) f(1+κ): D'(r) = (1+κ)·D(r/(1+κ)), no linear term", (r - B) - (1 + kappa) * ideal)
first = sp.series(A, kappa, 0, 2).removeO()
print("(A) to first order in κ:", sp.collect(sp.expand(first), r))
print("printed, to compare:    ", sp.collect(sp.expand(sixteen.subs({k1: K1, k2: K2})), r))
holds("with Δf = -κf the linear terms agree, the K1 terms differ by -2κK1·r³ and K2 by -4κK2·r⁵",
      first - sixteen.subs({k1: K1, k2: K2, df: -kappa * f}) - (-2 * kappa * K1 * r**3 - 4 * kappa * K2 * r**5))

section("κ = Δz/L: chief ray from the exit pupil, L in front of the detector")
height = r * (L + dz) / L
holds("image height after the move", height - r * (1 + dz / L))

section("Thin-lens retrofocus of f = 50 mm, stop at the rear lens, so L = back focal distance = 76.7 mm")
f2, s = sp.symbols("f2 s")
s_value = sp.solve(sp.Eq(50 * (1 - s / -100), sp.Rational(767, 10)), s)[0]
f2_value = sp.solve(sp.Eq(sp.Rational(1, 50), sp.Rational(-1, 100) + 1 / f2 - s_value / (-100 * f2)), f2)[0]
thin = lambda focal: sp.Matrix([[1, 0], [-1 / focal, 1]])
gap = lambda length: sp.Matrix([[1, length], [0, 1]])
front = gap(s_value) * thin(sp.Integer(-100))
system = thin(f2_value) * front
focal = -1 / system[1, 0]
back = -system[0, 0] / system[1, 0]
# Chief ray at field angle a: through the centre of the rear lens.
h1 = sp.solve((front * sp.Matrix([sp.Symbol("h"), a]))[0], sp.Symbol("h"))[0]
out = system * sp.Matrix([h1, a])
image = out[0] + back * out[1]
shift = sp.Rational(1, 100)
relative = sp.simplify((out[0] + (back + shift) * out[1]) / image - 1)
holds("f, back focal distance and image height f·a", [focal - 50, back - sp.Rational(767, 10), image - 50 * a])
print(f"lenses -100 mm and {float(f2_value):.3f} mm, {float(s_value):.1f} mm apart; Δz = 10 µm enlarges by {float(relative):+.4e}")
print(f"Δz/L = {0.01 / 76.7:+.4e}; printed k0' = -Δf/f with Δf = Δz: {-0.01 / 50:+.4e}")

section("Sizes")
corner = 40.32 * sp.sqrt(2)
for relative_distortion in (0.0003, 0.012):
    value = 2 * 1e-4 * relative_distortion * float(corner) * 1e3
    print(f"f = L = 100 mm, Δz = 10 µm, {100 * relative_distortion:g} % K1 lens, corner of 80.64 mm square: "
          f"linear term {1e-4 * float(corner) * 1e3:+.2f} µm, printed {-1e-4 * float(corner) * 1e3:+.2f} µm; K1 factor off by a further {value:.4f} µm")
