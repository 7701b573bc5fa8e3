"""Zhao et al. 2013: index of the general polynomial, printed as k = (i×i+j)/2+j; and the ground sample distance.

Shows: with the second letter of i×i+j read as i the terms of a cubic are numbered 0 to 9 without gap; as printed four are
no whole numbers and two coincide.
"""

from fractions import Fraction

from common import section

print(__doc__.strip())

section("Terms X^(i-j)·Y^j, j = 0..i, i = 0..3")
right, printed = [], []
for i in range(4):
    for j in range(i + 1):
        right.append(Fraction(i * i + i, 2) + j)
        printed.append(Fraction(i * i + j, 2) + j)
        print(f"i = {i}, j = {j}: (i×i+i)/2+j = {right[-1]}, printed (i×i+j)/2+j = {printed[-1]}")
if right != list(range(10)):
    raise SystemExit("not 0 to 9")
print(f"mended: 0 to 9, {len(right)} coefficients per axis; printed: {sum(k.denominator != 1 for k in printed)} of {len(printed)} are not whole, {len(set(printed))} different")
print(f"with i, j = 1, 2, 3 as printed the constant and the pure X terms are missing: {sum(1 for i in range(1, 4) for j in range(1, i + 1))} terms")

section("Ground sample distance")
print(f"12 µm x 3900 m / 170 mm = {12e-6 * 3900 / 0.170:.3f} m")
