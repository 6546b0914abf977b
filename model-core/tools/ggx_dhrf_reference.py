# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy==2.4.6", "scipy==1.17.1"]
# ///
"""Writes model-core/tests/golden/ggx_dhrf_reference.csv: DHRF_spec of GGX facets with Smith's masking, and its derivatives.

    uv run model-core/tools/ggx_dhrf_reference.py > model-core/tests/golden/ggx_dhrf_reference.csv

Shares with the crate only the change of variables to facet slopes. Here they are Cartesian (the crate's are polar): panels
halved towards every end and towards the lobe, 14-point Gauss on each; D, G and the Fresnel amplitudes are the printed ones;
both derivatives are seven-point differences of the whole integral. Before the table is written, the method is checked
against nested adaptive integration of the printed BRDF over the viewing hemisphere (scipy), which knows nothing of slopes.
"""
import sys

import numpy as np
from scipy import integrate

GAUSS_X, GAUSS_W = np.polynomial.legendre.leggauss(14)
SEVEN = ((1, 45 / 60), (2, -9 / 60), (3, 1 / 60))


def fresnel(n, kappa, c):
    """Textbook amplitudes, complex index."""
    m = complex(n, kappa)
    g = np.sqrt(m * m - (1 - c * c) + 0j)
    r_s = (c - g) / (c + g)
    r_p = (m * m * c - g) / (m * m * c + g)
    return 0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2)


def density(cos2_alpha, tan2_alpha, sigma):
    """D = sigma^2/(pi q^2), q = 1 - (1 - sigma^2) cos^2 alpha; sin^2 alpha taken from the tangent."""
    q = cos2_alpha * tan2_alpha + sigma**2 * cos2_alpha
    return sigma**2 / (np.pi * q * q)


def smith(cs, cv, sigma):
    """1/(1 + Lambda_s + Lambda_v)."""

    def lam(c):
        tan2 = (1 - c * c) / (c * c)
        return 0.5 * (np.sqrt(1 + sigma**2 * tan2) - 1)

    return 1 / (1 + lam(cs) + lam(cv))


def halved(a, b, centre, scale):
    """Edges between a and b: doubling away from the centre, halving towards a and b."""
    edges = {a, b}
    step = scale / 4
    while step < 4 * (b - a):
        edges.update(e for e in (centre - step, centre + step) if a < e < b)
        step *= 2
    gap = (b - a) / 2
    for _ in range(26):
        edges.update((a + gap, b - gap))
        gap /= 2
    return sorted(edges)


def gauss(edges):
    lo, hi = np.array(edges[:-1]), np.array(edges[1:])
    half = 0.5 * (hi - lo)
    keep = half > 0
    mid, half = (0.5 * (hi + lo))[keep], half[keep]
    return (mid[:, None] + half[:, None] * GAUSS_X).ravel(), (half[:, None] * GAUSS_W).ravel()


def nodes(theta_deg, sigma):
    """x, y and weight of all nodes in the disc of views above the horizon, y > 0 counted twice."""
    cs, ss = np.sin(np.radians(90 - theta_deg)), np.sin(np.radians(theta_deg))
    t = ss / cs
    x0, x1 = -cs / (1 + ss), (1 + ss) / cs
    xs, wx = gauss(halved(x0, x1, 0.0, sigma))
    out = []
    for x, w in zip(xs, wx):
        y_h2 = (x - x0) * (x1 - x)
        if y_h2 <= 0:
            continue
        y_h = np.sqrt(y_h2)
        ys, wy = gauss(halved(0.0, y_h, 0.0, np.hypot(sigma, x)))
        out.append((np.full(ys.size, x), ys, 2 * w * wy, np.full(ys.size, y_h)))
    return cs, ss, t, [np.concatenate(c) for c in zip(*out)]


def integrand(cs, ss, x, y, y_h, weight, sigma):
    """cos theta_a and the weight of F: D cos(theta_v) G/(4 cs cv) dOmega_v."""
    r2 = x * x + y * y
    tan2, cos2 = r2, 1 / (1 + r2)
    cos_a = (cs + x * ss) * np.sqrt(cos2)
    # 2 cos(theta_a) cos(alpha) - cs, in the form that vanishes on the horizon
    cv = cs * (y_h - y) * (y_h + y) * cos2
    # dOmega_v = 4 cos(theta_a) dOmega_h, dOmega_h = cos^3(alpha) dx dy
    return cos_a, weight * density(cos2, tan2, sigma) * smith(cs, cv, sigma) / cs * cos_a * cos2**1.5


def reference(n, kappa, theta_deg, sigma):
    cs, ss, _, (x, y, w, y_h) = nodes(theta_deg, sigma)
    cos_a, weight = integrand(cs, ss, x, y, y_h, w, sigma)
    value = np.sum(weight * fresnel(n, kappa, cos_a))
    mirror = np.sum(weight)
    h = 2e-3 * (n - 1)
    d_n = sum(
        c * (np.sum(weight * fresnel(n + k * h, kappa, cos_a)) - np.sum(weight * fresnel(n - k * h, kappa, cos_a)))
        for k, c in SEVEN
    ) / h
    h = 4e-3 * sigma
    f = fresnel(n, kappa, cos_a)
    d_sigma = sum(
        c
        * (
            np.sum(f * integrand(cs, ss, x, y, y_h, w, sigma + k * h)[1])
            - np.sum(f * integrand(cs, ss, x, y, y_h, w, sigma - k * h)[1])
        )
        for k, c in SEVEN
    ) / h
    return value, mirror, d_n, d_sigma


def over_the_views(n, kappa, theta_deg, sigma):
    """The printed BRDF over theta_v and phi_v, nested adaptive."""
    ts = np.radians(theta_deg)
    cs, ss = np.cos(ts), np.sin(ts)

    def brdf(tv, phi):
        cv, sv = np.cos(tv), np.sin(tv)
        cos_a = np.sqrt((1 + cs * cv + ss * sv * np.cos(phi)) / 2)
        cos_alpha = (cs + cv) / (2 * cos_a)
        q = 1 - (1 - sigma**2) * cos_alpha**2
        d = sigma**2 / (np.pi * q * q)
        return fresnel(n, kappa, cos_a) * d * smith(cs, cv, sigma) / (4 * cs * cv) * cv * sv

    def inner(tv):
        return integrate.quad(lambda p: brdf(tv, p), 0, np.pi, points=[np.pi - 2 * sigma], epsabs=1e-13, epsrel=1e-11, limit=400)[0]

    marks = [m for m in (ts - sigma, ts, ts + sigma) if 0 < m < np.pi / 2]
    return 2 * integrate.quad(inner, 0, np.pi / 2, points=marks or None, epsabs=1e-12, epsrel=1e-10, limit=400)[0]


def check():
    worst = 0.0
    for n, kappa, theta, sigma in [(1.5, 0, 0, 0.3), (1.45, 0, 40, 0.15), (1.3, 0, 60, 0.5), (2.0, 1.5, 75, 1.0), (1.6, 0, 85, 0.25)]:
        worst = max(worst, abs(reference(n, kappa, theta, sigma)[0] / over_the_views(n, kappa, theta, sigma) - 1))
    print(f"slopes against views: worst relative difference {worst:.1e}", file=sys.stderr)
    assert worst < 1e-9


def main():
    check()
    rng = np.random.default_rng(1975)
    print("# source:    computed for leafbrdf, tools/ggx_dhrf_reference.py (numpy 2.4.6, scipy 1.17.1), seed 1975")
    print("# made by:   Gauss on halved panels over Cartesian facet slopes, printed D and G, complex Fresnel amplitudes, derivatives")
    print("#            by seven-point differences of the integral; the script checks itself against the printed BRDF")
    print("# columns:   index n + i kappa, sigma unitless; theta_s in degrees; DHRF_spec of GGX-Smith for K = 4 pi; the same for F = 1;")
    print("#            derivatives of the former")
    print("# tolerance: 1e-12 relative (values); 1e-9 of value/n and value/sigma (derivatives)")
    print("n,kappa,sigma,theta_s_deg,dhrf_4pi,dhrf_F1_4pi,d_n,d_sigma")
    thetas = [0, 8, 21, 30, 41, 45, 60, 75, 80, 85, 88, 89]
    sigmas = [0.01, 0.02, 0.05, 0.078, 0.1, 0.25, 0.29, 0.46, 0.5, 0.75, 1.0]
    for i in range(264):
        if i < 132:
            theta, sigma = thetas[i % 12], sigmas[i // 12]
        else:
            theta = round(float(rng.uniform(0, 89) if i % 2 else 89 * (1 - rng.uniform() ** 2 / 2)), 2)
            sigma = round(float(10 ** rng.uniform(-2, 0)), 4)
        n = round(float(1 + 10 ** rng.uniform(np.log10(0.05), np.log10(4))), 3)
        kappa = round(float(rng.uniform(0, 3)), 3) if i % 4 == 3 else 0.0
        value, mirror, d_n, d_sigma = (float(v) for v in reference(n, kappa, theta, sigma))
        print(f"{n},{kappa},{sigma},{theta},{value!r},{mirror!r},{d_n!r},{d_sigma!r}")


if __name__ == "__main__":
    main()
