"""Reference values in 40 digits for the tests of leafbrdf-prospect.

    python -m venv v && v/bin/pip install mpmath==1.4.1 && v/bin/python reference.py

Writes e1_reference.csv, tau_reference.csv, t_av_reference.csv and derivatives_reference.csv beside this folder. Nothing here
shares code or formulas with the crate: the interface is Stern's definition integrated adaptively, E1 and E3 are mpmath's,
the pile is Stokes' printed form with a and b, and derivatives are differences in 250 digits with a step of 1e-30.
"""

import csv
import pathlib
import random

import mpmath
from mpmath import cos, e1, exp, expint, mp, mpf, nstr, pi, sin, sqrt

mp.dps = 40
HERE = pathlib.Path(__file__).resolve().parent.parent
DATA = HERE.parent.parent / "data"


def digits(x):
    return nstr(x, 17)


def write(name, head, columns, rows):
    with open(HERE / name, "w", newline="") as f:
        f.write("".join(f"# {line}\n" for line in head))
        out = csv.writer(f, lineterminator="\n")
        out.writerow(columns)
        out.writerows(rows)


def fresnel(n, c):
    g = sqrt(n * n - 1 + c * c)
    return ((g - c) / (g + c)) ** 2 / 2 * (1 + ((c * (g + c) - 1) / (c * (g - c) + 1)) ** 2)


T_AV = {}


def t_av(cone_deg, n):
    """Average transmissivity within the cone; the square root at the horizon is removed by c = x^2."""
    key = (cone_deg, n)
    if key not in T_AV:
        alpha = mpf(cone_deg) * pi / 180
        low = cos(alpha) if cone_deg != 90 else mpf(0)
        scale = sqrt(n * n - 1)
        cuts = sorted({x for x in [low, scale / 10, scale, 10 * scale, mpf(1)] if low <= x <= 1})
        reflected = mpmath.quad(lambda c: fresnel(n, c) * 2 * c, cuts)
        T_AV[key] = 1 - reflected / (sin(alpha) ** 2 if cone_deg != 90 else 1)
    return T_AV[key]


def leaf(n, k, plates, cone=40):
    """R, T of a leaf of N plates whose layers absorb k."""
    tau = 2 * expint(3, k) if k > 0 else mpf(1)
    ta, t12 = t_av(cone, n), t_av(90, n)
    t21 = t12 / n**2
    r21 = 1 - t21
    den = 1 - (r21 * tau) ** 2
    t_top = ta * tau * t21 / den
    r_top = 1 - ta + r21 * tau * t_top
    t = t12 * tau * t21 / den
    r = 1 - t12 + r21 * tau * t
    m = plates - 1
    if k == 0:
        t_sub = t / (t + (1 - t) * m)
        r_sub = 1 - t_sub
    else:
        d = sqrt((1 + r + t) * (1 + r - t) * (1 - r + t) * (1 - r - t))
        a = (1 + r * r - t * t + d) / (2 * r)
        b = (1 - r * r + t * t + d) / (2 * t)
        bm = b**m
        down = (a * bm) ** 2 - 1
        r_sub = a * (bm**2 - 1) / down
        t_sub = bm * (a * a - 1) / down
    den = 1 - r_sub * r
    return r_top + t_top * r_sub * t / den, t_top * t_sub / den


def table(name):
    with open(DATA / name) as f:
        rows = csv.DictReader(line for line in f if not line.startswith("#"))
        return {int(r["wavelength_nm"]): {k: mpf(v) for k, v in r.items()} for r in rows}


COLUMN = dict(cab="k_ab", car="k_car", cant="k_ant", cbrown="k_brown", cw="k_w", cm="k_m", prot="k_prot", cbc="k_cbc")
VERSIONS = {
    "5B": ("prospect_5b.csv", ["cab", "car", "cbrown", "cw", "cm"]),
    "D": ("prospect_pro.csv", ["cab", "car", "cant", "cbrown", "cw", "cm"]),
    "PRO": ("prospect_pro.csv", ["cab", "car", "cant", "cbrown", "cw", "cm", "prot", "cbc"]),
}


def expint_references():
    random.seed(3)
    points = [mpf(x) for x in ("1e-300 1e-100 1e-30 1e-16 1e-8 1e-3 0.1 0.5 0.999 1 1.001 1.9999 2 2.0001 5 10 100 699 700").split()]
    points += [mpf(float(mpf(10) ** random.uniform(-300, 0))) for _ in range(80)]
    points += [mpf(random.uniform(0.5, 4)) for _ in range(120)] + [mpf(random.uniform(4, 700)) for _ in range(80)]
    points.sort()
    write("e1_reference.csv", ["E1(x), mpmath, 40 digits; made by gen/reference.py"], ["x", "e1"],
          [(repr(float(x)), digits(e1(x))) for x in points])
    points = [x for x in points if x > mpf("1e-25")]
    # 1 - tau loses the digits that tau keeps: 60 of them
    with mpmath.workdps(60):
        rows = [(repr(float(x)), digits(2 * expint(3, x)), digits(1 - 2 * expint(3, x)),
                 digits(-expint(2, x) / expint(3, x))) for x in points]
    write("tau_reference.csv",
          ["tau = 2 E3(k), 1 - tau and d ln tau/dk = -E2/E3, mpmath, 60 digits; made by gen/reference.py"],
          ["k", "tau", "absorbed", "log_slope"], rows)


def interface_references():
    random.seed(4)
    ns = [mpf(x) for x in ("1.0000000001 1.00001 1.001 1.05 1.2708 1.33 1.4 1.5 1.5115 1.5295 2 3".split())]
    rows = [(cone, repr(float(n)), digits(t_av(cone, mpf(float(n))))) for n in ns for cone in (1, 10, 40, 59, 80, 90)]
    write("t_av_reference.csv",
          ["t_av(cone, n), Stern's definition by adaptive integration, 40 digits; made by gen/reference.py"],
          ["cone_deg", "n", "t_av"], rows)


def derivative_references():
    random.seed(5)
    names = ["n_struct"] + list(COLUMN)
    leaves = []
    for version in VERSIONS:
        for _ in range(6):
            p = dict(n_struct=random.uniform(1.05, 3), cab=random.uniform(5, 90), car=random.uniform(1, 25),
                     cant=random.uniform(0, 10), cbrown=random.uniform(0, 1), cw=random.uniform(0.003, 0.05),
                     cm=random.uniform(0.002, 0.02), prot=0, cbc=0)
            if version == "PRO":
                p.update(cm=0, prot=random.uniform(0.0005, 0.003), cbc=random.uniform(0.002, 0.02))
            leaves.append((version, p))
        none = dict.fromkeys(names, 0)
        # limits: no absorber at all, one plate, hardly any absorption, nearly one plate, opaque
        leaves.append((version, none | dict(n_struct=1.7)))
        leaves.append((version, none | dict(n_struct=1, cab=40, car=8, cw=0.01, cm=0.005 if version != "PRO" else 0)))
        leaves.append((version, none | dict(n_struct=2.3, cab=1e-9, cw=1e-7)))
        leaves.append((version, none | dict(n_struct=1.000001, cab=30, cw=0.01)))
        leaves.append((version, none | dict(n_struct=9.5, cab=1e-3, cw=1e-5)))
        leaves.append((version, none | dict(n_struct=1.2, cab=300, car=100, cw=1, cbrown=10)))
    rows = []
    for version, p in leaves:
        file, constituents = VERSIONS[version]
        coefficients = table(file)
        p = {k: float(f"{float(v):.6g}") for k, v in p.items()}
        for key in COLUMN:
            if key not in constituents:
                p[key] = 0.0
        for wavelength in [400, 450, 551, 640, 671, 702, 760, 801, 970, 1131, 1450, 1667, 1930, 2205, 2500]:
            c = coefficients[wavelength]

            def at(q):
                total = sum(q[key] * c[COLUMN[key]] for key in constituents)
                return leaf(c["n"], total / q["n_struct"], q["n_struct"])

            exact = {k: mpf(v) for k, v in p.items()}
            value = at(exact)
            slopes = []
            for key in names:
                if key != "n_struct" and key not in constituents:
                    slopes.append((mpf(0), mpf(0)))
                    continue
                # one-sided where the parameter is at its lower limit; tau has a term k^2 ln k, hence the extra digits
                with mpmath.workdps(250):
                    h = mpf(10) ** -30
                    up = at(exact | {key: exact[key] + h})
                    if exact[key] > (1 if key == "n_struct" else 0):
                        down = at(exact | {key: exact[key] - h})
                        slopes.append(tuple((u - d) / (2 * h) for u, d in zip(up, down)))
                    else:
                        here = at(exact)
                        slopes.append(tuple((u - v) / h for u, v in zip(up, here)))
            rows.append([version] + [repr(p[k]) for k in names] + [wavelength] + [digits(v) for v in value]
                        + [digits(s[0]) for s in slopes] + [digits(s[1]) for s in slopes])
    write("derivatives_reference.csv",
          ["R, T and their derivatives by every parameter; 250-digit differences with step 1e-30 (an opaque leaf has slopes of 1e-97); made by gen/reference.py",
           "a parameter that the version lacks has derivative 0"],
          ["version"] + names + ["wavelength_nm", "reflectance", "transmittance"]
          + ["dr_" + k for k in names] + ["dt_" + k for k in names], rows)


if __name__ == "__main__":
    expint_references()
    interface_references()
    derivative_references()
