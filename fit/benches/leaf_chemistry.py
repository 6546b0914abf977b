#!/usr/bin/env python3
"""What `leafbrdf fit --model leaf` says of leaves whose chemistry was measured: RMSE (bias, r2, RMSE within species), and how often
the truth lies within one and two standard errors.

    python3 leaf_chemistry.py LEAFBRDF FOLDER [--all] [-- OPTION ...]

FOLDER holds measurement files and chemistry.csv with the columns leaf, species, cab_ug_cm2, cw_cm, cm_g_cm2. Without --all only the
default call is made (and one with the OPTIONs, where there are any); with it every method under every coupling. Standard library
only.
"""

import argparse
import csv
import glob
import math
import os
import subprocess
import tempfile
import time

QUANTITIES = (("cab", "cab_ug_cm2", 1.0, "C_ab µg cm⁻²"), ("cw", "cw_cm", 1e3, "C_w mg cm⁻²"), ("cm", "cm_g_cm2", 1e3, "C_m mg cm⁻²"))

VARIANTS = [
    ("recommended, dry-matter (default)", []),
    ("recommended, dorsiventral", ["--interior", "dorsiventral"]),
    ("recommended, two-layer", ["--interior", "two-layer"]),
    ("recommended, plain", ["--interior", "plain"]),
    *[
        (f"{method}, {coupling}", ["--method", method, "--coupling", coupling])
        for method in ("two-step", "joint")
        for coupling in ("bousquet", "prospecular", "offset", "gain-offset")
    ],
    ("joint, bousquet, GGX, P1, tilt", ["--method", "joint", "--facets", "ggx", "--diffuse", "p1", "--tilt"]),
    (
        "joint, gain-offset, GGX, P1, tilt, dorsiventral, priors",
        ["--method", "joint", "--coupling", "gain-offset", "--facets", "ggx", "--diffuse", "p1", "--tilt", "--interior", "dorsiventral",
         "--content-priors"],
    ),
]


def table(path):
    with open(path, newline="") as file:
        lines = (line for line in file if not line.startswith("#"))
        return list(csv.DictReader(lines))


def run(program, files, options):
    with tempfile.TemporaryDirectory() as folder:
        begin = time.time()
        done = subprocess.run(
            [program, "fit", *files, "--model", "leaf", "-o", folder, *options], capture_output=True, text=True, check=False
        )
        if done.returncode not in (0, 1):
            raise SystemExit(done.stderr)
        return table(os.path.join(folder, "leaves.csv")), time.time() - begin


def statistics(rows, chemistry, name, column, unit):
    found, true, species, z = [], [], [], []
    for row in rows:
        truth = chemistry.get(row["leaf"])
        if truth and row[name] and truth.get(column):
            found.append(float(row[name]) * unit)
            true.append(float(truth[column]) * unit)
            species.append(truth["species"])
            if row[name + "_se"]:
                z.append(abs(found[-1] - true[-1]) / (float(row[name + "_se"]) * unit))
    n = len(found)
    if n < 3:
        return f"{n} leaves"
    error = [a - b for a, b in zip(found, true)]
    rmse = math.sqrt(sum(e * e for e in error) / n)
    mean_found, mean_true = sum(found) / n, sum(true) / n
    product = sum((a - mean_found) * (b - mean_true) for a, b in zip(found, true))
    spread = sum((a - mean_found) ** 2 for a in found) * sum((b - mean_true) ** 2 for b in true)
    within = []
    for one in set(species):
        own = [e for e, s in zip(error, species) if s == one]
        within += [e - sum(own) / len(own) for e in own]
    inside = math.sqrt(sum(e * e for e in within) / n)
    cover = f", {100 * sum(s < 1 for s in z) / len(z):.0f}/{100 * sum(s < 1.96 for s in z) / len(z):.0f} %" if z else ""
    missing = f", {len(rows) - n} empty" if n < len(rows) else ""
    return f"{rmse:.2f} ({sum(error) / n:+.2f}, {product**2 / spread:.2f}, {inside:.2f}{cover}{missing})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("options", nargs="*")
    arguments = parser.parse_args()
    chemistry = {row["leaf"]: row for row in table(os.path.join(arguments.folder, "chemistry.csv"))}
    files = sorted(path for path in glob.glob(os.path.join(arguments.folder, "*.csv")) if os.path.basename(path) != "chemistry.csv")
    variants = VARIANTS if arguments.all else VARIANTS[:1]
    if arguments.options:
        variants = variants + [(" ".join(arguments.options), arguments.options)]
    print("RMSE (bias, r², RMSE within species, truth within 1 / 1.96 standard errors)")
    for name, options in variants:
        rows, seconds = run(arguments.program, files, options)
        done = [row for row in rows if row["status"] == "done"]
        cells = [f"{label} {statistics(done, chemistry, *quantity)}" for *quantity, label in QUANTITIES]
        rmse = sum(float(row["rmse"]) for row in done) / len(done)
        print(f"{name}: {' | '.join(cells)} | BRDF rmse {rmse:.5f} | {len(done)} of {len(rows)} leaves, {seconds:.1f} s", flush=True)


main()
