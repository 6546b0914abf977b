#!/usr/bin/env python3
"""Which recipe reads C_ab, C_w and C_m off directional reflectance best on leaves it has not seen?

The study behind docs/retrieval-study.md (its directions: direction_study.py), in numpy and sharing nothing with the Rust code: PROSPECT-D (and PRO) with a
two-layer interior and exact derivatives, a damped Gauss–Newton fit of all leaves at once, and the scores.

    python3 retrieval_study.py recipes    LEAVES          recipes B, A, R, S: RMSE, bias, r², within species, bootstrap
    python3 retrieval_study.py constants  LEAVES          pigment share f, its slope and N: tables, and chosen leaving a species out
    python3 retrieval_study.py variants   LEAVES          what lost, one line each
    python3 retrieval_study.py errors     LEAVES          coverage of the standard errors, with and without held quantities
    python3 retrieval_study.py starts     LEAVES          random starts against the default one
    python3 retrieval_study.py leaf       LEAVES NAME...  parameters of single leaves, to check another implementation
    python3 retrieval_study.py windows    LEAVES          window, residual model and N, chosen leaving a species out
    python3 retrieval_study.py wavelength LEAVES          a shift of the wavelengths, fitted to pieces of the spectrum

LEAVES  folder of wide CSV files (`# quantity: brf`, φ_v = 180° forward, 400–2500 nm every nm) and chemistry.csv (columns
        leaf, species, cab_ug_cm2, cw_cm, cm_g_cm2)
Requirements: Python ≥ 3.9, numpy ≥ 1.24. Seconds for `recipes`, minutes for `constants`, `variants` and `windows`.
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
        files = [read_wide(folder / f"{name}.csv") for name in self.name]
        self.angle, self.value = [a for a, _ in files], [v for _, v in files]

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
    "S": dict(wavelengths=CUT, n_struct=1.5, share=0.7, cov=covariance(CUT, 0.01, 100.0, 0.005), share_slope=0.1, surface_sd=0.01),
}


def first_surface(wavelengths):
    """The relative departure from its mean of ρ(λ) = 1 − t_av(40°, n(λ)), what PROSPECT's first surface reflects."""
    rho = 1 - Interior(wavelengths, D).t_alpha
    return rho / rho.mean() - 1


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
    return dict(found, x=x, cost=cost, posterior=posterior, estimate=estimate, share=np.broadcast_to(share, (leaves, 1)))


def run(leaves, recipe, views=0.5, shifted=0.0, **changes):
    """A recipe with changes; `shifted`: the instrument's wavelengths are off by so many nm."""
    recipe = dict(RECIPES[recipe], **changes)
    slope, surface_sd = recipe.pop("share_slope", 0.0), recipe.pop("surface_sd", 0.0)
    if surface_sd:
        recipe["additive"] = (*recipe.get("additive", ()), (first_surface(recipe["wavelengths"]), surface_sd))
    y = leaves.mean_of_darkest_views(recipe["wavelengths"] - shifted, views)
    found = fit(y, **recipe)
    if slope:  # C_m hardly depends on the share, so one more fit settles it
        sure = np.sqrt(found["posterior"][:, D.index("cm"), D.index("cm")]) < 0.7  # half of the prior's variance
        share = np.clip(recipe["share"] - slope * np.log(found["cm"] / 0.005), 0.5, 0.8)
        found = fit(y, **dict(recipe, share=np.where(sure, share, recipe["share"])[:, None]))
    return found


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
        for one, other in (("R", "A"), ("R", "B"), ("S", "R"), ("S", "B")):
            print(one, "−", other, over_species(leaves, lambda i, p=one, q=other: rmse(error[p][:, i]) - rmse(error[q][:, i])))


def left_out(leaves, error, weigh):
    """Each species scored under the choice that is best on the others; `weigh` turns three RMSE into what is minimised."""
    chosen, held_out = [], np.zeros_like(leaves.true)
    for s in sorted(set(leaves.species)):
        rest = leaves.species != s
        best = min(error, key=lambda k: weigh(rmse(error[k][:, rest])))
        chosen.append(best)
        held_out[:, ~rest] = error[best][:, ~rest]
    line("chosen on the other species", leaves, leaves.true + held_out)
    print("chosen:", *chosen, sep="\n  ")


def constants(leaves):
    error = {}
    for f in (0.5, 0.55, 0.6, 0.63, 0.65, 2 / 3, 0.7, 0.73):
        for n in (1.3, 1.4, 1.5, 1.6):
            found = run(leaves, "R", share=f, n_struct=n)["estimate"]
            line(f"f {f:.3f}  N {n}", leaves, found)
            error[round(f, 3), n] = found - leaves.true
    left_out(leaves, error, lambda r: (r / AIMS).mean())
    error = {}
    for f in (0.63, 2 / 3, 0.7):
        for slope in (0.0, 0.05, 0.1, 0.15, 0.2):
            found = run(leaves, "S", share=f, share_slope=slope)["estimate"]
            line(f"f {f:.3f} − {slope} ln(C_m/5 mg cm⁻²)", leaves, found)
            error[round(f, 3), slope] = found - leaves.true
    left_out(leaves, error, lambda r: r[0])
    error = {}
    for sd in (0.0, 0.005, 0.01, 0.02, 0.05):
        found = run(leaves, "S", surface_sd=sd)["estimate"]
        line(f"offset may follow the index by ± {sd}", leaves, found)
        error[sd] = found - leaves.true
    left_out(leaves, error, lambda r: (r / AIMS).mean())
    for sd in (0.01, 0.02):
        print(sd, "−", 0.0, over_species(leaves, lambda i, p=error[sd], q=error[0.0]: rmse(p[:, i]) - rmse(q[:, i])))


def windows(leaves):
    """The choices of R other than f, each species scored under the best of the others."""
    out = {"all": None, "1850–2000": (1850, 2000), "1870–1910": (1870, 1910), "1380–1410, 1870–1900": (1870, 1900)}
    error = {}
    for name, gap in out.items():
        w = np.array([v for v in FULL if gap is None or not gap[0] <= v <= gap[1]])
        if name.startswith("1380"):
            w = w[(w < 1380) | (w > 1410)]
        slope = ((first_surface(w), 0.01),)
        for length in (30.0, 60.0, 100.0, 200.0):
            for nugget in (0.002, 0.005):
                cov = covariance(w, 0.01, length, nugget)
                for additive in ((), slope):
                    for n, f in ((1.4, 0.65), (1.5, 2 / 3)):
                        found = run(leaves, "R", wavelengths=w, cov=cov, n_struct=n, share=f, additive=additive)["estimate"]
                        error[name, length, nugget, bool(additive), n] = found - leaves.true
    print("left out, length (nm), uncorrelated part, offset may follow the index, N")
    left_out(leaves, error, lambda r: (r / AIMS).mean())


def wavelength(leaves):
    """Where, on the model's scale, the instrument's wavelengths seem to be: pieces of the spectrum, no chemistry."""
    for low, high in ((410, 800), (800, 1300), (1250, 1700), (1700, 2400), (800, 2400)):
        w = CUT[(CUT >= low) & (CUT <= high)]
        found = run(leaves, "R", wavelengths=w, cov=covariance(w, 0.01, 60.0, 0.002), shift_sd=3.0)["x"][:, -1]
        of_species = [found[leaves.species == s].mean() for s in sorted(set(leaves.species))]
        print(f"{low}–{high} nm: {found.mean():+.2f} ± {found.std():.2f} nm over leaves; species' means {min(of_species):+.1f} … {max(of_species):+.1f}")


def variants(leaves):
    w = CUT.astype(float)
    slope = first_surface(CUT)
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
    for recipe in ("R", "S"):
        print("recipe", recipe)
        coverage(leaves, recipe)


def coverage(leaves, recipe):
    at = [D.index(c) for c, _, _ in SCORED]
    base = run(leaves, recipe)
    f = RECIPES[recipe]["share"]
    b = np.log(base["estimate"])
    slope_n = (np.log(run(leaves, recipe, n_struct=1.65)["estimate"]) - np.log(run(leaves, recipe, n_struct=1.35)["estimate"])) / np.log(1.65 / 1.35)
    slope_f = (np.log(run(leaves, recipe, share=f + 0.02)["estimate"]) - np.log(run(leaves, recipe, share=f - 0.02)["estimate"])) / 0.04
    slope_nm = np.log(run(leaves, recipe, shifted=1.0)["estimate"]) - b
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
    for recipe in ("R", "S"):
        found = run(leaves, recipe)
        for name in names:
            i = leaves.name.index(name)
            x = dict(zip([f"ln {c}" for c in D] + ["b", "ln g"], found["x"][i].round(6).tolist()))
            print(recipe, name, x, "cost", round(float(found["cost"][i]), 5), "f", round(float(np.ravel(found["share"])[i]), 6))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("recipes", "constants", "windows", "wavelength", "variants", "errors", "starts", "leaf"))
    parser.add_argument("leaves", metavar="LEAVES")
    parser.add_argument("more", nargs="*", metavar="NAME")
    options = parser.parse_args()
    leaves = Leaves(options.leaves)
    if options.what == "leaf":
        return single(leaves, options.more)
    {
        "recipes": recipes, "constants": constants, "windows": windows, "wavelength": wavelength,
        "variants": variants, "errors": errors, "starts": starts,
    }[options.what](leaves)


if __name__ == "__main__":
    main()
