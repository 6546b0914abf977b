# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy==2.4.6", "scipy==1.17.1"]
# ///
"""Writes model-core/tests/golden/dhrf_index_reference.csv: DHRF_spec and its derivatives for real and complex index.

    uv run model-core/tools/dhrf_index_reference.py > model-core/tests/golden/dhrf_index_reference.csv

Shares with the crate only the change of variables to facet slopes. Kinks come from the roots of polynomials and from the
unfactored inequalities, panels from bisection at multiples of sigma, tanh-sinh across and 24-point Gauss along each
column, the Fresnel factor from the textbook's complex amplitudes, and both derivatives from seven-point differences of
the whole integral. Before the table is written, the method is checked against nested adaptive integration of the
printed BRDF over the viewing hemisphere (scipy), which knows nothing of slopes.
"""
import sys

import numpy as np
from scipy import integrate

GAUSS_X, GAUSS_W = np.polynomial.legendre.leggauss(24)
REACH = 6.6  # exp(-6.6^2) = 1e-19


def tanh_sinh():
    t = np.arange(-3.4, 3.4001, 0.1)
    u = 0.5 * np.pi * np.sinh(t)
    x = np.tanh(u)
    w = 0.1 * 0.5 * np.pi * np.cosh(t) / np.cosh(u) ** 2
    # distance to the nearer end, without cancellation
    end = 1 / (np.exp(np.abs(u)) * np.cosh(u))
    return x, w, end


DE_X, DE_W, DE_END = tanh_sinh()


def fresnel(n, kappa, c):
    """Textbook amplitudes, complex index."""
    m = complex(n, kappa)
    g = np.sqrt(m * m - (1 - c * c) + 0j)
    r_s = (c - g) / (c + g)
    r_p = (m * m * c - g) / (m * m * c + g)
    return 0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2)


def panels(a, b, marks):
    inner = [m for m in marks if a < m < b]
    edges = [a, *inner, b]
    return zip(edges[:-1], edges[1:])


def slopes(theta_deg, sigma):
    """cos theta_a and weight of every node."""
    cs = np.sin(np.radians(90 - theta_deg))
    ss = np.sin(np.radians(theta_deg))
    t = ss / cs
    root = np.hypot(t, 1)
    x0, x1 = -1 / (t + root), t + root
    # w (1 + x^2) = 4 w - 2 (1 + x^2), w = 1 + t x; and w = 2; and w = 1 + x^2
    cubic = [r.real for r in np.roots([t, 3, -3 * t, -1]) if abs(r.imag) < 1e-9]
    kinks = sorted([x0, x1, t, 1 / t if t > 1e-12 else 1e9, *cubic])
    marks = sorted({*kinks, *(sigma * k for k in np.arange(-REACH, REACH + 0.01, 1.1))})
    cosines, weights = [], []
    for a, b in panels(max(x0, -REACH * sigma), min(x1, REACH * sigma), marks):
        half = 0.5 * (b - a)
        for z, wz, end in zip(DE_X, DE_W, DE_END):
            x = a + half * end if z < 0 else b - half * end
            if not a < x < b:
                continue
            w = 1 + x * t
            level = min(w, 2.0)
            y_h2 = 2 * w - 1 - x * x
            y_k2 = 4 * w / (level + 2) - 1 - x * x
            if y_h2 <= 0:
                continue
            y_h, y_k = np.sqrt(y_h2), np.sqrt(max(0.0, y_k2))
            ys = sorted({y_k, *(sigma * k for k in np.arange(0, REACH + 0.01, 1.1))})
            for lo, hi in panels(0.0, min(y_h, REACH * sigma), ys):
                y = 0.5 * (lo + hi) + 0.5 * (hi - lo) * GAUSS_X
                r2 = 1 + x * x + y * y
                height = np.clip(np.minimum(level, 4 * w / r2 - 2), 0, None)
                cosines.append((cs + x * ss) / np.sqrt(r2))
                scaled = (x * x + y * y) / sigma**2
                weights.append((half * wz) * (hi - lo) * GAUSS_W * height * np.exp(-scaled) / (np.pi * sigma**2))
    return np.concatenate(cosines), np.concatenate(weights)


def total(nodes, n, kappa):
    c, w = nodes
    return float(np.sum(w * fresnel(n, kappa, c)))


STENCIL = [(-3, -1 / 60), (-2, 9 / 60), (-1, -45 / 60), (1, 45 / 60), (2, -9 / 60), (3, 1 / 60)]


def row(n, kappa, sigma, theta):
    nodes = slopes(theta, sigma)
    value = total(nodes, n, kappa)
    h = 0.008 * min(n - 1 + kappa, 1)
    d_n = sum(k * total(nodes, n + i * h, kappa) for i, k in STENCIL) / h
    h = 0.012 * sigma
    d_sigma = sum(k * total(slopes(theta, sigma + i * h), n, kappa) for i, k in STENCIL) / h
    return value, d_n, d_sigma


def printed(n, kappa, sigma, theta_deg):
    """Equations 6 to 10 as printed with K = 4 pi, integrated over the views."""
    ts = np.radians(theta_deg)

    def f(phi, tv):
        cos2a = np.cos(ts) * np.cos(tv) + np.sin(ts) * np.sin(tv) * np.cos(phi)
        ca = np.sqrt((1 + cos2a) / 2)
        cal = (np.cos(ts) + np.cos(tv)) / (2 * ca)
        g = min(1, 2 * cal * np.cos(tv) / ca, 2 * cal * np.cos(ts) / ca)
        tan2 = 1 / cal**2 - 1
        brdf = fresnel(n, kappa, ca) * g * np.exp(-tan2 / sigma**2) / (4 * np.pi * np.cos(ts) * np.cos(tv) * sigma**2 * cal**4)
        return 2 * brdf * np.cos(tv) * np.sin(tv)

    return integrate.dblquad(f, 0, np.pi / 2, 0, np.pi, epsabs=1e-9, epsrel=1e-8)[0]


def main():
    rng = np.random.default_rng(20050915)
    for n, kappa, sigma, theta in [(1.4, 0.0, 0.5, 30.0), (1.5, 2.0, 0.4, 60.0), (3.0, 4.0, 0.7, 75.0)]:
        a, b = total(slopes(theta, sigma), n, kappa), printed(n, kappa, sigma, theta)
        print(f"check: n={n} kappa={kappa} sigma={sigma} theta_s={theta}: {a:.12f}, printed {b:.12f}", file=sys.stderr)
        assert abs(a / b - 1) < 1e-6
    print("# source:    computed for leafbrdf, tools/dhrf_index_reference.py (numpy 2.4.6, scipy 1.17.1), seed 20050915")
    print("# made by:   kink-split tanh-sinh x Gauss quadrature over facet slopes, complex Fresnel amplitudes, derivatives by")
    print("#            seven-point differences of the integral; the script checks itself against the printed BRDF")
    print("# columns:   index n + i kappa, sigma unitless; theta_s in degrees; DHRF_spec for K = 4 pi; its derivatives")
    print("# tolerance: about 1e-12 relative (value); 1e-8 of the larger of value/sigma and |d| (derivatives)")
    print("n,kappa,sigma,theta_s_deg,dhrf_4pi,d_n,d_sigma")
    metals = [(1.0, 6.7), (1.0, 0.3), (2.5, 8.0), (1.0, 15.0), (30.0, 40.0)]
    thetas = [0.0, 8.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.5, 89.9]
    sigmas = [0.005, 0.01, 0.03, 0.08, 0.15, 0.3, 0.5, 0.8, 1.0, 2.0]
    for i in range(400):
        theta = thetas[i % 10] if i % 3 else round(float(rng.uniform(0, 89.9)), 2)
        sigma = sigmas[(i // 10) % 10] if i % 4 else round(float(0.005 * 400 ** rng.uniform()), 4)
        if i % 10 == 9 or rng.uniform() < 0.1:
            n, kappa = metals[rng.integers(len(metals))]
        else:
            n = round(float(1 + 0.1 * 40 ** rng.uniform()), 3)
            kappa = [0.0, 0.001, 0.1][rng.integers(3)] if rng.uniform() < 0.5 else round(float(rng.uniform(0, 5)), 3)
        value, d_n, d_sigma = row(n, kappa, sigma, theta)
        print(f"{n},{kappa},{sigma},{theta},{value!r},{d_n!r},{d_sigma!r}", flush=True)


if __name__ == "__main__":
    main()
