"""A shutter with ramps, where Yuan et al. 2012, eqs. 10-11, assumes equal exposure throughout.

Shows: effective exposure, centroid and variance of a trapezoid of base t with opening ramp r1 and closing ramp r2; by how much
the mean offset is wrong if the middle of the exposure is taken instead of the centroid.
"""

import sympy as sp

from common import holds, section

print(__doc__.strip())

t, a, b, tau = sp.symbols("t r1 r2 tau", positive=True)
pieces = ((tau / a, 0, a), (sp.Integer(1), a, t - b), ((t - tau) / b, t - b, t))


def integral(weight):
    return sp.simplify(sum(sp.integrate(sp.expand(w * weight), (tau, start, end)) for w, start, end in pieces))


section("Moments")
light = integral(1)
mean = sp.simplify(integral(tau) / light)
variance = sp.factor(sp.simplify(integral(tau**2) / light - mean**2))
holds("effective exposure t - (r1 + r2)/2", light - (t - (a + b) / 2))
holds("E[τ] = t/2 + (r1 - r2)(3t - 2r1 - 2r2) / (6(2t - r1 - r2))",
      mean - (t / 2 + (a - b) * (3 * t - 2 * a - 2 * b) / (6 * (2 * t - a - b))))
holds("equal ramps: E[τ] = t/2, Var[τ] = (t² - 2t·r + 2r²)/12",
      [mean.subs(b, a) - t / 2, variance.subs(b, a) - (t**2 - 2 * t * a + 2 * a**2) / 12])
skew = sp.simplify(integral((tau - mean) ** 3) / light)
holds("equal ramps: no odd moment", skew.subs(b, a))

section("Size")
case = {t: 1, a: sp.Rational(3, 10), b: sp.Rational(1, 10)}
print(f"ramps of 30 and 10 % of the base: E[τ]/t - 1/2 = {100 * float(mean.subs(case) - sp.Rational(1, 2)):.2f} %, "
      f"Var[τ]/t² = {float(variance.subs(case)):.5f} (uniform {1 / 12:.5f}), third moment {float(skew.subs(case)):+.6f} t³")
print(f"at δ = 0.17 mm the middle is {170 * float(mean.subs(case) - sp.Rational(1, 2)):.1f} µm from the mean offset")
