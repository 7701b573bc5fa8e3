"""Yuan et al. 2012, eqs. 5-8: how the principal point moves while the shutter is open.

Shows: (5) for one object point is one equation for two unknowns, for all points of a plane it gives (6) and (7), (6) with its
printed sign for an inverted image; the integrand printed in (8) gives f·η·t²/2, not the δ on its right-hand side.
"""

import sympy as sp

from common import holds, section

print(__doc__.strip())

f, V, H, t, dt, tau, eta = sp.symbols("f V H t dt tau eta", positive=True)
X, Y, du, dv, m = sp.symbols("X Y du dv m")  # X = X_A - X_S1, Y = Y_A - Y_S1; du = u_t - u_0, dv = v_t - v_0

section("(5), (6), (7)")
# Undistorted image of scale m: u_x - u_0 = m X, v_x - v_0 = m Y. The first line of (5) is then 0 = 0.
holds("first line of (5) is satisfied by every similar image", (m * Y) * X - (m * X) * Y)
second = sp.expand((m * Y - dv) * X - (m * X - du) * (Y + V * dt))
print("second line of (5):", sp.collect(second, [X, Y]), "= 0: one equation in du, dv")
by_point = sp.Poly(second, X, Y)
solution = sp.solve(by_point.coeffs(), [du, dv], dict=True)[0]
print("for all X, Y: du =", solution[du], ", dv =", solution[dv])
holds("(6) as printed for an inverted image, m = -f/H", solution[dv].subs(m, -f / H) - f * V / H * dt)
holds("(6) with the other sign for an upright image, m = +f/H", solution[dv].subs(m, f / H) + f * V / H * dt)
holds("(7)", solution[du])

section("(8)")
position = f * eta * tau  # v_t - v_0 at the time tau, by (6)
printed = sp.integrate(position, (tau, 0, t))
right = sp.integrate(sp.diff(position, tau), (tau, 0, t))
print("integral of (v_t - v_0), as printed:", printed)
print("integral of d(v_t)/dt:", right)
holds("the right-hand side of (8) is the integral of the rate", right - f * eta * t)
case = {f: 100, eta: sp.Rational(17, 100), t: sp.Rational(1, 100)}
print(f"f = 100 mm, V/H = 0.17 1/s, t = 1/100 s: right {float(right.subs(case)):.2f} mm, printed {float(printed.subs(case)):.5f} mm·s")
