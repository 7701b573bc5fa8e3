"""Yuan et al. 2012, eq. 28, abstract and section 4: accuracies.

Shows: the divisor of (28) and what the printed one does to σ; what 0.29 m and 0.18 m are as ratio and reduction; how far a
fit to ten control points lowers their own residuals without any gain in accuracy; travels of section 4.1.
"""

import math

from common import section

print(__doc__.strip())

section("(28): 2n observations, 5 parameters")
for n in (10, 100, 441, 10**6):
    print(f"n = {n}: n - 5 = {n - 5}, 2n - 5 = {2 * n - 5}, printed σ too large by a factor {math.sqrt((2 * n - 5) / (n - 5)):.3f}")
factor = math.sqrt((2 * 441 - 5) / (441 - 5))
print(f"the limit is sqrt 2 = {math.sqrt(2):.3f}; with n = 441, σ = 1.2 µm as printed is {1.2 / factor:.2f} µm per coordinate")

section("Abstract and section 4.2: 0.29 m and 0.18 m")
print(f"ratio {0.29 / 0.18:.2f}, reduction {100 * (0.29 - 0.18) / 0.29:.1f} %; 1 + 0.379 = {1 + (0.29 - 0.18) / 0.29:.2f}")
print(f"within the rounding of both: ratio {0.285 / 0.185:.2f} to {0.295 / 0.175:.2f}, reduction {100 * (1 - 0.185 / 0.285):.1f} to {100 * (1 - 0.175 / 0.295):.1f} %")

section("Ten control points, 20 coordinates of pure noise: residuals with five more parameters over residuals without")
print(f"position and attitude held: {math.sqrt((20 - 5) / 20):.2f}; six more parameters free in both: {math.sqrt((20 - 11) / (20 - 6)):.2f}; printed 0.18/0.29: {0.18 / 0.29:.2f}")

section("Travels of section 4.1, f = 100 mm (the paper gives no f)")
print(f"V/H 0.05 1/s, 1/700 s: {100 * 0.05 / 700 * 1e3:.1f} µm; V/H 0.17 1/s, 1/100 s: {100 * 0.17 / 100 * 1e3:.0f} µm; δ <= 0.015 in millimetres: 15 µm")
