"""Li et al. 2018, eqs. 1-7: precise angle method.

Shows: (1) to first order in p, and its sign of p; (2)-(4) are the least-squares solution as printed; the two misprints of (7), in
∂D/∂W and in δ_f; what they and the missing δ_p and f do to the 1.9 µm; how much distortion a fitted principal distance hides.
"""

import numpy as np
import sympy as sp

from common import holds, section

print(__doc__.strip())

f, p, W, dW = sp.symbols("f p W dW")

section("(1)")
T = sp.tan(W)
exact = f * sp.tan(W - dW) + f * sp.tan(dW)  # from the centre O; principal point P where the angle is dW
linear = sp.series(exact, dW, 0, 2).removeO()
holds("undistorted image: L = f·tanW - p·tan²W to first order, p = f·ΔW", sp.simplify(linear - (f * T - f * dW * T**2)))
D = sp.Symbol("L") - f * T + p * T**2

section("(2)-(4): normal equations, sums S_jk = Σ L^j·tan^k W")
S12, S11, S2, S3, S4 = sp.symbols("S12 S11 S2 S3 S4")
answer = sp.solve([f * S2 - p * S3 - S11, f * S3 - p * S4 - S12], [f, p], dict=True)[0]
bottom = S3**2 - S2 * S4
holds("(2) as printed", [answer[f] - (S12 * S3 - S11 * S4) / bottom, answer[p] - (S12 * S2 - S11 * S3) / bottom])
holds("(3), (4) as printed", [sp.solve(f * S2 - S11, f)[0] - S11 / S2, sp.solve(f * S3 - p * S4 - S12, p)[0] - (f * S3 - S12) / S4])

section("(7)")
right = sp.diff(D, W)
sec = 1 / sp.cos(W)
holds("∂D/∂W = -f·sec²W + 2p·tanW·sec²W", right - (-f * sec**2 + 2 * p * T * sec**2))
remainder = sp.simplify((right - (-f * sec**2 - 2 * p * T * sec**2)) / (4 * p * T * sec**2))
holds("the printed one is smaller by 4p·tanW·sec²W", remainder - 1)
T1, T2, L1, L2, W1, W2 = sp.symbols("T1 T2 L1 L2 W1 W2")
two = (L1 * T1 + L2 * T2) / (T1**2 + T2**2)  # (3) with two points
holds("δ_f² by δ_L is δ_L²/Σtan²W", sp.diff(two, L1) ** 2 + sp.diff(two, L2) ** 2 - 1 / (T1**2 + T2**2))
angles = two.subs({T1: sp.tan(W1), T2: sp.tan(W2)})
sensitivity = sp.diff(angles, W1).subs({L1: f * sp.tan(W1), L2: f * sp.tan(W2)})
holds("δ_f² by δ_W is ΣL²sec⁴W·δ_W²/(Σtan²W)² as printed, where L = f·tanW",
      sp.simplify(sensitivity + f * sp.tan(W1) / sp.cos(W1) ** 2 / (sp.tan(W1) ** 2 + sp.tan(W2) ** 2)))

section("Budget at the edge: δ_L = 1.3 µm, δ_W = 0.5\", 29 points evenly over ±18°")
angle = np.radians(np.linspace(-18, 18, 29))
tan = np.tan(angle)
sec2 = 1 + tan**2
dl, dw = 1.3, np.radians(0.5 / 3600)
t2 = (tan**2).sum()
edge = tan[-1]
print(f"Σtan²W = {t2:.4f}")


def budget(mm, printed=False, with_p=False):
    um = mm * 1e3
    of_f = dl**2 / (t2**2 if printed else t2) + ((um * tan) ** 2 * sec2**2).sum() / t2**2 * dw**2
    total = dl**2 + (um * sec2[-1] * dw) ** 2 + edge**2 * of_f
    if with_p:
        t4 = (tan**4).sum()  # (4) with f known: δ_p² by δ_L, and by δ_W through L - f·tanW
        total += edge**4 * (dl**2 / t4 + ((um * sec2 * tan**2) ** 2).sum() / t4**2 * dw**2)
    return float(np.sqrt(total))


for mm in (218, 473):
    print(f"f = {mm} mm: mended {budget(mm):.2f} µm, δ_f as printed {budget(mm, printed=True):.2f} µm, mended with δ_p {budget(mm, with_p=True):.2f} µm")
low, high = 100.0, 1000.0
for _ in range(60):
    low, high = ((low + high) / 2, high) if budget((low + high) / 2) < 1.9 else (low, (low + high) / 2)
print(f"1.90 µm without δ_p asks for f = {low:.0f} mm; 1.9 mm of bow at the edge for 0.5° across asks for f = {1.9 / np.tan(np.radians(0.5)):.0f} mm")
for count in (15, 29, 101):
    t = np.tan(np.radians(np.linspace(-18, 18, count)))
    print(f"{count} points: Σtan²W = {(t**2).sum():.3f}, δ_f by δ_L {dl / np.sqrt((t**2).sum()):.3f} µm, printed {dl / (t**2).sum():.3f} µm")

section("Section 2.3: distortion that a fitted principal distance hides; f0 = 218 mm, cubic distortion of 3.7 % at 18°")
f0 = 218.0
length = f0 * tan * (1 + 0.037 * (tan / edge) ** 2)
best = (length * tan).sum() / t2
print(f"about f0: {f0 * edge * 0.037:.2f} mm at the edge; about the fitted f = {best:.2f} mm (3): {length[-1] - best * edge:.2f} mm")
