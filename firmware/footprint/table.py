#!/usr/bin/env python3
"""Gathers what the boards printed (see src/main.rs) into one table; compares it with the committed one, or replaces that."""

import csv
import sys
from pathlib import Path

BOARDS = ["m0", "m4f", "m33", "rv32"]
GROWTH = 1.03
BEGIN, END = "<!-- footprint: written by `just footprint update` -->\n", "<!-- end of footprint -->\n"

# The bars of issue 6: most allowed on m4f and on m0.
BARS = {
    ("lb_brdf", "instructions"): (125, 5900),
    ("lb_brdf_from_degrees", "instructions"): (260, 14000),
    ("lb_dhrf", "instructions_max"): (25000, 1600000),
    ("lb_fit_band", "instructions"): (525000, 35000000),
    ("lb_brdf", "flash_bytes"): (500, 3584),
    ("surface_and_fit", "flash_bytes"): (8192, 14336),
    ("lb_brdf", "stack_bytes"): (48, 96),
    ("lb_fit_band", "stack_bytes"): (512, 768),
}
NAMES = {
    "lb_brdf": "BRDF from sines and cosines",
    "lb_brdf_from_degrees": "BRDF from degrees",
    "lb_brdf_gradient": "BRDF with gradient",
    "lb_brdf_at": "BRDF at a prepared direction",
    "lb_dhrf": "DHRF, grade E4d",
    "lb_fit_band": "one band: 3 parameters × 260 values, with errors",
    "lb_prospect_slice": "PROSPECT, 400–1000 nm at 5 nm",
    "lb_fit_cab": "N and C_ab from 8 bands",
    "surface_and_fit": "BRDF, DHRF, angles and fit together",
}


def fail(message):
    sys.exit(f"footprint: {message}")


def lines(path):
    for line in path.read_text().splitlines():
        yield line.split()


def board(path):
    """(entry, quantity) → figure, and name → hash."""
    figures, bits, bands = {}, {}, []
    for kind, name, *values in lines(path):
        if kind == "bits":
            bits[name] = values[0]
        elif kind == "instructions" and name.startswith("lb_fit_band_"):
            bands.append(int(values[0]))
        elif kind == "instructions":
            figures[name, "instructions"] = int(values[0])
            if len(values) > 1:
                figures[name, "instructions_max"] = int(values[1])
        elif kind == "stack" and name.startswith("lb_fit_band_"):
            key = ("lb_fit_band", "stack_bytes")
            figures[key] = max(figures.get(key, 0), int(values[0]))
        elif kind == "stack":
            figures[name, "stack_bytes"] = int(values[0])
        elif kind == "flash":
            figures[name, "flash_bytes"] = int(values[0])
        elif kind == "worst":
            figures[name, "most"] = int(values[0])
    figures["lb_fit_band", "instructions"] = round(sum(bands) / len(bands))
    figures["lb_fit_band", "instructions_max"] = max(bands)
    return figures, bits


def measured(folder):
    boards = {name: board(folder / f"{name}.txt") for name in BOARDS}
    host = {line[1]: line[2] for line in lines(folder / "host.txt") if line[0] == "bits"}
    if not host:
        fail("the host printed no bits")
    for name, (_, bits) in boards.items():
        if bits != host:
            fail(f"{name} and the host differ in their bits: {bits} {host}")
    keys = sorted(boards["m4f"][0])
    table = {key: [boards[name][0][key] for name in BOARDS] for key in keys}
    for line in lines(folder / "host.txt"):
        if line[0] == "error":
            # the bits are the same on every board
            table[line[1], "error_1e-8"] = [int(line[2])] * len(BOARDS)
    return table


def read(path):
    with path.open(newline="") as file:
        rows = csv.reader(row for row in file if not row.startswith("#"))
        next(rows)
        return {(entry, quantity): [int(x) for x in values] for entry, quantity, *values in rows}


def compiler_of(path):
    """The version of rustc that a footprint.csv was measured with."""
    for row in path.read_text().splitlines():
        if row.startswith("# rustc "):
            return row.removeprefix("# rustc ")
    fail(f"{path.name} does not say its compiler: run `just footprint update`")


def write(path, table, compiler):
    with path.open("w", newline="") as file:
        file.write("# Costs of the C interface on four boards under QEMU -icount; written by firmware/footprint/run update.\n")
        file.write(f"# rustc {compiler}\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["entry", "quantity", *BOARDS])
        for (entry, quantity), values in sorted(table.items()):
            rows.writerow([entry, quantity, *values])


def grown(table, committed):
    for key, values in table.items():
        for name, now, before in zip(BOARDS, values, committed.get(key, values)):
            if now > before * GROWTH:
                yield f"{name}: {' '.join(key)} has grown from {before} to {now}"
    for key in committed.keys() - table.keys():
        yield f"{' '.join(key)} is in footprint.csv and was not measured"
    for key in table.keys() - committed.keys():
        yield f"{' '.join(key)} was measured and is not in footprint.csv"


def number(x):
    return f"{x:,}" if x < 1_000_000 else f"{x / 1e6:.2f} M"


def markdown(table):
    out = ["| instructions a call | M0 | M4F | M33 | RV32 |", "|---|---|---|---|---|"]
    for entry, name in NAMES.items():
        for quantity, suffix in [("instructions", ""), ("instructions_max", ", at most")]:
            if (entry, quantity) in table:
                out.append(f"| {name}{suffix} | " + " | ".join(number(x) for x in table[entry, quantity]) + " |")
    out += ["", "| flash / stack, bytes | M0 | M4F | M33 | RV32 |", "|---|---|---|---|---|"]
    for entry, name in NAMES.items():
        flash, stack = table.get((entry, "flash_bytes")), table.get((entry, "stack_bytes"))
        cells = [f"{f:,}" + (f" / {s:,}" if stack else "") for f, s in zip(flash, stack or flash)]
        out.append(f"| {name} | " + " | ".join(cells) + " |")
    error = lambda key: f"{table[key, 'error_1e-8'][0] / 1e8:.1e}"
    out += [
        "",
        "| largest relative error, the same on every board | tan²α/σ² < 14 | < 80 |",
        "|---|---|---|",
        f"| BRDF from sines and cosines | {error('lb_brdf_14')} | {error('lb_brdf_80')} |",
        f"| BRDF from degrees | {error('lb_brdf_from_degrees_14')} | {error('lb_brdf_from_degrees_80')} |",
        f"| DHRF, grade E4d | {error('lb_dhrf')} | |",
        "",
    ]
    return "\n".join(out)


def bars(table):
    for key, (m4f, m0) in BARS.items():
        for name, bar in [("m4f", m4f), ("m0", m0)]:
            value = table[key][BOARDS.index(name)]
            word = "reached" if value <= bar else "MISSED"
            print(f"{word:8} {name:4} {' '.join(key):40} {value:>12,} of {bar:>12,}")


def main():
    mode, folder, path, readme = sys.argv[1], *map(Path, sys.argv[2:])
    table = measured(folder)
    compiler = (folder / "compiler.txt").read_text().strip()
    print(markdown(table))
    bars(table)
    text = readme.read_text()
    if BEGIN not in text or END not in text:
        fail(f"{readme.name} has no place for the table")
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    if mode == "update":
        write(path, table, compiler)
        readme.write_text(before + BEGIN + markdown(table) + END + after)
        return
    committed = read(path)
    faults = list(grown(table, committed))
    reference = compiler_of(path)
    if compiler != reference:
        for fault in faults:
            print(f"footprint: (not judged) {fault}")
        print(f"footprint: measured with rustc {compiler}, footprint.csv with {reference}: growth is not judged")
        faults = []
    if text != before + BEGIN + markdown(committed) + END + after:
        faults.append(f"{readme.name} does not show footprint.csv: run `just footprint update`")
    if faults:
        fail("; ".join(faults))
    if compiler == reference:
        print("footprint: no figure has grown by more than 3 %")
    print("footprint: the bits are the host's on every board")


if __name__ == "__main__":
    main()
