"""Packs the published PROSPECT coefficients into one plain CSV a version.

    python -m venv v && v/bin/pip install progeosail==2.1.0 numpy
    v/bin/python pack.py            # writes prospect_5b.csv and prospect_pro.csv beside this file

Only numbers are taken from the package (see PROVENANCE.md). The source files are recognised by their SHA-256, so that
another release cannot slip in unnoticed. Numbers are written with the digits that were published: the 5B file of the
package holds 32-bit floats, whose shortest decimal form restores them.
"""

import hashlib
import importlib.util
import pathlib

import numpy

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = pathlib.Path(importlib.util.find_spec("progeosail").origin).parent

SOURCES = {
    "prospect5_spectra.txt": "a66ffc43a4adb5644a613398ead866460da1ae4555663925b288d35c2a288ee7",
    "prospect_d_spectra.txt": "d22ec7f5672ae5a5903edcdf4d7817baf42ce1c6f337b4f7a84a86a554f2a81b",
    "prospect_pro_spectra.txt": "85a9e1785e73ebb9230f7eb676455b3aa9800b88d2c5530df12697779b52d3f6",
}

UNITS = """\
# wavelength_nm: nm; n: refractive index of leaf material, unitless
# k_ab, k_car{ant}: cm2 ug-1; k_brown: per arbitrary unit; k_w: cm-1; k_m{pro}: cm2 g-1
# source and checksums: PROVENANCE.md; packed by pack.py
"""


def read(name):
    data = (PACKAGE / name).read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    if digest != SOURCES[name]:
        raise SystemExit(f"{name}: SHA-256 {digest}, expected {SOURCES[name]}")
    return numpy.loadtxt(data.decode().splitlines())


def plain(value):
    """Shortest decimal that reads back as the same number, without exponent where that is short."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text


def write(name, head, columns, rows):
    lines = [head.rstrip("\n"), ",".join(columns)]
    lines += [",".join(plain(v) for v in row) for row in rows]
    text = "\n".join(lines) + "\n"
    (HERE / name).write_text(text, encoding="utf-8")
    print(hashlib.sha256(text.encode()).hexdigest(), name)


five = read("prospect5_spectra.txt")
five = numpy.array([[float(str(numpy.float32(v))) for v in row] for row in five])
five = numpy.column_stack([numpy.arange(400, 2501), five])
write(
    "prospect_5b.csv",
    "# PROSPECT-5B: specific absorption coefficients and refractive index\n" + UNITS.format(ant="", pro=""),
    ["wavelength_nm", "n", "k_ab", "k_car", "k_brown", "k_w", "k_m"],
    five,
)

pro = read("prospect_pro_spectra.txt")
d = read("prospect_d_spectra.txt")
assert (d == pro[:, :8]).all(), "PROSPECT-D is PROSPECT-PRO without the last two columns"
write(
    "prospect_pro.csv",
    "# PROSPECT-D (all but the last two columns) and PROSPECT-PRO: specific absorption coefficients and refractive index\n"
    + UNITS.format(ant=", k_ant", pro=", k_prot, k_cbc"),
    ["wavelength_nm", "n", "k_ab", "k_car", "k_ant", "k_brown", "k_w", "k_m", "k_prot", "k_cbc"],
    pro,
)
