#!/usr/bin/env python3
"""Which recipe reads C_ab, C_w and C_m off directional reflectance best on leaves it has not seen?

The study behind docs/retrieval-study.md, in numpy and sharing nothing with the Rust code: PROSPECT-D (and PRO) with a
two-layer interior and exact derivatives, a damped Gauss–Newton fit of all leaves at once, and the scores.

    python3 retrieval_study.py recipes    LEAVES          recipes B, A and R: RMSE, bias, r², within species, bootstrap
    python3 retrieval_study.py constants  LEAVES          pigment share f and N: a table, and chosen leaving a species out
    python3 retrieval_study.py variants   LEAVES          what lost, one line each
    python3 retrieval_study.py errors     LEAVES          coverage of the standard errors, with and without held quantities
    python3 retrieval_study.py starts     LEAVES          random starts against the default one
    python3 retrieval_study.py leaf       LEAVES NAME...  parameters of single leaves, to check another implementation
    python3 retrieval_study.py directions LEAVES OTHERS   surface and diffuse terms: fitted in OTHERS, cross-validated over
                                                          views, and predicted in OTHERS from the same leaves in LEAVES

LEAVES  folder of wide CSV files (`# quantity: brf`, φ_v = 180° forward, 400–2500 nm every nm) and chemistry.csv (columns
        leaf, species, cab_ug_cm2, cw_cm, cm_g_cm2)
OTHERS  folder of further directions; q<leaf>.csv is leaf <leaf> of LEAVES, mounted and measured again

Requirements: Python ≥ 3.9, numpy ≥ 1.24. Seconds for `recipes`, a minute or two for `constants`, `variants` and `directions`.
OMP_NUM_THREADS=1 keeps it to one core.
"""

import argparse
import csv
import os
import pathlib

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np  # noqa: E402

TABLE = pathlib.Path(__file__).resolve().parents[2] / "prospect" / "data" / "prospect_pro.csv"
COLUMN = dict(n=1, cab=2, car=3, cant=4, cbrown=5, cw=6, cm=7, prot=8, cbc=9)
PIGMENTS = ("cab", "car", "cant", "cbrown")
D = ("cab", "car", "cant", "cbrown", "cw", "cm")
PRO = ("cab", "car", "cant", "cbrown", "cw", "prot", "cbc")
# Prior of ln C: mean, standard deviation. Broad: a factor of 2.7 to 4.5 either way.
PRIOR = {
    "cab": (np.log(40), 1.5), "car": (np.log(8), 1.0), "cant": (np.log(0.5), 1.5), "cbrown": (np.log(0.005), 1.5),
    "cw": (np.log(0.012), 1.0), "cm": (np.log(0.006), 1.0), "prot": (np.log(0.001), 1.0), "cbc": (np.log(0.005), 1.0),
}
DARK = np.array([440, 450, 460, 680, 1930, 1940, 1950])  # nm: hardly any light comes back from the interior
SCORED = (("cab", 1.0, "C_ab"), ("cw", 1e3, "C_w"), ("cm", 1e3, "C_m"))
AIMS = np.array([5.0, 1.5, 1.0])


# ------------------------------------------------------------------------------------------------------ PROSPECT


def exponential_integral(x):
    """E1(x) for x > 0: power series up to 1, continued fraction above."""
    x = np.asarray(x, float)
    small, large = np.minimum(x, 1.0), np.maximum(x, 1.0)
    term, series = np.ones_like(x), np.zeros_like(x)
    for k in range(1, 25):
        term = term * (-small) / k
        series = series - term / k
    series = series - np.log(small) - 0.57721566490153286061
    fraction = np.zeros_like(x)
    for k in range(120, 0, -1):
        fraction = k * k / (large + 2 * k + 1 - fraction)
    return np.where(x <= 1.0, series, np.exp(-large) / (large + 1 - fraction))


def mean_transmissivity(cone_deg, n):
    """t_av: unpolarised Fresnel transmissivity averaged over a cone, by Gauss–Legendre quadrature."""
    node, weight = np.polynomial.legendre.leggauss(200)
    cone = np.deg2rad(cone_deg)
    theta, weight = 0.5 * cone * (node + 1), 0.5 * cone * weight
    n, c = np.asarray(n)[:, None], np.cos(theta)
    g = np.sqrt(n * n - 1 + c * c)
    t_s, t_p = 1 - ((c - g) / (c + g)) ** 2, 1 - ((n * n * c - g) / (n * n * c + g)) ** 2
    return (0.5 * (t_s + t_p) * np.sin(2 * theta) * weight).sum(1) / np.sin(cone) ** 2


class Interior:
    """d(λ), the light that has been inside: PROSPECT's reflectance less its first-surface reflection, pigments shared f : 1 − f."""

    table = None

    def __init__(self, wavelengths, names):
        if Interior.table is None:
            rows = [r for r in open(TABLE, encoding="utf-8") if r[0].isdigit()]
            Interior.table = np.array([[float(v) for v in r.split(",")] for r in rows])
        row = Interior.table[np.asarray(wavelengths, int) - 400]
        self.n, self.names, self.k = row[:, 1], tuple(names), {name: row[:, COLUMN[name]] for name in names}
        self.t_alpha, self.t12 = mean_transmissivity(40, self.n), mean_transmissivity(90, self.n)
        self.r12, self.t21 = 1 - self.t12, self.t12 / self.n**2
        self.r21 = 1 - self.t21

    def _stack(self, k, layers):
        """Reflectance and transmittance of `layers` plates under isotropic light, and their derivatives by k (complex step)."""
        e1, e = exponential_integral(np.maximum(k, 1e-12)), np.exp(-k)
        step = 1e-30
        tau = (1 - k) * e + k * k * e1 + 1j * step * 2 * (k * e1 - e)
        plate_t = self.t12 * self.t21 * tau / (1 - (self.r21 * tau) ** 2)
        plate_r = self.r12 + self.r21 * tau * plate_t
        root = np.sqrt((1 + plate_r + plate_t) * (1 + plate_r - plate_t) * (1 - plate_r + plate_t) * (1 - plate_r - plate_t))
        a = (1 + plate_r**2 - plate_t**2 + root) / (2 * plate_r)
        b = ((1 - plate_r**2 + plate_t**2 + root) / (2 * plate_t)) ** layers
        q = a * b - 1 / (a * b)
        r, t = (b - 1 / b) / q, (a - 1 / a) / q
        return r.real, t.real, r.imag / step, t.imag / step

    def __call__(self, content, n_struct, share):
        """d and {name: ∂d/∂C}; `content` maps names to columns (leaves, 1)."""
        upper = sum((2 * share if c in PIGMENTS else 1) * content[c] * self.k[c] for c in self.names) / n_struct
        lower = sum((2 - 2 * share if c in PIGMENTS else 1) * content[c] * self.k[c] for c in self.names) / n_struct
        r1, t1, r1_k, t1_k = self._stack(upper, n_struct / 2)
        r2, _, r2_k, _ = self._stack(lower, n_struct / 2)
        q, scale = 1 - r1 * r2, self.t_alpha / self.t12
        d = scale * (r1 + t1 * t1 * r2 / q - self.r12)
        by_upper = scale * (r1_k * (1 + (t1 * r2 / q) ** 2) + 2 * t1 * t1_k * r2 / q)
        by_lower = scale * (t1 / q) ** 2 * r2_k
        return d, {
            c: (by_upper * (2 * share if c in PIGMENTS else 1) + by_lower * (2 - 2 * share if c in PIGMENTS else 1)) * self.k[c] / n_struct
            for c in self.names
        }


# ---------------------------------------------------------------------------------------------------------- leaves


def read_wide(path):
    """θ_s, θ_v, φ_v (rad), and values (directions, wavelengths 400…2500)."""
    rows = [r.rstrip("\n").split(",") for r in open(path, encoding="utf-8") if not r.startswith("#")]
    angle = [np.deg2rad(np.array(r[1:], float)) for r in rows[:3]]
    value = np.array([[float(v) for v in r] for r in rows[3:]])
    if value[0, 0] != 400 or value[-1, 0] != 2500 or len(value) != 2101:
        raise SystemExit(f"{path}: expected 400–2500 nm every nm")
    return angle, value[:, 1:].T


class Leaves:
    def __init__(self, folder):
        folder = pathlib.Path(folder)
        rows = [r for r in csv.DictReader(open(folder / "chemistry.csv", encoding="utf-8")) if r["cab_ug_cm2"] and r["cw_cm"] and r["cm_g_cm2"]]
        rows.sort(key=lambda r: r["leaf"])
        self.name = [r["leaf"] for r in rows]
        self.species = np.array([r["species"] for r in rows])
        self.true = np.array([[float(r["cab_ug_cm2"]), 1e3 * float(r["cw_cm"]), 1e3 * float(r["cm_g_cm2"])] for r in rows]).T
        self.value = [read_wide(folder / f"{name}.csv")[1] for name in self.name]

    def mean_of_darkest_views(self, wavelengths, share=0.5):
        """Mean over the half of the views with the least surface reflection (that is, least where the interior is black)."""
        out = []
        for value in self.value:
            order = np.argsort(value[:, DARK - 400].mean(1), kind="stable")
            out.append(value[order[: max(1, int(len(value) * share))]].mean(0))
        return np.array([np.interp(wavelengths, np.arange(400.0, 2501.0), spectrum) for spectrum in out])


# ------------------------------------------------------------------------------------------------------------- fit

FULL = np.arange(410, 2451, 10)
CUT = np.array([w for w in range(410, 2401, 10) if not 1870 <= w <= 1910])


def covariance(wavelengths, sd=0.01, length=60.0, nugget=0.002):
    return sd**2 * np.exp(-np.abs(wavelengths[:, None] - wavelengths) / length) + nugget**2 * np.eye(len(wavelengths))


RECIPES = {
    "B": dict(wavelengths=FULL, n_struct=1.4, share=0.5, cov=1e-4 * np.eye(len(FULL))),
    "A": dict(wavelengths=FULL, n_struct=1.5, share=0.65, cov=covariance(FULL)),
    "R": dict(wavelengths=CUT, n_struct=1.5, share=2 / 3, cov=covariance(CUT, 0.01, 100.0, 0.005)),
}


def fit(y, wavelengths, n_struct, share, cov, names=D, additive=(), gains=(), sd_gain=0.2, shift_sd=None, start=None):
    """All leaves at once: minimise r'C⁻¹r + Σ((x − μ)/s)², x = (ln C, b, ln g, coefficients of `additive` shapes and of `gains`)."""
    interior = Interior(wavelengths, names)
    leaves, p = len(y), len(names)
    mean = np.array([PRIOR[c][0] for c in names] + [0.0, 0.0] + [0.0] * (len(additive) + len(gains) + bool(shift_sd)))
    spread = np.array([PRIOR[c][1] for c in names] + [0.1, sd_gain] + [s for _, s in additive] + [s for _, s in gains] + ([shift_sd] if shift_sd else []))
    n_struct = np.broadcast_to(np.asarray(n_struct, float).reshape(-1, 1), (leaves, 1))
    white = np.linalg.inv(np.linalg.cholesky(cov))
    x = np.tile(mean, (leaves, 1)) if start is None else start.copy()

    def evaluate(x):
        content = {c: np.exp(x[:, i : i + 1]) for i, c in enumerate(names)}
        d, by = interior(content, n_struct, share)
        log_gain, at = x[:, p + 1 : p + 2], p + 2 + len(additive)
        for i, (shape, _) in enumerate(gains):
            log_gain = log_gain + x[:, at + i : at + i + 1] * shape
        g = np.exp(log_gain)
        model = g * d + x[:, p : p + 1]
        column = [g * by[c] * content[c] for c in names] + [np.ones_like(d), g * d]
        for i, (shape, _) in enumerate(additive):
            model = model + x[:, p + 2 + i : p + 3 + i] * shape
            column.append(np.broadcast_to(shape, d.shape))
        column += [g * d * shape for shape, _ in gains]
        if shift_sd:
            slope = np.gradient(g * d, wavelengths, axis=1)
            model = model + x[:, -1:] * slope
            column.append(slope)
        residual = (model - y) @ white.T
        jacobian = np.matmul(white, np.stack(column, -1))
        return (residual**2).sum(1) + (((x - mean) / spread) ** 2).sum(1), residual, jacobian

    damping = np.full(leaves, 1e-3)
    cost, residual, jacobian = evaluate(x)
    for _ in range(200):
        hessian = np.matmul(jacobian.transpose(0, 2, 1), jacobian) + np.diag(spread**-2.0)
        slope = (jacobian * residual[:, :, None]).sum(1) + (x - mean) / spread**2
        damped = hessian + damping[:, None, None] * np.einsum("lii->li", hessian)[:, :, None] * np.eye(len(mean))
        step = -np.linalg.solve(damped, slope[:, :, None])[:, :, 0]
        step *= np.minimum(1.0, 1.5 / np.maximum(np.abs(step).max(1, keepdims=True), 1e-300))
        new_cost, new_residual, new_jacobian = evaluate(x + step)
        better = new_cost <= cost * (1 + 1e-14)
        settled = np.where(better, np.abs(new_cost - cost) < 1e-12 * cost, damping > 1e6)
        x, cost = np.where(better[:, None], x + step, x), np.where(better, new_cost, cost)
        residual, jacobian = np.where(better[:, None], new_residual, residual), np.where(better[:, None, None], new_jacobian, jacobian)
        damping = np.where(better, np.maximum(0.2 * damping, 1e-9), 6 * damping)
        if settled.all():
            break
    found = {c: np.exp(x[:, i]) for i, c in enumerate(names)}
    found.setdefault("cm", found.get("prot", 0) + found.get("cbc", 0))
    posterior = np.linalg.inv(np.matmul(jacobian.transpose(0, 2, 1), jacobian) + np.diag(spread**-2.0))
    estimate = np.array([found[c] * unit for c, unit, _ in SCORED])
    return dict(found, x=x, cost=cost, posterior=posterior, estimate=estimate, residual=residual)


def run(leaves, recipe, views=0.5, shifted=0.0, **changes):
    """A recipe with changes; `shifted`: the instrument's wavelengths are off by so many nm."""
    recipe = dict(RECIPES[recipe], **changes)
    y = leaves.mean_of_darkest_views(recipe["wavelengths"] - shifted, views)
    return fit(y, **recipe)


# ----------------------------------------------------------------------------------------------------------- scores


def rmse(error):
    return np.sqrt((error**2).mean(-1))


def line(name, leaves, estimate):
    error, cells = estimate - leaves.true, []
    for i in range(3):
        within = error[i].copy()
        for s in set(leaves.species):
            within[leaves.species == s] -= within[leaves.species == s].mean()
        r2 = np.corrcoef(estimate[i], leaves.true[i])[0, 1] ** 2
        cells.append(f"{rmse(error[i]):6.2f} ({error[i].mean():+5.2f}, {r2:.2f}, {rmse(within):4.2f})")
    print(f"{name:42s} " + " | ".join(cells), flush=True)


def over_species(leaves, statistic, draws=4000):
    """95 % interval of a statistic of leaf indices, species drawn with replacement."""
    rng, species = np.random.default_rng(0), sorted(set(leaves.species))
    member = {s: np.flatnonzero(leaves.species == s) for s in species}
    drawn = [statistic(np.concatenate([member[s] for s in rng.choice(species, len(species))])) for _ in range(draws)]
    return np.percentile(drawn, [2.5, 97.5], axis=0).T.round(2).tolist()


def recipes(leaves):
    print("RMSE (bias, r², RMSE within species): C_ab µg cm⁻² | C_w mg cm⁻² | C_m mg cm⁻²")
    error = {}
    for name in RECIPES:
        found = run(leaves, name)
        line(name, leaves, found["estimate"])
        error[name] = found["estimate"] - leaves.true
    if len(set(leaves.species)) > 3:
        for name, e in error.items():
            print(name, "95 % over species:", over_species(leaves, lambda i, e=e: rmse(e[:, i])))
        for other in ("A", "B"):
            print("R −", other, over_species(leaves, lambda i, o=other: rmse(error["R"][:, i]) - rmse(error[o][:, i])))


def constants(leaves):
    grid = [(f, n) for f in (0.5, 0.55, 0.6, 0.63, 0.65, 2 / 3, 0.7, 0.73) for n in (1.3, 1.4, 1.5, 1.6)]
    error = {}
    for f, n in grid:
        found = run(leaves, "R", share=f, n_struct=n)["estimate"]
        line(f"f {f:.3f}  N {n}", leaves, found)
        error[f, n] = found - leaves.true
    chosen, out = [], np.zeros_like(leaves.true)
    for s in sorted(set(leaves.species)):
        rest = leaves.species != s
        best = min(grid, key=lambda k: (rmse(error[k][:, rest]) / AIMS).mean())
        chosen.append(best)
        out[:, ~rest] = error[best][:, ~rest]
    line("chosen on the other species", leaves, leaves.true + out)
    print("chosen:", [(round(f, 3), n) for f, n in chosen])


def variants(leaves):
    w = CUT.astype(float)
    index = mean_transmissivity(40, Interior(CUT, D).n)
    slope = (1 - index) / (1 - index).mean() - 1
    glow = np.exp(-0.5 * ((w - 740) / 21) ** 2) + 0.5 * np.exp(-0.5 * ((w - 685) / 9) ** 2)
    detectors = ((1.0 * (w > 1000), 0.03), (1.0 * (w > 1830), 0.03))

    def only(name, keep, **changes):
        part = CUT[keep(CUT)]
        cov = covariance(part, 0.01, 100.0, 0.005)
        line(name, leaves, run(leaves, "R", wavelengths=part, cov=cov, **changes)["estimate"])

    line("R", leaves, run(leaves, "R")["estimate"])
    for name, changes in {
        "one layer (f = ½)": dict(share=0.5),
        "PROSPECT-PRO": dict(names=PRO),
        "gain by detector (1000, 1830 nm), sd .03": dict(gains=detectors),
        "offset may follow the index, sd .01": dict(additive=((slope, 0.01),)),
        "fluorescence 685 + 740 nm, sd .02": dict(additive=((glow, 0.02),)),
        "these four": dict(names=PRO, gains=detectors, additive=((slope, 0.01), (glow, 0.02))),
        "gain linear in wavelength, sd .1": dict(gains=(((w - 1400) / 1000, 0.1),)),
        "gain prior .02": dict(sd_gain=0.02),
        "gain prior .4": dict(sd_gain=0.4),
        "wavelength shift, sd 1 nm": dict(shift_sd=1.0),
        "no anthocyanin, no brown pigment": dict(names=("cab", "car", "cw", "cm")),
        "unweighted": dict(cov=1e-4 * np.eye(len(CUT))),
        "correlation length 30 nm": dict(cov=covariance(CUT, 0.01, 30.0, 0.005)),
        "correlation length 200 nm": dict(cov=covariance(CUT, 0.01, 200.0, 0.005)),
        "2 of 12 views": dict(views=0.17),
        "10 of 12 views": dict(views=0.84),
    }.items():
        line(name, leaves, run(leaves, "R", **changes)["estimate"])
    full = covariance(FULL, 0.01, 100.0, 0.005)
    line("410–2450 nm, 1.9 µm edge kept", leaves, run(leaves, "R", wavelengths=FULL, cov=full)["estimate"])
    only("without the red edge (690–780 nm)", lambda v: (v < 690) | (v > 780))
    only("without 2250–2400 nm", lambda v: v < 2250)
    only("up to 1000 nm", lambda v: v <= 1000)
    for power in (0.05, 0.1, 0.2):  # N grows with dry matter (an N–SLA relation): fixed point
        n = np.full(len(leaves.name), 1.5)
        for _ in range(8):
            found = run(leaves, "R", n_struct=n)
            n = np.clip(1.5 * (found["cm"] / 0.005) ** power, 1.05, 3.0)
        line(f"N = 1.5 (C_m/5 mg cm⁻²)^{power}", leaves, found["estimate"])


def errors(leaves):
    at = [D.index(c) for c, _, _ in SCORED]
    base = run(leaves, "R")
    b = np.log(base["estimate"])
    slope_n = (np.log(run(leaves, "R", n_struct=1.65)["estimate"]) - np.log(run(leaves, "R", n_struct=1.35)["estimate"])) / np.log(1.65 / 1.35)
    slope_f = (np.log(run(leaves, "R", share=0.70)["estimate"]) - np.log(run(leaves, "R", share=0.63)["estimate"])) / 0.07
    slope_nm = np.log(run(leaves, "R", shifted=1.0)["estimate"]) - b
    for name, s in (("∂ln C/∂ln N", slope_n), ("∂ln C/∂f", slope_f), ("∂ln C per nm", slope_nm)):
        print(name, s.mean(1).round(3), "±", s.std(1).round(3))
    var = base["posterior"][:, at, at].T
    z0 = b - np.log(leaves.true)
    for s_n, s_f, s_nm in ((0, 0, 0), (0.1, 0.05, 0.5), (0.15, 0.05, 0.5), (0.15, 0.1, 1.0), (0.2, 0.1, 1.0)):
        sd = np.sqrt(var + (slope_n * s_n) ** 2 + (slope_f * s_f) ** 2 + (slope_nm * s_nm) ** 2)
        z = np.abs(z0 / sd)
        print(f"sd of ln N {s_n}, f {s_f}, wavelength {s_nm} nm: within 1 sd {(z < 1).mean(1).round(2)}, within 1.96 sd {(z < 1.96).mean(1).round(2)}, mean sd of ln C {sd.mean(1).round(3)}")


def starts(leaves):
    rng = np.random.default_rng(0)
    base = run(leaves, "R")
    mean, spread = np.array([PRIOR[c] for c in D]).T
    worse = 0
    for _ in range(5):
        start = np.concatenate([mean, [0, 0]]) + np.concatenate([spread, [0.1, 0.2]]) * rng.normal(size=base["x"].shape)
        worse += (run(leaves, "R", start=start)["cost"] > 1.001 * base["cost"]).sum()
    print(f"{worse} of {5 * len(leaves.name)} random starts end more than 0.1 % above the default start")


def single(leaves, names):
    found = run(leaves, "R")
    for name in names:
        i = leaves.name.index(name)
        print(name, dict(zip([f"ln {c}" for c in D] + ["b", "ln g"], found["x"][i].round(6).tolist())), "cost", round(float(found["cost"][i]), 5))


# ------------------------------------------------------------------------------------------------------- directions

BANDS = np.arange(480, 871, 30)
EFFECTIVE_BANDS = 5.0  # the residuals of neighbouring bands are nearly the same
SURFACE = ("n", "ln σ", "a", "b", "t_x", "t_y", "e")


def shapes(x, angle, facets="ggx"):
    """Diffuse shape per k_L and specular term, both as BRF of the tilted leaf against the level panel."""
    n, sigma, a, b, t_x, t_y, e = x[0], np.exp(x[1]), *x[2:]
    theta_s, theta_v, phi = angle
    s = np.stack([np.sin(theta_s), 0 * theta_s, np.cos(theta_s)], -1)
    v = np.stack([np.sin(theta_v) * np.cos(phi), np.sin(theta_v) * np.sin(phi), np.cos(theta_v)], -1)
    m = np.array([np.tan(np.deg2rad(t_x)), np.tan(np.deg2rad(t_y)), 1.0])
    m /= np.linalg.norm(m)
    c_s, c_v, cos_phase = s @ m, v @ m, (s * v).sum(-1)
    c_a = np.sqrt((1 + cos_phase) / 2)
    c_alpha = np.minimum((c_s + c_v) / (2 * c_a), 1)
    g = np.sqrt(n * n - 1 + c_a**2)
    fresnel = 0.5 * ((g - c_a) / (g + c_a)) ** 2 * (1 + ((c_a * (g + c_a) - 1) / (c_a * (g - c_a) + 1)) ** 2)
    if facets == "ggx":
        q = 1 - (1 - sigma**2) * c_alpha**2
        w = c_v * np.sqrt(c_s**2 + sigma**2 * (1 - c_s**2)) + c_s * np.sqrt(c_v**2 + sigma**2 * (1 - c_v**2))
        specular = fresnel * sigma**2 / (np.pi * q**2) / (2 * w)
    else:
        masking = np.minimum(1, 2 * c_alpha * np.minimum(c_v, c_s) / c_a)
        specular = fresnel * masking / (4 * np.pi * c_s * c_v) * np.exp(-(1 / c_alpha**2 - 1) / sigma**2) / (sigma**2 * c_alpha**4)
    diffuse = (1 - a * c_s * c_v - b * (cos_phase - c_s * c_v) - e * cos_phase**2) / (1 - 2 * a / 3 - e / 2)
    irradiance = c_s / np.cos(theta_s)
    return diffuse * irradiance, np.pi * specular * irradiance


def lambert(diffuse, specular, y):
    return diffuse @ (y - specular[:, None]) / (diffuse @ diffuse)


def fit_surface(angle, y, free, mean, spread, sd, facets="ggx"):
    """k_L eliminated in every band; numerical Jacobian; the best of nine starts in (n, σ)."""
    free = [SURFACE.index(name) for name in free]
    low, high = np.array([1.05, np.log(0.05), -0.8, -0.8, -12, -12, -0.8]), np.array([3, np.log(1.2), 0.8, 0.8, 12, 12, 0.8])
    mean, spread = np.array(mean, float), np.array(spread, float)

    def residual(x):
        diffuse, specular = shapes(x, angle, facets)
        r = diffuse[:, None] * lambert(diffuse, specular, y) + specular[:, None] - y
        return np.concatenate([(r / sd * np.sqrt(EFFECTIVE_BANDS / y.shape[1])).ravel(), ((x - mean) / spread)[free]])

    best = None
    for n0 in (1.2, 1.4, 1.6):
        for sigma0 in (0.12, 0.25, 0.5):
            x = mean.copy()
            x[0], x[1], damping = n0, np.log(sigma0), 1e-2
            r = residual(x)
            for _ in range(60):
                jacobian = np.empty((len(r), len(free)))
                for j, i in enumerate(free):
                    plus, minus = x.copy(), x.copy()
                    plus[i], minus[i] = x[i] + 1e-5, x[i] - 1e-5
                    jacobian[:, j] = (residual(plus) - residual(minus)) / 2e-5
                hessian = jacobian.T @ jacobian
                step = -np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)) + 1e-12 * np.eye(len(free)), jacobian.T @ r)
                trial = x.copy()
                trial[free] = np.clip(x[free] + step, low[free], high[free])
                new = residual(trial)
                if new @ new < r @ r:
                    done = r @ r - new @ new < 1e-8 * (r @ r)
                    x, r, damping = trial, new, max(0.3 * damping, 1e-9)
                    if done:
                        break
                else:
                    damping *= 5
                    if damping > 1e8:
                        break
            if best is None or r @ r < best[0]:
                best = (r @ r, x)
    return best[1]


def misfit(x, angle, y, angle_test, y_test, facets="ggx"):
    """k_L from (angle, y), difference from y_test."""
    k = lambert(*shapes(x, angle, facets), y)
    diffuse, specular = shapes(x, angle_test, facets)
    return diffuse[:, None] * k + specular[:, None] - y_test


def directions(principal, hemispherical):
    far = 1e6  # no prior
    other, pair = {}, {}
    for path in sorted(pathlib.Path(hemispherical).glob("q*.csv")):
        angle, value = read_wide(path)
        other[path.stem] = (angle, value[:, BANDS - 400])
        twin = pathlib.Path(principal) / f"{path.stem[1:]}.csv"
        if twin.exists():
            angle, value = read_wide(twin)
            pair[path.stem] = (angle, value[:, BANDS - 400])
    p1 = ("n", "ln σ", "a", "b", "t_x", "t_y")
    mean, spread = [1.46, np.log(0.3), 0.15, 0, 0, 0, 0], [far, far, 0.1, 0.1, 3, 3, 0.1]
    lambertian = [1.46, np.log(0.3), 0, 0, 0, 0, 0]
    print(f"{len(other)} leaves; RMSE in sr⁻¹, mean (median)")
    models = (
        ("Beckmann", ("n", "ln σ"), lambertian, spread, "beckmann"),
        ("GGX + P1 + tilt", p1, mean, spread, "ggx"),
        ("GGX + P1 + P2 + tilt", p1 + ("e",), mean, [far, far, 0.2, 0.1, 3, 3, 0.1], "ggx"),
    )
    for name, free, centre, width, facets in models:
        inside, held_out = [], []
        for angle, y in other.values():
            x = fit_surface(angle, y, free, centre, width, 0.01, facets)
            inside.append(np.sqrt((misfit(x, angle, y, angle, y, facets) ** 2).mean()) / np.pi)
            if facets == "ggx":
                fold, error = np.random.default_rng(1).permutation(len(y)) % 5, np.empty_like(y)
                for k in range(5):
                    train, test = fold != k, fold == k
                    part, rest = [v[train] for v in angle], [v[test] for v in angle]
                    x = fit_surface(part, y[train], free, centre, width, 0.01)
                    error[test] = misfit(x, part, y[train], rest, y[test])
                held_out.append(np.sqrt((error**2).mean()) / np.pi)
        text = f"; views held out {np.mean(held_out):.5f} ({np.median(held_out):.5f})" if held_out else ""
        print(f"  {name:24s} {np.mean(inside):.5f} ({np.median(inside):.5f}){text}", flush=True)
    print(f"{len(pair)} leaves: 12 views of one mounting predict 41 of another; RMS in BRF, mean (median)")
    in_plane = ("n", "ln σ", "a", "b", "t_x")
    for name, free, centre, width, sd, facets, keep in (
        ("Beckmann", ("n", "ln σ"), lambertian, spread, 0.02, "beckmann", True),
        ("GGX + P1 + tilt, sd .02", in_plane, mean, spread, 0.02, "ggx", True),
        ("the same, tilt forgotten", in_plane, mean, spread, 0.02, "ggx", False),
        ("GGX + P1 + tilt, sd .04", in_plane, mean, spread, 0.04, "ggx", True),
        ("+ P2, e 0 (.1), sd .04", in_plane + ("e",), mean, spread, 0.04, "ggx", True),
        ("+ P2, e .1 (.03), sd .04", in_plane + ("e",), mean[:6] + [0.1], spread[:6] + [0.03], 0.04, "ggx", True),
    ):
        out = []
        for leaf, (angle, y) in pair.items():
            x = fit_surface(angle, y, free, centre, width, sd, facets)
            k = lambert(*shapes(x, angle, facets), y)
            if not keep:
                x[4] = 0.0
            diffuse, specular = shapes(x, other[leaf][0], facets)
            out.append(np.sqrt(((diffuse[:, None] * k + specular[:, None] - other[leaf][1]) ** 2).mean()))
        print(f"  {name:26s} {np.mean(out):.4f} ({np.median(out):.4f})", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("recipes", "constants", "variants", "errors", "starts", "leaf", "directions"))
    parser.add_argument("leaves", metavar="LEAVES")
    parser.add_argument("more", nargs="*", metavar="NAME | OTHERS")
    options = parser.parse_args()
    if options.what == "directions":
        if len(options.more) != 1:
            parser.error("directions needs two folders: LEAVES OTHERS")
        return directions(options.leaves, options.more[0])
    leaves = Leaves(options.leaves)
    if options.what == "leaf":
        return single(leaves, options.more)
    {"recipes": recipes, "constants": constants, "variants": variants, "errors": errors, "starts": starts}[options.what](leaves)


if __name__ == "__main__":
    main()
