# /// script
# requires-python = ">=3.11"
# dependencies = ["mpmath==1.4.1"]
# ///
"""Writes model-core/tests/golden/extended_reference.csv: the tilted leaf with GGX-Smith or Beckmann facets over a P1 interior.

    uv run model-core/tools/extended_reference.py > model-core/tests/golden/extended_reference.csv

Shares nothing with the crate: 60 digits, vectors in the instrument's frame, every equation as printed (the sine of the
tilt of a facet from its cosine, D = sigma^2/(pi q^2), Smith's Lambda, Fresnel amplitudes with Snell's law), and derivatives
from differences with a step of 1e-20.
"""
import random
import sys

import mpmath as mp

mp.mp.dps = 60
STEP = mp.mpf(10) ** -20


def unit(v):
    length = mp.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def fresnel(n, c):
    sin_t = mp.sqrt(1 - c * c) / n
    t = mp.sqrt(1 - sin_t * sin_t)
    r_s = (c - n * t) / (c + n * t)
    r_p = (n * c - t) / (n * c + t)
    return (r_s**2 + r_p**2) / 2


def ggx(cos_alpha, sigma):
    q = 1 - (1 - sigma**2) * cos_alpha**2
    return sigma**2 / (mp.pi * q * q)


def smith(cs, cv, sigma):
    def lam(c):
        tangent2 = (1 - c * c) / (c * c)
        return (mp.sqrt(1 + sigma**2 * tangent2) - 1) / 2

    return 1 / (1 + lam(cs) + lam(cv))


def beckmann(cos_alpha, sigma):
    tan2 = (1 - cos_alpha**2) / cos_alpha**2
    return mp.exp(-tan2 / sigma**2) / (mp.pi * sigma**2 * cos_alpha**4)


def v_cavity(cs, cv, cos_alpha, cos_a):
    return min(mp.mpf(1), 2 * cos_alpha * cv / cos_a, 2 * cos_alpha * cs / cos_a)


def measured(theta_s, theta_v, phi, n, sigma, a, b, k, t_x, t_y, facets):
    """cos(theta_s')/cos(theta_s) times the BRDF about the tilted normal (K = 4 pi); None below its horizon."""
    s = [mp.sin(theta_s), mp.mpf(0), mp.cos(theta_s)]
    v = [mp.sin(theta_v) * mp.cos(phi), mp.sin(theta_v) * mp.sin(phi), mp.cos(theta_v)]
    normal = unit([mp.tan(t_x), mp.tan(t_y), mp.mpf(1)])
    half = unit([x + y for x, y in zip(s, v)])
    cs, cv, cos_alpha, cos_a = dot(s, normal), dot(v, normal), dot(half, normal), dot(half, s)
    if cs <= 0 or cv <= 0:
        return None
    if facets == "ggx":
        lobe = ggx(cos_alpha, sigma) * smith(cs, cv, sigma)
    else:
        lobe = beckmann(cos_alpha, sigma) * v_cavity(cs, cv, cos_alpha, cos_a)
    specular = fresnel(n, cos_a) * lobe / (4 * cs * cv)
    shape = (1 - a * cs * cv - b * (dot(s, v) - cs * cv)) / (mp.pi * (1 - 2 * a / 3))
    return cs / mp.cos(theta_s) * (k * shape + specular)


def main():
    random.seed(1967)
    print(f"# source:    computed for leafbrdf, tools/extended_reference.py (mpmath {mp.__version__}, 60 digits), seed 1967")
    print("# made by:   printed equations on vectors in the instrument's frame; derivatives by differences with a step of 1e-20")
    print("# columns:   facets 0 = GGX with Smith's masking, 1 = Beckmann with V-cavities; angles and tilt in degrees; k_L; K = 4 pi;")
    print("#            cos(theta_s')/cos(theta_s) BRDF in 1/sr and its derivatives, those by the tilt per radian")
    print("# tolerance: exact to the digits written")
    print(
        "facets,theta_s_deg,theta_v_deg,phi_v_deg,n,sigma,a,b,k_l,in_plane_deg,lateral_deg,value,d_n,d_sigma,d_a,d_b,d_in_plane,d_lateral"
    )
    rows = 0
    while rows < 800:
        facets = "ggx" if rows < 600 else "beckmann"
        level = rows % 5 == 0
        sigma = round(10 ** random.uniform(-2 if facets == "ggx" else -1, 0), 4)
        theta_s = round(random.choice([random.uniform(0, 80), 8, 21, 41, 60, 0.0, 85.0]), 2)
        if rows % 2:
            # near the mirror direction, where the lobe is
            theta_v = round(min(85, abs(theta_s + 60 * sigma * random.gauss(0, 1))), 2)
            phi = round(180 + 60 * sigma * random.gauss(0, 1), 2)
        else:
            theta_v, phi = round(random.uniform(0, 85), 2), round(random.uniform(-180, 180), 2)
        n = round(1 + 10 ** random.uniform(-1.3, 0.6), 3)
        a, b, k = (round(random.uniform(low, 0.9), 3) for low in (-0.9, -0.9, 0.0))
        t_x, t_y = (0.0, 0.0) if level else (round(random.gauss(0, 4), 2), round(random.gauss(0, 4), 2))
        degrees = [mp.mpf(repr(x)) * mp.pi / 180 for x in (theta_s, theta_v, phi)]
        at = [mp.mpf(repr(x)) for x in (n, sigma, a, b, k)] + [mp.mpf(repr(t)) * mp.pi / 180 for t in (t_x, t_y)]
        value = measured(*degrees, *at, facets)
        if value is None:
            continue
        slopes = []
        for i in (0, 1, 2, 3, 5, 6):
            up, down = list(at), list(at)
            up[i] += STEP
            down[i] -= STEP
            above, below = measured(*degrees, *up, facets), measured(*degrees, *down, facets)
            slopes.append((above - below) / (2 * STEP))
        numbers = [theta_s, theta_v, phi, n, sigma, a, b, k, t_x, t_y]
        cells = [str(int(facets != "ggx")), *(repr(x) for x in numbers), *(mp.nstr(x, 18) for x in (value, *slopes))]
        print(",".join(cells))
        rows += 1
    print(f"{rows} rows", file=sys.stderr)


if __name__ == "__main__":
    main()
