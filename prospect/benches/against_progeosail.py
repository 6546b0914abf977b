"""PROSPECT-D, 2101 bands, one thread: this crate beside the Python package progeosail 2.1.0, by turns in one session.

    python -m venv v && v/bin/pip install progeosail==2.1.0
    v/bin/python prospect/benches/against_progeosail.py        # from the workspace's root

Prints the largest difference of the two spectra, then for each path the best time of all rounds and how many times faster
than the package it is. The package's own time is the best of all rounds too, after a call that lets numba compile.
"""

import csv
import io
import subprocess
import sys
import time

import progeosail  # noqa: F401  (loads the tables)
from progeosail.prospect_d import run_prospect

ROUNDS = 8
BENCH = ["cargo", "bench", "-q", "-p", "leafbrdf-prospect", "--bench", "cost", "--"]


def rust(*arguments):
    out = subprocess.run(BENCH + list(arguments), check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(out)))


def python():
    return run_prospect(1.5, 40.0, 8.0, 0.1, 0.012, 0.009, ant=1.0, prospect_version="D")


def main():
    _, r, t = python()
    ours = rust("--spectrum")
    worst = max(
        max(abs(float(row["reflectance"]) - a), abs(float(row["transmittance"]) - b)) for row, a, b in zip(ours, r, t)
    )
    assert len(ours) == len(r) == 2101
    print(f"largest difference of R and T: {worst:.1e}")

    package, paths = float("inf"), {}
    for _ in range(ROUNDS):
        for _ in range(300):
            start = time.perf_counter()
            python()
            package = min(package, time.perf_counter() - start)
        for row in rust():
            paths[row["what"]] = min(paths.get(row["what"], float("inf")), float(row["microseconds"]))
    package *= 1e6
    print(f"{'progeosail 2.1.0':22} {package:8.1f} µs")
    for what, cost in paths.items():
        print(f"{what:22} {cost:8.1f} µs   {package / cost:5.1f} times faster")
    print(f"value with all derivatives / value: {paths['with all derivatives'] / paths['vectorised']:.2f}")
    return 0 if worst < 1e-12 and package / paths["vectorised"] >= 10 and package / paths["portable"] >= 3.5 else 1


if __name__ == "__main__":
    sys.exit(main())
