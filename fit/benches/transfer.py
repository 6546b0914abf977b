#!/usr/bin/env python3
"""Fits the principal-plane views of a leaf, predicts the hemispherical views of the same leaf mounted again.

    python3 fit/benches/transfer.py leafbrdf PRINCIPAL_PLANE HEMISPHERICAL [options of `leafbrdf fit`]

Pairs are X.csv and qX.csv, wide files of BRF. Prints how many there are, and median and mean over them of the RMS of measured −
predicted BRF at 480–879 nm, θ_v ≤ 70°. Needs numpy. The BRDF is written out here once more, from the printed equations: Beckmann
facets, V-cavities, Lambert, K = 4π, so give `--normalization cook-torrance`, and no facets, diffuse term or tilt of another kind.
(`--example surface_transfer` does those.)
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

FIRST_NM, LAST_NM, MOST_THETA_V = 480.0, 879.0, 70.0


def wide(path):
    """Angles (θ_s, θ_v, φ_v in degrees, one column a direction), wavelengths, BRF."""
    rows = [line.split(",") for line in path.read_text().splitlines() if line and not line.startswith("#")]
    numbers = lambda row: [float(cell) if cell else np.nan for cell in row]
    angles = np.array([numbers(row[1:]) for row in rows[:3]])
    table = np.array([numbers(row) for row in rows[3:]])
    return angles, table[:, 0], table[:, 1:]


def brdf_specular(n, sigma, theta_s, theta_v, phi_v):
    """Eq. 10 with K = 4π; angles in degrees."""
    s, v, phi = np.radians(theta_s), np.radians(theta_v), np.radians(phi_v)
    cos_a = np.sqrt((1 + np.cos(s) * np.cos(v) + np.sin(s) * np.sin(v) * np.cos(phi)) / 2)
    cos_alpha = np.minimum((np.cos(s) + np.cos(v)) / (2 * cos_a), 1)
    masking = np.minimum(1, 2 * cos_alpha * np.minimum(np.cos(s), np.cos(v)) / cos_a)
    g = np.sqrt(n * n + cos_a**2 - 1)
    fresnel = ((g - cos_a) / (g + cos_a)) ** 2 / 2
    fresnel *= 1 + ((cos_a * (g + cos_a) - 1) / (cos_a * (g - cos_a) + 1)) ** 2
    tan2_alpha = 1 / cos_alpha**2 - 1
    density = np.exp(-tan2_alpha / sigma**2) / (sigma**2 * cos_alpha**4)
    return fresnel * masking * density / (4 * np.pi * np.cos(s) * np.cos(v))


def misfit(bands, path):
    angles, wavelengths, brf = wide(path)
    seen = angles[1] <= MOST_THETA_V
    residuals = []
    for nm, row in zip(wavelengths, brf):
        if FIRST_NM <= nm <= LAST_NM and nm in bands:
            k_l, n, sigma = bands[nm]
            residuals.append((row - k_l - np.pi * brdf_specular(n, sigma, *angles))[seen])
    return np.sqrt(np.nanmean(np.square(residuals)))


def main():
    program, plane, hemisphere, *options = sys.argv[1:]
    pairs = [(one, two) for one in sorted(Path(plane).glob("*.csv")) if (two := Path(hemisphere, "q" + one.name)).exists()]
    with tempfile.TemporaryDirectory() as folder:
        files = [str(one) for one, _ in pairs]
        subprocess.run([program, "fit", *files, "-o", folder, *options], check=True, stdout=subprocess.DEVNULL)
        found = []
        for one, two in pairs:
            with Path(folder, one.stem, "bands.csv").open(newline="") as file:
                rows = [row for row in csv.DictReader(file) if row["k_l"]]
            bands = {float(row["wavelength_nm"]): [float(row[name]) for name in ("k_l", "n", "sigma")] for row in rows}
            found.append(misfit(bands, two))
    print(f"{len(found)} pairs, median {np.median(found):.4f}, mean {np.mean(found):.4f} BRF")


if __name__ == "__main__":
    main()
