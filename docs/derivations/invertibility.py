"""Invertibility: conditions under which p -> p - D(p), measured to ideal, is one-to-one.

D is the library's evaluation form. Shows: over a disc, λ, a bound on the symmetric part of the
Jacobian of D, and q, a bound on its norm; λ < 1 makes the map strongly monotone, with an inverse
error of at most residual/(1 - λ), and q < 1 makes the fixed-point iteration contract; the
determinant alone is not enough; both bounds on the published lenses.
"""

import numpy as np
import sympy as sp

from common import grid, holds, published, section

print(__doc__.strip())

X, Y = sp.symbols("X Y", real=True)
hx, hy, gx, gy, b1, b2 = sp.symbols("hx hy gx gy b1 b2", real=True)
k = sp.symbols("k0:4", real=True)
p, h, G = sp.Matrix([X, Y]), sp.Matrix([hx, hy]), sp.Matrix([gx, gy])
R = X**2 + Y**2
identity = sp.eye(2)


def jacobian(displacement):
    return sp.Matrix(displacement).jacobian([X, Y])


def length(vector):
    return sp.sqrt(vector.dot(vector))


def have(claim, matrix, middle, half):
    """The symmetric part of the matrix has the eigenvalues middle ± half."""
    part = (matrix + matrix.T) / 2
    holds(claim, [part.trace() - 2 * middle, part.det() - (middle**2 - half**2)])


section("Jacobian of D = p·(g(R) + h·p) + g⃗·R + (b1·X + b2·Y, 0), R = |p|², part by part")
g = sum(k[n] * R**n for n in range(4))
slope = sum(n * k[n] * R**(n - 1) for n in range(1, 4))
radial = jacobian(p * g)
holds("radial: g·I + 2g'·p·pᵀ", radial - (g * identity + 2 * slope * p * p.T))
have("radial: eigenvalues g across the radius and g + 2Rg' along it", radial,
     g + R * slope, R * slope)
holds("g + 2Rg' = k0 + 3k1·R + 5k2·R² + 7k3·R³",
      g + 2 * R * slope - sum((2 * n + 1) * k[n] * R**n for n in range(4)))
with_h = jacobian(p * h.dot(p))
holds("h: (h·p)·I + p·hᵀ", with_h - (h.dot(p) * identity + p * h.T))
have("h: eigenvalues of the symmetric part (3h·p ± |h||p|)/2", with_h,
     3 * h.dot(p) / 2, length(h) * length(p) / 2)
with_g = jacobian(G * R)
holds("g⃗: 2g⃗·pᵀ", with_g - 2 * G * p.T)
have("g⃗: eigenvalues of the symmetric part g⃗·p ± |g⃗||p|", with_g,
     G.dot(p), length(G) * length(p))
affine = jacobian([b1 * X + b2 * Y, 0])
have("affinity: eigenvalues of the symmetric part (b1 ± hypot(b1, b2))/2", affine,
     b1 / 2, sp.sqrt(b1**2 + b2**2) / 2)
holds("affinity: norm hypot(b1, b2), as A·Aᵀ holds b1² + b2² alone",
      affine * affine.T - sp.diag(b1**2 + b2**2, 0))
print("""Over the disc |p| ≤ ρ the parts of h and g⃗ have norms of at most 2|h|ρ and 2|g⃗|ρ, and
their symmetric parts eigenvalues of at most as much. The largest eigenvalue and the norm of a sum
are at most the sums of those of its parts, so
    λ = max(g, g + 2Rg') + 2(|h| + |g⃗|)ρ + (b1 + hypot(b1, b2))/2
bounds the eigenvalues of the symmetric part, and
    q = max(|g|, |g + 2Rg'|) + 2(|h| + |g⃗|)ρ + hypot(b1, b2)
the norm, both maxima over 0 ≤ R ≤ ρ².""")

section("Consequences")
print("""Let F(p) = p - D(p), and s be the difference of two points of the disc. The segment
between them lies in the disc, and the mean of s·(I - J)s along it is s·ΔF, ΔF the difference of F
at the points. So s·ΔF ≥ (1 - λ)|s|², hence |ΔF| ≥ (1 - λ)|s|: for λ < 1 F is one-to-one, a
residual of length ε means an error of at most ε/(1 - λ), and the scale is at least 1 - λ in every
direction.
|ΔD| ≤ q|s|: for q < 1 the iteration d = D(ideal + d) contracts at the rate q.""")

section("Determinant alone")
turned = identity - jacobian(2 * p)
holds("D = 2p, a half turn: 1 - ∂xDx = 1 - ∂yDy = -1, determinant 1",
      [turned[0, 0] + 1, turned[1, 1] + 1, turned.det() - 1])
print("All three must be positive for a map to be one-to-one on a rectangle (Gale & Nikaidô 1965).")

section("Published lenses: bounds over the disc, largest values on 41 x 41 points of the format")
largest = 0
for name, f, (px, py), (half_x, half_y), K, (P1, P2) in published():
    rho = np.hypot(half_x + abs(px), half_y + abs(py))
    squares = np.linspace(0, rho**2, 2001)
    across = sum(K[n] * squares**n for n in range(4))
    along = sum((2 * n + 1) * K[n] * squares**n for n in range(4))
    decentring = 2 * (np.hypot(2 * P1, 2 * P2) + np.hypot(P1, P2)) * rho
    of_radius = np.array([across, along])
    bounds = [of_radius.max() + decentring, np.abs(of_radius).max() + decentring]
    x, y = grid(half_x, half_y, 41)
    x, y = x - px, y - py
    s = x * x + y * y
    gain = sum(K[n] * s**n for n in range(4))
    twice = 2 * sum(n * K[n] * s**(n - 1) for n in range(1, 4))
    mixed = twice * x * y + 2 * P2 * x + 2 * P1 * y
    dx_by_x = gain + twice * x * x + 6 * P1 * x + 2 * P2 * y
    dy_by_y = gain + twice * y * y + 6 * P2 * y + 2 * P1 * x
    matrices = np.array([[dx_by_x, mixed], [mixed, dy_by_y]]).transpose(2, 0, 1)
    values = np.linalg.eigvalsh(matrices)
    found = [values.max(), np.abs(values).max()]
    if found[0] > bounds[0] or found[1] > bounds[1]:
        raise SystemExit(f"{name}: {found} exceed {bounds}")
    largest = max(largest, bounds[1])
    shown = [round(float(value), 4) + 0.0 for value in bounds + found]
    print("{}: λ {:.4f}, q {:.4f}; found {:.4f} and {:.4f}".format(name, *shown))
print(f"largest q: {largest:.3f}")
