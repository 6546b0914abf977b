#!/usr/bin/env python3
"""Surface and diffuse terms on directional reflectance of whole leaves, and one joint fit with the interior.

The second half of docs/retrieval-study.md, in numpy and sharing nothing with the Rust code: Beckmann and GGX facets,
diffuse terms P1 and P2, tilt of the leaf; k_L is eliminated in every band.

    python3 direction_study.py directions LEAVES OTHERS   fitted in OTHERS, cross-validated over its views, and predicted
                                                          in OTHERS from the same leaves in LEAVES
    python3 direction_study.py parameters OTHERS          a, b and e (P2) by source angle
    python3 direction_study.py joint      LEAVES          lobe, P1, in-plane tilt and interior over all views at once: chemistry

LEAVES  folder of wide CSV files and chemistry.csv, as for retrieval_study.py
OTHERS  folder of further directions; q<leaf>.csv is leaf <leaf> of LEAVES, mounted and measured again

Requirements: Python ≥ 3.9, numpy ≥ 1.24. A minute or two each on an idle machine. OMP_NUM_THREADS=1 keeps it to one core.
"""

import argparse
import os
import pathlib

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np  # noqa: E402

import retrieval_study as study  # noqa: E402
from retrieval_study import read_wide  # noqa: E402

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


def parameters(hemispherical):
    """A property of the leaf would not depend on the source angle."""
    found = {}
    far = 1e6
    for path in sorted(pathlib.Path(hemispherical).glob("q*.csv")):
        angle, value = read_wide(path)
        mean, spread = [1.46, np.log(0.3), 0.15, 0, 0, 0, 0], [far, far, 0.2, 0.2, 3, 3, 0.3]
        x = fit_surface(angle, value[:, BANDS - 400], SURFACE, mean, spread, 0.01)
        found.setdefault(round(float(np.rad2deg(angle[0][0]))), []).append(x)
    everything = np.concatenate([np.array(v) for v in found.values()])
    print("all: a, b, e", everything[:, [2, 3, 6]].mean(0).round(3), "±", everything[:, [2, 3, 6]].std(0).round(3))
    for theta_s in sorted(found):
        x = np.array(found[theta_s])
        print(f"θ_s {theta_s}°, {len(x)} leaves: a, b, e {x[:, [2, 3, 6]].mean(0).round(3)} ± {x[:, [2, 3, 6]].std(0).round(3)}")


def joint(folder):
    """BRF = g·P(dir)·d(λ) + S(dir)·ρ(λ) + b over all views, ρ = 1 or ∝ ((n−1)/(n+1))² of PROSPECT's index.

    The residuals of a view have recipe R's covariance plus a free level of its own (sd .03: the lobe is not that good);
    all views together count as two, since the interior is wrong in the same way in each.
    """
    leaves, recipe, names = study.Leaves(folder), study.RECIPES["R"], study.D
    w = recipe["wavelengths"]
    interior = study.Interior(w, names)
    index = ((interior.n - 1) / (interior.n + 1)) ** 2
    index /= index[(w > 480) & (w < 880)].mean()
    first = study.run(leaves, "R")["x"]
    mean = np.array([study.PRIOR[c][0] for c in names] + [0, 0, 1.46, np.log(0.3), 0.15, 0, 0])
    spread = np.array([study.PRIOR[c][1] for c in names] + [0.1, 0.2, 0.3, 0.6, 0.1, 0.1, 3])
    for title, rho in (("lobe flat in wavelength", np.ones(len(w))), ("lobe follows the index", index)):
        estimate = np.empty_like(leaves.true)
        for i, (angle, value) in enumerate(zip(leaves.angle, leaves.value)):
            y = value[:, w - 400]
            white = np.linalg.inv(np.linalg.cholesky((recipe["cov"] + 0.03**2) * len(y) / 2))

            def surface(z, angle=angle):
                return shapes(np.array([np.clip(z[0], 1.02, 3), z[1], np.clip(z[2], -0.6, 0.6), np.clip(z[3], -0.6, 0.6), z[4], 0, 0]), angle)

            def evaluate(x, y=y, white=white, surface=surface):
                content = {c: np.exp(x[None, j : j + 1]) for j, c in enumerate(names)}
                d, by = interior(content, np.array([[1.5]]), recipe["share"])
                g, (diffuse, specular) = np.exp(x[7]), surface(x[8:])
                residual = g * diffuse[:, None] * d[0] + specular[:, None] * rho + x[6] - y
                column = [g * diffuse[:, None] * by[c][0] * content[c][0] for c in names]
                column += [np.ones_like(y), g * diffuse[:, None] * d[0]]
                for j in range(5):
                    step = np.zeros(5)
                    step[j] = 1e-5
                    plus, minus = surface(x[8:] + step), surface(x[8:] - step)
                    column.append((g * (plus[0] - minus[0])[:, None] * d[0] + (plus[1] - minus[1])[:, None] * rho) / 2e-5)
                r, jacobian = (residual @ white.T).ravel(), np.matmul(white, np.stack(column, -1)).reshape(-1, len(x))
                return r @ r + (((x - mean) / spread) ** 2).sum(), r, jacobian

            x, damping = mean.copy(), 1e-3
            x[:8] = first[i]
            cost, r, jacobian = evaluate(x)
            for _ in range(60):
                hessian = jacobian.T @ jacobian + np.diag(spread**-2.0)
                step = -np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), jacobian.T @ r + (x - mean) / spread**2)
                trial = x + step * min(1.0, 1.0 / np.abs(step).max())
                new = evaluate(trial)
                if new[0] < cost:
                    done = cost - new[0] < 1e-7 * cost
                    x, (cost, r, jacobian), damping = trial, new, max(0.2 * damping, 1e-9)
                    if done:
                        break
                else:
                    damping *= 6
                    if damping > 1e6:
                        break
            estimate[:, i] = [unit * np.exp(x[names.index(c)]) for c, unit, _ in study.SCORED]
        study.line(title, leaves, estimate)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("directions", "parameters", "joint"))
    parser.add_argument("folders", nargs="+", metavar="FOLDER")
    options = parser.parse_args()
    if len(options.folders) != (2 if options.what == "directions" else 1):
        parser.error("directions takes LEAVES OTHERS, parameters takes OTHERS, joint takes LEAVES")
    {"directions": directions, "parameters": parameters, "joint": joint}[options.what](*options.folders)


if __name__ == "__main__":
    main()
