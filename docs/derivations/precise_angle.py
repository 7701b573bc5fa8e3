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

section("(1) on a lens of large distortion")
k, W0 = sp.symbols("k W0")
turned = sp.tan(W - W0)
lens = p + f * turned + f * k * turned**3  # zero of W in the middle of the line: W0 = p/f to first order
first = sp.series(lens.subs(W0, dW * p / f), dW, 0, 2).removeO().subs(dW, 1)
Tx = sp.Symbol("T")
expected = f * Tx + f * k * Tx**3 - p * (1 + 3 * k) * Tx**2 - 3 * k * p * Tx**4
holds("L = f·T + f·k·T³ - p(1 + 3k)T² - 3kp·T⁴ to first order in p, T = tanW", sp.expand(first.subs(sp.tan(W), Tx) - expected))


def lens_places(f0, share, angles, p_mm=0.065):
    """Places of a lens with a cubic distortion of the ideal place, `share` at 18°."""
    cubic = share / (f0 * np.tan(np.radians(18))) ** 2
    zero = -p_mm
    for _ in range(50):
        zero = -p_mm - cubic * zero**3
    ideal = f0 * np.tan(angles + np.arctan(zero / f0))
    return p_mm + ideal + cubic * ideal**3


def fits(places, angles):
    """f and p of (2), f of (3), f0 of the quartic (6) weighted by tanW without W = 0, f0 of the unweighted one."""
    t = np.tan(angles)
    f2, p2 = np.linalg.lstsq(np.c_[t, -(t**2)], places, rcond=None)[0]
    f3 = (places * t).sum() / (t**2).sum()
    used = np.abs(t) > 1e-9
    unit = np.abs(places).max()
    powers = np.stack([(places[used] / unit) ** n for n in range(5)], axis=1)
    weighted = np.linalg.lstsq(powers * t[used, None], places[used], rcond=None)[0][0]
    plain = np.linalg.lstsq(powers, places[used] / t[used], rcond=None)[0][0]
    return np.array([f2, p2, f3, weighted, plain])


def sigmas(function, places, angles):
    """σ of the numbers of a function of places and angles, by differences: δ_L = 1.3 µm, δ_W = 0.5\"."""
    total = 0
    for i in range(len(angles)):
        for by_place in (True, False):
            def moved(sign):
                l, w = places.copy(), angles.copy()
                (l if by_place else w)[i] += sign * (1.3e-3 if by_place else dw)
                return function(l, w)
            total = total + ((moved(1) - moved(-1)) / 2) ** 2
    return np.sqrt(total)


def paraxial(places, angles):
    """D of (1) about f0 of the quartic with p of (2)."""
    found = fits(places, angles)
    t = np.tan(angles)
    return places - found[3] * t + found[1] * t**2


for f0 in (218.0, 473.0):
    places = lens_places(f0, 0.037, angle)
    found, sigma = fits(places, angle), sigmas(fits, places, angle)
    at_edge = paraxial(places, angle)[-1] - (places[-1] - f0 * edge + 0.065 * edge**2)
    spread = sigmas(paraxial, places, angle)
    print(f"f0 = {f0:.0f} mm, 3.7 %, p = 0.065 mm: p of (2) {found[1]:.3f} mm, {found[1] / 0.065:.1f} times the true one; f of (2) f0 + {found[0] - f0:.3f} mm")
    print(f"  f0 of the quartic: bias {1e3 * (found[3] - f0):+.1f} µm, σ {1e3 * sigma[3]:.1f} µm, {sigma[3] / sigma[2]:.1f} times δ_f of (3), {1e3 * sigma[2]:.1f} µm; "
          f"without weights σ {1e3 * sigma[4]:.0f} µm")
    print(f"  D at the edge about it: bias {1e3 * at_edge:+.1f} µm, σ {1e3 * spread[-1]:.1f} µm")
short = np.radians(np.linspace(-17, 16.4, 29))
narrow = lens_places(218.0, 0.026, short)
print(f"f0 = 218 mm, 2.6 %, -17° to 16.4°: p of (2) {fits(narrow, short)[1]:.3f} mm, {fits(narrow, short)[1] / 0.065:.1f} times")
flat = lens_places(218.0, 0.0003, angle)
print(f"f0 = 218 mm, 0.03 %: p of (2) {fits(flat, angle)[1]:.4f} mm, quartic f0 + {1e3 * (fits(flat, angle)[3] - 218):.1f} µm")

section("Table 1")
for f0 in (218.0, 473.0):
    of_percent = f0 * edge * 1e3 / 100
    print(f"f0 = {f0:.0f} mm: 3.70 against 3.729 % of the design is {0.029 * of_percent:.0f} µm at the edge, {0.029 * of_percent / 1.8:.0f} times 1.8 µm; "
          f"3.696 to 3.700 % of the bands is {0.004 * of_percent:.1f} µm")
