"""Direct linear transformation: Feng et al., eqs. 1, 4-7, and the survey's interior orientation from l1..l11.

Shows: the coefficients that follow from collinearity, against (5), (4) and (7) as printed; the rows of (6); the survey's formulas, and
what fx is with a skew; four corners set to zero as a change of gauge; storage of a table.
"""

import numpy as np
import sympy as sp

from common import holds, section

print(__doc__.strip())

a1, a2, a3, b1, b2, b3, c1, c2, c3 = sp.symbols("a1:4 b1:4 c1:4")
X, Y, Z, XS, YS, ZS, x0, y0, fx, fy, tb = sp.symbols("X Y Z X_S Y_S Z_S x0 y0 f_x f_y tan_beta")
R = sp.Matrix([[a1, b1, c1], [a2, b2, c2], [a3, b3, c3]])
S = sp.Matrix([XS, YS, ZS])
inner = sp.Matrix([[fx, -fx * tb, -x0], [0, fy, -y0], [0, 0, 1]])  # f_y is printed as f_x/((1+ds)·cosβ)
gamma = -R * S
gamma3 = gamma[2]

section("Feng (1), (5): x = x0 - (fx·u1 - fx·tanβ·u2)/u3, y = y0 - fy·u2/u3, u = R(P - S)")
u = R * (sp.Matrix([X, Y, Z]) - S)
three = inner * R.row_join(gamma) / gamma3  # rows l1..l4; l5..l8; l9..l11, 1
holds("last element 1", three[2, 3] - 1)
point = sp.Matrix([X, Y, Z, 1])
row = [(three * point)[i] for i in range(3)]
holds("x + (l1X + l2Y + l3Z + l4)/(l9X + l10Y + l11Z + 1) = 0, y likewise",
      [(x0 - (fx * u[0] - fx * tb * u[1]) / u[2]) + row[0] / row[2], (y0 - fy * u[1] / u[2]) + row[1] / row[2]])
def as_five(numerators, column):
    """Numerators of (5) for one column: x row, y row, last row."""
    one, two, last = numerators
    return [three[0, column] - (one * fx - two * fx * tb - last * x0) / gamma3,
            three[1, column] - (two * fy - last * y0) / gamma3, three[2, column] - last / gamma3]


holds("(5) as printed, all eight, with γ1, γ2, γ3 = -R·S",
      as_five((a1, a2, a3), 0) + as_five((b1, b2, b3), 1) + as_five(tuple(gamma), 3))
starred = (three[:, 0:2].row_join(three[:, 2] * Z + three[:, 3])) / (three[2, 2] * Z + 1)
holds("(3) as printed maps the points of a plane at the height Z like (1)",
      starred * sp.Matrix([X, Y, 1]) * (three[2, 2] * Z + 1) - three * point)
holds("and its last element is 1", starred[2, 2] - 1)

section("Feng (4): the object-space matrix")
plane = three.extract([0, 1, 2], [0, 1, 3])
mended = sp.Matrix([[1, 0, -XS], [0, 1, -YS], [0, 0, -ZS]])
printed = sp.Matrix([[1, 0, XS], [0, 1, YS], [0, 0, ZS]])
holds("third column (-X_S, -Y_S, -Z_S), with γ3 = -(a3·X_S + b3·Y_S + c3·Z_S) as printed", inner * R * mended / gamma3 - plane)
holds("printed third column (X_S, Y_S, Z_S): all of l3, l6 and the 1 with the wrong sign", (inner * R * printed / gamma3)[:, 2] + plane[:, 2])

section("Feng (7): R = 1, x0 = y0 = 0, fx = fy = f, tanβ = 0")
f = sp.Symbol("f")
vertical = dict(zip([a1, a2, a3, b1, b2, b3, c1, c2, c3], [1, 0, 0, 0, 1, 0, 0, 0, 1])) | {x0: 0, y0: 0, fx: f, fy: f, tb: 0}
special = plane.subs(vertical).applyfunc(sp.simplify)
print("from (5):  ", special.tolist())
as_printed = sp.Matrix([[f / ZS, 0, f * XS / ZS], [0, f / ZS, f * YS / ZS], [0, 0, 1]])
print("printed:   ", as_printed.tolist())
holds("l1 and l5 are -f/Z_S, not +f/Z_S; l3, l6 and the 1 as printed",
      [special[0, 0] + as_printed[0, 0], special[1, 1] + as_printed[1, 1], *(special[:, 2] - as_printed[:, 2])])
holds("(7) as printed is (4) as printed with γ3 = +Z_S", (inner * R * printed / ZS).subs(vertical) - as_printed)
holds("-(l1X + l3) is the image f(X - X_S)/Z_S", -(special[0, 0] * X + special[0, 2]) - f * (X - XS) / ZS)
print("with (7) as printed the image would be", sp.factor(-(as_printed[0, 0] * X + as_printed[0, 2])))

section("Feng (6): rows of the error equations")
l = sp.symbols("l1:9")
x, y, A = sp.symbols("x y A")
residual_x = (x * (l[6] * X + l[7] * Y + 1) + l[0] * X + l[1] * Y + l[2]) / A
residual_y = (y * (l[6] * X + l[7] * Y + 1) + l[3] * X + l[4] * Y + l[5]) / A
print("x row:", [sp.diff(residual_x, v) for v in l], "constant", sp.simplify(residual_x.subs({v: 0 for v in l})))
print("y row:", [sp.diff(residual_y, v) for v in l], "constant", sp.simplify(residual_y.subs({v: 0 for v in l})))
gx, gy = (g.ravel() for g in np.meshgrid(np.linspace(-500, 500, 21), np.linspace(-450, 450, 19)))
truth = np.array([-0.02, 1e-4, 0.3, -2e-4, -0.02, -0.2, 1e-6, -2e-6])
down = truth[6] * gx + truth[7] * gy + 1
ix, iy = -(truth[0] * gx + truth[1] * gy + truth[2]) / down, -(truth[3] * gx + truth[4] * gy + truth[5]) / down
zero, one = 0 * gx, 0 * gx + 1


def solve(third, last):
    rows = np.concatenate([
        np.stack([gx, gy, third, zero, zero, zero, ix * gx, last], axis=1),
        np.stack([zero, zero, zero, gx, gy, one, iy * gx, iy * gy], axis=1)])
    scale = np.maximum(np.abs(rows).max(axis=0), 1e-30)
    answer, _, rank, _ = np.linalg.lstsq(rows / scale, -np.concatenate([ix, iy]), rcond=1e-12)
    found = answer / scale
    d = found[6] * gx + found[7] * gy + 1
    error = np.hypot((found[0] * gx + found[1] * gy + found[2]) / d + ix, (found[3] * gx + found[4] * gy + found[5]) / d + iy)
    return rank, error.max()


for label, third, last in (("mended", one, ix * gy), ("yY/A in the last column of the x row", one, iy * gy)):
    rank, error = solve(third, last)
    print(f"{label}: rank {rank} of 8, largest error of a noise-free fit {1e3 * error:.1f} µm in an image {2 * ix.max():.0f} mm wide, tilted by a few mrad")
print(f"Z/A, with Z = 0, in the third column of the x row: rank {solve(zero, ix * gy)[0]} of 8, l3 cannot be determined")

section("Survey: x0, y0, fx, fy from l1..l11, q = l9² + l10² + l11²")
euler = sp.symbols("phi omega kappa")
rotation = sp.rot_axis1(euler[0]) * sp.rot_axis2(euler[1]) * sp.rot_axis3(euler[2])
numbers = {euler[0]: sp.Rational(3, 10), euler[1]: sp.Rational(-2, 10), euler[2]: sp.Rational(7, 10),
           XS: 3, YS: -5, ZS: 40, fx: sp.Rational(51, 1), fy: sp.Rational(515, 10), x0: sp.Rational(1, 10), y0: sp.Rational(-2, 10), tb: sp.Rational(1, 50)}
rot = rotation.subs(numbers)
entries = dict(zip([a1, b1, c1, a2, b2, c2, a3, b3, c3], list(rot)))
value = three.subs(entries).subs(numbers).evalf(30)
l_ = [value[i, j] for i in range(3) for j in range(4)]
q = l_[8] ** 2 + l_[9] ** 2 + l_[10] ** 2
dot = lambda i: sum(l_[i + j] * l_[8 + j] for j in range(3))
square = lambda i: sum(l_[i + j] ** 2 for j in range(3))
fx_found = sp.sqrt(square(0) / q - (dot(0) / q) ** 2)
print(f"given x0 0.1, y0 -0.2, fx 51, fy 51.5, tanβ 0.02: -(l1l9+l2l10+l3l11)/q = {float(-dot(0) / q):.6f}, -(l5l9+l6l10+l7l11)/q = {float(-dot(4) / q):.6f}")
print(f"sqrt((l1²+l2²+l3²)/q - x0²) = {float(fx_found):.6f} = fx/cosβ ({51 * (1 + 0.02**2) ** 0.5:.6f}); "
      f"sqrt((l5²+l6²+l7²)/q - y0²) = {float(sp.sqrt(square(4) / q - (dot(4) / q) ** 2)):.6f}")

section("Feng, section 2: four corners at radius ρ set to zero, K1 lens")
r, rho, K1 = sp.symbols("r rho K1")
scale = sp.solve(sp.Symbol("k") * (rho - K1 * rho**3) - rho, sp.Symbol("k"))[0]
table = r - scale * (r - K1 * r**3)
holds("the table holds K1·r·(r² - ρ²)/(1 - K1·ρ²)", table - K1 * r * (r**2 - rho**2) / (1 - K1 * rho**2))
holds("which is the same lens at f/(1 - K1·ρ²)", scale - 1 / (1 - K1 * rho**2))

section("Feng, section 2: storage of one table")
cells = 2160 * 1440
print(f"2160 x 1440 pixels x 2 coordinates: {cells * 8 / 1e6:.1f} MB in single, {cells * 16 / 1e6:.1f} MB in double precision; "
      f"1 GB holds {1e9 / (cells * 8):.0f} focus settings in single precision")

section("Feng, section 2: number of targets")
for width, height in ((1.0, 0.9), (1.1, 0.9)):
    columns, rows = round(width / 0.05) + 1, round(height / 0.05) + 1
    print(f"{width:.1f} m x {height:.1f} m at 5 cm: {columns} x {rows} = {columns * rows} targets")

section("Feng, section 2: interpolations, 15 x 10 targets 0.9 mm apart, lens of 1 % at the corner of 13.5 x 9 mm")
strength = -0.01 / (6.75**2 + 4.5**2)
columns, rows = 0.9 * (np.arange(15) - 7), 0.9 * (np.arange(10) - 4.5)
node_x, node_y = np.meshgrid(columns, rows)
bend = lambda x, y: (strength * x * (x**2 + y**2), strength * y * (x**2 + y**2))
node_dx, node_dy = bend(node_x, node_y)
at_x, at_y = (g.ravel() for g in np.meshgrid(np.linspace(-6.3, 6.3, 136), np.linspace(-4.05, 4.05, 91)))


def bilinear(values):
    i = np.clip(((at_x + 6.3) / 0.9).astype(int), 0, 13)
    j = np.clip(((at_y + 4.05) / 0.9).astype(int), 0, 8)
    s, t = (at_x - columns[i]) / 0.9, (at_y - rows[j]) / 0.9
    return (1 - s) * (1 - t) * values[j, i] + s * (1 - t) * values[j, i + 1] + (1 - s) * t * values[j + 1, i] + s * t * values[j + 1, i + 1]


def near(count):
    distance = (at_x[:, None] - node_x.ravel()) ** 2 + (at_y[:, None] - node_y.ravel()) ** 2
    order = np.argsort(distance, axis=1, kind="stable")[:, :count]
    return order, np.take_along_axis(distance, order, axis=1)


def mean_of_four(values):
    return values.ravel()[near(4)[0]].mean(axis=1)


def quadric(values):
    order, distance = near(13)
    answer = []
    for n, (index, square) in enumerate(zip(order, distance)):
        weight = 1 - square[:12] / square[12]
        u, v = node_x.ravel()[index[:12]] - at_x[n], node_y.ravel()[index[:12]] - at_y[n]
        design = np.stack([np.ones(12), u, v, u * u, u * v, v * v], axis=1) * weight[:, None]
        answer.append(np.linalg.lstsq(design, weight * values.ravel()[index[:12]], rcond=None)[0][0])
    return np.array(answer)


for name, way in (("bilinear", bilinear), ("moving quadric, 12 nearest", quadric), ("mean of 4 nearest", mean_of_four)):
    errors = 1e3 * np.concatenate([way(node) - true for node, true in zip((node_dx, node_dy), bend(at_x, at_y))])
    print(f"{name}: largest error {np.abs(errors).max():.2f} µm, rms {np.sqrt((errors**2).mean()):.3f} µm")

section("Feng, section 1: a homography of a pinhole image is a pinhole image")
random = np.random.default_rng(1)
camera = np.array([[-20.0, 0, 0.03], [0, -20, -0.02], [0, 0, 1]])
homography = np.eye(3) + random.normal(size=(3, 3)) * np.array([[1e-2, 1e-2, 0.1], [1e-2, 1e-2, 0.1], [1e-4, 1e-4, 0]])
first, second, third = homography @ camera
q = third @ third
x0_, y0_ = first @ third / q, second @ third / q
A_, B_, C_ = first @ first / q - x0_**2, second @ second / q - y0_**2, first @ second / q - x0_ * y0_
sine = -C_ / np.sqrt(A_ * B_)
tangent = sine / np.sqrt(1 - sine**2)
f_x, f_y = np.sqrt(A_ * (1 - sine**2)), np.sqrt(B_)
r3 = third / np.sqrt(q)
r2 = -(second / np.sqrt(q) - y0_ * r3) / f_y
r1 = -(first / np.sqrt(q) - x0_ * r3) / f_x + tangent * r2
turned = np.array([r1, r2, r3])
inner_ = np.array([[-f_x, f_x * tangent, x0_], [0, -f_y, y0_], [0, 0, 1]])
left = np.abs(inner_ @ turned * np.sqrt(q) - homography @ camera).max()
print(f"any homography times K is K'·R': f, x0, y0, B1, B2 and three angles, eight numbers; largest difference {0.0 if left < 1e-12 else left:.1f}, "
      f"R'R'ᵀ - 1 {0.0 if np.abs(turned @ turned.T - np.eye(3)).max() < 1e-12 else 1.0:.1f}")
